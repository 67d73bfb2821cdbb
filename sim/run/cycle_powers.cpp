#include "sim/run/cycle_powers.h"

#include <algorithm>
#include <cmath>

#include "sim/engine/case_result.h"

namespace servomill::sim::run {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kStep = 1.0;  // s, over which powers are averaged

}  // namespace

std::vector<PowerStep> averaged(const engine::HeatCourse& cycle) {
  const auto rows = cycle.power.size() / std::max<std::size_t>(1, cycle.bodies);
  const auto each = static_cast<std::size_t>(std::max(1L, std::lround(kStep / cycle.step)));
  std::vector<PowerStep> out;
  for (std::size_t first = 0; first < rows; first += each) {
    const std::size_t end = std::min(rows, first + each);
    VectorXd sum = VectorXd::Zero(static_cast<Index>(cycle.bodies));
    for (std::size_t row = first; row < end; ++row) {
      sum += Eigen::Map<const VectorXd>(&cycle.power[row * cycle.bodies],
                                        static_cast<Index>(cycle.bodies));
    }
    const auto steps = static_cast<double>(end - first);
    out.push_back({steps * cycle.step, sum / steps});
  }
  return out;
}

}  // namespace servomill::sim::run
