#include "sim/frequency/frequency_response.h"

#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "sim/frequency/stability.h"
#include "sim/numerics/complex_solver.h"
#include "sim/numerics/decompositions.h"

namespace servomill::sim::frequency {
namespace {

constexpr Complex kJ{0.0, 1.0};

constexpr auto kLookAway = [](Tick, std::uint8_t, const AxisSignals&) {};

Eigen::MatrixXd monodromy_of(AxisTestBench& stand) {
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

// Input at t = 0 of exp(i w t). Derivatives of a setpoint are exact, those of an offset are
// backward differences over the position period Tp, as the NC forms them. A force is held over a
// step h: the factor (w h/2) / sin(w h/2) exp(i w h/2) removes gain and delay of this hold.
StandInput sinusoid(Entry entry, Complex u, double w, double h, double Tp) {
  StandInput in;
  switch (entry) {
    case Entry::setpoint_fed_forward:
      in.dq = (kJ * w * u).real();
      in.ddq = (-w * w * u).real();
      [[fallthrough]];
    case Entry::setpoint:
      in.q = u.real();
      break;
    case Entry::offset: {
      const Complex rate = (1.0 - std::polar(1.0, -w * Tp)) / Tp;
      in.q = u.real();
      in.dq = (rate * u).real();
      in.ddq = (rate * rate * u).real();
      break;
    }
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

FrequencyResponse::FrequencyResponse(const model::MachineSettings& machine, int joint,
                                     Tick reading_delay, PositionLoop loop)
    : stand_(linearised(machine), joint, reading_delay, loop), monodromy_(monodromy_of(stand_)) {}

Response FrequencyResponse::at(Entry entry, double f) {
  assert(f > 0.0);
  const double w = 2.0 * std::numbers::pi * f, h = stand_.base();
  const model::LoopPeriods& periods = stand_.machine().nc.periods;
  const double Tp = periods.seconds(periods.position);
  const auto turn = [&](Tick n) { return std::polar(1.0, w * h * static_cast<double>(n)); };
  // exp(j w t) in two runs: its real part (phase 1), its imaginary part (phase -j)
  const auto feed = [&](Complex phase) {
    return [&, phase](Tick n) { return sinusoid(entry, phase * turn(n), w, h, Tp); };
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
  const Eigen::VectorXcd x0 = numerics::complex_solve(A, x_re.cast<Complex>() + kJ * x_im);

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
