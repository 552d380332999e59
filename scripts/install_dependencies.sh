#!/usr/bin/env bash
# Installs everything that hpm_mvs needs to build, test and run its demo on
# Debian 12 or Ubuntu. Works as root and with sudo, does nothing when all is there.
#   --colmap  also what COLMAP itself is built with, for the tests of patches/
#   --colmap-newest  also what COLMAP 4.x is built with beside PoseLib, whose
#             source is to be given to its CMake (patches/README.md)
#   --arm64   also what cross-compiles for ARM and runs it, for tests/arm; exit code 77
#             when the arm64 libraries cannot be had
#   --release also what documents are made and packages, spelling and scripts are checked
#             with and a compiler for Windows; not libc++-dev, which displaces a package of COLMAP's
#   --slurm   also Slurm, with which tests/cluster starts a scheduler of its own
#   --browser also Chromium, in which tests/browser opens the report of a run; where there is
#             no such package, a Chrome on PATH will do
#   --gui     also a virtual display and what presses the buttons of COLMAP's window on it, for
#             tests/patches/press_stereo_button.sh
#   --wheel   also what scripts/build_wheel.sh needs: the assembler of libjpeg-turbo
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
  libxxhash-dev
  nlohmann-json3-dev
  # tests (clang is the second compiler), format, lint
  libgtest-dev libgmock-dev libbenchmark-dev
  clang clang-format clang-tidy
  python3 python3-venv python3-dev
  # what cpack makes the Debian package with
  dpkg-dev file
  # the program whose step we replace; it also runs in the tests
  colmap
)

COLMAP_PACKAGES=(
  libunwind-dev  # of glog; the libunwind of libc++-dev displaces it
  libboost-filesystem-dev libboost-graph-dev libboost-system-dev libboost-test-dev
  libfreeimage-dev libmetis-dev libgoogle-glog-dev libsqlite3-dev liblz4-dev
  libglew-dev libgl-dev qtbase5-dev libqt5opengl5-dev
)

RELEASE_PACKAGES=(
  lintian
  doxygen
  codespell shellcheck
  g++-mingw-w64-x86-64-posix
)

# OpenImageIO's CMake package asks for its tools too.
COLMAP_NEWEST_PACKAGES=(
  "${COLMAP_PACKAGES[@]}"
  libopenimageio-dev openimageio-tools libfaiss-dev libsuitesparse-dev libqt5svg5-dev
)

# The emulator without the package that would let the kernel start it on its own.
ARM64_PACKAGES=(g++-aarch64-linux-gnu qemu-user)

arm64=0
check=0
for argument in "$@"; do
  case $argument in
    --colmap) PACKAGES+=("${COLMAP_PACKAGES[@]}") ;;
    --colmap-newest) PACKAGES+=("${COLMAP_NEWEST_PACKAGES[@]}") ;;
    --release) PACKAGES+=("${RELEASE_PACKAGES[@]}") ;;
    --arm64) arm64=1; PACKAGES+=("${ARM64_PACKAGES[@]}") ;;
    --slurm) PACKAGES+=(slurm-wlm munge) ;;
    --browser) PACKAGES+=(chromium) ;;
    --gui) PACKAGES+=(xvfb xdotool scrot libgl1-mesa-dri) ;;
    --wheel) PACKAGES+=(nasm) ;;
    --check) check=1 ;;
    --help) sed -n '2,/^set /s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "usage: scripts/install_dependencies.sh [--colmap] [--colmap-newest] [--arm64] [--release] [--slurm] [--browser] [--gui] [--wheel] [--check]" >&2; exit 2 ;;
  esac
done
# The arm64 libraries belong to no package manager's list.
finish() {
  ((arm64)) || exit 0
  if ((check)); then exec "$(dirname "$0")/install_arm64_sysroot.sh" --check; fi
  exec "$(dirname "$0")/install_arm64_sysroot.sh"
}

missing=()
for package in "${PACKAGES[@]}"; do
  status=$(dpkg-query -W -f='${db:Status-Abbrev}' "$package" 2>/dev/null || true)
  [[ $status == ii* ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  echo "dependencies: all ${#PACKAGES[@]} packages are installed"
  finish
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
finish
