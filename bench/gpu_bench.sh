#!/usr/bin/env bash
# Builds the CUDA backend on a machine with CUDA, runs the GPU tests, compute-sanitizer on
# small cases and the benchmarks, and writes bench/results/gpu-<card>-<date>.json beside
# logs in OUT_DIR. Needs nvcc and g++; the libraries from the system or, without a network,
# from build/gpu_carry (bench/gpu_carry.sh). No CMake.
#
#   bench/gpu_bench.sh [OUT_DIR]          # default build/gpu_out
#   STEPS="build test" bench/gpu_bench.sh # some of: build test sanitize bench
#   BENCH_ARGS="--quick 1 --srcs 10" bench/gpu_bench.sh
#
# A step that fails is reported and the next one runs; the exit code tells at the end.
set -uo pipefail
cd "$(dirname "$0")/.."
source bench/gpu/sources.sh

out=${1:-build/gpu_out}
steps=${STEPS:-build test sanitize bench}
objects=build/gpu_objects
mkdir -p "$out" "$objects"
failed=()

cuda=${CUDA_HOME:-/usr/local/cuda}
nvcc=$(command -v nvcc || echo "$cuda/bin/nvcc")
[[ -x $nvcc ]] || { echo "error: nvcc is not found; set CUDA_HOME" >&2; exit 2; }
cuda=$(dirname "$(dirname "$(readlink -f "$nvcc")")")
include=(-I"$cuda/include")
if [[ -d $carry/include ]]; then
  include+=(-I"$carry/include" -I"$carry/include/eigen3" -I"$carry/include/opencv4")
  # The old kind of path, which the libraries' own needs are looked up in, too.
  libs=("${shared_libs[@]/#/$carry/lib/}" -Wl,--disable-new-dtags,-rpath,"$PWD/$carry/lib")
  gtest=("$carry"/lib/lib{gtest_main.a,gmock.a,gtest.a})
else
  include+=(-I/usr/include/eigen3 -I/usr/include/opencv4)
  libs=(-ltbb -lgmp -lmpfr -llz4 -lhwy -lopencv_core -lopencv_imgproc)
  gtest=(-lgtest_main -lgmock -lgtest)
fi
capability=$(nvidia-smi --query-gpu=compute_cap --format=csv,noheader 2>/dev/null | head -1 | tr -d '. ')
[[ $capability =~ ^[0-9]+$ ]] || capability=90
card=$(nvidia-smi --query-gpu=name --format=csv,noheader 2>/dev/null | head -1 | tr -c 'A-Za-z0-9\n' '_')
card=${card:-no_card}

object_of() { echo "$objects/${1//\//_}.o"; }

compile() {
  local source=$1 object
  object=$(object_of "$source")
  # Everything is rebuilt when a header is newer; there are few files.
  if [[ -f $object && -z $(find src cuda tests bench "$source" -newer "$object" -name '*.[hc]*' -print -quit) ]]; then
    return 0
  fi
  if [[ $source == *.cu ]]; then
    "$nvcc" -std=c++17 -O3 -DNDEBUG -lineinfo -Xptxas -v -gencode "arch=compute_$capability,code=sm_$capability" \
      "${include[@]}" -I. -c "$source" -o "$object" >"$object.log" 2>&1
  else
    # CGAL's exact predicates change the rounding mode.
    [[ $source == *_cgal.cc ]] && include+=(-frounding-math)
    g++ "${cxx_flags[@]}" "${include[@]}" -c "$source" -o "$object" >"$object.log" 2>&1
  fi || { echo "error: $source" >&2; cat "$object.log" >&2; rm -f "$object"; return 1; }
}

link() {
  local program=$1 source files=()
  shift
  for source in "$@"; do files+=("$(object_of "$source")"); done
  g++ -o "$objects/$program" "${files[@]}" "${extra[@]}" "${libs[@]}" \
    -L"$cuda/lib64" -L"$cuda/targets/x86_64-linux/lib" -lcudart_static -lpthread -ldl -lrt
}

step_build() {
  local all=("${library_sources[@]}" "${kernel_sources[@]}" "${test_sources[@]}" "${bench_sources[@]}" \
    "${bench_kernel_sources[@]}") jobs=0 status=0 source
  for source in "${all[@]}"; do
    compile "$source" &
    if ((++jobs >= $(nproc))); then wait -n || status=1; ((jobs--)); fi
  done
  while ((jobs-- > 0)); do wait -n || status=1; done
  ((status == 0)) || return 1
  cat "$objects"/*.cu.o.log >"$out/ptxas.txt"
  extra=("${gtest[@]}")
  link gpu_test "${library_sources[@]}" "${kernel_sources[@]}" "${test_sources[@]}" || return 1
  extra=()
  link gpu_bench "${library_sources[@]}" "${kernel_sources[@]}" "${bench_sources[@]}" "${bench_kernel_sources[@]}"
}

step_test() {
  "$objects/gpu_test" 2>&1 | tee "$out/gpu_tests.txt" | grep -E "^\[  (PASSED|FAILED|SKIPPED)|basic|cost difference"
  return "${PIPESTATUS[0]}"
}

step_sanitize() {
  local sanitizer tool status=0
  sanitizer=$(command -v compute-sanitizer || echo "$cuda/bin/compute-sanitizer")
  [[ -x $sanitizer ]] || { echo "compute-sanitizer is not here"; return 1; }
  for tool in memcheck racecheck initcheck synccheck; do
    "$sanitizer" --tool "$tool" --error-exitcode 9 "$objects/gpu_test" \
      --gtest_filter='*EveryVariant.PassesTheSelfTest*' >"$out/sanitizer_$tool.txt" 2>&1 || status=1
    echo "$tool: $(grep -E 'ERROR SUMMARY|RACECHECK SUMMARY|FAILED|PASSED' "$out/sanitizer_$tool.txt" | tr '\n' ' ')"
  done
  return $status
}

step_bench() {
  local result
  result=bench/results/gpu-$card-$(date +%F).json
  "$objects/gpu_bench" --out "$out/gpu_bench.json" ${BENCH_ARGS:-} 2>&1 | tee "$out/gpu_bench.txt"
  [[ ${PIPESTATUS[0]} == 0 && -s $out/gpu_bench.json ]] || return 1
  cp "$out/gpu_bench.json" "$result"
  echo "written: $result"
}

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
