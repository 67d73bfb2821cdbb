// Points of a NURBS from the definition of its basis functions: slow, and another way than
// SplineCurve.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

namespace servomill {

class CoxDeBoor {
 public:
  CoxDeBoor(int order, std::vector<Eigen::Vector3d> points, std::vector<double> weights)
      : order_(order), points_(std::move(points)), weights_(std::move(weights)) {
    const int n = static_cast<int>(points_.size());
    for (int i = 0; i < n + order_; ++i) {
      knots_.push_back(std::clamp(i - order_ + 1, 0, n - order_ + 1));
    }
  }

  double last_knot() const { return knots_.back(); }

  Eigen::Vector3d point(double u) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double weight = 0.0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double N = weights_[i] * basis(i, order_, u);
      sum += N * points_[i];
      weight += N;
    }
    return sum / weight;
  }

  /// Length of the chords between n points.
  double length(int n) const {
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
      sum += (point(last_knot() * (i + 1) / n) - point(last_knot() * i / n)).norm();
    }
    return sum;
  }

  /// Distance of p from the curve: n points are looked at, the best of them is refined.
  double distance(const Eigen::Vector3d& p, int n) const {
    const auto at = [&](double u) { return (point(u) - p).norm(); };
    double best = 0.0;
    for (int i = 0; i <= n; ++i) {
      const double u = last_knot() * i / n;
      if (at(u) < at(best)) best = u;
    }
    double low = std::max(best - last_knot() / n, 0.0);
    double high = std::min(best + last_knot() / n, last_knot());
    constexpr double kGolden = 0.6180339887498949;
    while (high - low > 1e-13 * last_knot()) {
      const double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
      (at(a) < at(b) ? high : low) = at(a) < at(b) ? b : a;
    }
    return std::min(at(best), at(0.5 * (low + high)));
  }

 private:
  double basis(std::size_t i, int order, double u) const {
    const auto k = [&](std::size_t at) { return static_cast<double>(knots_[at]); };
    if (order == 1) {
      const bool is_last = u >= knots_.back() && k(i + 1) == knots_.back() && k(i) < k(i + 1);
      return (k(i) <= u && u < k(i + 1)) || is_last ? 1.0 : 0.0;
    }
    const auto part = [&](double above, double below, std::size_t j) {
      return below > 0.0 ? above / below * basis(j, order - 1, u) : 0.0;
    };
    const auto n = static_cast<std::size_t>(order);
    return part(u - k(i), k(i + n - 1) - k(i), i) + part(k(i + n) - u, k(i + n) - k(i + 1), i + 1);
  }

  int order_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<double> weights_;
  std::vector<int> knots_;
};

}  // namespace servomill
