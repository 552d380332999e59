#!/usr/bin/env bash
# The source archive of a release, hpm_mvs-<version>.tar.xz, from what is committed (HEAD):
# all that building, testing and the demo need beside the packages of
# install_dependencies.sh, so that it builds without a network.
# The same commit gives the same bytes.
# usage: make_source_archive.sh [FOLDER]    FOLDER: where it goes, by default build
set -euo pipefail
folder=$(realpath -m "${1:-$(dirname "$0")/../build}")
cd "$(dirname "$0")/.."

git rev-parse --git-dir >/dev/null 2>&1 || {
  echo "error: $PWD is no git repository; the archive is made of what is committed" >&2
  exit 2
}
version=$(git show HEAD:./VERSION)
mkdir -p "$folder"
archive=$folder/hpm_mvs-$version.tar.xz
git archive --format=tar --prefix="hpm_mvs-$version/" HEAD | xz -T1 -6 >"$archive.tmp"
mv "$archive.tmp" "$archive"
if [[ -n $(git status --porcelain) ]]; then
  echo "note: what is not committed is not in the archive" >&2
fi
echo "$archive"
