// A report as one HTML file that needs nothing else.
#pragma once

#include "colmap_plugin/inspect/report_data.h"

#include <string>

namespace hpm {

std::string ReportHtml(const ReportData& data);

}  // namespace hpm
