#include "plant/geometry/grid_overshoot.h"

#include <algorithm>
#include <cmath>

namespace servomill::plant {
namespace {

constexpr double kCounts = 0.1;   // of the range of all values
constexpr double kMaxWork = 2e8;  // products of B-splines; beyond, not every edge is evaluated
constexpr double kOfValue = 4.0;  // B-splines of each axis at a position
constexpr std::size_t kQuarters = 3;

double stride_for(const GridPoints& points) {
  const auto n = static_cast<double>(points.axes.size());
  const double work =
      static_cast<double>(points.error.size()) * n * kQuarters * std::pow(kOfValue, n);
  return std::max(1.0, std::ceil(work / kMaxWork));
}

// Evaluates the edges that begin at one combination of positions.
class Edges {
 public:
  explicit Edges(const GridFunction& grid) : grid_(grid), points_(grid.points()) {}

  void evaluate(std::size_t place) {
    std::vector<std::size_t> index(points_.axes.size());
    std::size_t rest = place;
    for (std::size_t k = index.size(); k-- > 0;) {
      index[k] = rest % points_.at[k].size();
      rest /= points_.at[k].size();
    }
    std::size_t stride = 1;
    for (std::size_t k = index.size(); k-- > 0;) {
      if (index[k] + 1 < points_.at[k].size()) {
        evaluate_edge(index, k, points_.error[place], points_.error[place + stride]);
      }
      stride *= points_.at[k].size();
    }
  }

  const GridOvershoot& farthest() const { return farthest_; }

 private:
  void evaluate_edge(const std::vector<std::size_t>& index, std::size_t along, double a, double b) {
    std::vector<double> at(index.size());
    for (std::size_t k = 0; k < at.size(); ++k) at[k] = points_.at[k][index[k]];
    const double from = at[along], to = points_.at[along][index[along] + 1];
    for (std::size_t i = 1; i <= kQuarters; ++i) {
      at[along] = from + (to - from) * static_cast<double>(i) / (kQuarters + 1);
      const double value = grid_.value(at);
      const double beyond = std::max(value - std::max(a, b), std::min(a, b) - value);
      if (beyond > farthest_.beyond) farthest_ = {beyond, along, from, to, at};
    }
  }

  const GridFunction& grid_;
  const GridPoints& points_;
  GridOvershoot farthest_;
};

}  // namespace

std::optional<GridOvershoot> overshoot_of(const GridFunction& grid) {
  const GridPoints& points = grid.points();
  if (points.interpolation != GridInterpolation::cubic) return std::nullopt;
  Edges edges(grid);
  const auto stride = static_cast<std::size_t>(stride_for(points));
  for (std::size_t place = 0; place < points.error.size(); place += stride) edges.evaluate(place);
  const auto [low, high] = std::minmax_element(points.error.begin(), points.error.end());
  if (edges.farthest().beyond <= kCounts * (*high - *low)) return std::nullopt;
  return edges.farthest();
}

}  // namespace servomill::plant
