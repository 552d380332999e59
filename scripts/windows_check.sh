#!/usr/bin/env bash
# Whether sources compile for Windows, by mingw-w64 as Debian has it: the given ones, or all of
# the library and of hpm_mvs. Nothing is linked (-fsyntax-only): there are no libraries of that
# system here; the headers of Eigen, OpenCV, oneTBB, Boost, fmt and Highway are Debian's.
# Exit code 77 without the compiler.
set -euo pipefail
cd "$(dirname "$0")/.."

mingw=x86_64-w64-mingw32-g++-posix
command -v $mingw >/dev/null || {
  echo "skipped: $mingw is not installed; scripts/install_dependencies.sh --release installs it" >&2
  exit 77
}
# Headers that know no system: /usr/include as a whole holds the C library of this one.
include=build/windows-include
mkdir -p "$include"
for headers in eigen3 opencv4 fmt nlohmann boost tbb oneapi hwy flann xxhash.h xxh3.h; do
  [[ ! -e /usr/include/$headers ]] || ln -sfn "/usr/include/$headers" "$include/$headers"
done

files=("$@")
if ((${#files[@]} == 0)); then
  # CGAL's triangulation is left out, since GMP has other headers on each system; OpenCV's takes
  # its place.
  mapfile -t files < <(find src colmap_plugin -name '*.cc' ! -path '*/in_colmap/*' \
    ! -name '*_posix.cc' ! -name triangulation_cgal.cc | sort)
fi
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P 2 $mingw -std=c++17 -fsyntax-only \
  -Wall -Wextra -Werror -Wno-unknown-pragmas \
  -DNOMINMAX -DWIN32_LEAN_AND_MEAN -D_USE_MATH_DEFINES -DFMT_HEADER_ONLY \
  -DHPM_VERSION='"x"' -DHPM_MVS_FROM_WRAPPER='"x"' \
  -I. -isystem "$include" -isystem "$include/eigen3" -isystem "$include/opencv4" \
  -isystem "/usr/include/$(gcc -print-multiarch)/opencv4"
echo "windows: ${#files[@]} sources compile"
