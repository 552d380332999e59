#!/usr/bin/env bash
# The source archive holds what is committed, and configures and builds without a
# network: unpacked somewhere else, a part of it is built and its test is run.
# usage: source_archive_test.sh FOLDER
set -euo pipefail
work=$(realpath -m "${1:?usage: source_archive_test.sh FOLDER}")
cd "$(dirname "$0")/../.."
fail() { echo "FAILED: $*" >&2; exit 1; }

git rev-parse --git-dir >/dev/null 2>&1 || { echo "skipped: no git repository here" >&2; exit 77; }
rm -rf "$work"
mkdir -p "$work"

archive=$(scripts/make_source_archive.sh "$work")
version=$(git show HEAD:./VERSION)
[[ $archive == "$work/hpm_mvs-$version.tar.xz" ]] || fail "the archive is called $archive"
scripts/make_source_archive.sh "$work/again" >/dev/null
cmp -s "$archive" "$work/again/$(basename "$archive")" || fail "the same commit gives other bytes"

tar -xf "$archive" -C "$work"
tree=$work/hpm_mvs-$version
diff <(cd "$tree" && find . -type f -o -type l | sed 's|^\./||' | LC_ALL=C sort) \
  <(git ls-tree -r --name-only HEAD | LC_ALL=C sort) || fail "the archive does not hold what is committed"

# Nothing is fetched while it is built. A name space without interfaces proves it, where
# one may be made.
offline=()
if unshare --net --map-root-user true 2>/dev/null; then
  offline=(unshare --net --map-root-user)
else
  echo "no name space without a network may be made here: that nothing is fetched is not shown"
fi
options=(-DCMAKE_BUILD_TYPE=Release -DHPM_CUDA=OFF)
if command -v ccache >/dev/null; then options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
"${offline[@]}" cmake -S "$tree" -B "$tree/build" -G Ninja "${options[@]}" >"$work/cmake.log" 2>&1 ||
  { tail "$work/cmake.log"; fail "it does not configure"; }
"${offline[@]}" cmake --build "$tree/build" -j 2 --target rng_test hpm_wrapper >"$work/build.log" 2>&1 ||
  { tail "$work/build.log"; fail "it does not build"; }
ctest --test-dir "$tree/build" -R '^rng_test$' --output-on-failure >"$work/ctest.log" ||
  { tail "$work/ctest.log"; fail "what was built does not run"; }
# All of it, minutes: HPM_WHOLE_ARCHIVE=1.
if [[ ${HPM_WHOLE_ARCHIVE:-0} == 1 ]]; then
  "${offline[@]}" cmake --build "$tree/build" -j 2 >"$work/build.log" 2>&1 ||
    { grep -A 10 FAILED "$work/build.log"; fail "it does not build as a whole"; }
fi
echo "ok: $(basename "$archive"), $(stat -c %s "$archive") bytes"
