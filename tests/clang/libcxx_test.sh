#!/usr/bin/env bash
# Clang with its own C++ library, as on a Mac. Every source of the library and of hpm_mvs
# compiles with it. Debian's OpenCV, Boost and fmt are built for GCC's library and do not link
# with it, so of the tests those are built and run that need none of them: src/base and src/core.
# usage: libcxx_test.sh FOLDER. Exit code 77 (= skipped) without clang++ or libc++.
set -euo pipefail
work=$(realpath -m "${1:?usage: libcxx_test.sh FOLDER}")
cd "$(dirname "$0")/../.."

fail() { echo "FAILED: $*" >&2; exit 1; }

launcher=()
if command -v ccache >/dev/null; then launcher=(ccache); fi
gtest=/usr/src/googletest

# check_sources FIND_EXPRESSION...: each source of the library and of hpm_mvs, as far as a
# compiler can judge alone.
check_sources() {
  find src colmap_plugin -name '*.cc' ! -path '*/in_colmap/*' "$@" | sort >"$work/sources"
  local status=0
  xargs -P 2 -I SOURCE "${compiler[@]}" -Wall -Wextra -Werror -fsyntax-only SOURCE \
    <"$work/sources" >"$work/compile.log" 2>&1 || status=$?
  if ((status != 0)); then
    grep -E 'error' "$work/compile.log" | head -n 30
    fail "not all sources compile"
  fi
  echo "compiled: $(wc -l <"$work/sources") sources"
}

# build_test PROGRAM SOURCE...: with GoogleTest built by the same compiler. The libraries to
# link stand in the array libraries.
build_test() {
  local program=$1 source object objects=()
  shift
  for source in "$gtest"/googletest/src/gtest-all.cc "$gtest"/googlemock/src/gmock-all.cc \
    "$gtest"/googletest/src/gtest_main.cc "$@"; do
    object=$work/$(tr / _ <<<"$source").o
    "${launcher[@]}" "${compiler[@]}" -w -O1 -I"$gtest/googletest" -I"$gtest/googletest/include" \
      -I"$gtest/googlemock" -I"$gtest/googlemock/include" -c "$source" -o "$object" 2>"$work/build.log" ||
      { grep -m 10 -A 3 error "$work/build.log"; fail "$source does not compile"; }
    objects+=("$object")
  done
  "${compiler[@]}" "${objects[@]}" "${libraries[@]}" -o "$program" 2>"$work/build.log" ||
    { head -n 20 "$work/build.log"; fail "$(basename "$program") does not link"; }
}

mkdir -p "$work"
if ! echo 'int main() {}' | clang++ -stdlib=libc++ -include string -x c++ - -o "$work/probe" 2>/dev/null; then
  echo "skipped: clang++ with libc++ is not installed: apt-get install libc++-dev, which displaces libunwind-dev, of COLMAP's glog" >&2
  exit 77
fi
compiler=(
  clang++ -stdlib=libc++ -std=c++17 -ffp-contract=off -DFMT_HEADER_ONLY
  -DHPM_VERSION='"x"' -DHPM_MVS_FROM_WRAPPER='"x"'
  -I. -isystem /usr/include/eigen3 -isystem /usr/include/opencv4
  -isystem "/usr/include/$(gcc -print-multiarch)/opencv4"
)
libraries=(-pthread)

echo "== every source compiles"
check_sources ! -name '*_windows.cc'

echo "== base and core are built and their tests run"
[[ -d $gtest ]] || { echo "libgtest-dev is not installed; the rest is left out"; exit 0; }
base=(src/base/*.cc src/base/platform/numbers.cc src/base/platform/*_posix.cc)
run() { # NAME SOURCE...
  local program=$work/$1
  shift
  build_test "$program" "$@"
  "$program" >"$program.log" 2>&1 || { grep -v -E ' OK |RUN ' "$program.log" | tail -n 40; fail "$program"; }
  echo "$(basename "$program"): $(grep -E '^\[  PASSED' "$program.log")"
}
run platform_test "${base[@]}" tests/base/platform/*.cc
run core_test src/core/*.cc tests/core/*_test.cc
