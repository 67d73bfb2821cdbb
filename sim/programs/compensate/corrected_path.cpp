#include "sim/programs/compensate/corrected_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/interrupt.h"

namespace servomill::sim::programs {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Shares of the tolerance: what may be missed between two looks, and what is left for blocks when
// printed digits have theirs, too.
constexpr double kMissed = 0.1, kForBlocks = 0.85;
constexpr double kForArcs = 0.65;  // a correction that turns between two looks is missed there
constexpr double kVaries = 0.1;    // of the tolerance: from then on a correction is not constant
constexpr double kStill = 1e-12;   // m, rad: what rounding leaves of positions
constexpr int kMaxHalvings = 20;
constexpr double kWidestArc = 3.0;        // rad, where an arc falls into several
constexpr double kShortestChord = 10e-6;  // m, of an arc: shorter ones are lines

struct Look {
  double t = 0.0;
  AxisWords c;  // corrected
  AxisWords d;  // correction, in work coordinates
};

class Fitter {
 public:
  Fitter(const ProgrammedMove& move, const Correction& correction, const AxisWords& begin,
         const FitOptions& options)
      : move_(move), correction_(correction), options_(options), begin_(begin) {
    turns_ = move.turns_axes();
    is_timed_ = correction.follows_path();
  }

  std::vector<FittedBlock> fit() {
    const bool wants_arcs = move_.arc && options_.allow_arcs && !turns_ && !is_timed_;
    look(wants_arcs);
    if (wants_arcs) {
      turns_ = varies_in_turn();
      if (!turns_ && (fit_whole_arc() || fit_arcs())) return std::move(out_);
      out_.clear();
      look(false);
    }
    turns_ = turns_ || varies_in_turn();
    fit_lines();
    return std::move(out_);
  }

 private:
  // ---- looking
  Look look_at(double t) const {
    Look one{t, move_.at(t), {}};
    one.d = move_.frame.turned_back(correction_.at(move_.frame.machine(one.c), move_.s(t)));
    one.c += one.d;
    return one;
  }

  void look(bool by_correction) {
    by_correction_ = by_correction;
    const double turn = (move_.end - move_.begin).tail<3>().cwiseAbs().maxCoeff();
    const double blocks = std::max(move_.length() / options_.look, turn / options_.look_turn);
    const auto n = std::max(1, static_cast<int>(std::ceil(blocks - 1e-9)));
    looks_.clear();
    looks_.push_back(look_at(0.0));
    for (const double t : places(n)) {
      throw_if_interrupted();
      const Look b = look_at(t);
      refine(Look(looks_.back()), b, kMaxHalvings);
      looks_.push_back(b);
    }
  }

  // Ends of n equal shares, and the rows of an offset along the path, between which it swings.
  std::vector<double> places(int n) const {
    std::vector<double> out;
    for (int i = 1; i <= n; ++i) out.push_back(i == n ? 1.0 : static_cast<double>(i) / n);
    const double way = move_.s_end - move_.s_begin;
    for (const double s : correction_.rows_between(move_.s_begin, move_.s_end)) {
      out.push_back((s - move_.s_begin) / way);
    }
    std::sort(out.begin(), out.end());
    constexpr double kSame = 1e-9;
    const auto is_same = [](double a, double b) { return b - a < kSame; };
    out.erase(std::unique(out.begin(), out.end(), is_same), out.end());
    out.back() = 1.0;
    return out;
  }

  // Looks between a and b until what lies between two of them is known.
  void refine(const Look& a, const Look& b, int halvings) {
    const Look middle = look_at(0.5 * (a.t + b.t));
    const AxisWords off = by_correction_ ? AxisWords(middle.d - 0.5 * (a.d + b.d))
                                         : AxisWords(middle.c - 0.5 * (a.c + b.c));
    const bool is_straight = off.head<3>().norm() <= kMissed * options_.tolerance &&
                             off.tail<3>().norm() <= kMissed * options_.tolerance_turn;
    if (!is_straight && halvings > 0) refine(a, middle, halvings - 1);
    looks_.push_back(middle);
    if (!is_straight && halvings > 0) refine(middle, b, halvings - 1);
  }

  bool varies_in_turn() const {
    return std::any_of(looks_.begin(), looks_.end(), [&](const Look& one) {
      return (one.d - looks_.front().d).tail<3>().norm() > kMissed * options_.tolerance_turn;
    });
  }

  // ---- what blocks have in common
  const AxisWords& start_of(std::size_t i) const { return i == 0 ? begin_ : looks_[i].c; }

  bool is_too_long(std::size_t i, std::size_t j) const {
    if (options_.max_block <= 0.0 || j == i + 1) return false;
    const double length = (looks_[j].t - looks_[i].t) * move_.length();
    if (length <= options_.max_block * (1.0 + 1e-9)) return false;
    for (std::size_t k = i + 1; k <= j; ++k) {
      if ((looks_[k].d - looks_[i].d).head<3>().norm() > kVaries * options_.tolerance) return true;
    }
    return false;
  }

