#include "plant/cutting/engagement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"

namespace servomill::plant {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kAcross = 1e-6;        // feed across the axis below which it counts as along it
constexpr double kSame = 1 * um;        // of places on the profile
constexpr double kSameShare = 1e-4;     // of the range of contact, for angles
constexpr double kMaxTurn = 7.5 * deg;  // of the profile's normal within one piece
constexpr int kPiecesOfFlank = 8;       // at least, of the height that can be in material
constexpr int kPiecesOfBottom = 6;
constexpr double kThinnest = 0.5 * mm;  // wall on the flank that is seen in any case
constexpr int kLevelsOfCorner = 8, kLevelsOfFlank = 14;

// Directions that are looked at, as shares of the range of contact: close to its ends, where
// shallow cuts are.
constexpr std::array<double, 21> kShares = {0.003, 0.01, 0.025, 0.05, 0.09,  0.14, 0.2,
                                            0.27,  0.34, 0.42,  0.5,  0.58,  0.66, 0.73,
                                            0.8,   0.86, 0.91,  0.95, 0.975, 0.99, 0.997};

// Profile of a cutter by arc length u (m) from the middle of its bottom.
class Profile {
 public:
  explicit Profile(const Cutter& cutter)
      : cutter_(cutter),
        bottom_(cutter.radius - cutter.corner_radius),
        corner_(bottom_ + 0.5 * kPi * cutter.corner_radius) {}

  double end_of_bottom() const { return bottom_; }
  double end_of_corner() const { return corner_; }
  double of_height(double h) const { return corner_ + h - cutter_.corner_radius; }  // on the flank

  struct Place {
    double radius, height, kappa;
  };
  Place at(double u) const {
    const double r = cutter_.corner_radius;
    if (u < bottom_) return {u, 0.0, 0.0};
    if (u >= corner_) return {cutter_.radius, r + u - corner_, 0.5 * kPi};
    const double kappa = (u - bottom_) / r;
    return {bottom_ + r * std::sin(kappa), r * (1.0 - std::cos(kappa)), kappa};
  }

