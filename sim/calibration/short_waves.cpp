#include "sim/calibration/short_waves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace servomill::sim::calibration {
namespace {

constexpr double kSignificant = 2.0;  // standard deviations of the noise's own roughness
constexpr double kOwn = 0.25;         // weight of a function's own roughness beside that of all

struct Roughness {
  double excess = 0.0;  // r'r - tr N
  double white = 0.0;   // tr G
  double noise = 0.0;   // variance of the excess without short waves: 2 tr(N N)

  void add(const Roughness& other) {
    excess += other.excess;
    white += other.white;
    noise += other.noise;
  }
  bool is_significant() const { return excess > kSignificant * std::sqrt(noise); }
  double variance() const { return white > 0.0 ? std::max(0.0, excess / white) : 0.0; }
};

bool counts(const SoughtFunction& function) {
  return !function.has_own_knots &&
         static_cast<int>(function.basis.form().knots.size()) >= kMinKnots;
}

Roughness roughness_of(const Adjustment& adjustment, const SoughtFunction& function) {
  const std::vector<double>& knots = function.basis.form().knots;
  const auto m = static_cast<Eigen::Index>(knots.size());
  const int n = function.basis.size();
  Roughness out;
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(m - 2, n);  // second differences of the unknowns
  for (Eigen::Index i = 1; i + 1 < m; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double b = (knots[k] - knots[k - 1]) / (knots[k + 1] - knots[k - 1]), a = 1.0 - b;
    D.row(i - 1) = function.basis.row(knots[k], 0.0) - a * function.basis.row(knots[k - 1], 0.0) -
                   b * function.basis.row(knots[k + 1], 0.0);
    out.white += 1.0 + a * a + b * b;
  }
  const Eigen::VectorXd r = D * adjustment.values.segment(function.first, n);
  const Eigen::MatrixXd N =
      D * adjustment.covariance.block(function.first, function.first, n, n) * D.transpose();
  out.excess = r.squaredNorm() - N.trace();
  out.noise = 2.0 * N.squaredNorm();
  return out;
}

// Mean of cos(2 pi x t) over x from 1 to 3.
double mean_cosine(double t) {
  const double angle = 2.0 * std::numbers::pi * t;
  return angle == 0.0 ? 1.0 : (std::sin(3.0 * angle) - std::sin(angle)) / (2.0 * angle);
}

}  // namespace

std::vector<double> short_waves(const Adjustment& adjustment) {
  const std::vector<SoughtFunction>& functions = adjustment.unknowns.functions;
  std::array<Roughness, 2> pooled;  // of angles, of lengths
  std::vector<Roughness> own;
  for (const SoughtFunction& function : functions) {
    own.push_back(counts(function) ? roughness_of(adjustment, function) : Roughness{});
    pooled[is_linear(function.name.direction) ? 1 : 0].add(own.back());
  }
  std::vector<double> out;
  for (std::size_t f = 0; f < functions.size(); ++f) {
    const Roughness& all = pooled[is_linear(functions[f].name.direction) ? 1 : 0];
    const bool rough = counts(functions[f]) && all.is_significant();
    out.push_back(rough ? std::sqrt(kOwn * own[f].variance() + (1.0 - kOwn) * all.variance())
                        : 0.0);
  }
  return out;
}

double interpolation_variance(const FunctionBasis& basis, double s) {
  const FunctionForm& form = basis.form();
  const auto above = std::upper_bound(form.knots.begin(), form.knots.end() - 1, s);
  if (above == form.knots.begin()) return 0.0;
  const double t = (s - *(above - 1)) / (*above - *(above - 1));
  const double a = 1.0 - t, b = t, near = mean_cosine(t), far = mean_cosine(1.0 - t);
  // the mean line over m knots takes a share of each of them
  const double u = (2.0 * s - form.lower - form.upper) / (form.upper - form.lower);
  const double line = (1.0 + (basis.lines() == 2 ? 3.0 * u * u : 0.0)) / double(form.knots.size());
  return std::max(
      line, 1.0 + a * a + b * b - 2.0 * (a * near + b * far) + line * (2.0 * (near + far) - 1.0));
}

}  // namespace servomill::sim::calibration