  // The farthest look that a block from i can reach, found as if nearer ones were reached, too.
  template <class Reaches>
  std::size_t farthest(std::size_t i, Reaches reaches) const {
    const std::size_t last = looks_.size() - 1;
    std::size_t step = 1, good = i;
    while (good < last) {
      const std::size_t next = std::min(good + step, last);
      if (!reaches(i, next)) break;
      good = next;
      step *= 2;
    }
    std::size_t bad = std::min(good + step, last + 1);
    if (good == last) return last;
    while (bad - good > 1) {
      const std::size_t middle = good + (bad - good) / 2;
      (reaches(i, middle) ? good : bad) = middle;
    }
    return good;
  }

  // ---- lines
  bool is_on_chord(const Look& one, const AxisWords& a, const AxisWords& b, double f) const {
    const Vector3d p = one.c.head<3>(), from = a.head<3>(), way = b.head<3>() - from;
    if (turns_ || is_timed_) {
      const AxisWords off = one.c - (a + f * (b - a));
      return off.head<3>().norm() <= kForBlocks * options_.tolerance &&
             off.tail<3>().norm() <= kForBlocks * options_.tolerance_turn;
    }
    const double squared = way.squaredNorm();
    const double share = squared > 0.0 ? std::clamp((p - from).dot(way) / squared, 0.0, 1.0) : 0.0;
    return (p - from - share * way).norm() <= kForBlocks * options_.tolerance;
  }

  bool line_reaches(std::size_t i, std::size_t j) const {
    if (is_too_long(i, j)) return false;
    const AxisWords& a = start_of(i);
    const AxisWords& b = looks_[j].c;
    for (std::size_t k = i + 1; k < j; ++k) {
      const double f = (looks_[k].t - looks_[i].t) / (looks_[j].t - looks_[i].t);
      if (!is_on_chord(looks_[k], a, b, f)) return false;
    }
    return true;
  }

  void fit_lines() {
    for (std::size_t i = 0; i + 1 < looks_.size();) {
      throw_if_interrupted();
      const std::size_t j = std::max(
          i + 1, farthest(i, [&](std::size_t a, std::size_t b) { return line_reaches(a, b); }));
      out_.push_back({looks_[i].t, looks_[j].t, looks_[j].c, {}});
      i = j;
    }
  }

  // ---- arcs
  const ArcSweep& programmed() const { return *move_.arc; }
  Vector2d in_plane(const AxisWords& p) const { return {p[programmed().a], p[programmed().b]}; }

  // The point nearest to `centre` from which both are equally far.
  static Vector2d equally_far(const Vector2d& a, const Vector2d& b, const Vector2d& centre) {
    const Vector2d chord = b - a;
    const double squared = chord.squaredNorm();
    if (squared == 0.0) return centre;
    return centre - chord * ((centre - 0.5 * (a + b)).dot(chord) / squared);
  }

  static std::optional<Vector2d> circumcentre(const Vector2d& a, const Vector2d& b,
                                              const Vector2d& c) {
    const Vector2d u = b - a, v = c - a;
    const double cross = 2.0 * (u.x() * v.y() - u.y() * v.x());
    if (std::abs(cross) < 1e-18) return std::nullopt;
    const double uu = u.squaredNorm(), vv = v.squaredNorm();
    return a + Vector2d(v.y() * uu - u.y() * vv, u.x() * vv - v.x() * uu) / cross;
  }

  bool arc_passes(std::size_t i, std::size_t j, const Vector2d& centre) const {
    const AxisWords &from = start_of(i), &to = looks_[j].c;
    const Vector2d a = in_plane(from) - centre;
    const double r = a.norm();
    const double sweep = programmed().sweep * (looks_[j].t - looks_[i].t);
    const int n = programmed().c;
    const double mismatch = (in_plane(to) - centre).norm() - r;
    // what the NC makes of unequal radii is its own business
    if (std::abs(mismatch) > kMissed * options_.tolerance) return false;
    // the angle from the begin, near what it is on the programmed arc
    const auto turned_to = [&](const Vector2d& p, double expected) {
      const double angle = std::atan2(a.x() * p.y() - a.y() * p.x(), a.dot(p));
      return angle +
             2.0 * std::numbers::pi * std::round((expected - angle) / (2.0 * std::numbers::pi));
    };
    // a helix rises with its own angle, which another centre makes another one
    const double whole = turned_to(in_plane(to) - centre, sweep);
    if (whole * sweep <= 0.0) return false;
    for (std::size_t k = i + 1; k < j; ++k) {
      const Vector2d p = in_plane(looks_[k].c) - centre;
      const double share = (looks_[k].t - looks_[i].t) / (looks_[j].t - looks_[i].t);
      const double along = from[n] + (to[n] - from[n]) * turned_to(p, whole * share) / whole;
      const double off = std::hypot(p.norm() - r, looks_[k].c[n] - along);
      if (!(off <= kForArcs * options_.tolerance)) return false;
    }
    return true;
  }

