#include "sim/input/read_record.h"

#include <array>
#include <string_view>

#include "plant/vocabulary/units.h"
#include "sim/input/read_ticks.h"

namespace servomill::sim::input {
namespace {

constexpr double kLongestSettling = 3600.0;  // s
constexpr double kCoarsestResolution = 1 * um;
constexpr std::array<std::string_view, 2> kStorages = {"float64", "float32"};

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

}  // namespace servomill::sim::input
