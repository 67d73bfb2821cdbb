/// The motion of a linear drive over a sub-step under a force that is a parabola in time.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace servomill::plant {

/// States at h/4, h/2, 3h/4 and h, the position as an increment, from columns
///   i, w, delta, v, command, f(0), f(h/2), f(h).
struct Propagator {
  static constexpr std::size_t kNodes = 4, kColumns = 8;
  /// v at the four nodes, then i, w, delta, x at h: all that a slide that glides needs.
  static constexpr std::size_t kSlideRows = 8, kCurrent = 4, kSpeed = 5, kWindUp = 6, kPosition = 7;
  /// i, w, delta, x at the first three nodes, node after node.
  static constexpr std::size_t kInnerRows = 12;

  std::array<std::array<double, kSlideRows>, kColumns> slide{};
  std::array<std::array<double, kInnerRows>, kColumns> inner{};
};

/// Further columns and rows of a Propagator for a drive on a bed.
struct BedPropagator {
  static constexpr std::size_t kColumns = Propagator::kColumns + 2;
  // rows of Propagator, columns b, db/dt
  std::array<std::array<double, Propagator::kSlideRows>, 2> slide{};
  std::array<std::array<double, Propagator::kInnerRows>, 2> inner{};
  // b, db/dt at the four nodes, node after node, from the columns of Propagator and b, db/dt
  std::array<std::array<double, 2 * Propagator::kNodes>, kColumns> bed{};
};

/// Equations dx/dt = A x + B (command, F) with kStates states: those of a drive (5) or of a drive
/// on a bed (7) of feed_drive.h. The last state is the position.
template <int kStates>
using DriveEquations = Eigen::Matrix<double, kStates, kStates + 2>;

/// Bound of the eigenvalues of a drive without its position (1/s). Rows or columns that couple one
/// way only have no say.
template <int kStates>
double fastest_rate(const DriveEquations<kStates>& equations);

/// e^{At}, int_0^t e^{A(t-s)} b ds and int_0^t e^{A(t-s)} b_F s^m ds, m = 0, 1, 2, as power series
/// in long double.
template <int kStates>
class PropagatorSeries {
 public:
  /// The sum of the omitted terms stays below the last bit of long double as long as
  /// t times the rates of A does not exceed this.
  static constexpr double kMaxRate = 2.0;

  explicit PropagatorSeries(const DriveEquations<kStates>& equations);
  /// @param h  s
  Propagator over(long double h) const;
  /// The part that a bed adds. @pre kStates is 7
  BedPropagator bed_over(long double h) const;
  /// The increment of the position at the time t of a sub-step of length h, by the same columns.
  std::array<double, Propagator::kColumns> position_at(long double t, long double h) const;

 private:
  static constexpr std::size_t kTerms = 30;  // 2^30 / 30!
  struct Values;
  Values at(long double t) const;
  enum State : int { i, w, delta, v, b, db, x = kStates - 1 };
  static long double entry(const Values& S, State state, std::size_t column, long double h);

  using Matrix = Eigen::Matrix<long double, kStates, kStates>;
  using Vector = Eigen::Matrix<long double, kStates, 1>;
  std::array<Matrix, kTerms> A_;
  std::array<Vector, kTerms> command_, force_;
  long double rate_;  // 1/s
};

}  // namespace servomill::plant
