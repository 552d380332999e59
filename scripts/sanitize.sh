#!/usr/bin/env bash
# Builds with sanitizers and runs the tests, those of the command line included.
# asan: addresses, leaks and undefined behaviour; tsan: races. Left out is what has a
# compiler or flags of its own (arm, clang, fuzz, patches, install, package, site), measures
# quality, needs real COLMAP for long (pycolmap), or has to be loaded before the sanitizer
# (faults).
# usage: scripts/sanitize.sh asan|tsan [arguments of ctest, e.g. -R resume]
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-}
[[ $preset == asan || $preset == tsan ]] || { sed -n 's/^# usage: //p' "$0" >&2; exit 2; }
options=(-DHPM_CUDA=OFF)
if command -v ccache >/dev/null; then options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
cmake --preset "$preset" "${options[@]}" >/dev/null
cmake --build --preset "$preset" >"build/$preset/build.log" || { tail -n 20 "build/$preset/build.log"; exit 1; }
# An allocation that fails is for the program to handle.
export ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=1
export UBSAN_OPTIONS=print_stacktrace=1
export TSAN_OPTIONS=halt_on_error=1:second_deadlock_stack=1:suppressions=$PWD/tests/tsan/suppressions.txt
exec ctest --test-dir "build/$preset" --output-on-failure -j2 \
  -LE 'arm|clang|faults|fuzz|install|package|patches|pycolmap|site' -E 'quality|scripts_test' "${@:2}"
