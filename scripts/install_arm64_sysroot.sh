#!/usr/bin/env bash
# The arm64 libraries that hpm_mvs is cross-compiled with: Debian's packages and all
# they depend on, unpacked into build/arm64-sysroot. The machine itself stays as it is:
# no foreign architecture is added to it, and no root is needed.
#   --check   fetches nothing; exit code 1 when the folder is missing or out of date
# Exit code 77 when the packages cannot be had.
set -euo pipefail
cd "$(dirname "$0")/.."
script=scripts/$(basename "$0")

PACKAGES=(
  libc6-dev
  libeigen3-dev
  libopencv-core-dev libopencv-imgproc-dev libopencv-imgcodecs-dev
  libcgal-dev
  libflann-dev
  libboost-program-options-dev
  libhwy-dev
  libtbb-dev
  libfmt-dev
  libxxhash-dev
  nlohmann-json3-dev
  libgtest-dev libgmock-dev
)
sysroot=$PWD/build/arm64-sysroot

# This script is copied into the folder last: a folder given up halfway, or made by an
# older script, is made again.
if cmp -s "$script" "$sysroot/made_by"; then
  echo "arm64: the libraries are in $sysroot"
  exit 0
fi
if [[ ${1:-} == --check ]]; then
  echo "arm64: the libraries are not in $sysroot"
  exit 1
fi

work=$sysroot.new
rm -rf "$work"
mkdir -p "$work"/{root,apt/{lists/partial,archives/partial,sources}}

# apt for an arm64 machine without a single package, with the sources of this one.
for list in /etc/apt/sources.list /etc/apt/sources.list.d/*.{list,sources}; do
  [[ -f $list ]] || continue
  sed -E 's/\barch=[^] ]*//; /^Architectures:/d' "$list" >"$work/apt/sources/$(basename "$list")"
done
[[ ! -f $work/apt/sources/sources.list ]] || mv "$work"/apt/sources/{sources,main}.list
touch "$work/apt/status"
apt_options=(
  -o APT::Architecture=arm64 -o APT::Architectures=arm64
  -o Dir::Etc::SourceList=/dev/null -o Dir::Etc::SourceParts="$work/apt/sources"
  -o Dir::State::Lists="$work/apt/lists" -o Dir::State::status="$work/apt/status"
  -o Dir::Cache="$work/apt" -o Debug::NoLocking=1 -o APT::Sandbox::User=""
)
echo "arm64: fetching the libraries into $sysroot"
if ! {
  apt-get "${apt_options[@]}" update &&
    apt-get "${apt_options[@]}" install --yes --download-only --no-install-recommends "${PACKAGES[@]}"
} >"$work/log" 2>&1; then
  echo "skipped: the arm64 packages cannot be had:" >&2
  tail -n 3 "$work/log" >&2
  exit 77
fi

# Libraries and headers; no programs, manuals, compilers.
for package in "$work"/apt/archives/*.deb; do
  dpkg-deb --fsys-tarfile "$package" |
    tar -x -C "$work/root" --exclude=./{etc,var,bin,sbin} --exclude=./usr/{bin,sbin,lib/gcc} \
      --exclude=./usr/share/{doc,fonts,icons,locale,man,perl,proj} --exclude='libLLVM*'
done

# What the packages' scripts do on a real machine: absolute links that mean this root,
# and Debian's alternatives.
(
  cd "$work/root"
  find . -type l -lname '/*' -print0 | while IFS= read -r -d '' link; do
    ln -sfr ".$(readlink "$link")" "$link"
  done
  cd usr/lib/aarch64-linux-gnu
  ln -s blas/libblas.so.3 lapack/liblapack.so.3 .
  ln -s hdf5-openmpi.pc pkgconfig/hdf5.pc
)

rm -rf "$sysroot"
mv "$work/root" "$sysroot"
cp "$script" "$sysroot/made_by"
rm -rf "$work"
