# Shared by bench/gpu_carry.sh and bench/gpu_bench.sh: what the GPU tests and the
# benchmark are made of. No image decoding, no COLMAP files;
# tests/house/gpu_sources_test.py compares the list with the tree.
library_sources=(
  src/base/error.cc
  src/core/sampling_pattern.cc
  src/engine/estimator.cc
  src/engine/local_planes.cc
  src/engine/method.cc
  src/engine/mine_regions.cc
  src/engine/plane_evidence.cc
  src/engine/schedule.cc
  src/engine/visit_params.cc
  src/image/inverse_depth_map.cc
  src/prior/build_prior.cc
  src/prior/credible_points.cc
  src/prior/level.cc
  src/prior/nearest_points.cc
  src/prior/planar_prior.cc
  src/prior/region_planes.cc
  src/prior/triangulation_cgal.cc
  src/prior/upsample_prior.cc
  src/prior/weak_regions.cc
  src/cpu/cpu_backend.cc
  src/cpu/cpu_target.cc
  src/cpu/cpu_views.cc
  src/cpu/geometric_error_scalar.cc
  src/cpu/geometric_error_simd.cc
  src/cpu/match_cost_scalar.cc
  src/cpu/match_cost_simd.cc
  src/cpu/texel_image.cc
  cuda/band_planner.cc
  cuda/memory_estimate.cc
  cuda/problem_tables.cc
  cuda/self_test.cc
  cuda/sweeps.cc
  cuda/check.cc
  cuda/cuda_backend.cc
  cuda/cuda_devices.cc
  cuda/device_images.cc
  tests/scenes/render.cc
  tests/scenes/scene.cc
  tests/scenes/surface.cc
  tests/scenes/texture.cc
)
kernel_sources=(
  cuda/image_kernels.cu
  cuda/sweep_quad.cu
  cuda/sweep_texture.cu
)
test_sources=(
  tests/cuda/emulated_backend.cc
  tests/cuda/gpu_test.cc
)
bench_sources=(
  bench/gpu/gpu_bench.cc
)
bench_kernel_sources=(
  bench/gpu/sampler_rate.cu
)
carry=build/gpu_carry
shared_libs=(libtbb.so.12 libgmp.so.10 libmpfr.so.6 liblz4.so.1 libhwy.so.1 libopencv_core.so.406 libopencv_imgproc.so.406)
# The same flags as the CMake build; fmt without its library.
cxx_flags=(-std=c++17 -O3 -DNDEBUG -ffp-contract=off -fPIC -DFMT_HEADER_ONLY -I.)
