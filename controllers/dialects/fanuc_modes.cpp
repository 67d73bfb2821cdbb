// Modal state of a Fanuc control: codes of a block, units, feeds and the tool length.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/dialects/fanuc_machine.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

using Group = FanucGroup;

struct KnownCode {
  int tenths;
  Group group;
};

// Codes that are read. Numbers and groups: B-63944EN, list of preparatory functions (M). G69 and
// G50 end rotation and scaling: B-63944EN-2/02 p. 211; G15 ends polar coordinates: Series 16/18-C,
// operator's manual for machining centers, section 9.2.
constexpr std::array kCodes = {
    KnownCode{0, Group::motion},         KnownCode{10, Group::motion},
    KnownCode{20, Group::motion},        KnownCode{30, Group::motion},
    KnownCode{40, Group::one_shot},      KnownCode{51, Group::contour},
    KnownCode{90, Group::one_shot},      KnownCode{150, Group::polar},
    KnownCode{170, Group::plane},        KnownCode{180, Group::plane},
    KnownCode{190, Group::plane},        KnownCode{200, Group::unit},
    KnownCode{210, Group::unit},         KnownCode{280, Group::one_shot},
    KnownCode{300, Group::one_shot},     KnownCode{310, Group::one_shot},
    KnownCode{400, Group::cutter},       KnownCode{430, Group::length},
    KnownCode{440, Group::length},       KnownCode{490, Group::length},
    KnownCode{500, Group::scaling},      KnownCode{501, Group::mirror},
    KnownCode{520, Group::one_shot},     KnownCode{530, Group::one_shot},
    KnownCode{921, Group::one_shot},     KnownCode{540, Group::work_system},
    KnownCode{550, Group::work_system},  KnownCode{560, Group::work_system},
    KnownCode{570, Group::work_system},  KnownCode{580, Group::work_system},
    KnownCode{590, Group::work_system},  KnownCode{610, Group::path},
    KnownCode{640, Group::path},         KnownCode{690, Group::rotation},
    KnownCode{800, Group::cycle},        KnownCode{900, Group::distance},
    KnownCode{910, Group::distance},     KnownCode{930, Group::feed_mode},
    KnownCode{940, Group::feed_mode},    KnownCode{950, Group::feed_mode},
    KnownCode{970, Group::spindle_mode}, KnownCode{980, Group::return_level},
    KnownCode{990, Group::return_level},
};

std::string code_text(int tenths) {
  return tenths % 10 == 0 ? fmt::format("G{}", tenths / 10)
                          : fmt::format("G{}.{}", tenths / 10, tenths % 10);
}

}  // namespace

void FanucMachine::read_codes() {
  codes_ = {};
  M_ = {};
  for (const FanucWord& one : block_->words) {
    if (one.letter == 'M') read_M(one);
    if (one.letter != 'G') continue;
    const double tenths = 10.0 * one.value();
    const auto found = std::find_if(kCodes.begin(), kCodes.end(), [&](const KnownCode& known) {
      return std::abs(known.tenths - tenths) < 1e-6;
    });
    if (found == kCodes.end()) {
      fail(one.column, fmt::format("G{:g} is not supported here", one.value()));
    }
    check_function(found->tenths, one.column);
    Code& place = codes_[static_cast<std::size_t>(found->group)];
    if (place.tenths >= 0) {
      fail(one.column, fmt::format("{} and {} in one block (same modal group)",
                                   code_text(place.tenths), code_text(found->tenths)));
    }
    place = {found->tenths, one.column};
  }
}

void FanucMachine::check_function(int tenths, int column) const {
  const std::pair<int, bool> optional[] = {{150, settings_.has_polar},
                                           {500, settings_.has_scaling},
                                           {501, settings_.has_mirror},
                                           {921, settings_.has_preset},
                                           {970, settings_.has_surface_speed}};
  for (const auto& [code, is_there] : optional) {
    if (code != tenths || is_there) continue;
    fail(column,
         fmt::format("{} causes an alarm on a control without this option", code_text(code)));
  }
}

