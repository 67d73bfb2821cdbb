/// Exact frequency response of one axis with its sampled loops.
#pragma once

#include <array>

#include "sim/frequency/fundamental.h"

namespace servomill::sim::frequency {

/// Excitation for the complex amplitude u of one tick's sinusoid: its real part. A force
/// is held over the tick and given so that its fundamental is that of Re(u exp(j w t)).
/// @param w  rad/s
/// @param h  s, base period
/// @param Tp  s, position period: of differences
StandInput sinusoid(Entry entry, Complex u, double w, double h, double Tp);

/// Transition Phi of the states of an axis over one hyperperiod, all inputs 0.
Eigen::MatrixXd monodromy_of(AxisTestBench& stand);

/// The linear part of an axis (sim/frequency/stability.h) under sampled loops is a linear system
/// whose coefficients repeat after one hyperperiod T: x(t + T) = Phi x(t) + f. A sinusoid exp(j w
/// t) as input has the steady answer
///
///   x(t + T) = exp(j w T) x(t),   x(0) = (exp(j w T) I - Phi)^-1 x_f,
///
/// where x_f is where one hyperperiod leads from x = 0. Each signal is then y(t) = p(t) exp(j w t)
/// with p of period T; its fundamental is the mean of p, taken over all base ticks, of a sampled
/// signal over its instants. No state is waited for, an unstable loop has its response, too.
/// Source: lifting of linear periodic systems, S. Bittanti, P. Colaneri, Periodic Systems, 2009.
///
/// A response at a reading, error or speed against the error of the same loop is the open loop
/// L = y / e; where the hyperperiod is the period of that loop it is the sampled open loop exactly.
class FrequencyResponse {
 public:
  /// @param loop  open: the velocity loop alone, without setpoint
  FrequencyResponse(const model::MachineSettings& machine, int joint, Tick reading_delay,
                    PositionLoop loop);

  /// @param f  Hz, > 0
  Response at(Entry entry, double f);

  const AxisTestBench& stand() const { return stand_; }
  const Eigen::MatrixXd& monodromy() const { return monodromy_; }

 private:
  AxisTestBench stand_;
  Eigen::MatrixXd monodromy_;
};

}  // namespace servomill::sim::frequency
