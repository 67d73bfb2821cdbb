#include "sim/preparation/offset_limits.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plant/vocabulary/interrupt.h"

namespace servomill::sim::preparation {
namespace {

constexpr double kSmallestShare = 0.1;  // share of a limit
constexpr double kMargin = 5e-3;  // share of a limit: between rows the path has extremes of its own
constexpr double kHeadroom = 0.98;  // the offset changes with the path
constexpr std::size_t kOrders = 3;
constexpr std::size_t kBand = 3;  // neighbours on each side that a third difference couples

// Differences of order 1, 2, 3 at row n: of rows n - first ... n - first + order.
struct Difference {
  std::size_t first;
  std::array<double, 4> weight;
};
constexpr std::array<Difference, kOrders> kDifferences = {
    {{0, {-1.0, 1.0, 0.0, 0.0}}, {1, {1.0, -2.0, 1.0, 0.0}}, {1, {-1.0, 3.0, -3.0, 1.0}}}};

bool fits(std::size_t order, std::size_t row, std::size_t rows) {
  const Difference& d = kDifferences[order];
  return row >= d.first && row - d.first + order + 1 < rows;
}

double difference(std::size_t order, const std::vector<double>& x, std::size_t row) {
  const Difference& d = kDifferences[order];
  double sum = 0.0;
  for (std::size_t k = 0; k <= order + 1; ++k) sum += d.weight[k] * x[row - d.first + k];
  return sum;
}

// Symmetric positive definite matrix with a band, factorised as L L^T.
class Banded {
 public:
  explicit Banded(std::size_t rows) : rows_(rows) {}
  std::size_t size() const { return rows_.size(); }
  double& at(std::size_t row, std::size_t column) { return rows_[row][row - column]; }

  void factorise() {
    for (std::size_t i = 0; i < size(); ++i) {
      for (std::size_t j = i > kBand ? i - kBand : 0; j <= i; ++j) {
        double sum = rows_[i][i - j];
        for (std::size_t k = i > kBand ? i - kBand : 0; k < j; ++k) {
          if (j - k <= kBand) sum -= rows_[i][i - k] * rows_[j][j - k];
        }
        rows_[i][i - j] = i == j ? std::sqrt(sum) : sum / rows_[j][0];
      }
    }
  }
  void solve(std::vector<double>& x) const {
    for (std::size_t i = 0; i < size(); ++i) {
      for (std::size_t k = 1; k <= std::min(kBand, i); ++k) x[i] -= rows_[i][k] * x[i - k];
      x[i] /= rows_[i][0];
    }
    for (std::size_t i = size(); i-- > 0;) {
      for (std::size_t k = 1; k <= kBand && i + k < size(); ++k) x[i] -= rows_[i + k][k] * x[i + k];
      x[i] /= rows_[i][0];
    }
  }

 private:
  std::vector<std::array<double, kBand + 1>> rows_;  // [i][k]: row i, column i - k
};

// The nearest series whose differences are within bounds, by the alternating direction method of
// multipliers. Where it is slow, the bounds weigh more and more: they are kept, and the series is
// near instead of nearest.
class Projection {
 public:
  /// @param u  m, rad
  explicit Projection(std::vector<double> u) : u_(std::move(u)), weight_(u_.size(), 1.0) {
    for (double& one : u_) one /= kUnit;
  }
  void weigh(std::size_t n, double weight) { weight_[n] = weight; }
  /// @param limit      size of the difference that counts as one
  /// @param low, high  of the difference (m, rad)
  void bound(std::size_t order, std::size_t n, double limit, double low, double high) {
    // accelerations change slowly from row to row
    const double emphasis = order == 1 ? 50.0 : 1.0;
    const double scale = emphasis * kUnit / limit;
    bounds_.push_back({order, n, scale, low / kUnit * scale, high / kUnit * scale, emphasis});
  }

  std::vector<double> solve() {
    constexpr int kStages = 9, kRounds = 250;
    constexpr double kFirmer = 4.0;
    std::vector<double> x = u_;
    for (int stage = 0; stage < kStages; ++stage) {
      throw_if_interrupted();
      const Banded matrix = factorised();
      for (int round = 0; round < kRounds; ++round) {
        std::vector<double> right(u_.size());
        for (std::size_t n = 0; n < u_.size(); ++n) right[n] = weight_[n] * u_[n];
        if (clip(x, right) < 0.3 * kLimitRounding) return in_units(std::move(x));
        matrix.solve(right);
        x.swap(right);
      }
      firmness_ *= kFirmer;
      for (Bound& one : bounds_) one.sum /= kFirmer;
    }
    return in_units(std::move(x));
  }

 private:
  static constexpr double kUnit = 1e-6;  // m, rad
  struct Bound {
    std::size_t order, row;
    double scale, low, high, emphasis;  // of the scaled difference
    double sum = 0.0;                   // scaled dual variable
  };

