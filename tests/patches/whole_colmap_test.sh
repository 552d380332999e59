#!/usr/bin/env bash
# Builds the whole of Debian's COLMAP 3.8 with the patch (no CUDA) and runs the
# demo scene through it: the maps must be those of hpm_mvs, byte for byte.
# usage: whole_colmap_test.sh HPM_MVS FOLDER. COLMAP_BUILD names a finished build, of any
# version, to use instead; patches/README.md tells how to make one. Exit code 77 (= skipped) without the source package or COLMAP's packages.
set -euo pipefail
cd "$(dirname "$0")/../.."
root=$PWD
hpm_mvs=$(realpath "${1:?usage: whole_colmap_test.sh HPM_MVS FOLDER}")
work=${2:?usage: whole_colmap_test.sh HPM_MVS FOLDER}
mkdir -p "$work"

if [[ -z ${COLMAP_BUILD:-} ]]; then
  if ! scripts/install_dependencies.sh --colmap --check; then
    echo "skipped: COLMAP's packages are missing; run scripts/install_dependencies.sh --colmap" >&2
    exit 77
  fi
  rm -rf "$work/debian" "$work/build"
  source=$(patches/debian_source.sh "$work/debian") # its own exit code 77
  patches/apply.sh "$source"
  cmake -S "$source" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DHPM_MVS_DIR="$root" -DCUDA_ENABLED=OFF -DCGAL_ENABLED=OFF >"$work/cmake.log"
  ninja -C "$work/build" -j"${JOBS:-2}" colmap_exe
  COLMAP_BUILD=$work/build
fi
colmap=$(realpath -e "$COLMAP_BUILD/src/colmap/exe/colmap" 2>/dev/null || # 3.9 and later
  realpath -e "$COLMAP_BUILD/src/exe/colmap")

fail() { echo "FAILED: $*" >&2; exit 1; }
fresh() { rm -rf "$work/$1" && mkdir -p "$work/$1" && cp -r data/workshop/{images,sparse,stereo} "$work/$1"; }
same_maps() { # FOLDER FOLDER: maps in the first are those in the second, and there are some
  local kind
  for kind in depth_maps normal_maps; do
    [[ -n $(find "$1/stereo/$kind" -name '*.bin') ]] || fail "no maps in $1/stereo/$kind"
    diff -rq "$1/stereo/$kind" "$2/stereo/$kind" || fail "maps of $1 and $2 differ"
  done
  echo "ok: the maps of $(basename "$1") and $(basename "$2") are the same"
}
options=(--PatchMatchStereo.max_image_size 200)

echo "== the commands"
"$colmap" help >"$work/help.txt"
grep -q '^  hpm_patch_match_stereo$' "$work/help.txt" || fail "colmap help does not name our command"
fresh direct
"$hpm_mvs" patch_match_stereo --workspace_path "$work/direct" "${options[@]}" >"$work/direct.log"
fresh command
"$colmap" hpm_patch_match_stereo --workspace_path "$work/command" "${options[@]}" >"$work/command.log"
same_maps "$work/direct" "$work/command"
fresh in_place
"$colmap" patch_match_stereo --workspace_path "$work/in_place" "${options[@]}" >"$work/in_place.log"
same_maps "$work/direct" "$work/in_place"
"$colmap" stereo_fusion --workspace_path "$work/in_place" --output_path "$work/fused.ply" >"$work/fusion.log"
points=$(LC_ALL=C sed -n 's/^element vertex //p' "$work/fused.ply")
((points > 2000)) || fail "only $points fused points"
echo "ok: $points points"
cp "$work/fused.ply" "$work/in_place/fused.ply"
cp "$work/fused.ply.vis" "$work/in_place/fused.ply.vis"
for mesher in poisson delaunay; do
  output=$work/meshed-$mesher.ply
  # Newer versions of COLMAP trim away all that so few points make.
  input=$work/fused.ply mesher_options=(--PoissonMeshing.depth 7 --PoissonMeshing.trim 3)
  [[ $mesher == delaunay ]] && input=$work/in_place mesher_options=()
  rm -f "$output"
  "$colmap" "${mesher}_mesher" --input_path "$input" --output_path "$output" \
    "${mesher_options[@]}" >"$work/$mesher.log" 2>&1 || true
  if [[ ! -s $output ]] && grep -qi CGAL "$work/$mesher.log"; then
    echo "skipped: this COLMAP was built without CGAL, which ${mesher}_mesher needs"
    continue
  fi
  faces=$(LC_ALL=C sed -n 's/^element face //p' "$output")
  ((faces > 1000)) || fail "${mesher}_mesher made only $faces triangles"
  echo "ok: ${mesher}_mesher made $faces triangles"
