/// Exact frequency response of one axis with its sampled loops.
#pragma once

#include <array>

#include "sim/frequency/fundamental.h"

namespace servomill::sim::frequency {

/// Point at which a sinusoid of amplitude 1 enters.
enum class Entry : std::uint8_t {
  setpoint,              // m, rad; its derivatives are not fed forward
  setpoint_fed_forward,  // the same with feed-forward as the NC has it
  offset,                // the same, its derivatives differences over a position period
  velocity_command,      // m/s, rad/s
  current_command,       // A
  force,                 // N, N m: on the slide, along +x
  reading,               // m, rad
};

/// Excitation for the complex amplitude u of one tick's sinusoid: its real part. A force
/// is held over the tick and given so that its fundamental is that of Re(u exp(j w t)).
/// @param w  rad/s
/// @param h  s, base period
/// @param Tp  s, position period: of differences
StandInput sinusoid(Entry entry, Complex u, double w, double h, double Tp);

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

/// Largest eigenvalue magnitude of the velocity loop without position loop over one hyperperiod of
/// all loops; the position that nobody controls is left out. Below 1 the loop is stable.
double velocity_spectral_radius(const model::MachineSettings& machine, int joint);

/// Frequency at which motor and load oscillate against one another (Hz); 0 for a rigid drive.
double resonance_frequency(const plant::FeedDriveParams& drive);
/// Frequencies at which the bed of the machine swings with the slide held on it, and under a slide
/// that nothing holds (Hz): zero and pole of the slide on its bed; 0 for a bed that stands still.
std::array<double, 2> bed_frequencies(const plant::FeedDriveParams& drive);
/// Frequency at which the load alone would oscillate on a motor held still (Hz); 0 for a rigid one.
double antiresonance_frequency(const plant::FeedDriveParams& drive);

/// Frequencies from above 0 to `to` (Hz) near which a response of the axis may have a sharp peak or
/// dip: those of the drive alone, and the eigenvalues exp((-a + j w) T) of the loops with little
/// damping, a < w. One hyperperiod T does not tell w from w + 2 pi k / T nor from -w: all are
/// given.
std::vector<double> ringing_frequencies(const model::MachineSettings& machine, int joint,
                                        Tick reading_delay, PositionLoop loop, double to);

/// Time in which the slowest part of a transient falls to 1/e (s); infinite if it grows.
double slowest_time_constant(const model::MachineSettings& machine, int joint, Tick reading_delay,
                             PositionLoop loop);

}  // namespace servomill::sim::frequency
