#!/usr/bin/env bash
# On a machine with a card: the GPU tests and compute-sanitizer, the kernels by variant, whole
# runs against the CPU, large images, the profiler's counters, most important first. Writes logs and
# JSON to OUT_DIR after each step; needs build/gpu_carry.tar.xz (bench/gpu_carry.sh), no compiler.
#
#   bench/gpu_bench.sh [OUT_DIR]             # default build/gpu_out
#   STEPS="test kernels" bench/gpu_bench.sh  # some of: test kernels runs large profile
#   BENCH_ARGS, RUNS_ARGS: for hpm_gpu_bench and bench/gpu/runs.py
#
# Each step has a time limit of its own. A step that fails is reported and the next one
# runs; the exit code tells at the end.
set -uo pipefail
cd "$(dirname "$0")/.."
out=${1:-build/gpu_out}
steps=${STEPS:-test kernels runs large profile}
carry=$PWD/build/gpu_carry
bin=$carry/bin
export LD_LIBRARY_PATH=$carry/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
PATH=$PATH:/usr/local/cuda/bin
mkdir -p "$out"
failed=()
[[ -d $carry || ! -f $carry.tar.xz ]] || tar -C build -xf "$carry.tar.xz"
[[ -x $bin/hpm_mvs ]] || { echo "error: $carry.tar.xz is not there; run bench/gpu_carry.sh" >&2; exit 2; }

# The tests in four processes and the sanitizer's tools, all at once; what the tests print of
# differences is the report.
step_test() {
  local shard tool status=0 pids=()
  for shard in 0 1 2 3; do
    GTEST_TOTAL_SHARDS=4 GTEST_SHARD_INDEX=$shard timeout 100 "$bin/cuda_gpu_test" \
      --gtest_filter='-*LargeImages*' >"$out/gpu_tests_$shard.txt" 2>&1 &
    pids+=($!)
  done
  for tool in memcheck racecheck initcheck synccheck; do
    timeout 100 compute-sanitizer --tool "$tool" --error-exitcode 9 "$bin/cuda_gpu_test" \
      --gtest_filter='*PassesTheSelfTest*' >"$out/sanitizer_$tool.txt" 2>&1 &
    pids+=($!)
  done
  for shard in "${pids[@]}"; do wait "$shard" || status=1; done
  cat "$out"/gpu_tests_?.txt >"$out/gpu_tests.txt"
  rm "$out"/gpu_tests_?.txt
  grep -E '^\[  (PASSED|FAILED|SKIPPED)|cost difference|: basic|Failure|what\(\)|^error' "$out/gpu_tests.txt" | sort | uniq -c | head -60
  for tool in memcheck racecheck initcheck synccheck; do
    grep -q '\[  PASSED  \] [1-9]' "$out/sanitizer_$tool.txt" || status=1
    echo "$tool: $(grep -E 'ERROR SUMMARY|RACECHECK SUMMARY|FAILED|PASSED' "$out/sanitizer_$tool.txt" | tr '\n' ' ')"
  done
  return $status
}

step_kernels() {
  local program name status=0
  for program in "$bin"/hpm_gpu_bench*; do
    name=$(basename "$program")
    echo "-- $name"
    timeout 60 "$program" --out "$out/${name#hpm_gpu_}.json" ${BENCH_ARGS:-} 2>&1 | tee "$out/$name.txt"
    [[ ${PIPESTATUS[0]} == 0 ]] || status=1
  done
  return $status
}

step_runs() { timeout 130 python3 -u bench/gpu/runs.py --carry "$carry" --out "$out/runs.json" ${RUNS_ARGS:-}; }

# Two bands of the first update of a basic pass.
step_profile() {
  timeout 60 ncu --clock-control none --kernel-name 'regex:Sweep' --launch-skip 8 --launch-count 2 \
    --section SpeedOfLight --section ComputeWorkloadAnalysis --section MemoryWorkloadAnalysis --section WarpStateStats \
    --section Occupancy --section LaunchStats --section InstructionStats \
    "$bin/hpm_gpu_bench" --out "$out/profiled.json" --srcs 10 --width 1600 --height 1065 --samplers 0 \
    --variants "${PROFILE_VARIANT:-byte 8x8}" >"$out/ncu.txt" 2>&1 || return 1
  grep -E 'Sweep|Duration|Registers|Throughput|Hit Rate|Achieved Occ|Theoretical Occ|Executed Ipc|No Eligible|Warp Cycles Per Issued|Local' \
    "$out/ncu.txt" | head -80
}

step_large() { timeout 80 "$bin/cuda_gpu_test" --gtest_filter='*LargeImages*' 2>&1 | tee "$out/large.txt" | tail -5; return "${PIPESTATUS[0]}"; }

{ date -u +%FT%TZ; nvidia-smi --query-gpu=name,driver_version,memory.total,clocks.max.sm --format=csv,noheader; nproc; } 2>&1 | tee "$out/machine.txt"
for step in $steps; do
  echo "== $step"
  start=$SECONDS
  "step_$step" || failed+=("$step")
  echo "== $step took $((SECONDS - start)) s"
done
if ((${#failed[@]} > 0)); then
  echo "failed: ${failed[*]}"
  exit 1
fi
echo "all steps passed"
