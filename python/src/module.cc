// The module hpm_mvs._core.
#include "python/src/errors.h"
#include "python/src/estimate.h"
#include "python/src/options.h"
#include "python/src/patch_match_stereo.h"
#include "python/src/progress.h"

#include <nanobind/nanobind.h>
#include <opencv2/core/utils/logger.hpp>

NB_MODULE(_core, module) {
  // What OpenCV would print about a file is said by our own messages.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  module.doc() = "HPM-MVS dense stereo; see the package hpm_mvs.";
  hpm::BindErrors(module);
  hpm::BindOptions(module);
  hpm::BindProgress(module);
  hpm::BindPatchMatchStereo(module);
  hpm::BindEstimate(module);
}