// Codes whose axis words move nothing.
bool FanucMachine::is_switch() const {
  const int one_shot = code(Group::one_shot);
  return has(Group::mirror) || has(Group::contour) || one_shot == 520 || one_shot == 921;
}

// G50.1 ends the mirror image of the axes named, G52 of 0 their local coordinates in all of G54 ...
// G59, G92.1 of 0 their shift by G92 (M: none of Fanuc's manuals was found; G52 of 0 is so in those
// of two controls that follow them, GSK 980MDc p. 61 and Mitsubishi M700V p. 531).
void FanucMachine::run_switch() {
  if (block_->words.front().letter != 'G')
    fail("G5.1, G50.1, G52 and G92.1 must be first in the block");
  if (has(Group::contour)) return;
  const int one_shot = code(Group::one_shot);
  if (one_shot == 921 && length_.mode == FanucLength::Mode::on) {
    fail("G92.1 cancels the active tool length");
  }
  auto& is_off = has(Group::mirror) ? modes_.is_mirror_off
                 : one_shot == 520  ? modes_.is_local_off
                                    : modes_.is_shift_off;
  for (const Axis axis : kAllAxes) {
    const FanucWord* one = word(letter(axis));
    if (one == nullptr) continue;
    if (one->mantissa != 0 && !has(Group::mirror)) {
      fail(one->column, fmt::format("G52 and G92.1 are supported with values of 0 only"));
    }
    is_off[static_cast<std::size_t>(index_of(axis))] = true;
  }
}

// More than one M in a block needs No. 3404#7 (M3B).
void FanucMachine::read_M(const FanucWord& word) {
  constexpr std::array kRead = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 30};
  if (M_.tenths >= 0) fail(word.column, "two M codes in a block depend on No. 3404#7 (M3B)");
  if (!word.is_integer() || std::find(kRead.begin(), kRead.end(), word.mantissa) == kRead.end()) {
    fail(word.column, fmt::format("M{:g} is not supported here", word.value()));
  }
  M_ = {static_cast<int>(word.mantissa), word.column};
}

bool FanucMachine::names_axis() const {
  return std::any_of(kAllAxes.begin(), kAllAxes.end(),
                     [&](Axis axis) { return word(letter(axis)) != nullptr; });
}

// Words that belong to none of the codes of the block.
void FanucMachine::check_words() const {
  const bool is_arc = modes_.motion && *modes_.motion >= 2 && code(Group::one_shot) < 0;
  for (const FanucWord& one : block_->words) {
    bool is_taken = std::string_view("GMSTFHXYZABC").find(one.letter) != std::string_view::npos;
    if (one.letter == 'I' || one.letter == 'J' || one.letter == 'K') is_taken = is_arc;
    if (one.letter == 'P') is_taken = code(Group::one_shot) == 40 || code(Group::one_shot) == 300;
    if (one.letter == 'Q' || one.letter == 'R') is_taken = has(Group::contour);
    if (!is_taken) {
      fail(one.column,
           fmt::format("{} is not used by any supported code of the block", one.letter));
    }
  }
}

void FanucMachine::set_modes() {
  set_unit();
  set_cancels();
  if (has(Group::motion)) {
    modes_.motion = code(Group::motion) / 10;
    modes_.is_cycle_off = true;  // a code of group 01 ends a canned cycle
  }
  if (has(Group::plane)) {
    modes_.normal_axis = code(Group::plane) == 170 ? 2 : code(Group::plane) == 180 ? 1 : 0;
  }
  if (has(Group::distance)) modes_.is_incremental = code(Group::distance) == 910;
  if (has(Group::work_system)) modes_.work_system = code(Group::work_system) / 10 - 53;
  if (has(Group::path)) {
    modes_.path = code(Group::path) == 610 ? PathMode::exact_stop : PathMode::continuous;
  }
  if (has(Group::feed_mode)) {
    const FeedMode mode = code(Group::feed_mode) == 930   ? FeedMode::inverse_time
                          : code(Group::feed_mode) == 940 ? FeedMode::units_per_minute
                                                          : FeedMode::units_per_revolution;
    if (modes_.feed_mode != mode && rules_.feed_mode_forgets_F) feed_.reset();
    modes_.feed_mode = mode;
  }
}

