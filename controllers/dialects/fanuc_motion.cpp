// Motion and dwell of a Fanuc control.
#include <fmt/format.h>

#include <cmath>

#include "controllers/dialects/fanuc_machine.h"
#include "controllers/dialects/planar_arc.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr std::size_t kZ = 2;

Eigen::Vector3d place_of(const KnownPosition& position) {
  return {position[0].value_or(0.0), position[1].value_or(0.0), position[2].value_or(0.0)};
}

}  // namespace

bool FanucMachine::has_centre() const {
  return word('I') != nullptr || word('J') != nullptr || word('K') != nullptr;
}

void FanucMachine::check_modes_of_motion() const {
  const auto need = [&](bool is_known, std::string_view what) {
    if (!is_known) fail(fmt::format("a motion requires an active {}", what));
  };
  need(modes_.motion.has_value(), "G0, G1, G2 or G3");
  need(modes_.is_incremental.has_value(), "G90 or G91");
  need(modes_.is_cutter_off, "G40");
  need(modes_.is_cycle_off, "G80");
  need(modes_.is_scaling_off, "G50");
  need(modes_.is_rotation_off, "G69");
  need(modes_.is_polar_off, "G15");
  for (const Axis axis : kAllAxes) {
    if (!is_linear(axis) && word(letter(axis)) == nullptr) continue;
    if (modes_.is_mirror_off[static_cast<std::size_t>(index_of(axis))]) continue;
    fail(fmt::format("G51.1 may be active in {}; cancel it with G50.1 {}0.", letter(axis),
                     letter(axis)));
  }
}

double FanucMachine::required(int axis, int column, const char* reason) const {
  const auto& known = position_[static_cast<std::size_t>(axis)];
  if (!known) {
    fail(column,
         fmt::format("{} requires the position of {}, which is unknown", reason, "XYZABC"[axis]));
  }
  return *known;
}

// G4 X in seconds, P in increments of time. Under G95 No. 3405#1 (DWL) decides.
void FanucMachine::run_dwell() {
  const FanucWord* X = word('X');
  const FanucWord* P = word('P');
  const int at = column(Group::one_shot);
  if ((X == nullptr) == (P == nullptr)) fail(at, "G4 requires either X or P");
  for (const FanucWord& one : block_->words) {
    const bool is_own = one.letter == 'G' || one.letter == 'X' || one.letter == 'P';
    if (!is_own) fail(one.column, fmt::format("{} is not allowed in a block with G4", one.letter));
  }
  if (!modes_.feed_mode || *modes_.feed_mode == FeedMode::units_per_revolution) {
    fail(at, "G4 requires G93 or G94: otherwise it depends on No. 3405#1 (DWL)");
  }
  const FanucWord& one = X != nullptr ? *X : *P;
  if (P != nullptr && !P->is_integer()) fail(P->column, "P must be an integer");
  if (one.mantissa < 0) fail(one.column, "the dwell time must be >= 0");
  const double increment = rules_.dwell_P_in_increments / (settings_.is_IS_C ? 10.0 : 1.0);
  MachineAction out = action(ActionKind::dwell);
  out.value = one.is_integer() ? one.value() * increment : one.value() * rules_.dwell_X_in_s;
  actions_.push_back(out);
}

// G53: a rapid, absolute, for one block (B-63844EN/02 p. 204 for the tool length; the rest M).
void FanucMachine::run_machine_position() {
  const int at = column(Group::one_shot);
  if (!names_axis()) fail(at, "G53 requires an axis");
  check_modes_of_motion();
  if (*modes_.is_incremental) fail(at, "G53 has no effect with G91");
  if (*modes_.motion != 0) fail(at, "G53 requires an active G0");
  MachineAction out = action(ActionKind::rapid);
  out.is_machine_position = true;
  out.is_straight = settings_.LRP;
  for (const Axis axis : kAllAxes) {
    const FanucWord* one = word(letter(axis));
    if (one == nullptr) continue;
    const auto i = static_cast<std::size_t>(index_of(axis));
    out.is_commanded[i] = true;
    const double value = dimension(*one, is_linear(axis));
    out.end[i] = is_linear(axis) ? value : within_a_turn(index_of(axis), value, 0.0, one->column);
    if (rules_.G53_ignores_work_offset) continue;
    *out.end[i] += (*setup_.work_offset[0])[index_of(axis)];
  }
  if (word('Z') != nullptr && rules_.machine_position_cancels_length) suspend_length();
  is_modal_machine_ = !rules_.G53_is_for_one_block;
  out.tool_offset = 0;
  move_to(out);
}

