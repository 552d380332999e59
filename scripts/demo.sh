#!/usr/bin/env bash
# From a fresh clone to a point cloud of the demo scene, measured against its exact
# ground truth. Everything it makes lies in demo_output/.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install_dependencies.sh
cmake -S . -B build/demo -G Ninja -DCMAKE_BUILD_TYPE=Release -DHPM_TESTS=OFF >/dev/null
cmake --build build/demo --target hpm_mvs eval_depth eval_cloud render_cloud

out=demo_output
dense=$out/dense
rm -rf "$out"
mkdir -p "$out"
cp -r data/workshop "$dense"
tar -xf "$dense/gt.tar.xz" -C "$dense"

build/demo/colmap_plugin/tool/hpm_mvs patch_match_stereo \
  --workspace_path "$dense" --Hpm.previews 1

echo "Fusing and meshing with COLMAP..."
colmap stereo_fusion --workspace_path "$dense" --output_path "$out/fused.ply" \
  --StereoFusion.num_threads 1 >"$out/stereo_fusion.log"
colmap poisson_mesher --input_path "$out/fused.ply" --output_path "$out/mesh.ply" \
  --PoissonMeshing.depth 7 --PoissonMeshing.trim 5 >"$out/poisson_mesher.log"

echo
echo "Depth and normals against the ground truth (relative depth error)"
build/demo/bench/eval_depth "$dense" --json "$out/depth.json"
echo
echo "Points against the ground truth (metres)"
build/demo/bench/eval_cloud "$out/fused.ply" "$dense/gt/points.ply" --json "$out/cloud.json"
build/demo/bench/render_cloud "$out/fused.ply" "$dense/sparse" 0003.jpg "$out/cloud.png" \
  --point_size 7

cat <<EOF

Look at
  $out/cloud.png                the points, seen from one of the cameras
  $dense/images/0003.jpg    the picture taken there
  $dense/stereo/previews/   depth and normals of every image
  $out/fused.ply                the points
  $out/mesh.ply                 the surface
EOF
