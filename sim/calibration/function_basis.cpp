#include "sim/calibration/function_basis.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace servomill::sim::calibration {
namespace {

constexpr int kIntervals = 64;  // at least, of the integrals over travel
// Gauss and Legendre, five points on [-1, 1]: exact to degree 9
constexpr double kNodes[] = {0.0, 0.5384693101056831, -0.5384693101056831, 0.9061798459386640,
                             -0.9061798459386640};
constexpr double kWeights[] = {0.5688888888888889, 0.4786286704993665, 0.4786286704993665,
                               0.2369268850561891, 0.2369268850561891};

// P_1 to P_n at u, by the recurrence (k + 1) P_k+1 = (2k + 1) u P_k - k P_k-1.
std::vector<double> legendre(int n, double u) {
  std::vector<double> out;
  double before = 1.0, now = u;
  for (int k = 1; k <= n; ++k) {
    out.push_back(now);
    const double next = ((2 * k + 1) * u * now - k * before) / (k + 1);
    before = now;
    now = next;
  }
  return out;
}

// Coefficients of the polynomials P_1 to P_n in powers of u.
std::vector<std::vector<double>> legendre_coefficients(int n) {
  std::vector<std::vector<double>> P = {{1.0}, {0.0, 1.0}};
  for (int k = 1; k < n; ++k) {
    const auto order = static_cast<std::size_t>(k);
    std::vector<double> next(order + 2, 0.0);
    for (std::size_t i = 0; i < P[order].size(); ++i) {
      next[i + 1] += (2.0 * k + 1.0) / (k + 1.0) * P[order][i];
    }
    for (std::size_t i = 0; i < P[order - 1].size(); ++i) {
      next[i] -= k / (k + 1.0) * P[order - 1][i];
    }
    P.push_back(std::move(next));
  }
  P.erase(P.begin());
  return P;
}

// p(u) with u = a + b s, as a polynomial of s.
std::vector<double> substituted(const std::vector<double>& p, double a, double b) {
  std::vector<double> out;
  for (auto c = p.rbegin(); c != p.rend(); ++c) {
    std::vector<double> next(out.size() + 1, 0.0);
    for (std::size_t i = 0; i < out.size(); ++i) {
      next[i] += a * out[i];
      next[i + 1] += b * out[i];
    }
    next[0] += *c;
    out = std::move(next);
  }
  while (!out.empty() && out.back() == 0.0) out.pop_back();
  return out;
}

}  // namespace

FunctionBasis::FunctionBasis(FunctionForm form, bool without_slope) : form_(std::move(form)) {
  assert(form_.lower < form_.upper);
  const int lines = without_slope ? 2 : 1;
  least_degree_ = without_slope || !form_.knots.empty() ? 2 : 1;
  hats_ = std::max(0, static_cast<int>(form_.knots.size()) - lines);
  first_knot_ = std::max(0, form_.degree - least_degree_ + 1);
  first_wave_ = first_knot_ + hats_;
  first_width_ = first_wave_ + 2 * static_cast<int>(form_.periods.size());
  size_ = first_width_ + form_.reversal_degree + 1;
  projection_ = Eigen::MatrixXd::Zero(lines, size_);
  project();
}

double FunctionBasis::normalized(double s) const {
  return (2.0 * s - form_.lower - form_.upper) / (form_.upper - form_.lower);
}

void FunctionBasis::plain_values(double s, double direction, std::vector<BasisValue>& out) const {
  if (first_knot_ > 0) {
    const std::vector<double> P = legendre(form_.degree, normalized(s));
    for (int k = 0; k < first_knot_; ++k) {
      out.push_back({k, P[static_cast<std::size_t>(k + least_degree_ - 1)]});
    }
  }
  const auto add_hat = [&](int knot, double value) {
    if (knot < hats_) out.push_back({first_knot_ + knot, value});
  };
  const std::vector<double>& knots = form_.knots;
  if (!knots.empty()) {
    const auto above = std::upper_bound(knots.begin(), knots.end(), s);
    if (above == knots.begin() || above == knots.end()) {  // constant beyond the ends
      const int end = above == knots.begin() ? 0 : static_cast<int>(knots.size()) - 1;
      add_hat(end, 1.0);
    } else {
      const auto k = static_cast<int>(above - knots.begin());
      const double share = (s - *(above - 1)) / (*above - *(above - 1));
      add_hat(k - 1, 1.0 - share);
      add_hat(k, share);
    }
  }
  int index = first_wave_;
  for (const double period : form_.periods) {
    const double phase = 2.0 * std::numbers::pi * s / period;
    out.push_back({index++, std::sin(phase)});
    out.push_back({index++, std::cos(phase)});
  }
  double power = 0.5 * direction;
  for (int k = 0; k <= form_.reversal_degree; ++k) {
    out.push_back({first_width_ + k, power});
    power *= normalized(s);
  }
}

