#include "sim/input/read_cutter.h"

#include <array>
#include <string_view>

#include "plant/vocabulary/units.h"

namespace servomill::sim::input {
namespace {

constexpr double kUsualSlenderness = 4.0;  // flutes over diameter
constexpr double kMaxTeeth = 100.0;

}  // namespace

std::optional<plant::Cutter> read_cutter(config::Reader& tool, double diameter) {
  if (diameter <= 0.0) {
    for (const std::string_view key : {"corner_radius_mm", "flute_length_mm", "teeth", "helix_deg",
                                       "runout_um", "runout_direction_deg"}) {
      if (!tool.has(key)) continue;
      tool.raw(key);
      tool.fault(key, "needs a diameter_mm above 0");
    }
    return std::nullopt;
  }
  const std::size_t before = tool.faults();
  plant::Cutter cutter{.radius = 0.5 * diameter};
  cutter.corner_radius = tool.real_or("corner_radius_mm", 0.0, config::kLength,
                                      {config::at_least(0.0), config::at_most(cutter.radius)});
  cutter.length = tool.real_or("flute_length_mm", kUsualSlenderness * diameter, config::kLength,
                               {config::above(cutter.corner_radius)});
  cutter.teeth = static_cast<int>(
      tool.integer_or("teeth", cutter.teeth, {config::at_least(1), config::at_most(kMaxTeeth)}));
  cutter.helix = tool.real_or("helix_deg", 30 * deg, config::kAngle,
                              {config::at_least(0.0), config::at_most(80 * deg)});
  cutter.runout = tool.real_or("runout_um", 0.0, config::kLength,
                               {config::at_least(0.0), config::at_most(plant::kMaxRunout)});
  cutter.runout_direction = tool.real_or("runout_direction_deg", 0.0, config::kAngle);
  if (tool.faults() > before) return std::nullopt;
  return cutter;
}

}  // namespace servomill::sim::input
