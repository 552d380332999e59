#!/usr/bin/env bash
# Builds here what bench/gpu_bench.sh runs, with the shared libraries it needs, and packs it
# into build/gpu_carry.tar.xz, for a machine with a card but without our packages or a network.
#
#   bench/gpu_carry.sh [WORKSPACE...]   # workspaces to take along beside those of data/
#
# GPU_ARCH (90): the card's compute capability. GPU_VARIANTS: more builds of hpm_gpu_bench
# to compare, each NAME=OPTION,OPTION..., e.g. "blocks8=-DHPM_BLOCKS_PER_PROCESSOR=8".
set -euo pipefail
cd "$(dirname "$0")/.."
carry=build/gpu_carry
arch=${GPU_ARCH:-90}

# Configures and builds targets with more options for the kernels: build_in FOLDER OPTIONS TARGET...
build_in() {
  cmake -S . -B "$1" -G Ninja -DCMAKE_BUILD_TYPE=Release -DHPM_CUDA=ON \
    -DCMAKE_CUDA_ARCHITECTURES="$arch-real" -DCMAKE_CUDA_FLAGS="-lineinfo $2" >/dev/null
  cmake --build "$1" --target "${@:3}" >/dev/null
}

# The readers of medical and satellite images that OpenCV's libraries ask for bring 150 MB
# with them; ours never calls one. Libraries of functions that return 0 stand in for them.
write_stand_ins() {
  local codecs=$1 name path
  ldd "$codecs" | awk '$1 ~ /^lib(gdal|gdcm(MSFF|DSED))\.so/ { print $1, $3 }' | while read -r name path; do
    comm -12 <(nm -D --undefined-only "$codecs" | awk '{ print $NF }' | sort -u) \
      <(nm -D --defined-only "$path" | awk '{ print $NF }' | sort -u) |
      awk '{ print ".globl \"" $1 "\"\n\"" $1 "\": xorl %eax, %eax\nret\n.zero 61" }' >"$carry/stand_in.s"
    gcc -shared -nostdlib -o "$carry/lib/$name" -Wl,-soname,"$name" "$carry/stand_in.s"
  done
  rm -f "$carry/stand_in.s"
}

rm -rf "$carry"
mkdir -p "$carry/bin" "$carry/lib" "$carry/scenes"
build_in build/gpu "" hpm_mvs cuda_gpu_test hpm_gpu_bench eval_depth
cp build/gpu/{colmap_plugin/tool/hpm_mvs,tests/cuda/cuda_gpu_test,bench/hpm_gpu_bench,bench/eval_depth} "$carry/bin/"
for variant in ${GPU_VARIANTS:-}; do
  options=${variant#*=}
  build_in "build/gpu_${variant%%=*}" "${options//,/ }" hpm_gpu_bench
  cp "build/gpu_${variant%%=*}/bench/hpm_gpu_bench" "$carry/bin/hpm_gpu_bench_${variant%%=*}"
done
write_stand_ins "$(ldd "$carry/bin/hpm_mvs" | awk '$1 ~ /^libopencv_imgcodecs/ { print $3 }')"
for program in "$carry"/bin/*; do
  # What comes with every compiler stays.
  LD_LIBRARY_PATH=$PWD/$carry/lib ldd "$program" | awk '$3 ~ /^\// { print $3 }' |
    { grep -vE '/(libc|libm|libgcc_s|libstdc\+\+|libdl|libpthread|librt)\.so' || true; }
done | sort -u | while read -r library; do cp -Ln "$library" "$carry/lib/" 2>/dev/null || true; done
strip "$carry"/bin/*
for workspace in "$@"; do
  mkdir -p "$carry/scenes/$(basename "$workspace")"
  cp -r "$workspace"/{images,sparse,stereo} "$carry/scenes/$(basename "$workspace")/"
  if [[ -f $workspace/gt.tar.xz ]]; then cp "$workspace/gt.tar.xz" "$carry/scenes/$(basename "$workspace")/"; fi
done
tar -C build -cJf "$carry.tar.xz" gpu_carry
echo "carry: $(du -sh "$carry.tar.xz" | cut -f1) in $carry.tar.xz"
