#!/usr/bin/env bash
# Every source is formatted as .clang-format says. Exit code 77 (= skipped) without
# clang-format.
set -euo pipefail
cd "$(dirname "$0")/../.."

if ! command -v clang-format >/dev/null; then
  echo "skipped: clang-format is not installed"
  exit 77
fi
folders=(src colmap_plugin bench tests)
[[ -d cuda ]] && folders+=(cuda)
find "${folders[@]}" \
  \( -name '*.h' -o -name '*.cc' -o -name '*.cu' -o -name '*.cuh' \) -print0 |
  xargs -0 clang-format --dry-run -Werror
