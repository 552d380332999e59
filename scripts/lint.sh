#!/usr/bin/env bash
# clang-tidy over the given sources, or over all of src/ and colmap_plugin/.
# Needs a configured build folder: BUILD, by default build/release.
set -euo pipefail
cd "$(dirname "$0")/.."

build=${BUILD:-build/release}
if [[ ! -f $build/compile_commands.json ]]; then
  echo "error: $build/compile_commands.json is missing; run cmake --preset release first" >&2
  exit 2
fi
files=("$@")
if ((${#files[@]} == 0)); then
  mapfile -t files < <(find src colmap_plugin -name '*.cc' | sort)
fi
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "$(nproc)" clang-tidy -p "$build" --quiet
echo "lint: ${#files[@]} files are clean"
