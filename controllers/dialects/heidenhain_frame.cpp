// From coordinates of a program to positions of the machine.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "controllers/dialects/heidenhain_control.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::heidenhain {
namespace {

constexpr std::size_t kX = 0;
constexpr std::size_t kY = 1;
constexpr std::size_t kZ = 2;

char letter_of(int axis) { return letter(kAllAxes[static_cast<std::size_t>(axis)]); }

}  // namespace

void Control::forget_positions() {
  if (!rules_.unknown_is_refused) return;
  state_.position.fill(std::nullopt);
}

// Every transformation that an earlier program may have left active must have been reset or set.
// M91 is not allowed in a tilted plane ([472] p. 122) nor with M128 ([530] p. 290); that cycles 8,
// 10 and 11 leave it alone was not found in a manual.
void Control::require_frame(const Place& place, bool is_machine_position) const {
  const State& s = state_;
  if (!s.is_tilted || !s.is_tcp_control) {
    fail(place, fmt::format("{} may be active from the previous program: program {} first",
                            s.is_tilted ? "M128" : "a tilted plane",
                            s.is_tilted ? "M129" : "PLANE RESET STAY"));
  }
  if (!s.is_mirrored)
    fail(place, "cycle 8 may be active from the previous program: reset it first");
  if (!s.rotation) fail(place, "cycle 10 may be active from the previous program: reset it first");
  if (!s.is_scaled) fail(place, "cycle 11 may be active from the previous program: reset it first");
  for (std::size_t i = 0; i < s.is_axis_scaling_off.size(); ++i) {
    if (s.is_axis_scaling_off[i]) continue;
    fail(place,
         fmt::format("cycle 26 may be active in {} from the previous program: reset it first",
                     "XYZ"[i]));
  }
  const bool is_changed = is_mirrored(0) || is_mirrored(1) || *s.rotation != 0.0;
  if (is_machine_position && is_changed) {
    fail(place, "M91 while cycle 8 or 10 is active: the effect is undocumented");
  }
  if (!is_machine_position && !s.tool) {
    fail(place, "a preceding TOOL CALL is required: the tool axis and length are unknown");
  }
}

bool Control::is_mirrored(int axis) const {
  return state_.is_mirrored && axis < 3 && (*state_.is_mirrored)[static_cast<std::size_t>(axis)];
}

double Control::plane_rotation() const {
  return setup_.work_rotation[static_cast<std::size_t>(state_.preset)] +
         state_.rotation.value_or(0.0);
}

// Position of the program's datum on an axis: preset, datum shift, and the length of the tool on Z.
double Control::origin(int axis, const Place& place) const {
  const auto i = static_cast<std::size_t>(axis);
  const auto& offset = setup_.work_offset[static_cast<std::size_t>(state_.preset)];
  if (!offset) {
    fail(place, fmt::format("the work offset of preset {} is unknown",
                            setup_.first_preset + state_.preset));
  }
  if (!state_.shift[i]) {
    fail(place, fmt::format("cycle 7 may be active in {} from the previous program: reset it first",
                            letter_of(axis)));
  }
  double value = (*offset)[axis] + *state_.shift[i];
  if (i == kZ) {
    if (!state_.length) {
      fail(place, fmt::format("the length of tool {} is unknown", state_.tool.value_or(0)));
    }
    value += *state_.length;
  }
  return value;
}

double Control::increment_base(const Positioning::Target& target, int axis) const {
  const auto& position = state_.position[static_cast<std::size_t>(axis)];
  if (!position) {
    fail(target.word->place, fmt::format("'{}': the position of {} is unknown here",
                                         target.word->text, letter_of(axis)));
  }
  return *position;
}

double Control::machine_target(const Positioning::Target& target, int axis) const {
  const double sign = is_mirrored(axis) ? -1.0 : 1.0;
  const bool counts_from_position = target.is_increment && rules_.increments_start_at_position;
  const double base =
      counts_from_position ? increment_base(target, axis) : origin(axis, target.word->place);
  return base + sign * target.value;
}

