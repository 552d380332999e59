// What messages of the library tell users to do, where the program has an
// option for it: the library does not know the names of options, so whoever
// shows its messages adds them (colmap_plugin/tool/name_options.h).
#pragma once

namespace hpm {

constexpr char kSmallerImages[] = "smaller images";
constexpr char kFewerThreads[] = "fewer threads";
constexpr char kFewerImagesAtOnce[] = "fewer images at once";
constexpr char kComputeOnCpu[] = "compute on the CPU";
constexpr char kCpuTarget[] = "CPU target";

}  // namespace hpm
