#!/usr/bin/env bash
# Cross-compiles for 64-bit ARM and runs under qemu: the tests of the core, of the
# priors, of the engine and of the CPU backend with NEON, then a whole run of hpm_mvs,
# whose maps with the scalar target must have the bytes of the native program's.
# usage: arm64_test.sh NATIVE_HPM_MVS FOLDER. FOLDER is kept for the next run. Exit code
# 77 (= skipped) without the cross compiler, the emulator or the arm64 libraries.
set -euo pipefail
cd "$(dirname "$0")/../.."
native=${1:?usage: arm64_test.sh NATIVE_HPM_MVS FOLDER}
folder=${2:?usage: arm64_test.sh NATIVE_HPM_MVS FOLDER}
build=$folder/build

if [[ $(uname -m) == aarch64 ]]; then
  echo "skipped: this machine is ARM, all other tests run on it" >&2
  exit 77
fi
if ! scripts/install_dependencies.sh --arm64 --check; then
  echo "skipped: run scripts/install_dependencies.sh --arm64" >&2
  exit 77
fi

options=()
if command -v ccache >/dev/null; then options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
mkdir -p "$folder"
cmake --preset arm64 -B "$build" "${options[@]}" >"$folder/cmake.log" 2>&1 ||
  { tail -n 20 "$folder/cmake.log"; exit 1; }

# Each test is a target of the same name.
tests=(
  candidates consistency_filter geometric_term initialize_pixel match_cost median_filter plane
  prior_term refinement rng sampling_pattern sweep take_neighbour update_pixel view_selection warp
  load_image prior triangulation_opencv mine_regions schedule memory_plan lru_cache
  texel_image cpu_targets cpu_views cpu_backend
)
cmake --build "$build" -j 2 --target "${tests[@]/%/_test}" accuracy_test hpm_mvs >"$folder/build.log" 2>&1 ||
  { grep -A 10 -E 'error|FAILED' "$folder/build.log" | head -n 40; exit 1; }

names=$(IFS='|'; echo "${tests[*]}")
ctest --test-dir "$build" -j 2 --output-on-failure --verbose -R "^($names)_test\$" >"$folder/ctest.log" ||
  { grep -E -B 8 'FAILED|Failed|Timeout' "$folder/ctest.log" | head -n 80; exit 1; }
passed=$(grep -c '^ *[0-9]*/.* Passed ' "$folder/ctest.log") || true
echo "passed on ARM: $passed of ${#tests[@]} test programs"
((passed == ${#tests[@]}))

# Without this line only the scalar target would have been shown to work.
grep -E '\[ +OK \] CpuTargets/EveryTarget\..*/neon' "$folder/ctest.log" | sed 's/^[0-9]*: //' ||
  { echo "error: the NEON target has not run" >&2; exit 1; }
qemu-aarch64 -L build/arm64-sysroot "$build/tests/engine/accuracy_test" --gtest_filter='*SmallScene*/neon' | tee "$folder/accuracy.log"
grep -q '\[ *OK \] .*IsAccurate/neon' "$folder/accuracy.log"

tests/same_maps.sh "$folder" "$native" qemu-aarch64 -L build/arm64-sysroot "$build/colmap_plugin/tool/hpm_mvs"
