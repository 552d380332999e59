#!/usr/bin/env bash
# Two builds of hpm_mvs, for two processors or by two compilers, must write the same bytes
# with the scalar target: three images of the demo scene, matched among themselves, very
# small. usage: same_maps.sh FOLDER HPM_MVS COMMAND...: the second one with what starts it.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:?usage: same_maps.sh FOLDER HPM_MVS COMMAND...}
native=${2:?usage: same_maps.sh FOLDER HPM_MVS COMMAND...}
other=("${@:3}")

workspace() { # NAME
  rm -rf "${folder:?}/$1"
  mkdir -p "$folder/$1/stereo"
  cp -r data/workshop/images data/workshop/sparse "$folder/$1"
  printf '%s\n' 0000.jpg '0001.jpg, 0002.jpg' 0001.jpg '0000.jpg, 0002.jpg' \
    0002.jpg '0000.jpg, 0001.jpg' >"$folder/$1/stereo/patch-match.cfg"
}
arguments=(patch_match_stereo --Hpm.device cpu --Hpm.cpu_target scalar --PatchMatchStereo.max_image_size 64)
workspace native
workspace other
"$native" "${arguments[@]}" --workspace_path "$folder/native" >"$folder/native.log"
"${other[@]}" "${arguments[@]}" --workspace_path "$folder/other" >"$folder/other.log"
maps=0
for map in "$folder"/native/stereo/{depth,normal}_maps/*.bin; do
  cmp "$map" "${map/#$folder\/native/$folder/other}"
  maps=$((maps + 1))
done
echo "same bytes: $maps maps"
((maps == 12))
