#!/usr/bin/env bash
# Collects into build/gpu_carry the headers and libraries that bench/gpu_bench.sh needs
# beside CUDA and a C++ compiler, for a machine that has neither them nor a network. Run
# it where scripts/install_dependencies.sh has been run, and take the folder along.
set -euo pipefail
cd "$(dirname "$0")/.."
source bench/gpu/sources.sh

rm -rf "$carry"
mkdir -p "$carry/include" "$carry/lib"
cuda=${CUDA_HOME:-/usr/local/cuda}
ours='^/usr/include/(x86_64-linux-gnu/)?(CGAL|boost|flann|fmt|tbb|oneapi|hwy|gtest|gmock|eigen3|opencv4|lz4[a-z]*\.h|gmp[a-z]*\.h|mpfr\.h|mpf2mpfr\.h)'
for source in "${library_sources[@]}" "${test_sources[@]}" "${bench_sources[@]}"; do
  g++ "${cxx_flags[@]}" -I/usr/include/eigen3 -I/usr/include/opencv4 -I"$cuda/include" -M "$source" 2>/dev/null ||
    { echo "error: $source cannot be read; run scripts/install_dependencies.sh" >&2; exit 1; }
done | tr ' \\' '\n\n' | grep -E "$ours" | sort -u |
  while read -r header; do
    target=$carry/include/${header#/usr/include/}
    target=${target/x86_64-linux-gnu\//}
    mkdir -p "$(dirname "$target")"
    cp "$header" "$target"
  done
# Highway includes itself by target through macros that -M follows, but not all of ops/.
cp -r /usr/include/hwy "$carry/include/"
lib=/usr/lib/x86_64-linux-gnu
cp -L "$lib"/lib{gtest,gtest_main,gmock}.a "$carry/lib/"
for name in "${shared_libs[@]}"; do
  cp -L "$lib/$name" "$carry/lib/"
  # What it needs in turn, but for what comes with every compiler.
  ldd "$lib/$name" | awk '$3 ~ /^\// { print $3 }' | grep -vE '/(libc|libm|libgcc_s|libstdc\+\+|libdl|libpthread)\.so' || true
done | sort -u | while read -r library; do cp -L "$library" "$carry/lib/"; done
echo "carry: $(find "$carry" -type f | wc -l) files, $(du -sh "$carry" | cut -f1), in $carry"