// G28, G30: through an intermediate point to the reference position.
void FanucMachine::run_reference_return() {
  const int at = column(Group::one_shot);
  if (!names_axis()) fail(at, "G28 and G30 require an axis");
  check_modes_of_motion();
  MachineAction through = action(ActionKind::rapid);
  through.is_straight = settings_.LRP;
  MachineAction home = through;
  home.is_machine_position = home.is_to_reference = true;
  bool moves = false;
  for (const Axis axis : kAllAxes) {
    const FanucWord* one = word(letter(axis));
    if (one == nullptr) continue;
    const auto i = static_cast<std::size_t>(index_of(axis));
    home.is_commanded[i] = true;
    home.end[i].reset();
    if (*modes_.is_incremental && one->mantissa == 0) continue;  // stays where it is
    through.is_commanded[i] = true;
    through.end[i] = target(index_of(axis), *one);
    moves = true;
  }
  if (moves && rules_.G28_goes_through_a_point) move_to(through);
  if (word('Z') != nullptr && rules_.reference_return_cancels_length) suspend_length();
  home.tool_offset = 0;
  move_to(home);
}

// G31: along a line at feed until the skip signal comes; without it to the end (Series
// 15i/150i-MA, Programming, p. 564). One-shot; the axes rest where the signal stopped them.
void FanucMachine::run_skip() {
  const int at = column(Group::one_shot);
  if (!names_axis()) fail(at, "G31 requires an axis");
  if (has(Group::length))
    fail(at, "a change of the tool length is not allowed in a block with G31");
  check_modes_of_motion();
  if (modes_.feed_mode != FeedMode::units_per_minute) {
    fail(at, "G31 requires an active G94");
  }
  MachineAction out = action(ActionKind::probe);
  set_target(out);
  set_action_feed(out);
  move_to(out);
  if (!rules_.skip_forgets_positions) return;
  for (std::size_t i = 0; i < position_.size(); ++i) {
    if (out.is_commanded[i]) position_[i].reset();
  }
}

// Machine coordinate commanded by a word of the block.
double FanucMachine::target(int axis, const FanucWord& word) {
  const bool is_linear = axis < kLinearJoints;
  const double value = dimension(word, is_linear);
  if (*modes_.is_incremental) {
    if (axis == 2 && length_.is_suspended) {
      fail(word.column,
           "an incremental Z is not allowed after G53, G28 or G30 has cancelled the tool length");
    }
    return required(axis, word.column, "an incremental move") + value;
  }
  if (!modes_.work_system) fail(word.column, "a motion requires an active G54 ... G59");
  const auto& offset = setup_.work_offset[static_cast<std::size_t>(*modes_.work_system - 1)];
  if (!offset) {
    fail(word.column, fmt::format("work offset G{} is unknown", 53 + *modes_.work_system));
  }
  const auto k = static_cast<std::size_t>(axis);
  const std::pair<bool, int> shifts[] = {{modes_.is_local_off[k], 52},
                                         {modes_.is_shift_off[k], 92}};
  for (const auto& [is_off, code] : shifts) {
    if (is_off) continue;
    fail(word.column, fmt::format("{} moves, and a shift by G{} may be active", word.letter, code));
  }
  if (!is_linear) return within_a_turn(axis, (*offset)[axis] + value, (*offset)[axis], word.column);
  return (*offset)[axis] + value + (axis == 2 ? acting_length(word.column) : 0.0);
}

// Position to which an absolute command moves a rotary axis with roll-over: the commanded angle,
// approached in the direction of the shorter distance (B-63534EN/02 p. 531). If the present
// position is unknown, turns are counted from the commanded one.
double FanucMachine::within_a_turn(int axis, double machine, double offset, int column) const {
  constexpr double kTurn = 360.0 * deg;
  const auto& before = position_[static_cast<std::size_t>(axis)];
  if (!settings_.rolls_over[static_cast<std::size_t>(axis - kLinearJoints)] || !before) {
    return machine;
  }
  if (!rules_.rolls_over_by_shorter_way) {
    return *before + machine - offset - std::fmod(*before - offset, kTurn);
  }
  const double way = std::remainder(machine - *before, kTurn);
  if (std::abs(std::abs(way) - 0.5 * kTurn) < 1e-9) {
    fail(column,
         fmt::format(
             "{} moves by 180 degrees: the direction is undetermined with No. 1008#0 (ROA) = 1",
             "XYZABC"[axis]));
  }
  return *before + way;
}

