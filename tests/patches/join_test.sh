#!/usr/bin/env bash
# in_colmap.cmake joins our library to COLMAP without a cycle: stand-ins with the libraries of
# COLMAP, and its rule against cycles, are configured as a patched COLMAP is.
# usage: join_test.sh FOLDER
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
work=${1:?usage: join_test.sh FOLDER}
rm -rf "$work"

fail() { echo "FAILED: $*" >&2; exit 1; }
stand_in() { # NAME FOLDER_OF_MVS CMAKE_LINES: a COLMAP of only these libraries
  local source=$work/$1
  mkdir -p "$source/$2"
  touch "$source/empty.cc"
  echo 'int main() {}' >"$source/main.cc"
  cat >"$source/CMakeLists.txt" <<EOF
cmake_minimum_required(VERSION 3.12)
project(COLMAP LANGUAGES C CXX)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
include(\${HPM_MVS_DIR}/colmap_plugin/in_colmap/in_colmap.cmake)
$3
EOF
  cmake -S "$source" -B "$source/build" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DHPM_MVS_DIR="$root" >"$source/cmake.log" 2>&1 ||
    { tail -n 12 "$source/cmake.log" >&2; fail "$1 cannot be configured"; }
}
ours() { echo "$work/$1/build"; }
links_us() { # NAME TARGET: its link command has our library before COLMAP's own
  local command
  command=$(ninja -C "$(ours "$1")" -t commands "$2" | tail -n 1)
  [[ $command == *libhpm_in_colmap.a* ]] || fail "$1: $2 is not linked with our library"
  [[ $command == *libhpm_in_colmap.a*lib"$3".a* ]] ||
    fail "$1: $2 has nothing of $3 after our library, which needs it"
}

stand_in 3.8 src/mvs '
add_library(colmap STATIC empty.cc)
add_executable(colmap_exe main.cc)
target_link_libraries(colmap_exe colmap)'
links_us 3.8 colmap_exe colmap

stand_in later src/colmap/mvs '
set_property(GLOBAL PROPERTY GLOBAL_DEPENDS_NO_CYCLES ON)
foreach(name mvs controllers exe ui)
  add_library(colmap_${name} STATIC empty.cc)
endforeach()
target_link_libraries(colmap_controllers PRIVATE colmap_mvs)
target_link_libraries(colmap_exe PUBLIC colmap_controllers colmap_mvs)
target_link_libraries(colmap_ui PUBLIC colmap_controllers)
add_library(colmap_mvs_cuda STATIC empty.cc)
target_link_libraries(colmap_mvs_cuda PUBLIC colmap_mvs)
add_executable(colmap_main main.cc)
target_link_libraries(colmap_main colmap_exe)
add_executable(controller_test main.cc)
target_link_libraries(controller_test colmap_controllers)'
links_us later colmap_main colmap_mvs
links_us later controller_test colmap_mvs
echo "ok: our library is joined to COLMAP of both kinds"
