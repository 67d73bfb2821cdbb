#include "sim/sweep/point_series.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "sim/model/scenario.h"
#include "sim/records/input_file.h"
#include "sim/run/build_identity.h"
#include "sim/run/run_case.h"
#include "sim/run/store.h"
#include "sim/sweep/sweep.h"
#include "sim/system/system_error.h"

namespace servomill::sim::sweep {

std::string series_folder(const std::string& path) {
  return (path.ends_with(".h5") ? path.substr(0, path.size() - 3) : path) + ".series";
}

namespace {

std::string series_name(const std::string& folder, std::uint64_t point) {
  return fmt::format("{}/{}.h5", folder, point + 1);
}

}  // namespace

bool has_point_series(const std::string& folder, const Sweep& sweep, std::uint64_t point) {
  const std::string path = series_name(folder, point);
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return false;
  try {
    const records::InputFile file(path);
    return run::build_of(file) == run::result_identity() &&
           file.text("/inputs", "resolved") == sweep.at(point).resolved;
  } catch (const InputError&) {
    return false;  // something else
  }
}

void write_point_series(const std::string& folder, const Sweep& sweep, const SweepPoint& point) {
  if (!point.result.cases || point.result.cases->empty()) return;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw system::SystemError(folder, "cannot be created", error.message());
  run::RunStore store(series_name(folder, point.index), true, sweep.at(point.index));
  for (const run::CaseOutput& one : *point.result.cases) store.add(one);
  store.commit(point.result.rows);
}

}  // namespace servomill::sim::sweep
