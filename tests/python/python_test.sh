#!/usr/bin/env bash
# The Python package in a fresh venv, beside the newest pycolmap. Exit code 77 where what it
# needs cannot be had.
#   --installed  its module is built against what the build folder installs
#   --whole      everything is built, by `pip install` of the tree
#   --portable   the wheel that runs on other systems, by scripts/build_wheel.sh
# usage: python_test.sh --installed|--whole|--portable BUILD_FOLDER FOLDER PYTHON
set -euo pipefail
usage="usage: python_test.sh --installed|--whole|--portable BUILD_FOLDER FOLDER PYTHON"
how=${1:?$usage}
build=$(realpath "${2:?$usage}")
work=$(realpath -m "${3:?$usage}")
python=${4:?$usage}
cd "$(dirname "$0")/../.."
source=$PWD
mkdir -p "$work"
log=$work/log.txt
fail() { echo "FAILED: $*" >&2; exit 1; }
skip() { echo "skipped: $*" >&2; exit 77; }
config=(-C "cmake.define.CMAKE_CXX_COMPILER_LAUNCHER=${HPM_LAUNCHER:-}" -C "build-dir=$work/build")

include=$("$python" -c 'import sysconfig; print(sysconfig.get_path("include"))')
[[ -f $include/Python.h ]] ||
  skip "no headers of $python; scripts/install_dependencies.sh installs Debian's (python3-dev)"

echo "== a fresh venv"
rm -rf "$work/venv" "$work/wheels"
"$python" -m venv "$work/venv" >"$log" 2>&1 || skip "$python makes no venv: $(tail -n 1 "$log")"
"$work/venv/bin/python" -m pip install --quiet --only-binary :all: numpy >>"$log" 2>&1 ||
  skip "no way to the registry: $(tail -n 1 "$log")"
"$work/venv/bin/python" -m pip install --quiet --only-binary :all: pycolmap >>"$log" 2>&1 ||
  echo "no wheel of pycolmap for this machine; its tests are skipped"

install_wheel() {
  "$work/venv/bin/python" -m pip install --no-deps "$work"/wheels/*.whl >>"$log" 2>&1 ||
    { tail "$log"; fail "installing the wheel"; }
}

case $how in
  --whole)
    echo "== pip install of the tree"
    "$work/venv/bin/python" -m pip install --no-deps "${config[@]}" "$source" >>"$log" 2>&1 ||
      { tail -n 30 "$log"; fail "pip install"; }
    ;;
  --portable)
    echo "== the portable wheel"
    PATH=$work/venv/bin:$PATH scripts/build_wheel.sh "$work/wheels" "${config[@]}" >>"$log" 2>&1 || { tail -n 30 "$log"; fail "the wheel"; }
    compgen -G "$work/wheels/*manylinux*.whl" >/dev/null || fail "it is for this system alone: $(ls "$work/wheels")"
    install_wheel
    ;;
  --installed)
    echo "== the wheel"
    # The tools stay from run to run: they do not change what is tested.
    tools=$work/tools
    "$tools/bin/python" -c "import nanobind, scikit_build_core" 2>/dev/null || {
      rm -rf "$tools"
      "$python" -m venv "$tools"
      "$tools/bin/python" -m pip install --quiet --only-binary :all: nanobind scikit-build-core >>"$log" 2>&1 ||
        skip "no way to the registry: $(tail -n 1 "$log")"
    }
    rm -rf "$work/prefix"
    cmake --install "$build" --prefix "$work/prefix" >>"$log"
    "$tools/bin/python" -m pip wheel --no-deps --no-build-isolation --wheel-dir "$work/wheels" \
      "${config[@]}" -C cmake.source-dir=python -C "cmake.define.CMAKE_PREFIX_PATH=$work/prefix" \
      "$source" >>"$log" 2>&1 || { grep -A 8 -E 'error|FAILED' "$log" | head -n 60; fail "building the wheel"; }
    install_wheel
    ;;
  *) fail "$usage" ;;
esac

failed=()
for test in "$source"/tests/python/*_test.py; do
  echo "== ${test##*/}"
  # Not from the tree, where another hpm_mvs would be found first.
  (cd "$work" && PYTHONPATH=$source/tests/cli "$work/venv/bin/python" "$test") || failed+=("${test##*/}")
done
((${#failed[@]} == 0)) || fail "${failed[*]}"
echo "ok"
