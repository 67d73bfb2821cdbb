#include "sim/input/read_bed.h"

#include <fmt/format.h>

#include <numbers>
#include <string_view>

#include "plant/vocabulary/units.h"

namespace servomill::sim::input {
namespace {

constexpr std::string_view kBedKey = "machine_bed";
constexpr double kTicksPerPeriod = 20.0;  // of the mode

}  // namespace

void read_bed(config::Reader& axis, bool linear, double base_period,
              plant::FeedDriveParams& drive) {
  if (!axis.has(kBedKey)) return;
  if (!linear) {
    axis.raw(kBedKey);
    axis.fault(kBedKey, "needs a linear axis, along which its drive pushes the bed back");
    return;
  }
  config::Reader table = axis.table(kBedKey);
  const std::size_t before = table.faults();
  const double M = table.real("mass", config::kMass, {config::above(0.0)});
  const double f = table.real("frequency_Hz", config::kRate, {config::above(0.0)});
  const double zeta =
      table.real("damping", config::kNumber, {config::at_least(0.0), config::below(1.0)});
  if (table.faults() > before) return;
  const double most = 1.0 / (kTicksPerPeriod * base_period);
  if (f > most) {
    table.fault("frequency_Hz",
                fmt::format("must be <= {:g} Hz: {:g} base periods of {:g} us in each period of "
                            "the mode; without machine_bed the bed is at rest",
                            most, kTicksPerPeriod, base_period / us));
  }
  drive.bed = {M, 2.0 * std::numbers::pi * f, zeta};
}

}  // namespace servomill::sim::input
