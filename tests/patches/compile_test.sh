#!/usr/bin/env bash
# Compiles what the 3.8 patch touches, and our glue, inside Debian's source package of
# COLMAP: as built without CUDA, then once more as COLMAP with its own stereo.
# usage: compile_test.sh FOLDER. Exit code 77 (= skipped) without the source package or
# the packages COLMAP needs.
set -euo pipefail
cd "$(dirname "$0")/../.."
root=$PWD
work=${1:?usage: compile_test.sh FOLDER}
rm -rf "$work"
mkdir -p "$work"

if ! scripts/install_dependencies.sh --colmap --check; then
  echo "skipped: COLMAP's packages are missing; run scripts/install_dependencies.sh --colmap" >&2
  exit 77
fi
source=$(patches/debian_source.sh "$work/debian") # its own exit code 77
patches/apply.sh "$source"

build=$work/build
cmake -S "$source" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS=-w \
  -DHPM_MVS_DIR="$root" -DCUDA_ENABLED=OFF -DGUI_ENABLED=ON -DCGAL_ENABLED=OFF \
  >"$work/cmake.log" 2>&1 || { tail -n 20 "$work/cmake.log"; exit 1; }

library=src/CMakeFiles/colmap.dir
program=src/exe/CMakeFiles/colmap_exe.dir
touched=(
  "$library/controllers/automatic_reconstruction.cc.o"
  "$library/util/option_manager.cc.o"
  "$library/ui/dense_reconstruction_widget.cc.o"
  "$program/colmap.cc.o" "$program/mvs.cc.o" "$program/sfm.cc.o"
)

# By object, as the library of the glue comes with all of COLMAP.
mapfile -t glue < <(ninja -C "$build" -t targets all | sed -n 's/^\(.*hpm_in_colmap\.dir.*\.o\):.*/\1/p')
((${#glue[@]} == 2)) || { echo "error: ${#glue[@]} files of the glue, expected 2" >&2; exit 1; }
objects=("${glue[@]}" "${touched[@]}")

ninja -C "$build" -j2 "${objects[@]}"
echo "compiled without CUDA: ${#glue[@]} files of the glue and ${#touched[@]} patched files"

# The same sources as a COLMAP with CUDA sees them; CUDA itself takes no part in them.
sources='(in_colmap/[a-z_]+|automatic_reconstruction|dense_reconstruction_widget|exe/(mvs|sfm|colmap))\.cc'
ninja -C "$build" -t commands "${objects[@]}" | grep -E -- " -c [^ ]*$sources\$" |
  sed 's/ -c / -DCUDA_ENABLED -fsyntax-only -c /' >"$work/commands"
count=$(wc -l <"$work/commands")
((count == 7)) || { echo "error: $count commands in $work/commands, expected 7" >&2; exit 1; }
(cd "$build" && bash -e "$work/commands")
echo "compiled as with CUDA: $count files"
