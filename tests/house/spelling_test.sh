#!/usr/bin/env bash
# Misspelt words in everything that is committed (codespell). Exit code 77 without it.
set -euo pipefail
cd "$(dirname "$0")/../.."
command -v codespell >/dev/null || {
  echo "skipped: codespell is not installed; scripts/install_dependencies.sh --release installs it" >&2
  exit 77
}
# Names in the code that look like misspelt words: AtLeast(), ReadBy(), the bytes "paDd", kInf;
# the variables called statics.
names=atleast,readby,padd,kinf,statics
spell() { codespell --ignore-words-list "$names" "$@"; }

if echo "teh" | spell - >/dev/null 2>&1; then
  echo "FAILED: codespell does not find a misspelt word" >&2
  exit 1
fi
files() {
  if git rev-parse --git-dir >/dev/null 2>&1; then
    git ls-files
  else
    find . -type f ! -path './build*' ! -path './.*venv/*' | sed 's|^\./||'
  fi
}
# Data, and bytes made up to be read wrong.
files | grep -v -E '^data/.*/|^bench/results/|\.jpg$|^tests/fuzz/seeds/|^tests/house/spelling_test\.sh$' |
  xargs -d '\n' codespell --ignore-words-list "$names"
echo "ok"
