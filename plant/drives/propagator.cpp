#include "plant/drives/propagator.h"

#include <cmath>

namespace servomill::plant {
namespace {

// Similar to A with rows and columns of equal size (Osborne's iteration): the size of its entries
// is that of its eigenvalues.
template <int n>
Eigen::Matrix<double, n, n> balanced(Eigen::Matrix<double, n, n> A) {
  // Similarity keeps the eigenvalues; units (A, rad/s, m) no longer matter to the norm then. Thirty
  // sweeps: the iteration converges linearly, and no result depends on its last digits.
  for (int sweep = 0; sweep < 30; ++sweep) {
    for (int j = 0; j < n; ++j) {
      const double column = A.col(j).cwiseAbs().sum() - std::abs(A(j, j));
      const double row = A.row(j).cwiseAbs().sum() - std::abs(A(j, j));
      if (column == 0.0 || row == 0.0) continue;
      const double scale = std::sqrt(row / column);
      A.col(j) *= scale;
      A.row(j) /= scale;
    }
  }
  return A;
}

}  // namespace

template <int kStates>
double fastest_rate(const DriveEquations<kStates>& A) {
  constexpr int n = kStates - 1;
  Eigen::Matrix<double, n, n> B = balanced<n>(A.template topLeftCorner<n, n>());
  for (int j = 0; j < n; ++j) {
    const double diagonal = B(j, j);
    B(j, j) = 0.0;
    // A state that acts on nothing, or on which nothing acts, adds its own diagonal alone: its
    // couplings could be scaled to any size.
    if (B.row(j).cwiseAbs().sum() == 0.0 || B.col(j).cwiseAbs().sum() == 0.0) {
      B.row(j).setZero();
      B.col(j).setZero();
    }
    B(j, j) = diagonal;
  }
  // The norm of rows bounds every eigenvalue.
  return B.cwiseAbs().rowwise().sum().maxCoeff();
}

template <int kStates>
struct PropagatorSeries<kStates>::Values {
  Matrix E = Matrix::Zero();
  Vector command = Vector::Zero();
  std::array<Vector, 3> moment = {Vector::Zero(), Vector::Zero(), Vector::Zero()};
};

template <int kStates>
PropagatorSeries<kStates>::PropagatorSeries(const DriveEquations<kStates>& equations)
    : rate_(static_cast<long double>(fastest_rate<kStates>(equations))) {
  const Matrix A = equations.template leftCols<kStates>().template cast<long double>();
  A_[0].setIdentity();
  // Powers once for all lengths: a drive is propagated over many different sub-steps.
  for (std::size_t k = 1; k < kTerms; ++k) A_[k] = A * A_[k - 1];
  for (std::size_t k = 0; k < kTerms; ++k) {
    command_[k] = A_[k] * equations.col(kStates).template cast<long double>();
    force_[k] = A_[k] * equations.col(kStates + 1).template cast<long double>();
  }
}

template <int kStates>
typename PropagatorSeries<kStates>::Values PropagatorSeries<kStates>::at(long double t) const {
  Values S;
  // An entry begins with one of the first terms; each further one is smaller by rate t / k.
  constexpr std::size_t kFirst = 6;
  std::size_t terms = kFirst;
  // Terms (rate t)^k / k! of the exponential, down to a thousandth of the rounding of a double.
  for (long double size = 1.0L; size > 1e-22L && terms < kTerms; ++terms) {
    size *= rate_ * t / static_cast<long double>(terms - kFirst + 1);
  }
  std::array<long double, 4> factor = {1.0L, t, t * t / 2.0L, t * t * t / 3.0L};
  for (std::size_t k = 0; k < terms; ++k) {
    const auto n = static_cast<long double>(k + 1);
    S.E += A_[k] * factor[0];
    S.command += command_[k] * factor[1];
    for (std::size_t m = 0; m < 3; ++m) S.moment[m] += force_[k] * factor[m + 1];
    // Factors t^(k+1+m) m! / (k+1+m)!: the integrals of e^(A (t - s)) s^m, by which a force that is
    // a parabola in time acts.
    for (std::size_t m = 0; m < 4; ++m) factor[m] *= t / (n + static_cast<long double>(m));
  }
  return S;
}

// Contribution of a column of BedPropagator, for a sub-step of length h, to a state.
template <int kStates>
long double PropagatorSeries<kStates>::entry(const Values& S, State state, std::size_t column,
                                             long double h) {
  // The parabolas that are 1 at one of 0, 1/2, 1 and 0 at the others: coefficients of 1, s, s^2.
  constexpr double kLagrange[3][3] = {{1.0, -3.0, 2.0}, {0.0, 4.0, -4.0}, {0.0, -1.0, 2.0}};
  if (column < 4) return S.E(state, static_cast<Eigen::Index>(column));
  if (column == 4) return S.command(state);
  if (column >= Propagator::kColumns) {
    return S.E(state, static_cast<Eigen::Index>(column - Propagator::kColumns) + b);
  }
  // A force given at begin, middle and end of the sub-step, as Simpson's rule has it.
  const double(&l)[3] = kLagrange[column - 5];
  return l[0] * S.moment[0](state) + l[1] * S.moment[1](state) / h +
         l[2] * S.moment[2](state) / (h * h);
}

template <int kStates>
std::array<double, Propagator::kColumns> PropagatorSeries<kStates>::position_at(
    long double t, long double h) const {
  const Values S = at(t);
  std::array<double, Propagator::kColumns> row{};
  for (std::size_t column = 0; column < row.size(); ++column) {
    row[column] = static_cast<double>(entry(S, x, column, h));
  }
  return row;
}

template <int kStates>
Propagator PropagatorSeries<kStates>::over(long double h) const {
  Propagator P;
  for (std::size_t node = 0; node < Propagator::kNodes; ++node) {
    const Values S = at(h * static_cast<long double>(node + 1) / 4.0L);
    constexpr State kOthers[] = {i, w, delta, x};
    for (std::size_t column = 0; column < Propagator::kColumns; ++column) {
      P.slide[column][node] = static_cast<double>(entry(S, v, column, h));
      const bool last = node + 1 == Propagator::kNodes;
      double* to = last ? &P.slide[column][Propagator::kCurrent] : &P.inner[column][4 * node];
      for (const State state : kOthers) *to++ = static_cast<double>(entry(S, state, column, h));
    }
  }
  return P;
}

template <>
BedPropagator PropagatorSeries<7>::bed_over(long double h) const {
  BedPropagator P;
  for (std::size_t node = 0; node < Propagator::kNodes; ++node) {
    const Values S = at(h * static_cast<long double>(node + 1) / 4.0L);
    const auto value = [&](State state, std::size_t column) {
      return static_cast<double>(entry(S, state, column, h));
    };
    for (std::size_t n = 0; n < 2; ++n) {
      const std::size_t column = Propagator::kColumns + n;
      P.slide[n][node] = value(v, column);
      const bool last = node + 1 == Propagator::kNodes;
      double* to = last ? &P.slide[n][Propagator::kCurrent] : &P.inner[n][4 * node];
      for (const State state : {i, w, delta, x}) *to++ = value(state, column);
    }
    for (std::size_t column = 0; column < BedPropagator::kColumns; ++column) {
      P.bed[column][2 * node] = value(b, column);
      P.bed[column][2 * node + 1] = value(db, column);
    }
  }
  return P;
}

template double fastest_rate<5>(const DriveEquations<5>&);
template double fastest_rate<7>(const DriveEquations<7>&);
template class PropagatorSeries<5>;
template class PropagatorSeries<7>;

}  // namespace servomill::plant
