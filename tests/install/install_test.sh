#!/usr/bin/env bash
# What users get: `cmake --install` into a prefix, and find_package(hpm_mvs) from another
# project. usage: install_test.sh BUILD_FOLDER FOLDER
set -euo pipefail
build=$(realpath "${1:?usage: install_test.sh BUILD_FOLDER FOLDER}")
work=$(realpath -m "${2:?usage: install_test.sh BUILD_FOLDER FOLDER}")
cd "$(dirname "$0")"
rm -rf "$work"
mkdir -p "$work"
prefix=$work/prefix
fail() { echo "FAILED: $*" >&2; exit 1; }

echo "== cmake --install"
cmake --install "$build" --prefix "$prefix" >"$work/install.log"
version=$("$prefix/bin/hpm_mvs" version | sed -n 's/^hpm_mvs \([0-9.]*\),.*/\1/p')
[[ $version == "$(<../../VERSION)" ]] || fail "the installed program does not run, or is not version $(<../../VERSION)"
# Found by its place beside the wrapper, not by PATH.
PATH=/usr/bin:/bin "$prefix/libexec/hpm_mvs/bin/colmap" patch_match_stereo --help | grep -q "hpm_mvs $version" ||
  fail "the installed wrapper does not find hpm_mvs"

echo "== the manual page"
page=$prefix/share/man/man1/hpm_mvs.1
for option in $("$prefix/bin/hpm_mvs" help | sed -n 's/^  --\([^ ]*\) arg.*/\1/p'); do
  grep -q -- "${option}" "$page" || fail "$option is not in $page"
done
if command -v groff >/dev/null; then
  [[ -z $(groff -man -Tutf8 -ww "$page" 2>&1 >/dev/null) ]] || fail "groff warns of $page"
fi

echo "== the completion"
complete_line() { # WORD... : the last one is completed
  bash -c 'source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _hpm_mvs; echo "${COMPREPLY[*]}"' \
    "$prefix/share/bash-completion/completions/hpm_mvs" "$@"
}
[[ $(complete_line hpm_mvs pat) == patch_match_stereo ]] || fail "the command is not completed"
[[ $(complete_line hpm_mvs patch_match_stereo --workspace_pa) == --workspace_path ]] ||
  fail "an option is not completed"
[[ $(complete_line hpm_mvs patch_match_stereo --Hpm.method hpm_fast_) == hpm_fast_no_nesp ]] ||
  fail "a choice is not completed"
[[ $(complete_line hpm_mvs patch_match_stereo --Hpm.method = hpm_fast_) == hpm_fast_no_nesp ]] ||
  fail "a choice behind = is not completed"
[[ $(complete_line hpm_mvs patch_match_stereo --Hpm.previews "") == "0 1" ]] ||
  fail "a boolean is not completed"

echo "== find_package(hpm_mvs)"
mkdir "$work/source"
cp consumer.cc "$work/source"
cp consumer.cmake "$work/source/CMakeLists.txt"
cmake -S "$work/source" -B "$work/consumer" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" \
  -DHPM_INCLUDE="$prefix/include/hpm_mvs" -DHPM_VERSION="${version%.*}" \
  -DCMAKE_BUILD_TYPE=Debug >"$work/consumer.log" 2>&1 || { tail "$work/consumer.log"; fail "configuring the consumer"; }
cmake --build "$work/consumer" >>"$work/consumer.log" 2>&1 || { grep -A 5 -E 'error|FAILED' "$work/consumer.log" | head -n 30; fail "building the consumer or the headers alone"; }
"$work/consumer/consumer" || fail "running the consumer"

echo "== the examples"
cmake -S ../../examples -B "$work/examples" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" \
  -DCMAKE_BUILD_TYPE=Debug >"$work/examples.log" 2>&1 || { tail "$work/examples.log"; fail "configuring the examples"; }
cmake --build "$work/examples" >>"$work/examples.log" 2>&1 ||
  { grep -A 5 -E 'error|FAILED' "$work/examples.log" | head -n 30; fail "building the examples"; }
"$work/examples/densify_three_images" || fail "running the example"

echo "ok: $version"
