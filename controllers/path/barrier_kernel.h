/// The arithmetic of time_optimal_law.h on eight points at once: slacks, and the derivatives of
/// what they cost. Included by the kernel: no Eigen here.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "plant/vocabulary/lanes.h"
#include "plant/vocabulary/simd.h"

namespace servomill::controllers {

inline constexpr std::size_t kBarrierJoints = 5;  // kJoints; no Eigen in kernels

/// Eight points at which the limits are looked at. With c the three coefficients that form b there,
/// x = (b, b', b'') = S c, the use of the limits of a joint is
///
///     jerk:          L sqrt(b),   L = j0 b + j1 b' + j2 b''
///     acceleration:  M = (J/A) (2/3 j1 b + (j2 + swell j0) b')
///
/// Between the ends of a cubic L is its control point in the middle; swell leads back to M there.
struct BarrierPoints {
  std::array<std::array<LaneArray, 3>, 3> S;
  LaneArray length;  // m, of the path, that a point stands for
  LaneArray time;    // s, the same in the law where the search begins
  LaneArray b_top;   // m^2/s^2
  LaneArray swell;   // m^2
  std::array<LaneArray, kBarrierJoints> j0, j1, j2;  // of the joints that move, divided by J
  std::array<std::uint32_t, kLaneWidth> interval;    // c[interval] is the first of three
};

/// The joints that move.
struct BarrierJoints {
  std::size_t count = 0;
  std::array<double, kBarrierJoints> ratio = {};     // s, J/A
  std::array<double, kBarrierJoints> per_jerk = {};  // s^3/m, 1/J
};

/// Eight parts of the path, each of one interval between knots and of one piece. Their points -
/// both ends and the middle - take six times the memory, so that a long path forms them when they
/// are due.
struct BarrierParts {
  LaneArray before, at, next, after;  // m, the knots around: the interval goes from `at` to `next`
  LaneArray from, to;                 // m
  LaneArray x;                        // m, `from` on the piece
  LaneArray b_top;                    // m^2/s^2
  std::array<LaneArray, kBarrierJoints> c1, c2, c3;  // of the piece, for the joints that move
  std::array<std::uint32_t, kLaneWidth> interval;
};

/// Eight points: their place in the path, and their share of the cost by its three coefficients.
struct BarrierTerms {
  std::array<LaneArray, 3> x;  // b, b', b''
  std::array<LaneArray, 3> g;  // first derivatives
  std::array<LaneArray, 6> h;  // second derivatives 00 01 02 11 12 22
};

/// Largest uses over all points; b_least <= 0 means that there is no speed somewhere.
struct BarrierUse {
  double b_least, jerk, acceleration, speed;  // m^2/s^2; of the limits, speed of v^2
};

/// Functions of one instruction set; the same bits from all of them.
struct BarrierKernel {
  /// Three blocks of points from each of the parts, in the order begin, middle, end of the first,
  /// begin ... of the second. `time` is that at the coefficients c.
  void (*form)(const BarrierParts* parts, std::size_t count, const BarrierJoints&, const double* c,
               BarrierPoints* out);
  /// Fills `time`, too.
  BarrierUse (*use)(BarrierPoints* points, std::size_t count, const BarrierJoints&,
                    const double* c);
  /// Derivatives of `sum length/sqrt(b) - mu sum time log(slack)`; limits used by less than a tenth
  /// are left out.
  void (*derive)(const BarrierPoints* points, std::size_t count, const BarrierJoints&,
                 const double* c, double mu, BarrierTerms* out);
  /// Largest loss of a slack in a step of the coefficients, of the slack; at least 1e-9.
  double (*largest_loss)(const BarrierPoints* points, std::size_t count, const BarrierJoints&,
                         const double* step, const BarrierTerms* terms);
};

template <SimdLevel level>
BarrierKernel make_barrier_kernel();

}  // namespace servomill::controllers
