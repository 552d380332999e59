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

configure() { # BUILD_FOLDER FLAGS
  cmake -S "$source" -B "$1" -G Ninja -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS="$2 -w" \
    -DHPM_MVS_DIR="$root" -DCUDA_ENABLED=OFF -DGUI_ENABLED=ON -DCGAL_ENABLED=OFF \
    >"$work/cmake.log" 2>&1 || { tail -n 20 "$work/cmake.log"; return 1; }
}
library=src/CMakeFiles/colmap.dir
program=src/exe/CMakeFiles/colmap_exe.dir
touched=(
  "$library/controllers/automatic_reconstruction.cc.o"
  "$library/util/option_manager.cc.o"
  "$library/ui/dense_reconstruction_widget.cc.o"
  "$program/colmap.cc.o" "$program/mvs.cc.o" "$program/sfm.cc.o"
)

configure "$work/build" ""
ninja -C "$work/build" -j2 hpm_in_colmap "${touched[@]}"
echo "compiled without CUDA: the glue and ${#touched[@]} patched files"

# The same sources as a COLMAP with CUDA compiles them; CUDA itself takes no part in them.
configure "$work/build_cuda" "-DCUDA_ENABLED -fsyntax-only"
ninja -C "$work/build_cuda" -t commands hpm_in_colmap "${touched[@]}" |
  grep -E 'in_colmap/[a-z_]+\.cc|automatic_reconstruction\.cc|dense_reconstruction_widget\.cc|exe/(mvs|sfm|colmap)\.cc' |
  grep -v hpm_mvs/ >"$work/commands"
[[ $(wc -l <"$work/commands") -ge 7 ]] || { echo "error: too few commands in $work/commands" >&2; exit 1; }
(cd "$work/build_cuda" && bash -e "$work/commands")
echo "compiled as with CUDA: $(wc -l <"$work/commands") files"
