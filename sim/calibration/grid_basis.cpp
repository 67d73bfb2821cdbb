#include "sim/calibration/grid_basis.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace servomill::sim::calibration {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Means of the hats over their knots, uniformly weighted.
VectorXd means_of_hats(const std::vector<double>& knots) {
  VectorXd out = VectorXd::Zero(Index(knots.size()));
  const double length = knots.back() - knots.front();
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    const double half = 0.5 * (knots[k + 1] - knots[k]) / length;
    out[Index(k)] += half;
    out[Index(k) + 1] += half;
  }
  return out;
}

// Hats at a place; constant beyond the ends.
VectorXd hats_at(const std::vector<double>& knots, double at) {
  VectorXd out = VectorXd::Zero(Index(knots.size()));
  const auto above = std::upper_bound(knots.begin(), knots.end(), at);
  if (above == knots.begin()) {
    out[0] = 1.0;
  } else if (above == knots.end()) {
    out[out.size() - 1] = 1.0;
  } else {
    const Index k = above - knots.begin();
    const double share = (at - *(above - 1)) / (*above - *(above - 1));
    out[k - 1] = 1.0 - share;
    out[k] = share;
  }
  return out;
}

std::vector<double> positions_to_ends(const std::vector<double>& knots,
                                      const std::array<double, 2>& travel) {
  std::vector<double> out = knots;
  if (travel[0] < out.front()) out.insert(out.begin(), travel[0]);
  if (travel[1] > out.back()) out.push_back(travel[1]);
  return out;
}

}  // namespace

GridBasis::GridBasis(GridForm form) : form_(std::move(form)) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    assert(form_.knots[axis].size() >= 2);
    mean_[axis] = means_of_hats(form_.knots[axis]);
  }
}

int GridBasis::size() const { return along(0) * along(1); }

VectorXd GridBasis::centred_hats(std::size_t axis, double at) const {
  return (hats_at(form_.knots[axis], at) - mean_[axis]).head(along(axis));
}

void GridBasis::evaluate(double s, double t, std::vector<BasisValue>& out) const {
  const VectorXd own = centred_hats(0, s), other = centred_hats(1, t);
  int index = 0;
  for (const double g : own) {
    for (const double h : other) out.push_back({index++, g * h});
  }
}

Eigen::RowVectorXd GridBasis::row(double s, double t) const {
  std::vector<BasisValue> values;
  evaluate(s, t, values);
  Eigen::RowVectorXd out(size());
  for (const BasisValue& one : values) out[one.index] = one.value;
  return out;
}

plant::GridPoints GridBasis::points(const VectorXd& coefficients) const {
  plant::GridPoints out;
  out.axes = {form_.axes[0], form_.axes[1]};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    out.at.push_back(positions_to_ends(form_.knots[axis], form_.travel[axis]));
  }
  for (const double s : out.at[0]) {
    for (const double t : out.at[1]) out.error.push_back(row(s, t).dot(coefficients));
  }
  return out;
}

}  // namespace servomill::sim::calibration
