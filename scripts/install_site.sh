#!/usr/bin/env bash
# What the documents' site is built with, into .site-venv: mkdocs with its material theme.
# Exit code 77 when it cannot be had. (Doxygen, for the reference of the headers, comes with
# scripts/install_dependencies.sh --release.)
set -euo pipefail
cd "$(dirname "$0")/.."

mkdocs=.site-venv/bin/mkdocs
if [[ -x $mkdocs ]] && $mkdocs --version >/dev/null 2>&1; then
  echo "site: $($mkdocs --version) is in .site-venv"
  exit 0
fi
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if python3 -m venv .site-venv >"$log" 2>&1 &&
  .site-venv/bin/python -m pip install --quiet 'mkdocs-material>=9,<10' >>"$log" 2>&1 &&
  $mkdocs --version >>"$log" 2>&1; then
  echo "site: installed $($mkdocs --version) into .site-venv"
  exit 0
fi
echo "skipped: no mkdocs-material, or no way to the registry:" >&2
tail -n 2 "$log" >&2
exit 77
