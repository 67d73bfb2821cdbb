#include "sim/calibration/short_waves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/numerics/dense_solver.h"

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

ShortWaves short_waves_of(const FunctionBasis& basis, int number) {
  const FunctionForm& form = basis.form();
  const auto m = static_cast<Eigen::Index>(form.knots.size());
  const double spacing = (form.knots.back() - form.knots.front()) / static_cast<double>(m - 1);
  const Eigen::ArrayXd s = Eigen::Map<const Eigen::ArrayXd>(form.knots.data(), m);
  ShortWaves out;
  out.amplitude = 1.0 / std::sqrt(number);
  out.tables.resize(m, Eigen::Index{2} * number);
  for (int i = 0; i < number; ++i) {
    // off the middle of its share: aliases of the upper half fall between those of the lower
    const double frequency = (1.0 + (2.0 * i + 0.5) / number) / spacing;
    out.periods.push_back(1.0 / frequency);
    const Eigen::ArrayXd angle = 2.0 * std::numbers::pi * frequency * s;
    out.tables.col(Eigen::Index{2} * i) = out.amplitude * angle.sin().matrix();
    out.tables.col(Eigen::Index{2} * i + 1) = out.amplitude * angle.cos().matrix();
  }
  // the mean line over all knots is no part of a component error; u as in interpolation_variance()
  Eigen::MatrixXd line(m, basis.lines());
  line.col(0).setOnes();
  if (basis.lines() == 2) {
    line.col(1) = ((2.0 * s - form.lower - form.upper) / (form.upper - form.lower)).matrix();
  }
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(basis.lines());
  for (Eigen::Index k = 0; k < out.tables.cols(); ++k) {
    const Eigen::VectorXd wave = out.tables.col(k), mean = numerics::least_squares(line, wave);
    out.tables.col(k) = wave - line * mean;
    variance += mean.cwiseAbs2();
  }
  const Eigen::Vector2d wanted = Eigen::Vector2d(1.0, 3.0) / static_cast<double>(m);
  out.lines = line;
  for (Eigen::Index k = 0; k < line.cols(); ++k) {
    out.lines.col(k) *= std::sqrt(std::max(0.0, wanted[k] - variance[k]));
  }
  return out;
}

}  // namespace servomill::sim::calibration