  Banded factorised() const {
    Banded matrix(u_.size());
    for (std::size_t n = 0; n < u_.size(); ++n) matrix.at(n, n) = weight_[n];
    for (const Bound& one : bounds_) {
      const Difference& d = kDifferences[one.order];
      for (std::size_t p = 0; p <= one.order + 1; ++p) {
        for (std::size_t q = 0; q <= p; ++q) {
          matrix.at(one.row - d.first + p, one.row - d.first + q) +=
              firmness_ * one.scale * one.scale * d.weight[p] * d.weight[q];
        }
      }
    }
    matrix.factorise();
    return matrix;
  }

  // Clips the differences of x, and adds to the right-hand side what they are to be. By how much
  // the worst was beyond, as a share of a limit.
  double clip(const std::vector<double>& x, std::vector<double>& right) {
    double worst = 0.0;
    for (Bound& one : bounds_) {
      const double d = one.scale * difference(one.order, x, one.row);
      worst = std::max(worst, std::max(one.low - d, d - one.high) / one.emphasis);
      const double clipped = std::clamp(d + one.sum, one.low, one.high);
      one.sum += d - clipped;
      const Difference& stencil = kDifferences[one.order];
      for (std::size_t k = 0; k <= one.order + 1; ++k) {
        right[one.row - stencil.first + k] +=
            firmness_ * one.scale * stencil.weight[k] * (clipped - one.sum);
      }
    }
    return worst;
  }

  static std::vector<double> in_units(std::vector<double> x) {
    for (double& one : x) one *= kUnit;
    return x;
  }

