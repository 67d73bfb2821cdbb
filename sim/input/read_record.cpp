#include "sim/input/read_record.h"

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/input/read_ticks.h"
#include "sim/model/machine.h"
#include "sim/model/run_settings.h"
#include "sim/model/scenario.h"

namespace servomill::sim::input {
namespace {

constexpr double kLongestSettling = 3600.0;  // s
constexpr double kCoarsestResolution = 1 * um;
constexpr std::array<std::string_view, 2> kStorages = {"float64", "float32"};

// Intervals [begin, end] of time.
std::vector<std::array<double, 2>> read_times(config::Reader& table) {
  std::vector<std::array<double, 2>> out;
  if (!table.has("time_s")) return out;
  const std::size_t before = table.faults();
  const std::vector<std::vector<double>> rows = table.rows("time_s");
  if (table.faults() > before) return out;
  for (const std::vector<double>& row : rows) {
    if (row.size() != 2 || row[0] < 0.0 || row[1] <= row[0]) {
      table.fault("time_s", "must be a list of [begin, end] with 0 <= begin < end");
      return {};
    }
    out.push_back({row[0], row[1]});
  }
  return out;
}

model::RecordWindows read_windows(config::Reader& record) {
  model::RecordWindows out;
  if (!record.has("windows")) return out;
  config::Reader table = record.table("windows");
  const std::size_t before = table.faults();
  out.sections = table.texts_or("sections", {});
  out.sections_place = table.place("sections");
  out.times = read_times(table);
  out.every =
      static_cast<int>(table.integer_or("every", 1, {config::at_least(1.0), config::at_most(1e9)}));
  if (table.faults() > before) return out;
  if (!out.limited()) table.fault("needs sections or time_s, which select the rows to record");
  if (out.sections.empty() && table.has("every")) {
    table.fault("every", "requires sections, whose passes it counts");
  }
  return out;
}

}  // namespace

void read_record(config::Reader& root, model::Scenario& out) {
  config::Reader table = root.table_or_empty("record");
  out.record_period = read_ticks(table, "period_ms", 1 * ms, out.machine.nc.periods.base, 1);
  model::RecordSpec& record = out.record;
  record.period_is_given = table.has("period_ms");
  record.format.storage = static_cast<records::Storage>(table.choice_or("storage", 0, kStorages));
  record.format.resolution =
      table.real_or("resolution_nm", record.format.resolution, config::kLength,
                    {config::at_least(0.0), config::at_most(kCoarsestResolution)});
  record.compression = static_cast<int>(table.integer_or(
      "compression", record.compression,
      {config::at_least(records::kNoCompression), config::at_most(records::kMaxCompression)}));
  record.windows = read_windows(table);
  record.extremes = table.boolean_or("extremes", false);
  record.uncorrectable = table.boolean_or("uncorrectable", false);
  constexpr double kGigabyte = 1e9, kHour = 3600.0, kMaxGigabytes = 1e6, kMaxHours = 1e4;
  record.max_size =
      kGigabyte * table.real_or("max_size_GB", record.max_size / kGigabyte, config::kNumber,
                                {config::above(0.0), config::at_most(kMaxGigabytes)});
  record.max_duration =
      kHour * table.real_or("max_duration_h", record.max_duration / kHour, config::kNumber,
                            {config::above(0.0), config::at_most(kMaxHours)});
  out.settle_time = table.real_or("settle_ms", 100 * ms, config::kTime,
                                  {config::at_least(0.0), config::at_most(kLongestSettling)});
}

void check_record(config::Reader& root, const model::Scenario& scenario) {
  if (!root.has("record")) return;
  config::Reader record = root.table("record");
  if (scenario.record.windows.limited()) {
    config::Reader windows = record.table("windows");
    if (!scenario.tests.empty()) {
      windows.fault("cannot be used with [[test]]: its readings need every row");
    } else if (!scenario.probes.empty()) {
      windows.fault("cannot be used with [[probe]]: a part is probed on the path of every row");
    }
  }
  if (scenario.record.extremes && !scenario.tests.empty()) {
    record.fault("extremes",
                 "must be false with [[test]]: its readings are means over rows at equal "
                 "intervals");
  }
}

}  // namespace servomill::sim::input
