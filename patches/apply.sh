#!/usr/bin/env bash
# Puts HPM-MVS into a source tree of COLMAP: patches/apply.sh SOURCE
# Takes it out again, byte for byte:      patches/apply.sh --undo SOURCE
# Only tells what it would do:            patches/apply.sh --check SOURCE
# Exit codes: 0 done or nothing to do, 1 no patch fits, 2 wrong usage.
set -euo pipefail

here=$(cd "$(dirname "$0")" && pwd)
usage="usage: patches/apply.sh [--undo|--check] COLMAP_SOURCE"
action=--apply
[[ ${1:-} == --undo || ${1:-} == --check ]] && action=$1 && shift
(($# == 1)) || { echo "$usage" >&2; exit 2; }
source=$1
if [[ ! -f $source/CMakeLists.txt ]] || ! grep -qi colmap "$source/CMakeLists.txt"; then
  echo "error: $source is not the source tree of COLMAP (no CMakeLists.txt that names it); $usage" >&2
  exit 2
fi

# "3.12.6" from CMakeLists.txt; the newest source calls itself by a version to come.
version=$(sed -nE 's/^(set\(COLMAP_VERSION|project\(COLMAP VERSION|.* VERSION) "?([0-9]+(\.[0-9]+)+)[^0-9].*/\2/p' \
  "$source/CMakeLists.txt" | head -n 1)

# No fuzz: a hunk lands where all its lines are, or nowhere. --check never writes.
run_patch() { # PATCH_FILE OPTION...
  patch --directory="$source" --strip=1 --force --fuzz=0 --no-backup-if-mismatch \
    --reject-file=- --input="$1" "${@:2}"
}
fits() { run_patch "$1" --dry-run --forward >/dev/null 2>&1; }
is_applied() { run_patch "$1" --dry-run --reverse >/dev/null 2>&1; }

# The patch of this very version, of its series, then all others, newest first: what
# counts is whether it fits.
candidates=()
for name in "$version" "${version%.*}"; do
  [[ -f $here/colmap-$name.patch ]] && candidates+=("$here/colmap-$name.patch")
done
mapfile -t all < <(printf '%s\n' "$here"/colmap-*.patch | sort -rV)
candidates+=("${all[@]}")

for patch in "${candidates[@]}"; do
  is_applied "$patch" || continue
  if [[ $action == --undo ]]; then
    run_patch "$patch" --reverse >/dev/null
    echo "took $(basename "$patch") out of $source (COLMAP ${version:-of unknown version})"
  else
    echo "$source already has $(basename "$patch")"
  fi
  exit 0
done
if [[ $action == --undo ]]; then
  echo "error: no patch of ours is in $source, or its lines were changed since" >&2
  exit 1
fi

for patch in "${candidates[@]}"; do
  fits "$patch" || continue
  if [[ $action == --check ]]; then
    echo "$(basename "$patch") fits $source (COLMAP ${version:-of unknown version})"
  else
    run_patch "$patch" --forward >/dev/null
    echo "put $(basename "$patch") into $source (COLMAP ${version:-of unknown version});" \
      "configure it with -DHPM_MVS_DIR=$(dirname "$here")"
  fi
  exit 0
done

echo "error: no patch fits $source (COLMAP ${version:-of unknown version})." >&2
echo "The nearest, $(basename "${candidates[0]}"), says:" >&2
run_patch "${candidates[0]}" --dry-run --forward 2>&1 |
  awk '/^checking file/ { file = $3 } /FAILED at|find file/ { print file ": " $0 }' >&2 || true
exit 1
