#include "sim/limits/path_follower.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/tool_axis.h"
#include "sim/model/machine.h"

namespace servomill::sim::limits {
namespace {

using Piece = engine::ProgramPath::Piece;

// Constants of (1).
constexpr double kSteps = 3.0, kDistances = 4.0;
constexpr double kMargin = 0.1e-3;        // m
constexpr double kRotaryRadius = 100e-3;  // m
constexpr double kNearer = 1e-18;         // m^2, by which a later piece must be nearer
constexpr double kStraight = 1e-12;       // m

bool is_straight(const Piece& piece) {
  const double chord = (piece.end - piece.begin).head<3>().norm();
  return piece.curve.sweep() == 0.0 && piece.curve.length() - chord <= kStraight;
}

// The tip is where all of them put it.
bool has_all_rotary(const LoggedPath& log, const JointLayout& layout) {
  return std::all_of(kAllAxes.begin(), kAllAxes.end(), [&](Axis axis) {
    return is_linear(axis) || !layout.joint_of(axis) ||
           log.is_recorded[static_cast<std::size_t>(index_of(axis))];
  });
}

}  // namespace

PathFollower::PathFollower(const ProgrammedPath& program, const LoggedPath& log)
    : program_(program), log_(log) {
  for (std::size_t i = 0; i < program.path.size(); ++i) {
    const Piece one = program.path.piece(i);
    if (!one.is_tip) continue;
    if (has_all_rotary(log, program.machine->chain().layout)) return;
    throw InputError({program.program, one.line},
                     "uses TCP control: the path requires the positions of the rotary axes, which "
                     "the recording lacks");
  }
}

PathPlace PathFollower::at(std::size_t sample) {
  double left = reach(sample);
  sample_ = sample;
  std::size_t best_piece = 0;
  Candidate best{0.0, std::numeric_limits<double>::infinity()};
  double low = share_;
  for (std::size_t i = 0; index_ + i < program_.path.size() && left >= 0.0; ++i) {
    const Piece& one = piece(index_ + i);
    const double length = length_of(one);
    const double high = length > 0.0 ? std::min(1.0, low + left / length) : 1.0;
    const Candidate here = nearest(one, in_coordinates_of(one, sample), low, high);
    if (here.cost < best.cost - (i > 0 ? kNearer : 0.0)) {
      best = here;
      best_piece = i;
    }
    left -= (1.0 - low) * length;
    low = 0.0;
  }
  ahead_.erase(ahead_.begin(), ahead_.begin() + static_cast<std::ptrdiff_t>(best_piece));
  index_ += best_piece;
  share_ = best.share;
  distance_ = std::sqrt(best.cost);
  return place(sample);
}

AxisWords PathFollower::in_coordinates_of(const Piece& piece, std::size_t sample) const {
  const AxisWords& at = log_.at[sample];
  return piece.is_tip ? program_.machine->tip_words(at, piece.p_ST) : at;
}

const Piece& PathFollower::piece(std::size_t index) {
  while (index_ + ahead_.size() <= index) {
    ahead_.push_back(program_.path.piece(index_ + ahead_.size()));
  }
  return ahead_[index - index_];
}

// Rotary axes that are not recorded, and those on a great circle, do not help to find the place.
double PathFollower::rotary_radius_of(const Piece& piece) const {
  return log_.has_rotary() && !piece.is_great_circle ? kRotaryRadius : 0.0;
}

double PathFollower::length_of(const Piece& piece) const {
  return piece.curve.length() + weighted(piece, piece.end - piece.begin).tail<3>().norm();
}

double PathFollower::reach(std::size_t sample) {
  const Piece& here = piece(index_);
  const AxisWords step =
      weighted(here, in_coordinates_of(here, sample) - in_coordinates_of(here, sample_));
  return kSteps * step.norm() + kDistances * distance_ + kMargin;
}

// Metres; axes that are not recorded do not count.
AxisWords PathFollower::weighted(const Piece& piece, AxisWords d) const {
  d.tail<3>() *= rotary_radius_of(piece);
  for (std::size_t i = 3; i < log_.is_recorded.size(); ++i) {
    if (!log_.is_recorded[i]) d[static_cast<int>(i)] = 0.0;
  }
  return d;
}

double PathFollower::cost(const Piece& piece, const AxisWords& p, double share) const {
  return weighted(piece, piece.curve.at(share) - p).squaredNorm();
}

PathFollower::Candidate PathFollower::nearest(const Piece& piece, const AxisWords& p, double low,
                                              double high) const {
  double share = high;
  if (is_straight(piece)) {
    const AxisWords d = weighted(piece, piece.end - piece.begin);
    const AxisWords from = weighted(piece, p - piece.begin);
    const double square = d.squaredNorm();
    if (square > 0.0) share = d.dot(from) / square;
  } else {
    share = piece.curve.closest(p.head<3>());
    if (share < low || share > high) {  // on a closed curve either end may be the nearer one
      share = cost(piece, p, low) <= cost(piece, p, high) ? low : high;
    }
  }
  share = std::clamp(share, low, high);
  return {share, cost(piece, p, share)};
}

PathPlace PathFollower::place(std::size_t sample) {
  const Piece& here = piece(index_);
  const AxisWords at = in_coordinates_of(here, sample), d = here.curve.at(share_) - at;
  // where rotary axes are ahead or behind, the nearest place of X Y Z is another one
  const double nearest = here.curve.closest(at.head<3>());
  PathPlace out{index_, here.s_begin + share_ * (here.s_end - here.s_begin),
                std::min(d.head<3>().norm(), (here.curve.at(nearest) - at).head<3>().norm())};
  if (!log_.has_rotary()) return out;
  out.knows_rotary = true;
  if (here.is_great_circle) {
    const auto k = controllers::ToolCentrePoint::axis_between(here.k_begin, here.k_end, share_);
    const JointLayout& layout = program_.machine->chain().layout;
    out.rotary = angle_between(k, program_.machine->tool_axis(layout.joints(log_.at[sample])));
    return out;
  }
  for (int i = 3; i < kAxisWords; ++i) {
    if (log_.is_recorded[static_cast<std::size_t>(i)]) {
      out.rotary = std::max(out.rotary, std::abs(d[i]));
    }
  }
  return out;
}

}  // namespace servomill::sim::limits
