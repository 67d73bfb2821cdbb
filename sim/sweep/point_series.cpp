#include "sim/sweep/point_series.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "sim/hdf5/system_error.h"
#include "sim/store.h"

namespace servomill::sim {

std::string series_folder(const std::string& path) {
  return (path.ends_with(".h5") ? path.substr(0, path.size() - 3) : path) + ".series";
}

void write_point_series(const std::string& folder, const Sweep& sweep, const SweepPoint& point) {
  if (point.result.cases.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw SystemError(folder, "cannot be made", error.message());
  RunStore store(fmt::format("{}/{}.h5", folder, point.index + 1), true, sweep.at(point.index));
  for (const CaseOutput& one : point.result.cases) store.add(one);
  store.commit(point.result.rows);
}

}  // namespace servomill::sim
