/// Margins of a position loop to which a strategy adds a gain.
///
/// Velocity commands enter the loop where Kv does: with the open loop L of the axis as its NC is
/// set, the loop with the added gain is
///
///     L (Kv + C (1 + 1 / (Ti s))) / Kv                                                        (1)
///
/// exactly, the sampling included, up to the integral, which is summed once a position period. A
/// gain along a direction across axes with equal loops acts like this on each of them.
#pragma once

#include "plant/vocabulary/added_gain.h"
#include "plant/vocabulary/ticks.h"
#include "sim/frequency/margins.h"
#include "sim/model/forward.h"

namespace servomill::sim::frequency {

class FrequencyResponse;

inline constexpr double kLowestFrequency = 0.5;   // Hz, of curves from which margins are taken
inline constexpr std::size_t kFrequencies = 150;  // of them, before those where they turn

/// Frequencies (Hz) up to half the rate of the position loop's sampling.
std::vector<double> position_grid(const model::MachineSettings& machine, int joint,
                                  Tick reading_delay);
/// Open position loop at any of them.
ResponseAt open_position(FrequencyResponse& response);

/// The open position loop of an axis up to half the rate of its sampling.
/// @param machine        linearised or not
/// @param reading_delay  ticks between the scale and what the position loop reads
Curve open_position_loop(const model::MachineSettings& machine, int joint, Tick reading_delay);

/// Margins of (1).
/// @param Kv  1/s, with which the open loop was taken
Margins margins_with(const Curve& open_loop, double Kv, const AddedGain& added);

/// The largest C (1/s) such that it and every smaller one leave the margins; 0: there is none. To
/// 1e-4 of Kv.
/// @param largest_Kv  1/s, of all axes that share the integral part; Kv: this is the only one
double largest_added_gain(const Curve& open_loop, double Kv, double largest_Kv,
                          const WantedMargins& wanted);

}  // namespace servomill::sim::frequency
