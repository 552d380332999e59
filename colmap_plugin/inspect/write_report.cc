#include "colmap_plugin/inspect/write_report.h"

#include "colmap_plugin/formats/atomic_file.h"
#include "colmap_plugin/inspect/report_data.h"
#include "colmap_plugin/inspect/report_html.h"

namespace hpm {

std::filesystem::path ReportPath(const ControllerOptions& options) {
  return StereoPath(options.workspace) / "report.html";
}

std::filesystem::path WriteReport(const ControllerOptions& options,
                                  const std::filesystem::path& path,
                                  const std::string& program,
                                  const LogSink& log,
                                  const CancelToken& cancel) {
  ReportData data = GatherReport(options, log, cancel);
  data.program = program;
  std::filesystem::path target = path.empty() ? ReportPath(options) : path;
  WriteFileAtomically(target, ReportHtml(data));
  return target;
}

}  // namespace hpm
