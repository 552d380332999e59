// Sizes fixed at compile time, so that a pixel visit needs no allocation.
#pragma once

namespace hpm {

constexpr int kMaxViews =
    32;  // source views of one reference (bits of a view mask)
constexpr int kNumRegions = 8;     // propagation regions, one candidate each
constexpr int kMaxExtensions = 3;  // of a region, N_ext of the paper
constexpr int kMaxRegionSamples = 11 << kMaxExtensions;
constexpr int kPatchAxis =
    6;  // window samples per axis: radius * {-1, -3/5, -1/5, 1/5, 3/5, 1}
constexpr int kPatchSize = kPatchAxis * kPatchAxis;

constexpr float kMaxCost =
    2.0f;  // 1 - NCC lies in [0, 2]; also the cost of "cannot be seen"
constexpr float kMinVariance =
    1e-2f;  // grey levels squared; below it a window counts as constant:
            // quantisation alone makes more, and float32 sums are not exact
            // enough for less

}  // namespace hpm
