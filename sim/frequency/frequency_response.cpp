#include "sim/frequency/frequency_response.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "sim/stability.h"

namespace servomill::sim {
namespace {

constexpr Complex kJ{0.0, 1.0};

constexpr auto kLookAway = [](Tick, std::uint8_t, const AxisSignals&) {};

Eigen::MatrixXd monodromy_of(AxisStand& stand) {
  const int states = stand.states();
  Eigen::MatrixXd Phi(states, states);
  for (int column = 0; column < states; ++column) {
    stand.settle(0.0);
    stand.set_states(Eigen::VectorXd::Unit(states, column));
    stand.run(
        0, [](Tick) { return StandInput{}; }, kLookAway);
    Phi.col(column) = stand.get_states();
  }
  return Phi;
}

}  // namespace

StandInput sinusoid(Entry entry, Complex u, double w, double h) {
  StandInput in;
  switch (entry) {
    case Entry::set_point_fed_forward:
      in.dq = (kJ * w * u).real();
      in.ddq = (-w * w * u).real();
      [[fallthrough]];
    case Entry::set_point:
      in.q = u.real();
      break;
    case Entry::velocity_command:
      in.added.velocity = u.real();
      break;
    case Entry::current_command:
      in.added.current = u.real();
      break;
    case Entry::force: {
      const double half = 0.5 * w * h;
      in.added.force = (u * std::polar(half / std::sin(half), half)).real();
      break;
    }
    case Entry::reading:
      in.added.reading = u.real();
      break;
  }
  return in;
}

FrequencyResponse::FrequencyResponse(const MachineSettings& machine, int joint, Tick reading_delay,
                                     PositionLoop loop)
    : stand_(linearised(machine), joint, reading_delay, loop), monodromy_(monodromy_of(stand_)) {}

Response FrequencyResponse::at(Entry entry, double f) {
  assert(f > 0.0);
  const double w = 2.0 * std::numbers::pi * f, h = stand_.base();
  const auto turn = [&](Tick n) { return std::polar(1.0, w * h * static_cast<double>(n)); };
  // exp(j w t) in two runs: its real part (phase 1), its imaginary part (phase -j)
  const auto feed = [&](Complex phase) {
    return [&, phase](Tick n) { return sinusoid(entry, phase * turn(n), w, h); };
  };
  const auto from = [&](const Eigen::VectorXd& x) {
    stand_.settle(0.0);
    stand_.set_states(x);
  };
  const auto forced = [&](Complex phase) {
    from(Eigen::VectorXd::Zero(stand_.states()));
    stand_.run(0, feed(phase), kLookAway);
    return stand_.get_states();
  };
  const Eigen::VectorXd x_re = forced(1.0), x_im = forced(-kJ);

  Eigen::MatrixXcd A = -monodromy_.cast<Complex>();
  A.diagonal().array() += turn(stand_.hyperperiod());
  const Eigen::VectorXcd x0 = A.partialPivLu().solve(x_re.cast<Complex>() + kJ * x_im);

  Fundamental sum;
  const auto add = [&](Complex part) {
    return [&, part](Tick n, std::uint8_t due, const AxisSignals& y) {
      sum.add(due, y, part * std::conj(turn(n)));
    };
  };
  from(x0.real());
  stand_.run(0, feed(1.0), add(1.0));
  from(x0.imag());
  stand_.run(0, feed(-kJ), add(kJ));
  Response mean = sum.mean();
  for (Complex& one : mean) one *= 2.0;  // each instant was counted in both runs
  return mean;
}

double slowest_time_constant(const MachineSettings& machine, int joint, Tick reading_delay,
                             PositionLoop loop) {
  const LoopPeriods& p = machine.nc.periods;
  const double T = p.seconds(hyperperiod(loop_rates(p, reading_delay)));
  const double radius = loop == PositionLoop::closed
                            ? spectral_radius(machine, joint, reading_delay)
                            : velocity_spectral_radius(machine, joint);
  return radius < 1.0 ? -T / std::log(radius) : std::numeric_limits<double>::infinity();
}

double velocity_spectral_radius(const MachineSettings& machine, int joint) {
  MachineSettings alone = linearised(machine);
  alone.nc.cascade[static_cast<std::size_t>(joint)].Kv = 0.0;
  AxisStand stand(alone, joint, 0, PositionLoop::closed);
  const Eigen::MatrixXd monodromy = monodromy_of(stand);
  if (!monodromy.allFinite()) return std::numeric_limits<double>::infinity();
  const Eigen::VectorXcd all = monodromy.eigenvalues();
  // the position is carried along: one eigenvalue of 1, as near as the others let it be computed
  Eigen::Index carried = 0;
  (all.array() - 1.0).abs().minCoeff(&carried);
  double radius = 0.0;
  for (Eigen::Index k = 0; k < all.size(); ++k) {
    if (k != carried) radius = std::max(radius, std::abs(all[k]));
  }
  return radius;
}

}  // namespace servomill::sim
