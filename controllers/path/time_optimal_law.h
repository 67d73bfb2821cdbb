/// A time law that uses the jerk of every joint, made from a slower one.
///
/// With b(s) = v^2 the limits of acceleration and jerk of a joint q(s) are
///
///     |q'' b + q' b'/2| <= A,     |q''' b + (3/2) q'' b' + q' b''/2| <= J / sqrt(b)           (1)
///
/// b is a quadratic spline, so that b'' = 2 beta is constant between knots, where s'' = a + beta x
/// and s(t) is a hyperbolic or trigonometric function (time_law.h). The integral of ds/sqrt(b) is
/// minimised under (1) and b <= v_top^2 by Newton steps on
///
///     time - mu sum log(slack of each limit)                                                  (2)
///
/// while mu falls. Slacks remain positive throughout, J/sqrt(b), which is convex, being taken by
/// its tangent; the matrix has five diagonals.
///
/// It begins with the law that is given, somewhat slower, and leaves its first and last ramp.
///
/// Source: b(s) as the unknown: Verscheure, Demeulenaere, Swevers, De Schutter, Diehl,
/// "Time-optimal path tracking for robots: a convex optimization approach", IEEE Trans. Automatic
/// Control 54(10), 2009; (2): Boyd and Vandenberghe, "Convex optimization", Cambridge 2004,
/// chapter 11.
#pragma once

#include <span>

#include "controllers/path/path_limits.h"
#include "controllers/path/smooth_path.h"
#include "controllers/path/time_law.h"

namespace servomill::controllers {

/// @param law    along the path, within the limits
/// @param v_top  largest speed on each piece (m/s), by feed and joint speeds
/// @param limits acceleration and jerk of the joints, scaled like the path
/// @param stretches  limits of the law; needed where it does not begin and end at rest
/// @param speeds  where it begins and ends; they are kept
/// @return a law that takes less time; `law` itself if none is found
/// Law: (1) and v <= v_top hold everywhere on the way: between the points where slacks are kept
/// positive the hull of the polynomials is looked at, and the whole slowed down by what is missing.
TimeLaw refine_time_law(TimeLaw law, const SmoothPath& path, std::span<const double> v_top,
                        const JointLimits& limits, std::span<const SegmentLimits> stretches = {},
                        const EndSpeeds& speeds = {});

}  // namespace servomill::controllers
