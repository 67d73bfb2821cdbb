// Straight lines: L, FMAX, M91, M140.
#include <fmt/format.h>

#include <cmath>

#include "controllers/dialects/heidenhain_control.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::heidenhain {
namespace {

struct Travel {
  double linear = 0.0;  // m
  double rotary = 0.0;  // rad
  bool is_linear = false;
  bool is_rotary = false;
  bool is_known = true;
};

// Travel of the commanded axes from `from`.
Travel travel_of(const MachineAction& action, const KnownPosition& from, const KnownPosition& to) {
  Travel travel;
  for (int axis = 0; axis < kAxisWords; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    if (!action.is_commanded[i]) continue;
    const bool is_linear = axis <= index_of(Axis::Z);
    const bool is_known = from[i] && to[i];
    const double way = is_known ? *to[i] - *from[i] : 0.0;
    if (is_known && way == 0.0) continue;
    travel.is_known = travel.is_known && is_known;
    (is_linear ? travel.is_linear : travel.is_rotary) = true;
    double& sum = is_linear ? travel.linear : travel.rotary;
    sum = std::hypot(sum, way);
  }
  return travel;
}

}  // namespace

void Control::require_radius_off(const Positioning& p, const HeidenhainBlock& block) {
  for (const HeidenhainWord& word : block.words) {
    if (word.text == "R0") state_.is_radius_off = true;
  }
  const bool is_off = state_.is_radius_off.value_or(false);
  if (p.has_target() && !is_off) {
    fail(place_,
         "cutter radius compensation may be active from the previous program: program R0 first");
  }
}

double Control::effective_feed(const Positioning& p) {
  if (p.feed_word == Positioning::FeedWord::f) state_.feed = p.feed;
  if (p.feed_word == Positioning::FeedWord::fauto) {
    if (!state_.tool_call_feed) fail(place_, "FAUTO: the last TOOL CALL has no F");
    state_.feed = state_.tool_call_feed;
  }
  if (!state_.feed && state_.has_block_feed) {
    fail(place_, "no F in the block: it is undocumented how long FT and FU remain active");
  }
  if (!state_.feed) fail(place_, "no feed rate is active; program F");
  const double feed = *state_.feed;
  if (!rules_.f_is_modal) state_.feed.reset();
  return feed;
}

// F of programs in INCH counts tenths of an inch per minute (TNC 7 user's manual, Cutting data; M
// for the older controls). Degrees per minute where only rotary axes move, unless M116 is active,
// which ends with the program ([ISO] p. 164), but is not known to if that was interrupted.
double Control::feed_per_minute(double feed, const MachineAction& action,
                                const KnownPosition& end) {
  const double length = is_inch_ ? (rules_.f_is_in_tenths_of_inch ? 0.1 : 1.0) * inch : mm;
  const Travel travel = travel_of(action, state_.position, end);
  if (!travel.is_rotary) return feed * length / minute;
  if (state_.is_rotary_feed_in_mm.value_or(rules_.unknown_is_refused)) {
    fail(place_, "F for a rotary axis, and M116 may be active: program M117 first");
  }
  if (!travel.is_linear) return feed * deg_per_min;
  if (!travel.is_known) {
    fail(place_,
         "F for linear and rotary axes from an unknown position: the feed rate is undetermined");
  }
  if (!settings_.is_feed_of_all_axes) return feed * length / minute;
  const double path = std::hypot(travel.linear / mm, travel.rotary / deg);
  return feed * length / minute * (travel.linear / mm) / path;
}

void Control::set_feed(const Positioning& p, MachineAction& action, const KnownPosition& end) {
  if (p.feed_word == Positioning::FeedWord::ft) {
    const double time = p.feed * (rules_.ft_is_in_seconds ? 1.0 : minute);
    action.feed_mode = FeedMode::inverse_time;
    action.feed = 1.0 / time;
    state_.feed.reset();
    state_.has_block_feed = true;
    return;
  }
  const bool is_fu = p.feed_word == Positioning::FeedWord::fu;
  const double feed = is_fu ? p.feed : effective_feed(p);
  if (is_fu) state_.feed.reset();
  state_.has_block_feed = is_fu;
  if (!is_fu && !state_.is_per_revolution) {
    fail(place_, "M136 may be active from the previous program: program M137 before F");
  }
  if (!is_fu && !*state_.is_per_revolution) {
    action.feed = feed_per_minute(feed, action, end);
    return;
  }
  const Travel travel = travel_of(action, state_.position, end);
  if (travel.is_rotary) {
    fail(place_, "feed per revolution of a rotary axis: the unit is undocumented");
  }
  if (!is_fu && is_inch_) {
    fail(place_, "M136 in a program in INCH: the unit of F is undocumented");
  }
  action.feed_mode = FeedMode::units_per_revolution;
  const double unit_of_f = is_fu ? unit() : settings_.is_m136_in_micrometres ? um : mm;
  action.feed = feed * unit_of_f;
}

