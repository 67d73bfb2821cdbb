#include "sim/responses/rational_fit.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/progress.h"
#include "sim/numerics/decompositions.h"
#include "sim/numerics/dense_solver.h"
#include "sim/responses/response_misfit.h"

namespace servomill::sim::responses {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

Complex polynomial(const std::vector<double>& c, Complex p) {
  Complex sum = 0.0;
  for (auto one = c.rbegin(); one != c.rend(); ++one) sum = sum * p + *one;
  return sum;
}

// Real and imaginary part of each line, one after the other.
void put(Eigen::MatrixXd& rows, std::size_t line, Eigen::Index column, Complex value) {
  rows(static_cast<Eigen::Index>(2 * line), column) = value.real();
  rows(static_cast<Eigen::Index>(2 * line + 1), column) = value.imag();
}

// The parameters of a model in a row: b, a without its last, dead time in periods of w0.
class Fitter {
 public:
  Fitter(const MeasuredResponse& response, const RationalOrder& order)
      : response_(response), order_(order) {
    const double first = response.lines.front().frequency, last = response.lines.back().frequency;
    // Frequencies over the geometric mean of the range: powers of p stay near 1, and with them the
    // condition of the normal equations.
    w0_ = kTurn * std::sqrt(first * last);
  }

  Eigen::Index size() const {
    return order_.numerator + 1 + order_.denominator + (order_.with_dead_time ? 1 : 0);
  }

  Rational model(const Eigen::VectorXd& x) const {
    Rational out;
    out.w0 = w0_;
    out.b.assign(x.data(), x.data() + order_.numerator + 1);
    out.a.assign(x.data() + order_.numerator + 1,
                 x.data() + order_.numerator + 1 + order_.denominator);
    out.a.push_back(1.0);
    if (order_.with_dead_time) out.dead_time = x[x.size() - 1] / w0_;
    return out;
  }

  std::vector<Complex> at_lines(const Eigen::VectorXd& x) const {
    const Rational m = model(x);
    std::vector<Complex> out;
    for (const ResponseLine& line : response_.lines) out.push_back(m.at(line.frequency));
    return out;
  }

  // Linear iterations: |B - G A|^2 / |A of the last one|^2.
  Eigen::VectorXd start(const std::vector<double>& weight) const {
    // Sanathanan and Koerner (1963): the linear equation error, divided by the denominator of the
    // round before, tends to the error of the response. The rounds need not fall steadily: the best
    // one counts.
    constexpr int kRounds = 30;
    std::vector<double> of_last(weight.size(), 1.0);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(size()), best = x;
    double least = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kRounds; ++round) {
      solve_linear(weight, of_last, x);
      const Rational m = model(x);
      for (std::size_t n = 0; n < weight.size(); ++n) {
        of_last[n] = std::max(
            std::abs(polynomial(m.a, Complex(0.0, kTurn * response_.lines[n].frequency / w0_))),
            1e-12);
      }
      const double cost = residual(x, weight).squaredNorm();
      if (cost < least) {
        least = cost;
        best = x;
      }
    }
    return best;
  }

