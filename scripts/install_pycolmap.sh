#!/usr/bin/env bash
# Wheels of pycolmap, for the tests that let newer COLMAP read our maps: the newest one into
# .venv, with --before the newest of the series before into .venv-before. Exit code 77 when
# one cannot be had; its tests are then skipped.
set -euo pipefail
cd "$(dirname "$0")/.."

version_in() { # FOLDER: the version of pycolmap that works there
  [[ -x $1/bin/python ]] && "$1/bin/python" -c 'import pycolmap; print(pycolmap.__version__)' 2>/dev/null
}
install_into() { # FOLDER REQUIREMENT
  local version
  if version=$(version_in "$1"); then
    echo "pycolmap: $version is in $1"
    return
  fi
  if python3 -m venv "$1" >"$log" 2>&1 &&
    "$1/bin/python" -m pip install --quiet --only-binary :all: "$2" >>"$log" 2>&1 &&
    version=$(version_in "$1"); then
    echo "pycolmap: installed $version into $1"
    return
  fi
  echo "skipped: no wheel of $2 for this machine or no way to the registry:" >&2
  tail -n 2 "$log" >&2
  exit 77
}
log=$(mktemp)
trap 'rm -f "$log"' EXIT

install_into .venv pycolmap
[[ ${1:-} == --before ]] || exit 0
newest=$(version_in .venv)
install_into .venv-before "pycolmap<${newest%.*}"