// Least squares of the mean and the slope over travel: <f, 1> and 3 <f, u>, as 1 and u are
// orthogonal with <u, u> = 1/3.
void FunctionBasis::project() {
  std::vector<double> ends = {form_.lower, form_.upper};
  for (int i = 1; i < kIntervals; ++i) {
    ends.push_back(form_.lower + (form_.upper - form_.lower) * i / kIntervals);
  }
  for (const double knot : form_.knots) {
    if (knot > form_.lower && knot < form_.upper) ends.push_back(knot);
  }
  std::sort(ends.begin(), ends.end());
  std::vector<BasisValue> values;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const double half = 0.5 * (ends[i + 1] - ends[i]);
    for (std::size_t node = 0; node < std::size(kNodes); ++node) {
      const double s = ends[i] + half * (1.0 + kNodes[node]);
      const double weight = kWeights[node] * half / (form_.upper - form_.lower);
      values.clear();
      plain_values(s, 0.0, values);
      for (const BasisValue& one : values) {
        projection_(0, one.index) += weight * one.value;
        if (lines() == 2) projection_(1, one.index) += 3.0 * weight * one.value * normalized(s);
      }
    }
  }
}

void FunctionBasis::evaluate(double s, double direction, std::vector<BasisValue>& out) const {
  plain_values(s, direction, out);
  out.push_back({size_, 1.0});
  if (lines() == 2) out.push_back({size_ + 1, normalized(s)});
}

Eigen::RowVectorXd FunctionBasis::row(double s, double direction) const {
  std::vector<BasisValue> values;
  plain_values(s, direction, values);
  Eigen::RowVectorXd out = -projection_.row(0);
  if (lines() == 2) out -= normalized(s) * projection_.row(1);
  for (const BasisValue& one : values) out[one.index] += one.value;
  return out;
}

plant::ErrorFunction FunctionBasis::function(const Eigen::VectorXd& coefficients) const {
  plant::ErrorFunction out;
  const double b = 2.0 / (form_.upper - form_.lower);
  const double a = normalized(0.0);
  const Eigen::VectorXd line = projection_ * coefficients;
  std::vector<double> powers(static_cast<std::size_t>(std::max(2, form_.degree + 1)), 0.0);
  powers[0] -= line[0];
  if (lines() == 2) powers[1] -= line[1];
  const auto P = legendre_coefficients(form_.degree);
  for (int k = 0; k < first_knot_; ++k) {
    const std::vector<double>& p = P[static_cast<std::size_t>(k + least_degree_ - 1)];
    for (std::size_t i = 0; i < p.size(); ++i) powers[i] += coefficients[k] * p[i];
  }
  if (form_.knots.empty()) {
    out.polynomial = substituted(powers, a, b);
  } else {                                     // the line becomes part of the table
    const bool takes_line = first_knot_ == 0;  // else the polynomial does
    std::vector<double> values;
    for (int k = 0; k < static_cast<int>(form_.knots.size()); ++k) {
      const double u = normalized(form_.knots[static_cast<std::size_t>(k)]);
      const double hat = k < hats_ ? coefficients[first_knot_ + k] : 0.0;
      values.push_back(hat + (takes_line ? powers[0] + powers[1] * u : 0.0));
    }
    out.tables.push_back({form_.knots, std::move(values)});
    if (!takes_line) out.polynomial = substituted(powers, a, b);
  }
  for (std::size_t i = 0; i < form_.periods.size(); ++i) {
    const double sine = coefficients[first_wave_ + 2 * static_cast<int>(i)];
    const double cosine = coefficients[first_wave_ + 2 * static_cast<int>(i) + 1];
    out.harmonics.push_back({sine, form_.periods[i], 0.0});
    out.harmonics.push_back({cosine, form_.periods[i], 0.5 * std::numbers::pi});
  }
  if (form_.reversal_degree >= 0) {
    const Eigen::VectorXd w = coefficients.tail(form_.reversal_degree + 1);
    const auto width = substituted({w.data(), w.data() + w.size()}, a, b);
    if (!width.empty()) out.reversals.push_back({width, form_.reversal_distance});
  }
  return out;
}

}  // namespace servomill::sim::calibration
