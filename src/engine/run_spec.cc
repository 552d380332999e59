#include "src/engine/run_spec.h"

namespace hpm {

RunSpec DefaultRunSpec(const std::string& method, int side) {
  const Method& row = FindMethod(method);
  ScheduleOptions options;
  options.method = method;
  options.num_levels = AutomaticLevels(row, side);
  RunSpec spec;
  spec.schedule = MakeSchedule(options);
  spec.params = DefaultParams(row);
  return spec;
}

}  // namespace hpm
