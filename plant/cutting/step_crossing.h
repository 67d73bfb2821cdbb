/// Rays through the volume that one step of a cutter sweeps.
#pragma once

#include "plant/cutting/swept_cutter.h"

namespace servomill::plant {

/// Parameter (m) at which a ray leaves the step; minus infinity where it misses it.
double leave_step(const SweptCutter& step, const Ray& ray);

/// Parameter (m) at which a ray that leaves the step at s entered it.
double enter_step(const SweptCutter& step, const Ray& ray, double s);

}  // namespace servomill::plant
