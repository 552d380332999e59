#!/usr/bin/env bash
# Builds with clang, where every warning is an error, and runs: the tests of the core, of
# the priors, of the engine and of the CPU backend with all SIMD targets of this machine,
# then a whole run of hpm_mvs, whose maps with the scalar target must have the bytes of
# the other compiler's program.
# usage: clang_test.sh COMPILER_ID HPM_MVS FOLDER: CMake's name of the compiler that made
# HPM_MVS. FOLDER is kept for the next run. Exit code 77 (= skipped) without clang++, or
# if COMPILER_ID is clang itself.
set -euo pipefail
cd "$(dirname "$0")/../.."
usage="usage: clang_test.sh COMPILER_ID HPM_MVS FOLDER"
compiler_id=${1:?$usage}
native=${2:?$usage}
folder=${3:?$usage}
build=$folder/build

if [[ $compiler_id == *Clang* ]]; then
  echo "skipped: everything here is built with clang, all other tests run it" >&2
  exit 77
fi
if ! command -v clang++ >/dev/null; then
  echo "skipped: clang++ is not installed; scripts/install_dependencies.sh installs it" >&2
  exit 77
fi

options=(-DCMAKE_CXX_FLAGS=-Werror)
if command -v ccache >/dev/null; then options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
mkdir -p "$folder"
cmake --preset clang -B "$build" "${options[@]}" >"$folder/cmake.log" 2>&1 ||
  { tail -n 20 "$folder/cmake.log"; exit 1; }

# Each test is a target of the same name.
tests=(
  candidates consistency_filter geometric_term initialize_pixel match_cost median_filter plane
  prior_term refinement rng sampling_pattern sweep take_neighbour update_pixel view_selection warp
  prior local_planes mine_regions schedule memory_plan lru_cache
  texel_image cpu_targets cpu_views cpu_backend
)
cmake --build "$build" -j 2 --target "${tests[@]/%/_test}" hpm_mvs >"$folder/build.log" 2>&1 ||
  { grep -A 10 -E 'error|FAILED' "$folder/build.log" | head -n 40; exit 1; }

names=$(IFS='|'; echo "${tests[*]}")
ctest --test-dir "$build" -j 2 --output-on-failure --verbose -R "^($names)_test\$" >"$folder/ctest.log" ||
  { grep -E -B 8 'FAILED|Failed|Timeout' "$folder/ctest.log" | head -n 80; exit 1; }
passed=$(grep -c '^ *[0-9]*/.* Passed ' "$folder/ctest.log") || true
echo "passed, built with clang: $passed of ${#tests[@]} test programs"
((passed == ${#tests[@]}))

# Both programs offer the same SIMD targets.
targets() {
  { "$1" patch_match_stereo --workspace_path x --Hpm.cpu_target none 2>&1 || true; } | grep -o 'use one of .*'
}
offered=$(targets "$native")
offered_by_clang=$(targets "$build/colmap_plugin/tool/hpm_mvs")
echo "targets: $offered_by_clang"
if [[ $offered_by_clang != "$offered" ]]; then
  echo "error: the other compiler's program says: $offered" >&2
  exit 1
fi

tests/same_maps.sh "$folder" "$native" "$build/colmap_plugin/tool/hpm_mvs"