void Control::move_to(const Positioning& p, const KnownPosition& end, MachineAction action) {
  for (int axis = 0; axis < kAxisWords; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    action.is_commanded[i] = action.is_commanded[i] || p.target[i].word;
  }
  const bool is_rapid = p.feed_word == Positioning::FeedWord::fmax ||
                        (state_.is_fmax_modal && p.feed_word == Positioning::FeedWord::none);
  state_.is_fmax_modal = is_rapid && !rules_.fmax_acts_in_its_block_only;
  if (is_rapid && action.kind == ActionKind::feed) {
    action.kind = ActionKind::rapid;
    action.is_straight = settings_.is_rapid_straight;
  } else {
    set_feed(p, action, end);
  }
  action.end = end;
  state_.position = end;
  actions_.push_back(action);
}

// Coordinates of M91 count from the machine datum, the tool length is dropped. [472] p. 122
KnownPosition Control::machine_targets(const Positioning& p) const {
  KnownPosition end = state_.position;
  for (int axis = 0; axis < kAxisWords; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const Positioning::Target& target = p.target[i];
    if (!target.word) continue;
    if (target.is_increment) fail(target.word->place, "M91 requires absolute coordinates");
    double to = target.value;
    const bool is_rotary = axis > index_of(Axis::Z);
    if (is_rotary && end[i]) to = on_shorter_path(*end[i], to, target.word->place);
    if (axis == index_of(Axis::Z) && !rules_.m91_drops_tool_length) to += state_.length.value_or(0);
    end[i] = to;
  }
  return end;
}

MachineAction Control::new_motion(ActionKind kind) const {
  MachineAction action;
  action.kind = kind;
  action.line = place_.line;
  action.tool = action.tool_offset = state_.tool.value_or(0);
  action.is_path_mode_known = state_.is_path_mode_known;
  action.path_tolerance = state_.path_tolerance;
  return action;
}

void Control::move_straight(const Positioning& p) {
  const bool is_m91 = p.has_m(91) || state_.is_m91_modal;
  state_.is_m91_modal = is_m91 && !rules_.m91_acts_in_its_block_only;
  require_frame(place_, is_m91);
  MachineAction action = new_motion(ActionKind::feed);
  action.is_machine_position = is_m91;
  if (is_m91) {
    action.tool_offset = 0;
  } else if (plane_rotation() != 0.0 && (p.target[0].word || p.target[1].word)) {
    action.is_commanded[0] = action.is_commanded[1] = true;
  }
  const bool counts_from_machine = is_m91 && rules_.m91_counts_from_machine_datum;
  move_to(p, counts_from_machine ? machine_targets(p) : targets(p), action);
}

// L with any of: coordinates, R0, F, M. A block of M functions only is read alike.
void Control::run_line(const HeidenhainBlock& block, std::size_t first) {
  using FeedWord = Positioning::FeedWord;
  const Positioning p = read_words(block, first);
  if (p.radius_angle || p.direction) fail(place_, "a straight line does not accept PA, IPA or DR");
  act_at_start(p);
  require_radius_off(p, block);
  if (p.is_retract) {
    retract(p);
  } else if (p.has_target()) {
    move_straight(p);
  } else if (p.has_m(91)) {
    fail(place_, "M91 requires a coordinate");
  } else if (p.feed_word == FeedWord::f) {
    state_.feed = p.feed;
  } else if (p.feed_word != FeedWord::none && p.feed_word != FeedWord::fmax) {
    fail(place_, "a feed rate for this block requires a coordinate");
  }
  act_at_end(p);
}

// M140 MB MAX: to the limit of travel along the tool axis, at rapid where no F is given. M
void Control::retract(const Positioning& p) {
  if (p.has_target()) fail(place_, "M140 with coordinates is not covered by the verification");
  if (p.feed_word != Positioning::FeedWord::none && p.feed_word != Positioning::FeedWord::fmax) {
    fail(place_, "M140 with a feed is not covered by the verification");
  }
  require_frame(place_, true);
  if (!state_.tool) fail(place_, "M140 requires a preceding TOOL CALL: the tool axis is unknown");
  state_.position[2].reset();
  MachineAction& action = emit(ActionKind::rapid, place_);
  action.is_commanded[2] = true;
  action.is_machine_position = action.is_to_reference = true;
  action.is_straight = settings_.is_rapid_straight;
}

}  // namespace servomill::controllers::heidenhain
