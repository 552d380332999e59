#!/usr/bin/env bash
# The newest pycolmap wheel into .venv, for the tests that let the newest COLMAP read
# our maps. Exit code 77 when it cannot be had; those tests are then skipped.
set -euo pipefail
cd "$(dirname "$0")/.."

if [[ -x .venv/bin/python ]] && .venv/bin/python -c 'import pycolmap' 2>/dev/null; then
  echo "pycolmap: $(.venv/bin/python -c 'import pycolmap; print(pycolmap.__version__)') is in .venv"
  exit 0
fi
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if python3 -m venv .venv >"$log" 2>&1 &&
  .venv/bin/python -m pip install --quiet --only-binary :all: pycolmap >>"$log" 2>&1 &&
  .venv/bin/python -c 'import pycolmap' >>"$log" 2>&1; then
  echo "pycolmap: installed $(.venv/bin/python -c 'import pycolmap; print(pycolmap.__version__)') into .venv"
  exit 0
fi
echo "skipped: no pycolmap wheel for this machine or no way to the registry:" >&2
tail -n 2 "$log" >&2
exit 77