  // One of these iterations: the coefficients by least squares, the dead time as it is.
  void solve_linear(const std::vector<double>& weight, const std::vector<double>& of_last,
                    Eigen::VectorXd& x) const {
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(2 * weight.size()), size());
    Eigen::MatrixXd y(K.rows(), 1);
    for (std::size_t n = 0; n < weight.size(); ++n) {
      const ResponseLine& line = response_.lines[n];
      const Complex p(0.0, kTurn * line.frequency / w0_);
      // The last coefficient of A is 1: its term is the right side.
      Complex power = weight[n] / of_last[n];
      for (int k = 0; k <= order_.denominator; ++k, power *= p) {
        if (k <= order_.numerator) put(K, n, k, power);
        if (k < order_.denominator) put(K, n, order_.numerator + 1 + k, -line.value * power);
        if (k == order_.denominator) put(y, n, 0, line.value * power);
      }
    }
    const Eigen::Index coefficients = K.cols() - (order_.with_dead_time ? 1 : 0);
    x.head(coefficients) = numerics::least_squares(K.leftCols(coefficients), y.col(0));
  }

  Eigen::VectorXd residual(const Eigen::VectorXd& x, const std::vector<double>& weight) const {
    const std::vector<Complex> at = at_lines(x);
    Eigen::MatrixXd out(static_cast<Eigen::Index>(2 * weight.size()), 1);
    for (std::size_t n = 0; n < weight.size(); ++n) {
      put(out, n, 0, weight[n] * (at[n] - response_.lines[n].value));
    }
    return out.col(0);
  }

  Eigen::MatrixXd jacobian(const Eigen::VectorXd& x, const std::vector<double>& weight) const {
    const Rational m = model(x);
    Eigen::MatrixXd J(static_cast<Eigen::Index>(2 * weight.size()), size());
    for (std::size_t n = 0; n < weight.size(); ++n) {
      const double f = response_.lines[n].frequency;
      const Complex p(0.0, kTurn * f / w0_), G = m.at(f), A = polynomial(m.a, p);
      const Complex delay = std::exp(-Complex(0.0, kTurn * f) * m.dead_time);
      Complex power = weight[n];
      for (int k = 0; k <= std::max(order_.numerator, order_.denominator); ++k, power *= p) {
        if (k <= order_.numerator) put(J, n, k, power * delay / A);
        if (k < order_.denominator) put(J, n, order_.numerator + 1 + k, -power * G / A);
      }
      if (order_.with_dead_time) put(J, n, size() - 1, -weight[n] * p * G);
    }
    return J;
  }

  // Levenberg and Marquardt, in columns of like size.
  Eigen::VectorXd descend(Eigen::VectorXd x, const std::vector<double>& weight) const {
    constexpr int kMaxRounds = 200;
    double damping = 1e-3, cost = residual(x, weight).squaredNorm();
    for (int round = 0; round < kMaxRounds && damping < 1e12; ++round) {
      const Eigen::MatrixXd J = jacobian(x, weight);
      const Eigen::VectorXd scale = J.colwise().norm().cwiseMax(1e-300);
      const Eigen::MatrixXd unit = J * scale.cwiseInverse().asDiagonal();
      const Eigen::VectorXd gradient = unit.transpose() * residual(x, weight);
      Eigen::MatrixXd normal = unit.transpose() * unit;
      normal.diagonal().array() += damping;
      const Eigen::VectorXd step =
          -numerics::solve_symmetric(normal, gradient).cwiseQuotient(scale);
      const double next = residual(x + step, weight).squaredNorm();
      if (!(next < cost)) {
        damping *= 10.0;
        continue;
      }
      const bool ends = cost - next < 1e-13 * cost;
      x += step;
      cost = next;
      damping = std::max(damping * 0.2, 1e-15);
      if (ends) break;
    }
    return x;
  }

 private:
  const MeasuredResponse& response_;
  RationalOrder order_;
  double w0_ = 1.0;
};

// Roots of a polynomial, by the eigenvalues of its companion matrix.
Eigen::VectorXcd roots_of(std::vector<double> c) {
  while (c.size() > 1 && c.back() == 0.0) c.pop_back();
  const auto n = static_cast<Eigen::Index>(c.size()) - 1;
  if (n < 1) return {};
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index k = 0; k + 1 < n; ++k) companion(k + 1, k) = 1.0;
  for (Eigen::Index k = 0; k < n; ++k) {
    companion(k, n - 1) = -c[static_cast<std::size_t>(k)] / c.back();
  }
  return numerics::eigenvalues(companion);
}

