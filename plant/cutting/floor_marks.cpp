#include "plant/cutting/floor_marks.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "plant/cutting/engagement.h"

namespace servomill::plant {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kAlong = 0.866;    // cosine of the angle by which a normal may be off, 30 deg
constexpr double kReach = 0.5e-3;   // m, by which a target may be inside of the bottom
constexpr double kRoot = 1e-12;     // of a step
constexpr double kSettled = 1e-13;  // m
constexpr int kMaxIterations = 60;

// Angle within half a turn of 0.
double wrapped(double angle) { return std::remainder(angle, kTurn); }

// (1); none beyond the edge.
std::optional<double> height_of_edge(const Cutter& cutter, double rho) {
  const double over = rho - (cutter.radius - cutter.corner_radius);
  if (over <= 0.0) return 0.0;
  if (over > cutter.corner_radius) return std::nullopt;
  return cutter.corner_radius -
         std::sqrt(cutter.corner_radius * cutter.corner_radius - over * over);
}

// The target seen from the cutter along one step of the path: across the axis, linear in the share
// of the step.
struct Step {
  Vector2d from, to;       // m, along x and y of the spindle
  Vector2d normal;         // of the target, likewise
  double angle, rotation;  // rad, psi at its begin and by which the cutter turns
  Vector2d at(double share) const { return from + share * (to - from); }
  // Direction of the target less that at the begin: it changes by less than half a turn.
  double turned(double share) const {
    const Vector2d p = at(share);
    return wrapped(std::atan2(p.x(), p.y()) - std::atan2(from.x(), from.y()));
  }
  // Tooth direction less that of the target, from which whole turns are left out at the begin.
  double ahead(double share) const {
    return angle - std::atan2(from.x(), from.y()) + share * rotation - turned(share);
  }
};

class FloorMarks {
 public:
  FloorMarks(const Cutter& cutter, const TurningPath& path, const ProbeTarget& target)
      : cutter_(cutter), path_(path), target_(target) {
    double longest = 0.0;
    for (int tooth = 0; tooth < cutter.teeth; ++tooth) {
      longest = std::max(longest, cutter.radius + cutter.radius_offset(tooth));
    }
    reach_ = longest;
  }

  // From a position back and forth, as long as the cutter is above the target.
  std::optional<double> lowest(std::size_t position) {
    const std::size_t last = path_.positions.size() - 1;
    for (std::size_t i = position; i > 0 && add_step(i - 1); --i) continue;
    for (std::size_t i = position; i < last && add_step(i); ++i) continue;
    return lowest_;
  }

 private:
  // Edges that pass the target between position i and the next; false: the cutter is elsewhere.
  bool add_step(std::size_t i) {
    const CutterPosition &here = path_.positions[i], &next = path_.positions[i + 1];
    const Vector3d D = target_.point - here.tip;
    const auto spindle = spindle_directions(path_.R_WG * here.axis);
    const Eigen::Matrix<double, 2, 3> across = (path_.R_WG.transpose() * spindle).transpose();
    const Vector2d from = across * D, to = across * (target_.point - next.tip);
    const double height = D.dot(here.axis);
    if (target_.normal.dot(here.axis) < kAlong || height > cutter_.corner_radius + kReach ||
        height < -2.0 * cutter_.radius || std::min(from.norm(), to.norm()) > reach_) {
      return false;
    }
    const double rotation = path_.angles[i + 1] - path_.angles[i];
    if (rotation == 0.0) return true;
    const double sense = rotation > 0.0 ? 1.0 : -1.0;
    for (int tooth = 0; tooth < cutter_.teeth; ++tooth) {
      const Step step{from, to, across * target_.normal,
                      path_.angles[i] + sense * kTurn * tooth / cutter_.teeth, rotation};
      add_passages(step, i, tooth);
    }
    return true;
  }

  // Whole turns between tooth and target within [begin, end): none is lost or doubled between one
  // step and the next.
  void add_passages(const Step& step, std::size_t i, int tooth) {
    const double begin = step.ahead(0.0) / kTurn, end = step.ahead(1.0) / kTurn;
    const double low = std::ceil(std::min(begin, end)), high = std::ceil(std::max(begin, end));
    for (double turn = low; turn < high; ++turn) {
      const double share = share_where(step, kTurn * turn);
      const CutterPosition& here = path_.positions[i];
      const Vector3d tip = here.tip + share * (path_.positions[i + 1].tip - here.tip);
      const auto d = distance_to_edge(step, share, tooth, (target_.point - tip).dot(here.axis),
                                      target_.normal.dot(here.axis));
      if (d) lowest_ = std::min(lowest_.value_or(*d), *d);
    }
  }

  // From the target along the normal, whose points are farther from the axis or nearer where it
  // leans.
  // @param height  of the target above the tip
  // @param along   of the normal, along the axis
  std::optional<double> distance_to_edge(const Step& step, double share, int tooth, double height,
                                         double along) const {
    double d = 0.0;
    for (int n = 0; n < kMaxIterations; ++n) {
      const double rho = (step.at(share) + d * step.normal).norm();
      const auto z = height_of_edge(cutter_, rho - cutter_.radius_offset(tooth));
      if (!z) return std::nullopt;
      const double next = (*z - height) / along;
      if (std::abs(next - d) < kSettled) return next;
      d = next;
    }
    return d;
  }

  // Share of the step at which the tooth is ahead by so much, by bisection and the secant in turn.
  static double share_where(const Step& step, double wanted) {
    double low = 0.0, high = 1.0;
    double at_low = step.ahead(low) - wanted, at_high = step.ahead(high) - wanted;
    for (int n = 0; n < kMaxIterations && high - low > kRoot; ++n) {
      const double secant = low - at_low * (high - low) / (at_high - at_low);
      const bool inside = n % 2 == 0 && secant > low && secant < high;
      const double middle = inside ? secant : 0.5 * (low + high);
      const double value = step.ahead(middle) - wanted;
      if (value == 0.0) return middle;
      ((value > 0.0) == (at_high > 0.0) ? high : low) = middle;
      ((value > 0.0) == (at_high > 0.0) ? at_high : at_low) = value;
    }
    return 0.5 * (low + high);
  }

  const Cutter& cutter_;
  const TurningPath& path_;
  const ProbeTarget& target_;
  double reach_ = 0.0;  // m
  std::optional<double> lowest_;
};

}  // namespace

bool is_floor(const ProbeTarget& target, const CutterPosition& cutter) {
  return target.normal.dot(cutter.axis) >= kAlong;
}

std::optional<double> floor_mark(const Cutter& cutter, const TurningPath& path,
                                 const ProbeTarget& target, std::size_t position) {
  assert(path.positions.size() == path.angles.size() && position < path.positions.size());
  return FloorMarks(cutter, path, target).lowest(position);
}

}  // namespace servomill::plant