  std::vector<double> u_, weight_;
  std::vector<Bound> bounds_;
  double firmness_ = 1.0;
};

bool keeps(const Joints& demands, const Joints& limits) {
  for (int j = 0; j < kJoints; ++j) {
    if (limits[j] > 0.0 && demands[j] > (1.0 + kLimitRounding) * limits[j]) return false;
  }
  return true;
}

Joints lowered(const Joints& planned, const Joints& demands, const Joints& limits) {
  Joints out = planned;
  for (int j = 0; j < kJoints; ++j) {
    if (demands[j] <= limits[j]) continue;
    out[j] = std::max(kSmallestShare * limits[j], planned[j] * kHeadroom * limits[j] / demands[j]);
  }
  return out;
}

}  // namespace

OffsetLimits::OffsetLimits(std::vector<PathRange> path, double row_period,
                           const controllers::JointLimits& limits)
    : limits_{limits.v, limits.a, limits.j}, h_(row_period), path_(std::move(path)) {}

void PathRanges::add(const PathDerivatives& now) {
  const auto widen = [&](PathRange& range) {
    for (std::size_t order = 0; order < kOrders; ++order) {
      range.low[order] = range.low[order].cwiseMin(now[order]);
      range.high[order] = range.high[order].cwiseMax(now[order]);
    }
  };
  if (!rows_.empty()) widen(rows_.back());
  if (instants_++ % every_ == 0) rows_.push_back({now, now});
}

std::vector<PathRange> derivatives_of(const controllers::Trajectory& path,
                                      const strategies::PathTimes& times) {
  PathRanges out(times.every);
  controllers::Trajectory::Cursor cursor{};
  for (std::size_t n = 0; n < times.s.size(); ++n) {
    const auto at = path.at(static_cast<double>(n) * times.h, cursor);
    out.add({at.dQ_ref, at.ddQ_ref, at.dddQ_ref});
  }
  return out.rows();
}

controllers::JointLimits OffsetLimits::demands(const std::vector<Joints>& u) const {
  std::array<Joints, kOrders> most = {Joints::Zero(), Joints::Zero(), Joints::Zero()};
  for (int j = 0; j < kJoints; ++j) {
    std::vector<double> x(kBand, u.front()[j]);  // the machine stands before and behind
    for (const Joints& one : u) x.push_back(one[j]);
    x.insert(x.end(), kBand, u.back()[j]);
    for (std::size_t row = 0; row < x.size(); ++row) {
      const std::size_t n = std::min(row > kBand ? row - kBand : 0, path_.size() - 1);
      for (std::size_t order = 0; order < kOrders; ++order) {
        if (!fits(order, row, x.size())) continue;
        const double own = difference(order, x, row) / std::pow(h_, order + 1);
        const Range path = of_path(order, n, j);
        most[order][j] =
            std::max({most[order][j], std::abs(path.low + own), std::abs(path.high + own)});
      }
    }
  }
  return {most[0], most[1], most[2]};
}

// Derivative of the path while a difference at a row acts: as the jerk of the offset from this row
// to the next, as control point of its acceleration one row before, too, of its velocity one row
// before and one behind.
OffsetLimits::Range OffsetLimits::of_path(std::size_t order, std::size_t row, int joint) const {
  const std::size_t first = order < 2 && row > 0 ? row - 1 : row;
  const std::size_t last = std::min(order < 1 ? row + 1 : row, path_.size() - 1);
  Range out{path_[row].low[order][joint], path_[row].high[order][joint]};
  for (std::size_t n = first; n <= last; ++n) {
    out.low = std::min(out.low, path_[n].low[order][joint]);
    out.high = std::max(out.high, path_[n].high[order][joint]);
  }
  return out;
}

// Differences of the offset (m, rad) for which the path leaves room at a row. A path on its limit,
// or beyond it by rounding, leaves none.
OffsetLimits::Range OffsetLimits::left(std::size_t order, std::size_t row, int joint) const {
  const double scale = std::pow(h_, order + 1);
  const Range path = of_path(order, row, joint);
  const double limit = (1.0 - kMargin) * limits_[order][joint];
  return {std::min(0.0, (-limit - path.low) * scale), std::max(0.0, (limit - path.high) * scale)};
}

// By how much an offset exceeds what is left, as a share of the limit.
double OffsetLimits::beyond(const std::vector<double>& u, std::size_t row, int joint) const {
  double out = 0.0;
  for (std::size_t order = 0; order < kOrders; ++order) {
    if (!fits(order, row, u.size())) continue;
    const Range range = left(order, row, joint);
    const double d = difference(order, u, row);
    const double limit = limits_[order][joint] * std::pow(h_, order + 1);
    out = std::max(out, std::max(range.low - d, d - range.high) / limit);
  }
  return out;
}

void OffsetLimits::bring_within(std::vector<double>& u, std::size_t from, std::size_t to,
                                int joint) const {
  constexpr double kFixed = 1e15;  // weight of rows next to those that stay
  const auto begin = u.begin() + static_cast<std::ptrdiff_t>(from);
  Projection projection({begin, begin + static_cast<std::ptrdiff_t>(to - from)});
  for (std::size_t n = 0; n < to - from; ++n) {
    if (n < kBand || n + kBand >= to - from) projection.weigh(n, kFixed);
    for (std::size_t order = 0; order < kOrders; ++order) {
      if (!fits(order, n, to - from)) continue;
      const Range range = left(order, from + n, joint);
      projection.bound(order, n, limits_[order][joint] * std::pow(h_, order + 1), range.low,
                       range.high);
    }
  }
  const std::vector<double> x = projection.solve();
  std::copy(x.begin(), x.end(), begin);
}

void OffsetLimits::rest_at_ends(std::vector<Joints>& u, double within) const {
  const std::size_t rows =
      std::min(u.size() / 2, kBand + 1 + static_cast<std::size_t>(within / h_));
  const Joints first = u.front(), last = u.back();
  for (std::size_t n = 0; n < rows; ++n) {
    const double x = std::max(0.0, static_cast<double>(n) - static_cast<double>(kBand)) /
                     static_cast<double>(rows - kBand);
    const double share = strategies::smooth_step(x);
    u[n] = first + share * (u[n] - first);
    u[u.size() - 1 - n] = last + share * (u[u.size() - 1 - n] - last);
  }
}

std::vector<Joints> OffsetLimits::nearest_within(std::vector<Joints> u, double from_ends) const {
  constexpr double kAround = 0.25;  // s
  const auto around = static_cast<std::size_t>(kAround / h_);
  for (int j = 0; j < kJoints; ++j) {
    if (!(limits_[0][j] > 0.0)) continue;
    std::vector<double> x;
    for (const Joints& one : u) x.push_back(one[j]);
    std::size_t from = 0, to = 0;  // of the stretch that is being found; empty: none
    const auto finish = [&] {
      if (to > from) bring_within(x, from, to, j);
    };
    for (std::size_t n = 0; n < x.size(); ++n) {
      const double away = h_ * static_cast<double>(std::min(n, x.size() - 1 - n));
      if (away > from_ends || beyond(x, n, j) <= 0.5 * kLimitRounding) continue;
      if (n > to + around || to == 0) {
        finish();
        from = n > around ? n - around : 0;
      }
      to = std::min(x.size(), n + around + 1);
    }
    finish();
    for (std::size_t n = 0; n < u.size(); ++n) u[n][j] = x[n];
  }
  return u;
}

bool keeps(const controllers::JointLimits& demands, const controllers::JointLimits& limits) {
  return keeps(demands.v, limits.v) && keeps(demands.a, limits.a) && keeps(demands.j, limits.j);
}

controllers::JointLimits lowered(const controllers::JointLimits& planned,
                                 const controllers::JointLimits& demands,
                                 const controllers::JointLimits& limits) {
  return {lowered(planned.v, demands.v, limits.v), lowered(planned.a, demands.a, limits.a),
          lowered(planned.j, demands.j, limits.j)};
}

}  // namespace servomill::sim::preparation