 private:
  const Cutter& cutter_;
  double bottom_, corner_;
};

// Bisection for the point between a and b at which `is` changes.
template <class Is>
double change(double a, double b, double same, Is is) {
  const bool at_a = is(a);
  while (std::abs(b - a) > same) {
    const double middle = 0.5 * (a + b);
    (is(middle) == at_a ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

class Search {
 public:
  Search(const Cutter& cutter, const CutterMotion& motion, const IsMaterial& is_material,
         const Eigen::AlignedBox3d& within)
      : cutter_(cutter),
        tip_(motion.position.tip),
        frame_(frame_of(motion)),
        profile_(cutter),
        is_material_(is_material) {
    find_heights(within);
  }

  std::vector<EngagedArc> arcs() {
    if (highest_ <= lowest_) return {};
    add_sections();
    std::vector<EngagedArc> out;
    for (const Section& section : sections_) {
      const std::vector<double> breaks = breaks_of(section);
      for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
        add_pieces(section, breaks[i], breaks[i + 1], out);
      }
    }
    return out;
  }

 private:
  struct Section {
    double begin, end;
    std::vector<double> levels;
    double longest;  // piece
  };

  // Heights of the cutter that reach into the box.
  void find_heights(const Eigen::AlignedBox3d& within) {
    if (within.isEmpty()) return;
    const Eigen::Vector3d k = frame_.axes.col(2);
    const Eigen::Vector3d spread =
        cutter_.radius * (1.0 - k.array().square()).max(0.0).sqrt().matrix();
    const Eigen::Vector3d low = within.min() - tip_ - spread, high = within.max() - tip_ + spread;
    lowest_ = 0.0;
    highest_ = cutter_.length;
    for (int i = 0; i < 3; ++i) {  // low <= h k <= high
      if (std::abs(k[i]) < 1e-12) {
        if (low[i] > 0.0 || high[i] < 0.0) highest_ = -1.0;
        continue;
      }
      const double a = low[i] / k[i], b = high[i] / k[i];
      lowest_ = std::max(lowest_, std::min(a, b));
      highest_ = std::min(highest_, std::max(a, b));
    }
  }

  void add_sections() {
    const auto middles = [](double begin, double end, int n) {
      std::vector<double> levels;
      for (int i = 0; i < n; ++i) levels.push_back(begin + (end - begin) * (i + 0.5) / n);
      return levels;
    };
    const double bottom = profile_.end_of_bottom(), corner = profile_.end_of_corner();
    if (frame_.feed.along < -kAcross && bottom > 0.0 && lowest_ <= 0.0) {
      sections_.push_back(
          {0.0, bottom, middles(0.0, bottom, kPiecesOfBottom), bottom / kPiecesOfBottom});
    }
    if (corner > bottom && lowest_ < cutter_.corner_radius) {
      sections_.push_back({bottom, corner, middles(bottom, corner, kLevelsOfCorner),
                           kMaxTurn * cutter_.corner_radius});
    }
    if (highest_ <= cutter_.corner_radius) return;
    const double low = std::max(lowest_, cutter_.corner_radius), range = highest_ - low;
    Section flank{
        profile_.of_height(low), profile_.of_height(highest_), {}, range / kPiecesOfFlank};
    for (int i = 0; i < kLevelsOfFlank; ++i) {
      const double share = (i + 0.5) / kLevelsOfFlank;
      add_level(flank, flank.begin + range * share * share * share);
    }
    add_level(flank, flank.end - 0.5 * kThinnest);
    sections_.push_back(std::move(flank));
  }

  // And as many before it as a thin wall needs to be seen.
  static void add_level(Section& section, double level) {
    const double before = section.levels.empty() ? section.begin : section.levels.back();
    if (level <= before) return;
    const int n = static_cast<int>(std::ceil((level - before) / kThinnest));
    for (int i = 1; i <= n; ++i) section.levels.push_back(before + (level - before) * i / n);
  }

  bool in_material(const Profile::Place& place, double phi) const {
    const Eigen::Vector3d p(place.radius * std::sin(phi), place.radius * std::cos(phi),
                            place.height);
    return is_material_(tip_ + frame_.axes * p);
  }
  bool in_material(double u, double share) const {
    const Profile::Place place = profile_.at(u);
    const AngleRange range = contact_range(frame_.feed, place.kappa);
    return !range.empty() && in_material(place, range.from + share * (range.to - range.from));
  }

  // Ends of the section, and where material begins or ends along the profile.
  std::vector<double> breaks_of(const Section& section) const {
    std::vector<double> breaks = {section.begin, section.end};
    std::vector<std::array<bool, kShares.size()>> seen;
    for (const double u : section.levels) {
      auto& row = seen.emplace_back();
      for (std::size_t k = 0; k < kShares.size(); ++k) row[k] = in_material(u, kShares[k]);
    }
    for (std::size_t i = 0; i + 1 < seen.size(); ++i) {
      const double a = section.levels[i], b = section.levels[i + 1];
      std::vector<double> found;
      for (std::size_t k = 0; k < kShares.size(); ++k) {
        if (seen[i][k] == seen[i + 1][k]) continue;
        const auto is = [&](double u) { return in_material(u, kShares[k]); };
        const auto is_there = [&](double u) {
          return is(std::max(a, u - kSame)) == seen[i][k] &&
                 is(std::min(b, u + kSame)) == seen[i + 1][k];
        };
        if (std::none_of(found.begin(), found.end(), is_there)) {
          found.push_back(change(a, b, kSame, is));
        }
      }
      breaks.insert(breaks.end(), found.begin(), found.end());
    }
    // below the lowest level and above the highest one
    add_end(section.begin, section.levels.front(), seen.front(), breaks);
    add_end(section.end, section.levels.back(), seen.back(), breaks);
    std::sort(breaks.begin(), breaks.end());
    return breaks;
  }

  void add_end(double end, double level, const std::array<bool, kShares.size()>& seen,
               std::vector<double>& breaks) const {
    const double inside = end + 1e-3 * (level - end);
    for (std::size_t k = 0; k < kShares.size(); ++k) {
      if (in_material(inside, kShares[k]) == seen[k]) continue;
      const auto is = [&](double u) { return in_material(u, kShares[k]); };
      breaks.push_back(change(inside, level, kSame, is));
      return;
    }
  }

  void add_pieces(const Section& section, double begin, double end,
                  std::vector<EngagedArc>& out) const {
    if (end - begin < kSame) return;
    const int pieces = std::max(1, static_cast<int>(std::ceil((end - begin) / section.longest)));
    const double width = (end - begin) / pieces;
    for (int i = 0; i < pieces; ++i) add_arcs(begin + (i + 0.5) * width, width, out);
  }

  void add_arcs(double u, double width, std::vector<EngagedArc>& out) const {
    const Profile::Place place = profile_.at(u);
    const AngleRange range = contact_range(frame_.feed, place.kappa);
    if (range.empty()) return;
    const auto angle = [&](double share) { return range.from + share * (range.to - range.from); };
    const auto is = [&](double share) { return in_material(place, angle(share)); };
    bool inside = is(kShares.front());
    double begin = 0.0;
    const auto close = [&](double end) {
      out.push_back({width, place.height, place.kappa, angle(begin), angle(end), place.radius});
    };
    for (std::size_t k = 0; k + 1 < kShares.size(); ++k) {
      if (is(kShares[k + 1]) == inside) continue;
      const double at = change(kShares[k], kShares[k + 1], kSameShare, is);
      if (inside) close(at);
      begin = at;
      inside = !inside;
    }
    if (inside) close(1.0);
  }

  const Cutter& cutter_;
  Eigen::Vector3d tip_;
  CutterFrame frame_;
  Profile profile_;
  const IsMaterial& is_material_;
  double lowest_ = 0.0, highest_ = -1.0;
  std::vector<Section> sections_;
};

}  // namespace

CutterFrame frame_of(const CutterMotion& motion) {
  const Eigen::Vector3d k = motion.position.axis.normalized();
  const double along = motion.feed.dot(k);
  Eigen::Vector3d across = motion.feed - along * k;
  const double length = across.norm();
  CutterFrame frame;
  if (length > kAcross) {
    across /= length;
    frame.feed = {length, along};
  } else {
    across = k.unitOrthogonal();
    frame.feed = {0.0, along > 0.0 ? 1.0 : -1.0};
  }
  const Eigen::Vector3d left = k.cross(across);
  frame.axes << across, motion.clockwise ? left : Eigen::Vector3d(-left), k;
  return frame;
}

Eigen::Matrix<double, 3, 2> spindle_directions(const Eigen::Vector3d& k) {
  constexpr double kAlong = 1.7e-3;  // sine of 0.1 deg
  const Eigen::Vector3d X = Eigen::Vector3d::UnitX(), Y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d reference = (X - X.dot(k) * k).norm() > kAlong ? X : Y;
  Eigen::Matrix<double, 3, 2> out;
  out.col(0) = (reference - reference.dot(k) * k).normalized();
  out.col(1) = k.cross(Eigen::Vector3d(out.col(0)));
  return out;
}

ToothAngle tooth_angle(const CutterFrame& frame) {
  const Eigen::Vector3d e1 = frame.axes.col(0);
  const Eigen::Matrix<double, 3, 2> across = spindle_directions(frame.axes.col(2));
  const double from_x = std::atan2(e1.dot(across.col(1)), e1.dot(across.col(0)));
  if (frame.axes.determinant() > 0.0) return {from_x, 1.0};
  return {kPi - from_x, -1.0};
}

std::vector<EngagedArc> engagement(const Cutter& cutter, const CutterMotion& motion,
                                   const IsMaterial& is_material,
                                   const Eigen::AlignedBox3d& within) {
  return Search(cutter, motion, is_material, within).arcs();
}

double engaged_height(std::span<const EngagedArc> arcs) {
  double top = 0.0;
  for (const EngagedArc& arc : arcs) {
    const double climb = arc.width * std::sin(arc.kappa);
    if (climb > 0.0) top = std::max(top, arc.height + 0.5 * climb);
  }
  return top;
}

}  // namespace servomill::plant
