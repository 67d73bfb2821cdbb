#include "sim/standards/test_cycle.h"

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>

#include "plant/vocabulary/units.h"

namespace servomill::sim::standards {

std::vector<CycleStop> stops(const TestCycle& cycle) {
  const std::vector<double>& targets = cycle.targets;
  const double below = targets.front() - cycle.overrun, above = targets.back() + cycle.overrun;
  std::vector<CycleStop> out = {{below, 0, 0, 0}};
  for (int run = 0; run < cycle.runs; ++run) {
    for (std::size_t i = 0; i < targets.size(); ++i) out.push_back({targets[i], 1, run, i});
    out.push_back({above, 0, run, 0});
    for (std::size_t i = targets.size(); i-- > 0;) out.push_back({targets[i], -1, run, i});
    out.push_back({below, 0, run, 0});
  }
  return out;
}

std::vector<double> spaced_targets(double from, double to, int count, double spread,
                                   std::uint64_t seed) {
  boost::random::mt19937_64 engine(seed);
  boost::random::uniform_real_distribution<double> part(-1.0, 1.0);
  std::vector<double> out;
  for (int i = 0; i < count; ++i) {
    double target = from + (to - from) * i / (count - 1);
    if (i > 0 && i + 1 < count) target += spread * part(engine);
    out.push_back(target);
  }
  return out;
}

int usual_target_count(double travel) {
  constexpr double kPerMetre = 5.0, kMin = 5.0, kMax = 1000.0;
  return static_cast<int>(std::ceil(std::clamp(kPerMetre * travel, kMin, kMax)));
}

int usual_rotary_target_count(double travel) {
  constexpr double kSlack = 1e-9;  // rad
  if (travel <= 90.0 * deg + kSlack) return 3;
  return travel <= 180.0 * deg + kSlack ? 5 : 8;
}

}  // namespace servomill::sim::standards
