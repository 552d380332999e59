#!/usr/bin/env bash
# The Debian package: its name, what it depends on, what it holds, that its programs run
# from where they are unpacked, and what lintian says of it.
# usage: deb_test.sh BUILD_FOLDER FOLDER
set -euo pipefail
build=$(realpath "${1:?usage: deb_test.sh BUILD_FOLDER FOLDER}")
work=$(realpath -m "${2:?usage: deb_test.sh BUILD_FOLDER FOLDER}")
root=$(realpath "$(dirname "$0")/../..")
fail() { echo "FAILED: $*" >&2; exit 1; }

for tool in dpkg-shlibdeps:dpkg-dev file:file; do
  command -v "${tool%:*}" >/dev/null || {
    echo "skipped: ${tool#*:} is not installed; scripts/install_dependencies.sh installs it" >&2
    exit 77
  }
done
rm -rf "$work"
mkdir -p "$work"

echo "== names of systems"
cat >"$work/name.cmake" <<END
include($root/cmake/hpm_system_name.cmake)
hpm_system_name(\${file} name)
message("\${name}")
END
name_of() { cmake -Dfile="$1" -P "$work/name.cmake" 2>&1; }
printf 'NAME="Ubuntu"\nVERSION_ID="24.04"\nVERSION="24.04 LTS"\nID=ubuntu\nID_LIKE=debian\n' >"$work/ubuntu"
printf 'PRETTY_NAME="Debian GNU/Linux 12"\nVERSION_ID="12"\nID=debian\n' >"$work/debian"
[[ $(name_of "$work/ubuntu") == ubuntu24.04 ]] || fail "Ubuntu 24.04 is called $(name_of "$work/ubuntu")"
[[ $(name_of "$work/debian") == debian12 ]] || fail "Debian 12 is called $(name_of "$work/debian")"
[[ -z $(name_of "$work/nowhere") ]] || fail "a system that says nothing has a name"

echo "== cpack"
cpack --config "$build/CPackConfig.cmake" -G DEB -B "$work" >"$work/cpack.log" 2>&1 ||
  { tail "$work/cpack.log"; fail "cpack"; }
system=$(name_of /etc/os-release)
version=$(<"$root/VERSION")
package=$work/hpm-mvs_$version-1${system:+~$system}_$(dpkg --print-architecture).deb
[[ -f $package ]] || fail "no $package, but $(echo "$work"/*.deb)"

echo "== fields"
[[ $(dpkg-deb --field "$package" Version) == "$version-1${system:+~$system}" ]] || fail "another version"
[[ $(dpkg-deb --field "$package" Recommends) == colmap ]] || fail "colmap is not recommended"
depends=$(dpkg-deb --field "$package" Depends)
echo "$depends"
# Every library that the programs name comes from a package that is named.
dpkg-deb --extract "$package" "$work/root"
needed=$(objdump -p "$work/root/usr/bin/hpm_mvs" "$work/root/usr/libexec/hpm_mvs/bin/colmap" |
  sed -n 's/^ *NEEDED *//p' | sort -u)
for library in $needed; do
  path=$(ldconfig -p | sed -n "s|^\s*$library .*=> ||p" | head -n 1)
  # Packages know a file by the path it had before /lib became /usr/lib, or after.
  owner=$(dpkg-query --search "$path" "/usr$path" "${path#/usr}" 2>/dev/null | head -n 1 | cut -d: -f1) || true
  [[ -n $owner ]] || fail "no package owns $library"
  [[ ", $depends," == *", $owner "* || ", $depends," == *", $owner,"* ]] || fail "$library of $owner is not in Depends"
done
# One that no program needs is not: FLANN's pkg-config file names MPI and HDF5.
if grep -q -E 'mpi|hdf5' <<<"$depends"; then fail "libraries that are not needed are in Depends"; fi

echo "== contents"
for file in bin/hpm_mvs libexec/hpm_mvs/bin/colmap share/man/man1/hpm_mvs.1.gz \
  share/bash-completion/completions/hpm_mvs share/doc/hpm-mvs/copyright \
  share/doc/hpm-mvs/changelog.gz share/doc/hpm-mvs/changelog.Debian.gz; do
  [[ -f $work/root/usr/$file ]] || fail "/usr/$file is not in the package"
done
[[ ! -e $work/root/usr/include ]] || fail "headers are in the package of the programs"
grep -q "Redistribution and use" "$work/root/usr/share/doc/hpm-mvs/copyright" || fail "no licence in copyright"
if grep -q '^HPM_CGAL:BOOL=ON' "$build/CMakeCache.txt"; then
  grep -q "GPL" "$work/root/usr/share/doc/hpm-mvs/copyright" || fail "copyright does not tell of CGAL"
fi

echo "== the programs, from where they are unpacked"
"$work/root/usr/bin/hpm_mvs" version | grep -q "^hpm_mvs $version," || fail "hpm_mvs does not run"
PATH=/usr/bin:/bin "$work/root/usr/libexec/hpm_mvs/bin/colmap" patch_match_stereo --help |
  grep -q "hpm_mvs $version" || fail "the wrapper does not find hpm_mvs"
apt-get install --simulate -qq "$package" >"$work/apt.log" 2>&1 ||
  { cat "$work/apt.log"; fail "apt cannot resolve what the package depends on"; }

echo "== lintian"
if command -v lintian >/dev/null; then
  # initial-upload-closes-no-bugs: it is not uploaded to Debian.
  lintian --allow-root --fail-on error,warning \
    --suppress-tags initial-upload-closes-no-bugs "$package" || fail "lintian"
else
  echo "lintian is not installed and left out; scripts/install_dependencies.sh --release installs it"
fi
echo "ok: $(basename "$package")"
