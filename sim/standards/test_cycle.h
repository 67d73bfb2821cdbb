/// Standard test cycle of a linear axis, ISO 230-2:2014, 5.3.3: every run approaches all targets
/// upwards, then all of them downwards.
#pragma once

#include <cstdint>
#include <vector>

namespace servomill::sim::standards {

struct TestCycle {
  std::vector<double> targets;  // m, rising
  int runs = 5;
  double overrun = 0.0;  // m, beyond the first and the last target, where the axis reverses
};

/// A place where the axis stops. It is measured at targets, not where it reverses.
struct CycleStop {
  double position = 0.0;   // m
  int direction = 0;       // of the approach: 1 or -1; 0: reversal
  int run = 0;             // from 0
  std::size_t target = 0;  // index, where there is a direction
};

/// All stops in their order; the first is the reversal below the first target.
std::vector<CycleStop> stops(const TestCycle& cycle);

/// Targets between two ends, both included, in equal steps. The inner ones are displaced by a
/// random part of +-spread (m), since ISO 230-2, 5.3.2 has no multiples of a period of the errors.
/// @pre count >= 2, spread below half of a step
std::vector<double> spaced_targets(double from, double to, int count, double spread,
                                   std::uint64_t seed);

/// Number of targets that ISO 230-2, 5.3.2 asks for: five a metre, five at least; 1000 at most.
int usual_target_count(double travel);
/// The same of a rotary axis (travel in rad), ISO 230-2, table 1: three up to 90 deg, five up to
/// 180 deg, eight beyond.
int usual_rotary_target_count(double travel);

}  // namespace servomill::sim::standards
