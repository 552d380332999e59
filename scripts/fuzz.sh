#!/usr/bin/env bash
# Fuzzes the readers of files that come from elsewhere, and the matching cost of all SIMD
# targets, each for SECONDS (default 60), with address and undefined-behaviour sanitizers. What is found stays in build/fuzz/findings, the
# corpus grows in build/fuzz/corpus. Exit code 77 without clang.
# usage: scripts/fuzz.sh [SECONDS] [READER...]
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-60}
readers=("${@:2}")
((${#readers[@]} > 0)) || readers=(map graph cfg image_size model_binary model_text pmvs stamp lock project_file cost)
command -v clang++ >/dev/null || { echo "skipped: clang++ is not installed" >&2; exit 77; }
build=build/fuzz
options=()
if command -v ccache >/dev/null; then options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
cmake -S . -B "$build" -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_BUILD_TYPE=RelWithDebInfo -DHPM_CUDA=OFF \
  -DHPM_FUZZ=ON -DHPM_SANITIZE=address,undefined -DCMAKE_CXX_FLAGS=-fsanitize=fuzzer-no-link "${options[@]}" >/dev/null
cmake --build "$build" --target "${readers[@]/#/fuzz_}" >"$build/build.log" || { tail -n 20 "$build/build.log"; exit 1; }
mkdir -p "$build/findings"
failed=()
for reader in "${readers[@]}"; do
  mkdir -p "$build/corpus/$reader"
  log=$build/$reader.log
  "$build/tests/fuzz/fuzz_$reader" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=1024 -max_len=4096 \
    -artifact_prefix="$build/findings/$reader-" "$build/corpus/$reader" "tests/fuzz/seeds/$reader" >"$log" 2>&1 || failed+=("$reader")
  rm -rf /dev/shm/hpm_fuzz_"$reader"_*
  echo "$reader: $(grep -oE 'DONE.*|Done.*runs.*' "$log" | tail -n 1)"
done
if ((${#failed[@]} > 0)); then
  for reader in "${failed[@]}"; do grep -m 3 -E 'ERROR|SUMMARY|terminate' "$build/$reader.log" || true; done
  echo "findings: ${failed[*]}, in $build/findings" >&2
  exit 1
fi
