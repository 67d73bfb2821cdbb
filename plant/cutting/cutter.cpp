#include "plant/cutting/cutter.h"

#include <cmath>
#include <numbers>

namespace servomill::plant {

double Cutter::radius_at(double h) const {
  if (h >= corner_radius) return radius;
  return radius - corner_radius + std::sqrt(h * (2.0 * corner_radius - h));
}

double Cutter::radius_offset(int tooth) const {
  if (runout == 0.0) return 0.0;
  return 0.5 * runout * std::cos(2.0 * std::numbers::pi * tooth / teeth - runout_direction);
}

std::vector<std::string> implausible(const Cutter& cutter) {
  std::vector<std::string> faults;
  if (!(cutter.radius > 0.0)) faults.emplace_back("radius must be > 0");
  if (cutter.corner_radius < 0.0) faults.emplace_back("corner_radius must be >= 0");
  if (cutter.corner_radius > cutter.radius) faults.emplace_back("corner_radius must be <= radius");
  if (!(cutter.length > cutter.corner_radius))
    faults.emplace_back("length must be > corner_radius");
  if (cutter.teeth < 1) faults.emplace_back("teeth must be >= 1");
  if (cutter.runout < 0.0) faults.emplace_back("runout must be >= 0");
  if (cutter.runout > kMaxRunout) faults.emplace_back("runout must be <= 0.2 mm");
  if (std::abs(cutter.helix) >= 1.5) faults.emplace_back("helix must be below 86 deg");
  return faults;
}

}  // namespace servomill::plant
