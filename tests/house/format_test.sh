#!/usr/bin/env bash
# Every source is formatted as .clang-format says; names those that are not. Exit
# code 77 (= skipped) without clang-format.
set -euo pipefail
cd "$(dirname "$0")/../.."

if ! command -v clang-format >/dev/null; then
  echo "skipped: clang-format is not installed"
  exit 77
fi
folders=(src colmap_plugin bench tests examples python)
[[ -d cuda ]] && folders+=(cuda)
if ! messages=$(find "${folders[@]}" \
  \( -name '*.h' -o -name '*.cc' -o -name '*.cu' -o -name '*.cuh' \) -print0 |
  xargs -0 clang-format --dry-run -Werror 2>&1); then
  sed -n 's/^\([^ :]*\):[0-9]*:[0-9]*: error: .*/\1/p' <<<"$messages" | sort -u
  echo "run clang-format -i on these files"
  exit 1
fi
