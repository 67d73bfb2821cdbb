#include "sim/input/read_record.h"

#include <array>
#include <string_view>

#include "plant/vocabulary/units.h"
#include "sim/input/read_ticks.h"

namespace servomill::sim {
namespace {

constexpr double kLongestSettling = 3600.0;  // s
constexpr double kCoarsestResolution = 1 * um;
constexpr std::array<std::string_view, 2> kStorages = {"float64", "float32"};

}  // namespace

void read_record(Reader& root, Scenario& out) {
  Reader table = root.table_or_empty("record");
  out.record_period = read_ticks(table, "period_ms", 1 * ms, out.machine.nc.periods.base, 1);
  RecordSpec& record = out.record;
  record.period_is_given = table.has("period_ms");
  record.format.storage = static_cast<Storage>(table.choice_or("storage", 0, kStorages));
  record.format.resolution = table.real_or("resolution_nm", record.format.resolution, kLength,
                                           {at_least(0.0), at_most(kCoarsestResolution)});
  record.compression = static_cast<int>(table.integer_or(
      "compression", record.compression, {at_least(kNoCompression), at_most(kMostCompression)}));
  record.uncorrectable = table.boolean_or("uncorrectable", false);
  constexpr double kGigabyte = 1e9, kHour = 3600.0, kMostGigabytes = 1e6, kMostHours = 1e4;
  record.max_size = kGigabyte * table.real_or("max_size_GB", record.max_size / kGigabyte, kNumber,
                                              {above(0.0), at_most(kMostGigabytes)});
  record.max_duration = kHour * table.real_or("max_duration_h", record.max_duration / kHour,
                                              kNumber, {above(0.0), at_most(kMostHours)});
  out.settle_time =
      table.real_or("settle_ms", 100 * ms, kTime, {at_least(0.0), at_most(kLongestSettling)});
}

}  // namespace servomill::sim
