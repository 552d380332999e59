#!/usr/bin/env bash
# Unpacks Debian's source package of COLMAP into FOLDER and prints where it lies.
# Needs no root: the lists of source packages are kept beside it, made from the
# machine's own apt sources. Exit code 77 when the registry cannot be reached.
set -euo pipefail

folder=${1:?usage: patches/debian_source.sh FOLDER}
mkdir -p "$folder"/apt/{lists/partial,archives/partial,sources}
folder=$(cd "$folder" && pwd)

# Both notations of apt; only the kind of package changes.
for list in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
  [[ -f $list ]] || continue
  sed -n 's/^deb\b/deb-src/p' "$list" >"$folder/apt/sources/$(basename "$list" .list).list"
done
for list in /etc/apt/sources.list.d/*.sources; do
  [[ -f $list ]] || continue
  sed 's/^Types:.*/Types: deb-src/' "$list" >"$folder/apt/sources/$(basename "$list")"
done
apt_options=(
  -o Dir::Etc::SourceList=/dev/null -o Dir::Etc::SourceParts="$folder/apt/sources"
  -o Dir::State::Lists="$folder/apt/lists" -o Dir::Cache="$folder/apt"
  -o Debug::NoLocking=1 -o APT::Sandbox::User=""
)

if ! { apt-get "${apt_options[@]}" update &&
  cd "$folder" && apt-get "${apt_options[@]}" source --only-source colmap; } >"$folder/apt/log" 2>&1; then
  echo "skipped: Debian's source package of colmap cannot be had, see $folder/apt/log" >&2
  exit 77
fi
rm -rf "$folder/apt"
find "$folder" -maxdepth 1 -type d -name 'colmap-*'
