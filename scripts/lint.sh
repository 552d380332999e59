#!/usr/bin/env bash
# clang-tidy over the given sources, or over all of src/, colmap_plugin/, cuda/ and bench/
# that the build compiles. Needs a configured build folder: BUILD, by default build/release.
# .clang-tidy says which checks and why not others. Exit code 77 without clang-tidy.
set -euo pipefail
cd "$(dirname "$0")/.."

command -v clang-tidy >/dev/null || {
  echo "skipped: clang-tidy is not installed; scripts/install_dependencies.sh installs it" >&2
  exit 77
}
build=${BUILD:-build/release}
if [[ ! -f $build/compile_commands.json ]]; then
  echo "error: $build/compile_commands.json is missing; run cmake --preset release first" >&2
  exit 2
fi
files=("$@")
if ((${#files[@]} == 0)); then
  mapfile -t files < <(sed -n 's/^ *"file": "\(.*\)",\{0,1\}$/\1/p' "$build/compile_commands.json" |
    sed "s|^$PWD/||" | grep -E '^(src|colmap_plugin|cuda|bench)/.*\.cc$' | sort -u)
fi
((${#files[@]} > 0)) || { echo "error: no sources in $build/compile_commands.json" >&2; exit 2; }
# A file's findings in one piece.
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "${JOBS:-$(nproc)}" bash -c '
  clang-tidy -p "$0" --quiet "$1" >"${TMPDIR:-/tmp}/lint.$$" 2>/dev/null
  status=$?
  cat "${TMPDIR:-/tmp}/lint.$$"
  rm "${TMPDIR:-/tmp}/lint.$$"
  exit $status' "$build"
echo "lint: ${#files[@]} files are clean"
