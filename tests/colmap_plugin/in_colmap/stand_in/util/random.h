// What the glue needs of COLMAP 3.8's header of this name.
#pragma once

namespace colmap {

constexpr int kDefaultPRNGSeed = 0;

}  // namespace colmap
