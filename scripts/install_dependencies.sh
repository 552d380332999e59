#!/usr/bin/env bash
# Installs everything that hpm_mvs needs to build, test and run its demo on
# Debian 12 or Ubuntu. Works as root and with sudo, does nothing when all is there.
#   --colmap  also what COLMAP itself is built with, for the tests of patches/
#   --check   installs nothing; exit code 1 when something is missing
set -euo pipefail

PACKAGES=(
  # build
  build-essential cmake ninja-build patch pkg-config xz-utils
  # libraries
  libeigen3-dev
  libopencv-core-dev libopencv-imgproc-dev libopencv-imgcodecs-dev
  libcgal-dev
  libflann-dev
  libboost-program-options-dev
  libceres-dev
  libhwy-dev
  libtbb-dev
  libfmt-dev
  nlohmann-json3-dev
  # tests, format, lint
  libgtest-dev libbenchmark-dev
  clang-format clang-tidy
  python3 python3-venv
  # the program whose step we replace; it also runs in the tests
  colmap
)

COLMAP_PACKAGES=(
  libboost-filesystem-dev libboost-graph-dev libboost-system-dev libboost-test-dev
  libfreeimage-dev libmetis-dev libgoogle-glog-dev libsqlite3-dev liblz4-dev
  libglew-dev libgl-dev qtbase5-dev libqt5opengl5-dev
)

check=0
for argument in "$@"; do
  case $argument in
    --colmap) PACKAGES+=("${COLMAP_PACKAGES[@]}") ;;
    --check) check=1 ;;
    *) echo "usage: scripts/install_dependencies.sh [--colmap] [--check]" >&2; exit 2 ;;
  esac
done

missing=()
for package in "${PACKAGES[@]}"; do
  status=$(dpkg-query -W -f='${db:Status-Abbrev}' "$package" 2>/dev/null || true)
  [[ $status == ii* ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  echo "dependencies: all ${#PACKAGES[@]} packages are installed"
  exit 0
fi

if ((check)); then
  echo "dependencies: missing ${missing[*]}"
  exit 1
fi

as_root=()
if ((EUID != 0)); then
  command -v sudo >/dev/null || {
    echo "error: ${#missing[@]} packages are missing and neither root nor sudo is available." >&2
    echo "Install them yourself: apt-get install ${missing[*]}" >&2
    exit 1
  }
  as_root=(sudo)
fi

echo "dependencies: installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install -y -qq --no-install-recommends "${missing[@]}"
