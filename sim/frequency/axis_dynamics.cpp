#include "sim/frequency/axis_dynamics.h"

#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "sim/frequency/axis_test_bench.h"
#include "sim/frequency/frequency_response.h"
#include "sim/frequency/stability.h"
#include "sim/model/machine.h"
#include "sim/numerics/decompositions.h"

namespace servomill::sim::frequency {

double resonance_frequency(const plant::FeedDriveParams& p) {
  if (p.is_rigid()) return 0.0;
  return std::sqrt(p.k * (1.0 / p.M + p.r * p.r / p.J)) / (2.0 * std::numbers::pi);
}

std::array<double, 2> bed_frequencies(const plant::FeedDriveParams& p) {
  if (!p.on_bed()) return {0.0, 0.0};
  const double f = p.bed.w / (2.0 * std::numbers::pi);
  return {f, f * std::sqrt((p.travelling_mass() + p.bed.M) / p.bed.M)};
}

double antiresonance_frequency(const plant::FeedDriveParams& p) {
  return p.is_rigid() ? 0.0 : std::sqrt(p.k / p.M) / (2.0 * std::numbers::pi);
}

std::vector<double> ringing_frequencies(const model::MachineSettings& machine, int joint,
                                        Tick reading_delay, PositionLoop loop, double to) {
  const plant::FeedDriveParams& drive = machine.drives[static_cast<std::size_t>(joint)];
  std::vector<double> out;
  const auto add = [&](double f) {
    if (f > 0.0 && f <= to) out.push_back(f);
  };
  add(resonance_frequency(drive));
  add(antiresonance_frequency(drive));
  for (const double f : bed_frequencies(drive)) add(f);
  std::vector<PositionLoop> loops = {PositionLoop::open};
  if (loop == PositionLoop::closed) loops.push_back(loop);
  for (const PositionLoop one : loops) {
    const FrequencyResponse response(machine, joint, reading_delay, one);
    const double rate = 1.0 / response.stand().period();
    for (const Complex z : numerics::eigenvalues(response.monodromy())) {
      if (z.imag() <= 0.0) continue;  // one of each pair
      const double f = std::arg(z) / (2.0 * std::numbers::pi) * rate;
      const double a = -std::log(std::abs(z)) / (2.0 * std::numbers::pi) * rate;
      for (double turns = 0.0; turns <= to + rate; turns += rate) {
        for (const double image : {turns + f, turns - f}) {
          if (a < image) add(image);
        }
      }
    }
  }
  return out;
}

double slowest_time_constant(const model::MachineSettings& machine, int joint, Tick reading_delay,
                             PositionLoop loop) {
  const model::LoopPeriods& p = machine.nc.periods;
  const double T = p.seconds(model::hyperperiod(engine::loop_rates(p, reading_delay)));
  const double radius = loop == PositionLoop::closed
                            ? spectral_radius(machine, joint, reading_delay)
                            : velocity_spectral_radius(machine, joint);
  return radius < 1.0 ? -T / std::log(radius) : std::numeric_limits<double>::infinity();
}

double velocity_spectral_radius(const model::MachineSettings& machine, int joint) {
  model::MachineSettings alone = linearised(machine);
  alone.nc.cascade[static_cast<std::size_t>(joint)].Kv = 0.0;
  AxisTestBench stand(alone, joint, 0, PositionLoop::closed);
  const Eigen::MatrixXd monodromy = monodromy_of(stand);
  if (!monodromy.allFinite()) return std::numeric_limits<double>::infinity();
  const Eigen::VectorXcd all = numerics::eigenvalues(monodromy);
  // the position is carried along: one eigenvalue of 1, as near as the others let it be computed
  Eigen::Index carried = 0;
  (all.array() - 1.0).abs().minCoeff(&carried);
  double radius = 0.0;
  for (Eigen::Index k = 0; k < all.size(); ++k) {
    if (k != carried) radius = std::max(radius, std::abs(all[k]));
  }
  return radius;
}

}  // namespace servomill::sim::frequency
