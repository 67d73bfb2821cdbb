#include "sim/preparation/cut_places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace servomill::sim::preparation {
namespace {

using Eigen::Vector3d;

constexpr double kAsNear = 2e-6;    // m
constexpr double kAligned = 0.035;  // sine of 2 deg
constexpr double kAlong = 0.5;      // cosine between normal and path from which on it faces along
constexpr double kPlunge = 0.99;    // cosine between path and axis
constexpr double kMoves = 1e-9;     // m

Vector3d across(const Vector3d& v, const Vector3d& k) { return v - v.dot(k) * k; }

// Share of a straight step at which it is nearest to the end of u, which begins where it does.
double nearest_share(const Vector3d& u, const Vector3d& step) {
  return std::clamp(u.dot(step) / step.squaredNorm(), 0.0, 1.0);
}

double beyond(double value, double least, double most) {
  return std::max({least - value, value - most, 0.0});
}

// A point against a step of the path.
struct Candidate {
  CutPlace place;
  double off = 0.0;      // m, of the surface from the point
  double rank = 0.0;     // the same, but for what rows leave of a path where it turns
  double lateral = 0.0;  // m, of the axis from a point that the tip cuts
};

class Step {
 public:
  Step(const ToolRow& from, const ToolRow& to, const SurfacePoint& point)
      : from_(from), to_(to), point_(point), cutter_(*from.cutter), step_(to.tip - from.tip) {}

  // None where no part of the cutter faces the point.
  std::optional<Candidate> candidate(std::size_t row) const {
    const double cosine = point_.normal.dot(from_.axis);
    const bool has_tip = !cutter_.is_ball();
    Candidate out;
    if (std::abs(cosine) <= kAligned) {
      out = by_flank();
    } else if (cosine < 0.0) {
      return {};
    } else if (has_tip && across(point_.normal, from_.axis).norm() <= kAligned) {
      out = by_tip();
    } else {
      out = by_corner();
    }
    out.place.row = row;
    return out;
  }

  bool is_along() const {
    const Vector3d t = step_.normalized();
    return std::abs(t.dot(point_.normal)) > kAlong || std::abs(t.dot(from_.axis)) > kPlunge;
  }

 private:
  Vector3d axis_at(double share) const {
    return (from_.axis + share * (to_.axis - from_.axis)).normalized();
  }
  Vector3d tip_at(double share) const { return from_.tip + share * step_; }

  // Share at which the axis is nearest to q; the end of a plunge, which is as near all along.
  double share_across(const Vector3d& q) const {
    const Vector3d step = across(step_, from_.axis);
    if (step.norm() <= kMoves) return 1.0;
    return nearest_share(across(q - from_.tip, from_.axis), step);
  }

  Candidate by_flank() const {
    const Vector3d q = point_.point + cutter_.radius * point_.normal;
    const double share = share_across(q);
    const Vector3d k = axis_at(share), tip = tip_at(share);
    const double height = (point_.point - tip).dot(k);
    const Vector3d gap = across(q - tip, k);
    const double excess = beyond(height, cutter_.corner_radius, cutter_.length);
    return {{0, share, CutBy::flank},
            std::hypot(gap.norm(), excess),
            std::hypot(rank(gap), excess),
            0.0};
  }

  Candidate by_tip() const {
    const double share = share_across(point_.point);
    const Vector3d k = axis_at(share), from_tip = point_.point - tip_at(share);
    const double lateral = across(from_tip, k).norm();
    const double most = cutter_.radius - cutter_.corner_radius;
    const double off = std::hypot(from_tip.dot(k), beyond(lateral, 0.0, most));
    return {{0, share, CutBy::tip}, off, off, lateral};
  }

  // Tip (m) of the cutter whose corner touches the point.
  Vector3d touching_tip(const Vector3d& k) const {
    const double r = cutter_.corner_radius;
    Vector3d out = point_.point + r * (point_.normal - k);
    if (!cutter_.is_ball()) {
      out += (cutter_.radius - r) * across(point_.normal, k).normalized();
    }
    return out;
  }

  Candidate by_corner() const {
    const double share = nearest_share(touching_tip(from_.axis) - from_.tip, step_);
    const Vector3d gap = touching_tip(axis_at(share)) - tip_at(share);
    return {{0, share, CutBy::corner}, gap.norm(), rank(gap), 0.0};
  }

  // A path that turns within a step is straight in its rows. Its end may miss up to a step.
  double rank(const Vector3d& gap) const {
    const double along = std::abs(gap.dot(step_.normalized()));
    return along <= step_.norm() ? std::sqrt(std::max(0.0, gap.squaredNorm() - along * along))
                                 : gap.norm();
  }

  const ToolRow& from_;
  const ToolRow& to_;
  const SurfacePoint& point_;
  const plant::Cutter& cutter_;
  const Vector3d step_;
};

// The nearest one of those in a row.
std::vector<CutPlace> places_of(const std::vector<Candidate>& all) {
  std::vector<CutPlace> out;
  double least = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool goes_on = i > 0 && all[i].place.row == all[i - 1].place.row + 1;
    if (goes_on && all[i].off >= least) continue;
    if (goes_on) out.pop_back();
    out.push_back(all[i].place);
    least = all[i].off;
  }
  return out;
}

// True if no place of a step can be nearer to a point than `distance` (m).
bool is_farther(const ToolRow& from, const ToolRow& to, const Vector3d& point, double distance) {
  const double reach =
      std::hypot(from.cutter->radius, from.cutter->length) + (to.tip - from.tip).norm() + distance;
  return (point - from.tip).squaredNorm() > reach * reach;
}

// Leaves those whose value is as small as the least one.
template <typename Value>
void keep_nearest(std::vector<Candidate>& all, Value value) {
  double least = std::numeric_limits<double>::infinity();
  for (const Candidate& one : all) least = std::min(least, value(one));
  std::erase_if(all, [&](const Candidate& one) { return value(one) > least + kAsNear; });
}

}  // namespace

CutSearch find_cut(const std::vector<ToolRow>& rows, const SurfacePoint& point) {
  CutSearch out;
  const double farthest = kFarthestCut + std::abs(point.deviation);
  std::vector<Candidate> candidates;
  for (std::size_t n = 0; n + 1 < rows.size(); ++n) {
    const ToolRow &from = rows[n], &to = rows[n + 1];
    if (from.cutter == nullptr || from.run < 0 || to.run != from.run) continue;
    if ((to.tip - from.tip).norm() <= kMoves) continue;
    if (is_farther(from, to, point.point, std::max(farthest, out.nearest))) continue;
    const Step step(from, to, point);
    const std::optional<Candidate> one = step.candidate(n);
    if (!one) continue;
    const bool is_along = step.is_along();
    if (is_along && one->off <= farthest) out.is_along = true;
    if (one->off < out.nearest) {
      out.nearest = one->off;
      out.nearest_row = n;
    }
    if (!is_along && one->off <= farthest) candidates.push_back(*one);
  }
  keep_nearest(candidates, [](const Candidate& one) { return one.rank; });
  keep_nearest(candidates, [](const Candidate& one) { return one.lateral; });
  out.places = places_of(candidates);
  return out;
}

}  // namespace servomill::sim::preparation
