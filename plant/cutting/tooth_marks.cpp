#include "plant/cutting/tooth_marks.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "plant/cutting/engagement.h"

namespace servomill::plant {
namespace {

using Eigen::Vector3d;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kAcross = 0.0175;    // sine of the angle by which a normal may be off, 1 deg
constexpr double kTurnsAround = 1.5;  // of travel, within which a tooth may make the surface
constexpr double kNear = 1e-6;        // m, likewise, of a cutter that does not feed
constexpr double kReach = 0.5e-3;     // m, by which flank and target may be apart
constexpr double kPassed = 1e-12;     // m, along the wall
constexpr int kMaxIterations = 20;

// A flank that passes a target, seen at one position: axes across the wall and along it.
struct Flank {
  Vector3d n, along, x, y;  // n: normal, as far as it is across the axis
  double height = 0.0;      // m, of the target above the tip
};

class Marks {
 public:
  Marks(const Cutter& cutter, const TurningPath& path, const ProbeTarget& target)
      : cutter_(cutter), path_(path), target_(target) {}

  // From a position back and forth, as long as the flank is near.
  std::optional<double> deepest(std::size_t position) {
    const std::size_t last = path_.positions.size() - 1;
    for (std::size_t i = position; i > 0 && add_step(i - 1); --i) continue;
    for (std::size_t i = position; i < last && add_step(i); ++i) continue;
    return deepest_;
  }

 private:
  // Teeth that point at the wall between position i and the next; false: it is too far away.
  bool add_step(std::size_t i) {
    const double from = path_.angles[i], to = path_.angles[i + 1];
    if (from == to) return true;
    const CutterPosition& here = path_.positions[i];
    const Vector3d d = target_.point - here.tip;
    const double step = (path_.positions[i + 1].tip - here.tip).norm();
    const double window = kNear + step + std::sqrt(2.0 * cutter_.radius * path_.swing) +
                          kTurnsAround * kTurn * step / std::abs(to - from);
    const auto flank = flank_at(here);
    if (!flank || std::abs(flank->along.dot(d)) > window ||
        std::abs(-flank->n.dot(d) - cutter_.radius) > kReach) {
      return false;
    }
    const double sense = to > from ? 1.0 : -1.0;
    const double lag = flank->height * std::tan(cutter_.helix) / cutter_.radius;
    const double inward = std::atan2(-flank->n.dot(flank->x), -flank->n.dot(flank->y));
    for (int tooth = 0; tooth < cutter_.teeth; ++tooth) {
      const double ahead = sense * (kTurn * tooth / cutter_.teeth - lag);
      const double first = inward - ahead;
      // turns in [low, high): none is lost or doubled between one step and the next
      const double low = std::ceil((std::min(from, to) - first) / kTurn);
      const double high = std::ceil((std::max(from, to) - first) / kTurn);
      for (double turn = low; turn < high; ++turn) {
        add_passage(*flank, i, first + kTurn * turn, ahead,
                    cutter_.radius + cutter_.radius_offset(tooth));
      }
    }
    return true;
  }

  std::optional<Flank> flank_at(const CutterPosition& at) const {
    const double along_axis = target_.normal.dot(at.axis);
    const double height = (target_.point - at.tip).dot(at.axis);
    if (std::abs(along_axis) > kAcross || height < cutter_.corner_radius ||
        height > cutter_.length) {
      return std::nullopt;
    }
    const Vector3d n = (target_.normal - along_axis * at.axis).normalized();
    const auto directions = spindle_directions(path_.R_WG * at.axis);
    return Flank{n, at.axis.cross(n), path_.R_WG.transpose() * directions.col(0),
                 path_.R_WG.transpose() * directions.col(1), height};
  }

  // The edge of a tooth that points at the wall at psi crosses the line through the target: g = 0
  // along the wall, by Newton's method.
  void add_passage(const Flank& flank, std::size_t i, double psi, double ahead, double radius) {
    for (int n = 0; n < kMaxIterations; ++n) {
      while (i > 0 && !is_beyond(psi, i)) --i;
      while (i + 2 < path_.positions.size() && is_beyond(psi, i + 1)) ++i;
      const double span = path_.angles[i + 1] - path_.angles[i];
      if (span == 0.0) return;
      const Vector3d& begin = path_.positions[i].tip;
      const Vector3d rate = (path_.positions[i + 1].tip - begin) / span;
      const Vector3d centre = begin + (psi - path_.angles[i]) * rate - target_.point;
      const double s = std::sin(psi + ahead), c = std::cos(psi + ahead);
      const Vector3d r = s * flank.x + c * flank.y, dr = c * flank.x - s * flank.y;
      const double g = flank.along.dot(centre + radius * r);
      if (std::abs(g) < kPassed) {
        const double d = flank.n.dot(centre + radius * r) / flank.n.dot(target_.normal);
        deepest_ = std::min(deepest_.value_or(d), d);
        return;
      }
      psi -= g / flank.along.dot(rate + radius * dr);
    }
  }

  // psi is not before the angle of position i, in the sense of rotation there.
  bool is_beyond(double psi, std::size_t i) const {
    const std::size_t next = std::min(i + 1, path_.angles.size() - 1);
    const bool falls = path_.angles[next] < path_.angles[next - 1];
    return falls ? psi <= path_.angles[i] : psi >= path_.angles[i];
  }

  const Cutter& cutter_;
  const TurningPath& path_;
  const ProbeTarget& target_;
  std::optional<double> deepest_;
};

}  // namespace

std::optional<double> tooth_mark(const Cutter& cutter, const TurningPath& path,
                                 const ProbeTarget& target, std::size_t position) {
  assert(path.positions.size() == path.angles.size() && position < path.positions.size());
  return Marks(cutter, path, target).deepest(position);
}

}  // namespace servomill::plant
