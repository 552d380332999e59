// `hpm_mvs report`, and what a run writes at its end.
#pragma once

#include "colmap_plugin/options/options.h"
#include "src/base/cancel.h"
#include "src/base/log.h"

#include <filesystem>

namespace hpm {

// Where it is written unless a path is given: stereo/report.html.
std::filesystem::path ReportPath(const ControllerOptions& options);

// `program`: name and version. Empty path: ReportPath(). Returns the
// path. Throws as GatherReport() and WriteFileAtomically() do.
std::filesystem::path WriteReport(const ControllerOptions& options,
                                  const std::filesystem::path& path,
                                  const std::string& program,
                                  const LogSink& log,
                                  const CancelToken& cancel);

}  // namespace hpm
