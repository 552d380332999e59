#include "src/cpu/cpu_views.h"

#include "src/base/error.h"
#include "src/base/remedies.h"
#include "src/cpu/texel_image.h"
#include "src/engine/source_geometry.h"
#include "src/engine/visit_params.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hpm {
namespace {

// The middle of what unsigned 32-bit offsets reach, see MatchViews::origin.
constexpr int64_t kTexelOrigin = int64_t{1} << 31;

}  // namespace

CpuViews::CpuViews(const ViewSet& views, const MethodParams& params)
    : match_() {
  const GrayImage& ref = *views.ref.image;
  padding_ = params.patch_radius;
  padded_width_ = ref.width + 2 * padding_;
  padded_ref_.resize(static_cast<size_t>(padded_width_) *
                     (ref.height + 2 * padding_));
  for (int row = -padding_; row < ref.height + padding_; ++row) {
    const uint8_t* from =
        &ref.data[static_cast<size_t>(std::clamp(row, 0, ref.height - 1)) *
                  ref.width];
    uint8_t* to =
        &padded_ref_[static_cast<size_t>(row + padding_) * padded_width_];
    std::fill_n(to, padding_, from[0]);
    std::copy_n(from, ref.width, to + padding_);
    std::fill_n(to + padding_ + ref.width, padding_, from[ref.width - 1]);
  }

  match_.ref = views.ref.camera;
  match_.shape = ShapeOf(params);
  match_.shape.ref_has_gaps = ref.has_gaps;
  for (const bool mixed : {false, true}) {
    for (int i = 0; i < 256; ++i) {
      color_weights_[mixed][i] =
          ColorWeight(match_.shape, mixed, static_cast<float>(i));
    }
  }

  size_t num_texels = 0;
  for (const View& src : views.srcs) num_texels += src.image->data.size();
  if (num_texels > static_cast<size_t>(std::numeric_limits<int32_t>::max())) {
    throw Error(ErrorCode::kOutOfResources,
                std::string("the source images of one reference have more than "
                            "2^31 pixels together; use ") +
                    kSmallerImages + " or fewer sources in patch-match.cfg");
  }
  texels_.resize(num_texels + kTexelPadding);
  size_t offset = 0;
  for (const View& src : views.srcs) {
    const int j = match_.num_views++;
    PackTexels(*src.image, texels_.data() + offset);
    depth_views_.push_back(DepthViewOf(views.ref.camera, src));
    inverse_depths_.push_back(src.inverse_depth);
    src_centers_.push_back(CenterOf(views.ref.camera, src));
    const ViewWarp& warp = depth_views_.back().to_src;
    for (int i = 0; i < 9; ++i) match_.M[i][j] = warp.M.m[i];
    match_.v[0][j] = warp.v.x;
    match_.v[1][j] = warp.v.y;
    match_.v[2][j] = warp.v.z;
    match_.max_u[j] = static_cast<float>(src.image->width - 1);
    match_.max_v[j] = static_cast<float>(src.image->height - 1);
    match_.stride[j] = static_cast<int32_t>(sizeof(Texel)) * src.image->width;
    match_.offset[j] = static_cast<int32_t>(
        static_cast<int64_t>(sizeof(Texel) * offset) - kTexelOrigin);
    match_.has_gaps[j] = src.image->has_gaps;
    match_.any_has_gaps |= src.image->has_gaps;
    offset += src.image->data.size();
  }
  match_.origin =
      reinterpret_cast<const uint8_t*>(texels_.data()) + kTexelOrigin;
}

RefPatch CpuViews::PatchAt(int col, int row) const {
  const uint8_t* origin = padded_ref_.data() +
                          static_cast<size_t>(padding_) * padded_width_ +
                          padding_;
  return MakeRefPatch(
      match_.shape,
      [&](int c, int r) {
        return static_cast<float>(
            origin[static_cast<ptrdiff_t>(r) * padded_width_ + c]);
      },
      [&](bool mixed, float difference) {
        return color_weights_[mixed][static_cast<int>(difference)];
      },
      col,
      row);
}

uint64_t CpuViews::MemoryNeeded(int width, int height, int num_srcs) {
  const uint64_t pixels = static_cast<uint64_t>(width) * height;
  return pixels * (sizeof(uint8_t) + sizeof(Texel) * num_srcs);
}

}  // namespace hpm