// A switch changes work offsets and compensation values: B-63944EN p. 192.
void FanucMachine::set_unit() {
  if (!has(Group::unit)) return;
  const int at = column(Group::unit);
  if (block_->words.size() > 1) {
    fail(at, "G20 and G21 must be in a separate block at the start of the program");
  }
  const double unit = code(Group::unit) == 200 ? rules_.inch_in_mm * mm : mm;
  if (modes_.unit && *modes_.unit != unit) {
    fail(at, "switching between G20 and G21 changes work offsets and compensation values");
  }
  modes_.unit = unit;
}

void FanucMachine::set_cancels() {
  if (has(Group::cutter)) modes_.is_cutter_off = true;
  if (has(Group::cycle)) modes_.is_cycle_off = true;
  if (has(Group::scaling)) modes_.is_scaling_off = true;
  if (has(Group::rotation)) modes_.is_rotation_off = true;
  if (has(Group::polar)) modes_.is_polar_off = true;
  if (has(Group::spindle_mode)) modes_.is_surface_speed_off = true;
}

// F without a point counts whole mm/min; its increments in other modes are not read.
void FanucMachine::set_feed() {
  const FanucWord* F = word('F');
  if (F == nullptr) return;
  if (!modes_.feed_mode) fail(F->column, "F requires an active G93, G94 or G95");
  if (!modes_.unit) fail(F->column, "F requires an active G20 or G21");
  const bool is_metric_minute =
      *modes_.feed_mode == FeedMode::units_per_minute && *modes_.unit == mm;
  if (F->is_integer() && !is_metric_minute) {
    fail(F->column, "F requires a decimal point: its increment depends on parameters");
  }
  if (F->mantissa <= 0) fail(F->column, "F must be > 0");
  feed_ = F->value();
}

void FanucMachine::set_spindle() {
  const FanucWord* S = word('S');
  if (S == nullptr) return;
  if (!S->is_integer()) fail(S->column, "S must be an integer");
  if (S->mantissa < 0) fail(S->column, "S must be >= 0");
  if (!modes_.is_surface_speed_off) {
    fail(S->column, "S requires G97: with G96 it is a cutting speed");
  }
  speed_ = S->value() * rpm;
  const bool switches = M_.tenths >= 3 && M_.tenths <= 5;
  if (!switches && direction_) {
    MachineAction out = action(ActionKind::spindle);
    out.direction = *direction_;
    out.value = *speed_;
    actions_.push_back(out);
  }
}

int FanucMachine::integer(char letter, int max) const {
  const FanucWord& one = *word(letter);
  if (!one.is_integer() || one.mantissa < 0 || one.mantissa > max) {
    fail(one.column, fmt::format("{} must be an integer in 0 ... {}", letter, max));
  }
  return static_cast<int>(one.mantissa);
}

// Value of a dimension word in m or rad. Digits below the increment are cut off by the control
// (M), so that they are refused.
double FanucMachine::dimension(const FanucWord& word, bool is_linear) const {
  if (is_linear && !modes_.unit) {
    fail(word.column, fmt::format("{} requires an active G20 or G21", word.letter));
  }
  const double unit = is_linear ? *modes_.unit : deg;
  const bool is_inch = is_linear && unit != mm;
  const int digits = (settings_.is_IS_C ? 4 : 3) + (is_inch ? 1 : 0);
  if (word.is_integer() && rules_.number_without_point_is_increments) {
    return word.value() / std::pow(10.0, digits) * unit;
  }
  std::int64_t rest = word.mantissa;
  int decimals = word.decimals;
  for (; decimals > 0 && rest % 10 == 0; --decimals) rest /= 10;
  if (decimals > digits) {
    fail(word.column, fmt::format("{} has {} decimals; the control truncates after {}", word.letter,
                                  decimals, digits));
  }
  return word.value() * unit;
}

