// Positions: increments, frames, rotary axes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/siemens/translator.h"

namespace servomill::controllers::siemens {
namespace {

constexpr double kTurn = 360.0;

}  // namespace

bool Translator::is_increment(const Number& number) const {
  return number.measure == Measure::incremental ||
         (number.measure == Measure::modal && modes_.is_incremental);
}

// An increment behind a new frame or length takes it in as SD42440 and SD42442 say: K2
// (6FC5397-0BP10-0BA0) p. 1-7.
void Translator::require_same_offset(std::size_t axis, const Number& number) const {
  constexpr double kSame = 1e-9;  // mm, degrees
  if (!is_increment(number) || !programmed_[axis]) return;
  const auto now = program_position(axis);
  if (now && std::abs(*now - *programmed_[axis]) < kSame) return;
  fail(number.place,
       fmt::format(
           "an increment of {} after a change of frame, work offset or tool length: SD42440 and "
           "SD42442 determine whether it includes the change; program an absolute position first",
           letter(kAllAxes[axis])));
}

// The position of an axis in the program's coordinates, where those that it depends on are known.
std::optional<double> Translator::program_position(std::size_t axis) const {
  if (axis >= 3) {
    if (!work_[axis]) return std::nullopt;
    return modes_.frame.rotary_to_program(axis, *work_[axis]);
  }
  return linear_position(static_cast<int>(axis));
}

std::optional<double> Translator::linear_position(int axis) const {
  Eigen::Vector3d work = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const auto& known = work_[static_cast<std::size_t>(i)];
    if (!known && modes_.frame.couples_back(axis, i)) return std::nullopt;
    work[i] = known.value_or(0.0);
  }
  return modes_.frame.to_program(work)[axis];
}

std::optional<Point> Translator::program_point(int normal) const {
  const auto axes = plane_axes(normal);
  const auto u = program_position(axes[0]);
  const auto v = program_position(axes[1]);
  if (!u || !v) return std::nullopt;
  return Point(*u, *v);
}

/// @pre the frame keeps the plane
Point Translator::work_point(int normal, const Point& program) const {
  const auto axes = plane_axes(normal);
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (int i = 0; i < 2; ++i)
    p[static_cast<Eigen::Index>(axes[static_cast<std::size_t>(i)])] = program[i];
  const Eigen::Vector3d work = modes_.frame.to_work(p);
  return {work[static_cast<Eigen::Index>(axes[0])], work[static_cast<Eigen::Index>(axes[1])]};
}

// X, Y and Z of a block in program coordinates.
Translator::NamedEnds Translator::named_ends(const Block& block) {
  NamedEnds out;
  std::size_t named = 0, free = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const auto now = program_position(i);
    out.is_known[i] = now.has_value();
    out.p[k] = now.value_or(0.0);
    if (!block.axes[i]) continue;
    const Number& number = *block.axes[i];
    if (number.measure != Measure::modal && number.measure != Measure::absolute &&
        number.measure != Measure::incremental) {
      fail(number.place, fmt::format("{}: DC, ACP and ACN are allowed for rotary axes only",
                                     letter(kAllAxes[i])));
    }
    require_same_offset(i, number);
    const bool is_by = is_increment(number);
    out.is_named[i] = true;
    out.by[k] = number.value * unit();
    out.p[k] = out.by[k] + (is_by ? out.p[k] : 0.0);
    out.is_known[i] = out.is_known[i] || !is_by;
    ++named;
    if (is_by && !now) ++free;
  }
  if (free > 0 && free < named) {
    fail("the start position of an increment is unknown here; program an absolute position first");
  }
  out.is_incremental = free > 0;
  return out;
}

// X, Y, Z that move, since the block names them or the frame is turned. Increments from unknown
// positions stay increments.
void Translator::linear_ends(const Block& block, Values& end, bool& is_incremental) {
  const NamedEnds named = named_ends(block);
  is_incremental = named.is_incremental;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!named.is_named[i]) continue;
    programmed_[i].reset();
    if (!is_incremental) programmed_[i] = named.p[static_cast<Eigen::Index>(i)];
  }
  const Eigen::Vector3d to =
      is_incremental ? modes_.frame.increment(named.by) : modes_.frame.to_work(named.p);
  for (int i = 0; i < 3; ++i) {
    if (!is_moved(named, i)) continue;
    if (!is_incremental) require_known(named, i);
    end[static_cast<std::size_t>(i)] = to[i];
  }
}

bool Translator::is_moved(const NamedEnds& named, int axis) const {
  for (int j = 0; j < 3; ++j) {
    if (named.is_named[static_cast<std::size_t>(j)] && modes_.frame.couples(axis, j)) return true;
  }
  return false;
}

// A turned frame leads from all positions that it couples.
void Translator::require_known(const NamedEnds& named, int axis) {
  for (int j = 0; j < 3; ++j) {
    if (named.is_known[static_cast<std::size_t>(j)] || !modes_.frame.couples(axis, j)) continue;
    fail(fmt::format(
        "the position of {} is unknown here and required in a rotated frame; program it",
        "XYZ"[j]));
  }
}

// A modulo axis goes to a position within the turn that it is in; DC takes the shorter way, ACP and
// ACN the way in one direction. [F] "Absolute dimension for rotary axes"
double Translator::rotary_end(std::size_t axis, const Number& number) {
  const double target = modes_.frame.rotary_to_work(axis, number.value);
  if (number.measure == Measure::absolute || number.measure == Measure::modal) {
    return target + turns_[axis];
  }
  if (!work_[axis]) {
    fail(number.place, fmt::format("{}: the position of the axis is unknown here; program an "
                                   "absolute position first",
                                   letter(kAllAxes[axis])));
  }
  constexpr double kRounding = 1e-9;
  const double way = target - *work_[axis];
  double turned = std::remainder(way, kTurn);
  if (number.measure != Measure::shortest) {
    turned = way - kTurn * std::floor((way + kRounding) / kTurn);
    if (number.measure == Measure::negative && turned > kRounding) turned -= kTurn;
  } else if (std::abs(std::abs(turned) - kTurn / 2.0) < 1e-6) {
    fail(number.place, fmt::format("{}=DC: rotation by 180 degrees: the direction is undetermined",
                                   letter(kAllAxes[axis])));
  }
  turns_[axis] = *work_[axis] + turned - target;
  return *work_[axis] + turned;
}

Values Translator::ends(const Block& block, bool& is_incremental) {
  Values end;
  linear_ends(block, end, is_incremental);
  for (std::size_t i = 3; i < end.size(); ++i) {
    if (!block.axes[i]) continue;
    const Number& number = *block.axes[i];
    require_same_offset(i, number);
    if (!is_increment(number)) {
      if (is_incremental)
        fail(number.place, "absolute positions and increments from unknown positions in one block");
      end[i] = rotary_end(i, number);
    } else if (is_incremental || !work_[i]) {
      if (!is_incremental &&
          std::any_of(end.begin(), end.end(), [](const auto& one) { return one.has_value(); })) {
        fail(number.place,
             "the position of the rotary axis is unknown here; program an absolute position first");
      }
      is_incremental = true;
      end[i] = modes_.frame.rotary_increment(i, number.value);
    } else {
      end[i] = *work_[i] + modes_.frame.rotary_increment(i, number.value);
    }
    programmed_[i].reset();
    if (!is_incremental) programmed_[i] = modes_.frame.rotary_to_program(i, *end[i]);
  }
  return end;
}

}  // namespace servomill::controllers::siemens
