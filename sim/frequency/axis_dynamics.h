/// Natural frequencies and time constants of one axis, its drive alone and with its loops.
#pragma once

#include <array>
#include <vector>

#include "plant/vocabulary/ticks.h"
#include "sim/frequency/axis_signals.h"
#include "sim/model/forward.h"

namespace servomill::plant {
struct FeedDriveParams;  // plant/drives/feed_drive.h
}  // namespace servomill::plant

namespace servomill::sim::frequency {

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
