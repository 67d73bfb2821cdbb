#include "strategies/optimal_points.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace servomill::strategies {
namespace {

// Slopes of chords from one point that pass all points seen so far within the tolerance.
class Cone {
 public:
  explicit Cone(double tolerance) : tolerance_(tolerance) {}

  bool holds(const Eigen::Vector3d& slope) const {
    return (slope.array() >= low_.array()).all() && (slope.array() <= high_.array()).all();
  }
  void pass(const Eigen::Vector3d& slope, double distance) {
    const Eigen::Vector3d side = Eigen::Vector3d::Constant(tolerance_ / distance);
    low_ = low_.cwiseMax(slope - side);
    high_ = high_.cwiseMin(slope + side);
  }
  bool is_empty() const { return (low_.array() > high_.array()).any(); }

 private:
  static constexpr double kAny = std::numeric_limits<double>::infinity();
  double tolerance_;
  Eigen::Vector3d low_ = Eigen::Vector3d::Constant(-kAny);
  Eigen::Vector3d high_ = Eigen::Vector3d::Constant(kAny);
};

}  // namespace

std::vector<std::size_t> fewest_points(std::span<const double> x,
                                       std::span<const Eigen::Vector3d> value, double tolerance) {
  assert(x.size() >= 2 && value.size() == x.size());
  const std::size_t last = x.size() - 1;
  std::vector<std::size_t> chords(x.size(), last + 1), from(x.size(), 0);  // of the way to a point
  chords[0] = 0;
  for (std::size_t i = 0; i < last; ++i) {
    Cone cone(tolerance);
    for (std::size_t j = i + 1; j <= last && !cone.is_empty(); ++j) {
      const double distance = x[j] - x[i];
      const Eigen::Vector3d slope = (value[j] - value[i]) / distance;
      if (cone.holds(slope) && chords[i] + 1 < chords[j]) {
        chords[j] = chords[i] + 1;
        from[j] = i;
      }
      cone.pass(slope, distance);
    }
  }
  std::vector<std::size_t> points = {last};
  while (points.back() != 0) points.push_back(from[points.back()]);
  std::reverse(points.begin(), points.end());
  return points;
}

std::vector<std::size_t> optimal_points(std::span<const double> x,
                                        std::span<const Eigen::Vector3d> value, std::size_t most) {
  assert(most >= 2);
  std::vector<std::size_t> points = {0, x.size() - 1};
  double above = largest_deviation(x, value, points), below = 0.0;
  if (std::vector<std::size_t> exact = fewest_points(x, value, 0.0); exact.size() <= most) {
    return exact;
  }
  constexpr double kNear = 1e-3;  // of the deviation
  while (above - below > kNear * above) {
    const double tolerance = 0.5 * (below + above);
    std::vector<std::size_t> found = fewest_points(x, value, tolerance);
    if (found.size() > most) {
      below = tolerance;
    } else {
      above = std::min(tolerance, largest_deviation(x, value, found));
      points = std::move(found);
    }
  }
  return points;
}

double largest_deviation(std::span<const double> x, std::span<const Eigen::Vector3d> value,
                         std::span<const std::size_t> points) {
  double largest = 0.0;
  for (std::size_t k = 1; k < points.size(); ++k) {
    const std::size_t a = points[k - 1], b = points[k];
    const Eigen::Vector3d slope = (value[b] - value[a]) / (x[b] - x[a]);
    for (std::size_t i = a + 1; i < b; ++i) {
      const Eigen::Vector3d off = value[i] - value[a] - slope * (x[i] - x[a]);
      largest = std::max(largest, off.cwiseAbs().maxCoeff());
    }
  }
  return largest;
}

}  // namespace servomill::strategies
