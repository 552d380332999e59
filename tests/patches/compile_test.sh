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

mapfile -t glue < <(ninja -C "$build" -t targets all | sed -n 's/^\(.*hpm_in_colmap\.dir.*\.o\):.*/\1/p')

# The compiler's own commands, as the build would first make all of COLMAP and of our library.
sources='(in_colmap/[a-z_]+|automatic_reconstruction|option_manager|dense_reconstruction_widget|exe/(mvs|sfm|colmap))\.cc'
ninja -C "$build" -t commands "${glue[@]}" "${touched[@]}" |
  grep -E -- " -c [^ ]*$sources\$" | sort -u >"$work/commands"
count=$(wc -l <"$work/commands")
((count == 8)) || { echo "error: $count commands in $work/commands, expected 8" >&2; exit 1; }
compile() { # LABEL COMMANDS
  (cd "$build" && tr '\n' '\0' <"$2" | xargs -0 -n 1 -P 2 sh -c)
  echo "compiled $1: 2 files of the glue and 6 that the patch touches"
}
(cd "$build" && sed -n 's/.* -o \([^ ]*\) -c .*/\1/p' "$work/commands" | xargs -n 1 dirname | xargs mkdir -p)
compile "without CUDA" "$work/commands"

# The same sources as a COLMAP with CUDA sees them; CUDA itself takes no part in them.
sed 's/ -c / -DCUDA_ENABLED -fsyntax-only -c /' "$work/commands" >"$work/commands_cuda"
compile "as with CUDA" "$work/commands_cuda"
