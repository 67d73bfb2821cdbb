/// The quantities of the probed part of one case. The points are the means of all repetitions; with
/// a base case, the nominal points moved by what they differ from the same points of it.
#pragma once

#include <span>

#include "sim/evaluation/quantity.h"

namespace servomill::sim::evaluation {

/// Entries of this family, in QuantityEntry::probes at least 1. Points at which one of the cases
/// met nothing are left out, and the note says so.
std::span<const QuantityEntry> probe_quantities();

}  // namespace servomill::sim::evaluation