  std::optional<Vector2d> arc_centre(std::size_t i, std::size_t j) const {
    if (is_too_long(i, j)) return std::nullopt;
    const Vector2d a = in_plane(start_of(i)), b = in_plane(looks_[j].c);
    Vector2d mean = Vector2d::Zero();
    for (std::size_t k = i; k <= j; ++k) mean += in_plane(looks_[k].d);
    mean /= static_cast<double>(j - i + 1);
    const Vector2d moved = mean + Vector2d(programmed().centre_a, programmed().centre_b);
    const Vector2d shifted = equally_far(a, b, moved);
    if (arc_passes(i, j, shifted)) return shifted;
    if (j - i < 2 || std::abs(programmed().sweep) * (looks_[j].t - looks_[i].t) > kWidestArc) {
      return std::nullopt;
    }
    const auto through = circumcentre(a, in_plane(looks_[i + (j - i) / 2].c), b);
    if (through && arc_passes(i, j, *through)) return through;
    return std::nullopt;
  }

  void add_arc(std::size_t i, std::size_t j, const Vector2d& centre, int turns) {
    Arc arc;
    arc.normal_axis = programmed().c;
    arc.centre[programmed().a] = centre.x();
    arc.centre[programmed().b] = centre.y();
    arc.centre[programmed().c] = looks_[j].c[programmed().c];
    arc.turns = turns;
    out_.push_back({looks_[i].t, looks_[j].t, looks_[j].c, arc});
  }

  bool is_long_enough(std::size_t i, std::size_t j) const {
    return (in_plane(looks_[j].c) - in_plane(start_of(i))).norm() > kShortestChord;
  }

  int direction() const { return programmed().sweep > 0.0 ? 1 : -1; }

  bool fit_whole_arc() {
    const std::size_t last = looks_.size() - 1;
    const double turns = std::abs(programmed().sweep) / (2.0 * std::numbers::pi);
    const bool is_closed = std::abs(turns - std::round(turns)) < 1e-9;
    AxisWords& end = looks_[last].c;
    const double gap = (in_plane(begin_) - in_plane(end)).norm();
    // nearly closed arcs turn into lines or circles when they are printed
    if (is_closed ? gap > kMissed * options_.tolerance : gap < kShortestChord) return false;
    if (is_closed) {
      for (const int i : {programmed().a, programmed().b}) end[i] = begin_[i];
    }
    const auto centre = arc_centre(0, last);
    if (!centre) return false;
    add_arc(0, last, *centre, direction() * static_cast<int>(std::ceil(turns - 1e-9)));
    return true;
  }

  bool arc_reaches(std::size_t i, std::size_t j) const {
    const double sweep = std::abs(programmed().sweep) * (looks_[j].t - looks_[i].t);
    return sweep <= kWidestArc && arc_centre(i, j).has_value();
  }

  // @return false if an arc is shorter than arcs should be
  bool fit_arcs() {
    for (std::size_t i = 0; i + 1 < looks_.size();) {
      throw_if_interrupted();
      const std::size_t j =
          farthest(i, [&](std::size_t a, std::size_t b) { return arc_reaches(a, b); });
      if (j == i || !is_long_enough(i, j)) return false;
      add_arc(i, j, *arc_centre(i, j), direction());
      i = j;
    }
    return true;
  }

  const ProgrammedMove& move_;
  const Correction& correction_;
  const FitOptions& options_;
  AxisWords begin_;
  bool turns_ = false;     // rotary axes move, programmed or corrected
  bool is_timed_ = false;  // what was learnt along the path belongs to a share of the move
  bool by_correction_ = false;
  std::vector<Look> looks_;
  std::vector<FittedBlock> out_;
};

}  // namespace

AxisWords WorkFrame::turned(const AxisWords& v) const {
  AxisWords out = v;
  out[0] = cos * v[0] - sin * v[1];
  out[1] = sin * v[0] + cos * v[1];
  return out;
}

AxisWords WorkFrame::turned_back(const AxisWords& v) const {
  AxisWords out = v;
  out[0] = cos * v[0] + sin * v[1];
  out[1] = -sin * v[0] + cos * v[1];
  return out;
}

AxisWords ProgrammedMove::at(double t) const {
  if (t >= 1.0) return end;
  AxisWords out = begin + t * (end - begin);
  if (arc) out.head<3>() = arc->point(t);
  return out;
}

double ProgrammedMove::length() const {
  const double length = arc ? arc->length() : (end - begin).head<3>().norm();
  return length > kStill ? length : 0.0;
}

bool ProgrammedMove::turns_axes() const { return (end - begin).tail<3>().norm() > kStill; }

AxisWords corrected(const ProgrammedMove& move, const Correction& correction, double t) {
  const AxisWords work = move.at(t);
  return work + move.frame.turned_back(correction.at(move.frame.machine(work), move.s(t)));
}

std::vector<FittedBlock> fit(const ProgrammedMove& move, const Correction& correction,
                             const AxisWords& begin, const FitOptions& options) {
  return Fitter(move, correction, begin, options).fit();
}

}  // namespace servomill::sim::programs
