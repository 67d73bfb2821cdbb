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

}  // namespace

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

}  // namespace servomill::sim::frequency
