/// Positions of a cutter between two others: interpolated, and bounded by the chord.
#pragma once

#include "plant/cutting/swept_cutter.h"

namespace servomill::plant {

constexpr double kTurnTolerance =
    1e-9;  // m, by which a step may miss the turn of the cutter's axis

/// The position at a share of the way: the tip goes straight, the axis turns at constant speed.
/// @pre the axes differ
CutterPosition between(const CutterPosition& a, const CutterPosition& b, double share);

/// Bound of the distance (m), seen from the cutter, between the places first .. last and the
/// straight way from the first to the last, over all points of the body; infinite where the axis
/// turns by a right angle and more.
double distance_from_chord(const CutterPosition* first, const CutterPosition* last,
                           const Envelope& body);

}  // namespace servomill::plant