double FanucMachine::length_of(int number, int column) const {
  if (number == 0) return 0.0;
  const auto found = setup_.tool_length.find(number);
  if (found == setup_.tool_length.end()) {
    fail(column, fmt::format("the length H{} is unknown", number));
  }
  return found->second;
}

// G43, G44, G49 and H. Without Z the change of length moves Z where TOS is 0 (B-63943EN-1/02
// p. 1654).
void FanucMachine::set_length() {
  const FanucWord* H = word('H');
  if (!has(Group::length)) {
    if (H == nullptr) return;
    if (length_.mode != FanucLength::Mode::on) fail(H->column, "H requires an active G43");
    change_length(FanucLength::Mode::on, length_.sign, integer('H', 999), H->column);
    return;
  }
  const int at = column(Group::length);
  if (code(Group::length) == 490) {
    if (H != nullptr) fail(H->column, "H is not allowed in a block with G49");
    return change_length(FanucLength::Mode::off, 1.0, 0, at);
  }
  if (H == nullptr) fail(at, "G43 requires H");
  if (settings_.TLB && modes_.normal_axis != 2) {
    fail(at,
         "G43 requires G17: with No. 5001#1 (TLB) = 1 the length applies to an axis other than Z");
  }
  const double sign = (code(Group::length) == 430 ? 1.0 : -1.0) * rules_.G43_sign;
  change_length(FanucLength::Mode::on, sign, integer('H', 999), at);
}

void FanucMachine::change_length(FanucLength::Mode mode, double sign, int number, int column) {
  const std::optional<double> before = length_.acts;
  const double after = mode == FanucLength::Mode::on ? sign * length_of(number, column) : 0.0;
  length_ = {mode, sign, number, after, false};
  const int one_shot = code(Group::one_shot);
  const bool is_machine = one_shot == 530 || one_shot == 280 || one_shot == 300;
  if (is_machine && mode == FanucLength::Mode::on) {
    fail(column, "a tool length is not allowed in a block with G53, G28 or G30");
  }
  if (word('Z') != nullptr) {
    if (is_machine) return;
    if (!modes_.is_incremental) fail(column, "G90 or G91 must be active");
    if (*modes_.is_incremental)
      fail(column, "a change of the tool length under G91 depends on No. 5006#6 (TOS)");
    return;
  }
  if (is_machine) fail(column, "G49 with G53, G28 or G30 requires Z");
  const bool moves =
      mode == FanucLength::Mode::on ? rules_.G43_alone_moves_Z : rules_.G49_alone_moves_Z;
  if (before == after || settings_.TOS || !moves) return;
  if (!before) {
    fail(column,
         "moves Z by the change of the tool length with No. 5006#6 (TOS) = 0, and the previous "
         "length is unknown");
  }
  if (names_axis())
    fail(column, "a change of the tool length is not allowed in a block that moves other axes");
  if (!modes_.motion || *modes_.motion > 1)
    fail(column, "a change of the tool length requires G0 or G1");
  check_modes_of_motion();
  MachineAction out = action(*modes_.motion == 0 ? ActionKind::rapid : ActionKind::feed);
  out.is_commanded[2] = true;
  if (position_[2]) out.end[2] = *position_[2] + after - *before;
  if (*modes_.motion == 1) set_action_feed(out);
  move_to(out);
}

// G53, G28, G30 with Z: the vector is cancelled, the display stays (B-63844EN/02 p. 204).
void FanucMachine::suspend_length() {
  if (length_.mode == FanucLength::Mode::unknown) length_.acts = 0.0;
  if (length_.mode != FanucLength::Mode::on) return;
  length_.is_suspended = true;
  length_.acts = 0.0;
}

// Length with which an absolute Z is reached.
double FanucMachine::acting_length(int column) {
  if (length_.mode == FanucLength::Mode::unknown) {
    fail(column, "Z requires an active G43, G44 or G49");
  }
  const bool returns = settings_.EVO || !rules_.length_returns_only_with_EVO;
  if (length_.is_suspended && returns) {
    length_.is_suspended = false;
    length_.acts = length_.sign * length_of(*length_.number, column);
  }
  return *length_.acts;
}

}  // namespace servomill::controllers