// A root's change with a coefficient: -p^k / C'(p). Frequency |p|, damping -Re p / |p|.
std::vector<Root> roots_with_deviation(const std::vector<double>& c, double w0,
                                       const Eigen::MatrixXd& covariance) {
  std::vector<Root> out;
  std::vector<double> slope;
  for (std::size_t k = 1; k < c.size(); ++k) slope.push_back(static_cast<double>(k) * c[k]);
  for (const Complex& p : roots_of(c)) {
    if (p.imag() < -1e-12 * std::abs(p)) continue;  // its conjugate stands for both
    const Complex down = polynomial(slope, p);
    Eigen::MatrixXd along(2, covariance.cols());  // of frequency and damping
    Complex power = 1.0;
    // First-order propagation of the covariance of the coefficients to |p| and -Re p / |p|.
    const double size = std::abs(p);
    for (Eigen::Index k = 0; k < along.cols(); ++k, power *= p) {
      const Complex change = -power / down;
      const double of_size = (std::conj(p) * change).real() / size;
      along(0, k) = of_size;
      along(1, k) = -change.real() / size + p.real() / (size * size) * of_size;
    }
    const Eigen::Matrix2d C = along * covariance * along.transpose();
    out.push_back({size * w0 / kTurn, -p.real() / size,
                   std::sqrt(std::max(C(0, 0), 0.0)) * w0 / kTurn,
                   std::sqrt(std::max(C(1, 1), 0.0)), p.imag() > 1e-12 * size});
  }
  std::sort(out.begin(), out.end(),
            [](const Root& a, const Root& b) { return a.frequency < b.frequency; });
  return out;
}

}  // namespace

Complex Rational::at(double f) const {
  const Complex s(0.0, kTurn * f);
  return polynomial(b, s / w0) / polynomial(a, s / w0) * std::exp(-s * dead_time);
}

RationalFit fit_rational(const MeasuredResponse& response, const RationalOrder& order,
                         const std::string& name) {
  const Fitter fitter(response, order);
  const auto parameters = static_cast<std::size_t>(fitter.size());
  if (response.lines.size() < parameters) {
    throw InputError(
        {name}, fmt::format("contains {} lines; {} of a numerator of degree {} and a denominator "
                            "of degree {} require at least as many",
                            response.lines.size(), parameters, order.numerator, order.denominator));
  }
  // all lines alike first, then as exactly as they are measured
  double floor = 1.0;
  Eigen::VectorXd x = fitter.start(line_weights(response, floor));
  std::vector<double> weight;
  constexpr int kRounds = 4;
  Stage rounds("rounds", kRounds, Steps::unlike);
  for (int round = 0; round < kRounds; ++round) {
    rounds.reach(round);
    weight = line_weights(response, floor);
    x = fitter.descend(x, weight);
    // Lines are trusted no further than the model reaches: the median misfit is added to their
    // noise. Otherwise lines of little noise would force the model error onto all others.
    floor = median_misfit(response, fitter.at_lines(x));
  }
  RationalFit out;
  out.noise_ratio = noise_ratio(response, fitter.at_lines(x), parameters);
  if (!out.has_model_error()) {
    weight = line_weights(response, 0.0);
    x = fitter.descend(x, weight);
  }
  out.model = fitter.model(x);
  out.noise_ratio = noise_ratio(response, fitter.at_lines(x), parameters);
  out.median_misfit = median_misfit(response, fitter.at_lines(x));
  const Eigen::MatrixXd J = fitter.jacobian(x, weight);
  const double rows = static_cast<double>(2 * weight.size() - parameters);
  // Not below 1: a fit that is better than the noise by chance has no narrower intervals.
  const double ratio = fitter.residual(x, weight).squaredNorm() / std::max(rows, 1.0);
  out.covariance = numerics::pseudo_inverse(J.transpose() * J) * std::max(ratio, 1.0) *
                   response.lines_per_estimate;
  const Eigen::Index n = order.numerator + 1, m = order.denominator;
  out.zeros = roots_with_deviation(out.model.b, out.model.w0, out.covariance.topLeftCorner(n, n));
  out.poles = roots_with_deviation(out.model.a, out.model.w0, out.covariance.block(n, n, m, m));
  if (order.with_dead_time) {
    out.dead_time_deviation = std::sqrt(std::max(out.covariance(n + m, n + m), 0.0)) / out.model.w0;
  }
  return out;
}

}  // namespace servomill::sim::responses
