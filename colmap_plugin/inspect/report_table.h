// The table of images of a report, and what its colours mean.
#pragma once

#include "colmap_plugin/inspect/report_data.h"

#include <string>

namespace hpm {

std::string ReportTable(const ReportData& data);

}  // namespace hpm