done

echo "== failures"
fresh broken
echo "no picture" >"$work/broken/images/0003.jpg"
code=0
"$colmap" hpm_patch_match_stereo --workspace_path "$work/broken" "${options[@]}" >"$work/broken.log" 2>&1 || code=$?
((code == 4)) || fail "exit code $code of hpm_patch_match_stereo with a broken image, expected 4"
rm -r "$work/broken" && fresh broken
echo "no picture" >"$work/broken/images/0003.jpg"
code=0
"$colmap" patch_match_stereo --workspace_path "$work/broken" "${options[@]}" >"$work/broken2.log" 2>&1 || code=$?
((code != 0)) || fail "exit code 0 of patch_match_stereo with a broken image"
grep -q 0003.jpg "$work/broken2.log" || fail "the broken image is not named"
[[ -f $work/broken/stereo/depth_maps/0005.jpg.geometric.bin ]] || fail "the other images were given up"
echo "ok: a broken image gives exit codes 4 and $code, the others are computed"

echo "== automatic_reconstructor"
rm -rf "$work/auto" && mkdir -p "$work/auto/sparse/0"
cp data/workshop/sparse/* "$work/auto/sparse/0"
"$colmap" automatic_reconstructor --workspace_path "$work/auto" --image_path data/workshop/images \
  --use_gpu 0 --quality low --dense 1 >"$work/auto.log" 2>&1 || fail "automatic_reconstructor, see $work/auto.log"
rm -rf "$work/expected" && mkdir -p "$work/expected/stereo"
cp -r "$work"/auto/dense/0/{images,sparse} "$work/expected"
cp "$work"/auto/dense/0/stereo/*.cfg "$work/expected/stereo"
"$hpm_mvs" patch_match_stereo --workspace_path "$work/expected" \
  --PatchMatchStereo.max_image_size 1000 --PatchMatchStereo.window_radius 4 \
  --PatchMatchStereo.num_samples 7 --PatchMatchStereo.geom_consistency 0 >"$work/expected.log"
same_maps "$work/auto/dense/0" "$work/expected"
points=$(LC_ALL=C sed -n 's/^element vertex //p' "$work/auto/dense/0/fused.ply")
((points > 5000)) || fail "automatic_reconstructor fused only $points points"
mesh=$work/auto/dense/0/meshed-poisson.ply
[[ -s $mesh ]] || fail "automatic_reconstructor made no mesh"
faces=$(LC_ALL=C sed -n 's/^element face //p' "$mesh") # COLMAP's trimming may leave none of so few points
echo "ok: automatic_reconstructor made $points points and a mesh of $faces triangles"

echo "== the window"
if [[ $(ldd "$colmap") != *libQt* ]]; then
  echo "skipped: this COLMAP was built without its window"
  exit 0
fi
fresh window
code=0
tests/patches/press_stereo_button.sh "$colmap" "$work/window" "$work/window.png" || code=$?
((code == 77)) && exit 0 # it has said why
((code == 0)) || fail "the Stereo button"
fresh direct
"$hpm_mvs" patch_match_stereo --workspace_path "$work/direct" >"$work/direct.log"
same_maps "$work/direct" "$work/window"
echo "ok: the Stereo button, see $work/window.png"
