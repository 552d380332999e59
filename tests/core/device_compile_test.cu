// Compiled, not run: the decisions of src/core stay device code. A kernel
// visits pixels with the scalar matching cost, as a CUDA backend would with
// textures.
#include "src/core/consistency_filter.h"
#include "src/core/initialize_pixel.h"
#include "src/core/match_cost.h"
#include "src/core/median_filter.h"
#include "src/core/take_neighbour.h"
#include "src/core/update_pixel.h"
#include "src/core/upsample_plane.h"

namespace hpm {

struct DeviceViews {
  Camera ref;
  const unsigned char* ref_image;
  const unsigned char* const* src_images;
  const DepthView* depth_views;
  PatchShape shape;
};

struct DeviceCost {
  const DeviceViews& views;
  RefPatch patch;
  int col, row;

  __device__ DeviceCost(const DeviceViews& v, int c, int r)
      : views(v), col(c), row(r) {
    patch = MakeRefPatch(
        v.shape,
        [&](int x, int y) {
          return static_cast<float>(v.ref_image[y * v.ref.width + x]);
        },
        [&](bool mixed, float d) { return ColorWeight(v.shape, mixed, d); },
        c,
        r);
  }

  __device__ void Photometric(const Plane* planes,
                              int num_planes,
                              const uint8_t* chosen,
                              int num_views,
                              float* costs) const {
    for (int i = 0; i < num_planes; ++i) {
      const PlaneSlope slope = SlopeOf(views.ref, planes[i]);
      for (int k = 0; k < num_views; ++k) {
        const ViewWarp& warp = views.depth_views[chosen[k]].to_src;
        const unsigned char* image = views.src_images[chosen[k]];
        costs[i * num_views + k] = MatchCost(
            views.shape,
            patch,
            WarpPatch(
                warp, slope, static_cast<float>(col), static_cast<float>(row)),
            [&](float u, float v) {
              return static_cast<float>(image[static_cast<int>(v) * warp.width +
                                              static_cast<int>(u)]);
            },
            warp.width,
            warp.height);
      }
    }
  }

  __device__ bool HasDepth(int view) const {
    return views.depth_views[view].HasDepth();
  }

  __device__ void GeometricErrors(const Plane* planes,
                                  int num_planes,
                                  const uint8_t* asked,
                                  int num_views,
                                  float* errors) const {
    hpm::GeometricErrors(views.ref,
                         views.depth_views,
                         5.0f,
                         col,
                         row,
                         planes,
                         num_planes,
                         asked,
                         num_views,
                         errors);
  }
};

__global__ void VisitPixels(VisitParams params,
                            const SamplingPattern* pattern,
                            PixelState state,
                            DeviceViews views,
                            FilterParams filter,
                            const Vec3f* src_centers,
                            uint32_t* consistent) {
  const int col = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  const int row = static_cast<int>(blockIdx.y * blockDim.y + threadIdx.y);
  if (col >= state.width || row >= state.height) return;
  const DeviceCost cost(views, col, row);
  Rng rng(1, col, row);
  InitializePixel(params, state, StartFrom::kRandom, cost, &rng, col, row);
  UpdatePixel(VisitOf(params, *pattern, state, 0, col, row), cost, &rng);
  TakeNeighbour(params, state, col, row);
  MedianFilterPixel(params.ref, state, col, row);
  const int at = row * state.width + col;
  consistent[at] = ConsistentViews(
      params, filter, src_centers, cost, state.planes[at], col, row);
}

}  // namespace hpm