// [476] p. 192, [530] p. 520: a rotary axis whose display is reduced to less than 360 degrees takes
// the shorter path with M126, or always where MP7682 bit 2 says so.
double Control::on_shorter_path(double from, double to, const Place& place) const {
  constexpr double kHalfTurn = std::numbers::pi;
  const double way = to - from;
  if (std::abs(way) < kHalfTurn - 1e-9 || !settings_.is_rotary_display_reduced) return to;
  if (!settings_.is_shorter_path_usual && !state_.is_shorter_path && rules_.unknown_is_refused) {
    fail(place,
         "a rotary axis would rotate by 180 degrees or more, and M126 may be active from the "
         "previous program: program M127 or M126 first");
  }
  const bool is_shorter = settings_.is_shorter_path_usual || state_.is_shorter_path.value_or(false);
  if (!is_shorter || !rules_.m126_takes_shorter_path) return to;
  const double shorter = std::remainder(way, 2.0 * kHalfTurn);
  if (std::abs(std::abs(shorter) - kHalfTurn) < 1e-9) {
    fail(place, "a rotary axis would rotate by 180 degrees: the direction is undetermined");
  }
  return from + shorter;
}

// With a rotation about Z, X and Y of the machine both depend on both words.
KnownPosition Control::rotated_targets(const Positioning& p, KnownPosition end) const {
  const auto& x = p.target[kX];
  const auto& y = p.target[kY];
  if (!x.word && !y.word) return end;
  const Place& place = (x.word ? x : y).word->place;
  const auto& offset = setup_.work_offset[static_cast<std::size_t>(state_.preset)];
  const double basic = setup_.work_rotation[static_cast<std::size_t>(state_.preset)];
  const double angle = plane_rotation() * (rules_.rotation_is_counter_clockwise ? 1.0 : -1.0);
  const double shift_x = origin(0, place) - (*offset)[0];
  const double shift_y = origin(1, place) - (*offset)[1];
  // origin of the program's coordinates in the machine
  const double origin_x = (*offset)[0] + std::cos(basic) * shift_x - std::sin(basic) * shift_y;
  const double origin_y = (*offset)[1] + std::sin(basic) * shift_x + std::cos(basic) * shift_y;
  double now_x = 0.0;
  double now_y = 0.0;
  const bool needs_now = !x.word || !y.word || x.is_increment || y.is_increment;
  if (needs_now) {
    if (!end[kX] || !end[kY]) {
      fail(place, "the coordinate system is rotated, and the position of X or Y is unknown here");
    }
    const double dx = *end[kX] - origin_x;
    const double dy = *end[kY] - origin_y;
    now_x = std::cos(angle) * dx + std::sin(angle) * dy;
    now_y = -std::sin(angle) * dx + std::cos(angle) * dy;
  }
  const double to_x = !x.word ? now_x : x.is_increment ? now_x + x.value : x.value;
  const double to_y = !y.word ? now_y : y.is_increment ? now_y + y.value : y.value;
  end[kX] = origin_x + std::cos(angle) * to_x - std::sin(angle) * to_y;
  end[kY] = origin_y + std::sin(angle) * to_x + std::cos(angle) * to_y;
  return end;
}

// Positions of all axes at the end of a block without M91.
KnownPosition Control::targets(const Positioning& p) const {
  KnownPosition end = state_.position;
  const bool is_rotated = plane_rotation() != 0.0;
  if (is_rotated) end = rotated_targets(p, end);
  for (int axis = is_rotated ? 2 : 0; axis < kAxisWords; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const Positioning::Target& target = p.target[i];
    if (!target.word) continue;
    double to = machine_target(target, axis);
    if (axis > index_of(Axis::Z) && state_.position[i] && !target.is_increment) {
      to = on_shorter_path(*state_.position[i], to, target.word->place);
    }
    end[i] = to;
  }
  return end;
}

}  // namespace servomill::controllers::heidenhain
