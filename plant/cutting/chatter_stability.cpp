#include "plant/cutting/chatter_stability.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

#include "plant/vocabulary/interrupt.h"

namespace servomill::plant {
namespace {

using Complex = std::complex<double>;

constexpr double kFullTurn = 2.0 * std::numbers::pi;
constexpr int kPerPeriod = 60;       // intervals, of the fastest mode
constexpr int kMinIntervals = 40;    // of a tooth passage
constexpr int kVectors = 6;          // of the subspace
constexpr int kMaxPassages = 400;    // of its iteration
constexpr double kConverged = 1e-6;  // of the largest multiplier, relative, three times in a row
constexpr int kCalm = 3;
constexpr double kReal = 1e-6;  // imaginary part of a real multiplier, relative

}  // namespace

Chatter ChatterStability::kind() const {
  if (std::abs(multiplier.imag()) > kReal * std::abs(multiplier)) return Chatter::hopf;
  return multiplier.real() < 0.0 ? Chatter::flip : Chatter::fold;
}

// Vectors without structure, the same each time.
void ChatterAnalysis::resize(int intervals) {
  if (intervals == intervals_) return;
  intervals_ = intervals;
  const auto rows = 2 * static_cast<Eigen::Index>(modes_.size()) + 2 * intervals;
  vectors_.resize(rows, kVectors);
  for (Eigen::Index j = 0; j < kVectors; ++j) {
    for (Eigen::Index i = 0; i < rows; ++i) {
      vectors_(i, j) = std::sin(1.0 + 0.7 * static_cast<double>((i + 1) * (j + 1)));
    }
  }
}

// Matrices of the intervals: from q, q' / w, x(t - T) at the begin and at the end to q, q' / w.
std::vector<Eigen::MatrixXd> ChatterAnalysis::steps_of(const PeriodicCut& cut) const {
  const auto modes = static_cast<Eigen::Index>(modes_.size());
  const Eigen::Index n = 2 * modes;
  const double dt = cut.passage() / intervals_;
  const auto factors = directional_factors(cut.coefficients, cut.teeth, cut.slices, intervals_);
  std::vector<Eigen::MatrixXd> out;
  for (const Eigen::Matrix2d& A : factors) {
    // of q, q' / w, of a constant x(t - T) and of its rise over the interval
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n + 4, n + 4);
    for (Eigen::Index i = 0; i < modes; ++i) {
      const ChatterMode& mode = modes_[static_cast<std::size_t>(i)];
      M(i, modes + i) = mode.frequency * dt;
      M(modes + i, i) = -mode.frequency * dt;
      M(modes + i, modes + i) = -2.0 * mode.damping * mode.frequency * dt;
      const Eigen::RowVector2d pull =
          mode.frequency / mode.stiffness * dt * mode.direction.transpose() * A;
      for (Eigen::Index j = 0; j < modes; ++j) {
        M(modes + i, j) -= pull.dot(modes_[static_cast<std::size_t>(j)].direction);
      }
      M.block<1, 2>(modes + i, n) = pull;
    }
    M.block<2, 2>(n, n + 2).setIdentity();
    const Eigen::MatrixXd E = M.exp();
    Eigen::MatrixXd step(n, n + 4);
    step.leftCols(n) = E.topLeftCorner(n, n);
    step.middleCols(n, 2) = E.block(0, n, n, 2) - E.block(0, n + 2, n, 2);
    step.rightCols(2) = E.block(0, n + 2, n, 2);
    out.push_back(std::move(step));
  }
  return out;
}

Eigen::MatrixXd ChatterAnalysis::over_passage(const Eigen::MatrixXd& states,
                                              const std::vector<Eigen::MatrixXd>& steps) const {
  const auto modes = static_cast<Eigen::Index>(modes_.size());
  const Eigen::Index n = 2 * modes, columns = states.cols();
  Eigen::MatrixXd D(2, modes);
  for (Eigen::Index i = 0; i < modes; ++i) {
    D.col(i) = modes_[static_cast<std::size_t>(i)].direction;
  }
  Eigen::MatrixXd out(states.rows(), columns), now(n + 4, columns), next(n, columns);
  now.topRows(n) = states.topRows(n);
  const Eigen::MatrixXd x_begin = D * states.topRows(modes);  // the last of the passage before
  for (int i = 0; i < intervals_; ++i) {
    const Eigen::Index row = n + 2 * i;
    out.middleRows(row, 2) = D * now.topRows(modes);
    now.middleRows(n, 2) = states.middleRows(row, 2);
    if (i + 1 < intervals_) {
      now.bottomRows(2) = states.middleRows(row + 2, 2);
    } else {
      now.bottomRows(2) = x_begin;
    }
    next.noalias() = steps[static_cast<std::size_t>(i)].lazyProduct(now);
    now.topRows(n) = next;
  }
  out.topRows(n) = now.topRows(n);
  return out;
}

// Frequency of the largest harmonic of x(t) = exp(log(multiplier) t / T) times a periodic function.
double ChatterAnalysis::strongest(const Eigen::VectorXcd& state, Complex multiplier,
                                  double passage) const {
  const auto n = 2 * static_cast<Eigen::Index>(modes_.size());
  const Complex rate = std::log(multiplier);
  double largest = -1.0, frequency = 0.0;
  for (int k = -intervals_ / 2; k < intervals_ / 2; ++k) {
    Eigen::Vector2cd sum = Eigen::Vector2cd::Zero();
    for (int i = 0; i < intervals_; ++i) {
      const double share = static_cast<double>(i) / intervals_;
      sum += state.segment<2>(n + 2 * i) * std::exp(-share * (rate + Complex(0.0, kFullTurn * k)));
    }
    if (sum.norm() <= largest) continue;
    largest = sum.norm();
    frequency = std::abs(rate.imag() / kFullTurn + k) / passage;
  }
  return frequency;
}

ChatterStability ChatterAnalysis::of(const PeriodicCut& cut) {
  double fastest = 0.0;
  for (const ChatterMode& mode : modes_) fastest = std::max(fastest, mode.frequency / kFullTurn);
  const double T = cut.passage();
  resize(std::max(kMinIntervals, static_cast<int>(std::ceil(kPerPeriod * fastest * T))));
  const std::vector<Eigen::MatrixXd> steps = steps_of(cut);
  Complex largest = 0.0;
  Eigen::VectorXcd state;
  for (int n = 0, calm = 0; n < kMaxPassages && calm < kCalm; ++n) {
    throw_if_interrupted();
    const Eigen::MatrixXd V = Eigen::HouseholderQR<Eigen::MatrixXd>(vectors_).householderQ() *
                              Eigen::MatrixXd::Identity(vectors_.rows(), kVectors);
    vectors_ = over_passage(V, steps);
    const Eigen::EigenSolver<Eigen::MatrixXd> ritz(V.transpose() * vectors_);
    Eigen::Index first = 0;
    ritz.eigenvalues().cwiseAbs().maxCoeff(&first);
    Complex found = ritz.eigenvalues()[first];
    Eigen::VectorXcd weights = ritz.eigenvectors().col(first);
    if (found.imag() < 0.0) {
      found = std::conj(found);
      weights = weights.conjugate().eval();
    }
    const bool is_calm =
        std::abs(std::abs(found) - std::abs(largest)) < kConverged * std::abs(found);
    calm = is_calm ? calm + 1 : 0;
    largest = found;
    state = V.cast<Complex>() * weights;
  }
  if (largest == 0.0) return {};
  return {largest, strongest(state, largest, T)};
}

}  // namespace servomill::plant