void FanucMachine::set_target(MachineAction& out) {
  for (const Axis axis : kAllAxes) {
    const FanucWord* one = word(letter(axis));
    if (one == nullptr) continue;
    const auto i = static_cast<std::size_t>(index_of(axis));
    out.is_commanded[i] = true;
    out.end[i] = target(index_of(axis), *one);
  }
  if (word('Z') != nullptr && length_.mode == FanucLength::Mode::on) {
    out.tool_offset = length_.is_suspended ? 0 : *length_.number;
  }
}

void FanucMachine::run_motion() {
  check_modes_of_motion();
  if (settings_.TLB && length_.mode == FanucLength::Mode::on && modes_.normal_axis != 2) {
    fail(
        "a motion outside G17 with a tool length: it is undocumented whether the length follows "
        "the plane with No. 5001#1 (TLB) = 1");
  }
  const int motion = *modes_.motion;
  MachineAction out = action(motion == 0   ? ActionKind::rapid
                             : motion == 1 ? ActionKind::feed
                                           : ActionKind::arc);
  out.is_straight = motion != 0 || settings_.LRP;
  set_target(out);
  if (motion >= 2) set_arc(out);
  if (motion != 0) set_action_feed(out);
  if (code(Group::one_shot) == 90) is_modal_exact_stop_ = !rules_.exact_stop_G9_is_for_one_block;
  move_to(out);
}

void FanucMachine::set_arc(MachineAction& out) const {
  if (!modes_.normal_axis) fail("an arc requires an active G17, G18 or G19");
  const int normal = *modes_.normal_axis;
  const int a = (normal + 1) % 3, b = (normal + 2) % 3;
  if (!has_centre()) fail("an arc requires I, J or K");
  required(a, 1, "an arc");
  required(b, 1, "an arc");
  const Eigen::Vector3d begin = place_of(position_), end = place_of(out.end);
  out.centre = begin;
  for (const int i : {0, 1, 2}) {
    const FanucWord* one = word("IJK"[i]);
    if (one == nullptr) continue;
    if (i == normal) fail(one->column, fmt::format("{} is not in the plane", one->letter));
    const double value = dimension(*one, true);
    out.centre[i] =
        rules_.centre_is_from_begin
            ? begin[i] + value
            : (*setup_
                    .work_offset[static_cast<std::size_t>(modes_.work_system.value_or(1) - 1)])[i] +
                  value;
  }
  for (const Axis axis : {Axis::A, Axis::B, Axis::C}) {
    const FanucWord* one = word(letter(axis));
    if (one != nullptr) fail(one->column, "rotary axes are not allowed in an arc");
  }
  if (const auto fault = arc_fault(begin, end, out.centre, normal)) fail(*fault);
  out.normal_axis = normal;
  const bool is_clockwise = (*modes_.motion == 2) == rules_.G2_is_clockwise;
  const bool is_swapped = normal == 1 && rules_.G18_first_axis != 2;
  out.turns = is_clockwise != is_swapped ? -1 : 1;
}

void FanucMachine::set_action_feed(MachineAction& out) const {
  if (!modes_.feed_mode) fail("a feed motion requires an active G93, G94 or G95");
  out.feed_mode = *modes_.feed_mode;
  const bool is_inverse = out.feed_mode == FeedMode::inverse_time;
  if (is_inverse && word('F') == nullptr) fail("G93 requires F in every block");
  if (!feed_) fail("a feed motion requires a known F");
  if (is_inverse) {
    // for arcs the manuals divide by the radius, not by the length (M)
    if (out.kind == ActionKind::arc) fail("an arc is not supported with G93");
    out.feed = rules_.inverse_time_is_per_minute ? *feed_ / minute : *feed_;
    return;
  }
  bool moves_linear = false, moves_rotary = false;
  for (std::size_t i = 0; i < out.end.size(); ++i) {
    if (!out.is_commanded[i] || out.end[i] == position_[i]) continue;
    (i <= kZ ? moves_linear : moves_rotary) = true;
  }
  if (moves_linear && moves_rotary) {
    fail("linear and rotary axes in one block require G93");
  }
  const bool is_linear_feed = moves_linear || out.kind == ActionKind::arc || !moves_rotary;
  const double unit = is_linear_feed ? *modes_.unit : deg;
  out.feed = *feed_ * unit / (out.feed_mode == FeedMode::units_per_minute ? minute : 1.0);
  if (out.kind != ActionKind::arc || !rules_.helix_feed_is_along_arc) return;
  const Eigen::Vector3d begin = place_of(position_), end = place_of(out.end);
  const double along = end[out.normal_axis] - begin[out.normal_axis];
  const double flat = arc_length(begin, end, out.centre, out.normal_axis, out.turns);
  if (flat > 0.0) out.feed *= std::hypot(flat, along) / flat;
}

}  // namespace servomill::controllers
