// Modal functions, feeds, spindle, M functions.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "controllers/siemens/codes.h"
#include "controllers/siemens/translator.h"

namespace servomill::controllers::siemens {
namespace {

constexpr std::size_t at(Group group) { return static_cast<std::size_t>(group); }

int number_of(const Code& code) {
  int number = 0;
  std::from_chars(code.name.data() + 1, code.name.data() + code.name.size(), number);
  return number;
}

MotionCode motion_named(const std::string& name) {
  if (name == "G0") return MotionCode::rapid;
  if (name == "G1") return MotionCode::line;
  if (name == "G2") return MotionCode::clockwise;
  if (name == "G3") return MotionCode::counterclockwise;
  if (name == "CIP") return MotionCode::through_point;
  if (name == "CT") return MotionCode::tangential;
  return MotionCode::thread;
}

}  // namespace

void Translator::set_modes(const Block& block) {
  if (const Code* code = codes_[at(Group::units)]) set_units(*code);
  if (const Code* code = codes_[at(Group::plane)]) set_plane(*code);
  if (const Code* code = codes_[at(Group::distance)]) {
    modes_.is_incremental = code->name == "G91";
  }
  if (const Code* code = codes_[at(Group::feed)]) {
    set_feed_code(number_of(*code));
  }
  if (const Code* code = codes_[at(Group::contour_feed)]) {
    modes_.is_contour_feed = code->name == "CFC";
  }
  if (const Code* code = codes_[at(Group::work_offset)]) set_offset(*code);
  if (const Code* code = codes_[at(Group::path)]) set_path(*code);
  if (codes_[at(Group::exact_stop)] != nullptr) {
    warn_once("G9", "G9: non-modal exact stop is ignored; use G60");
  }
  if (codes_[at(Group::rapid)] != nullptr) {
    warn_once("RTLIOF", "RTLIOF: treated as RTLION, rapid moves in a straight line");
  }
  if (const Code* code = codes_[at(Group::compressor)]; code && code->name != "COMPOF") {
    warn_once(
        "compressor",
        code->name + ": linear blocks are not compressed; the CYCLE832 tolerance blends them");
  }
  if (const Code* code = codes_[at(Group::transformation)]) transform(*code);
  if (const Code* code = codes_[at(Group::cutter)]) set_side(block, *code);
  if (const Code* code = codes_[at(Group::motion)]) {
    modes_.motion = motion_named(code->name);
  }
  set_feed(block);
}

// G97 and G971 end a constant cutting speed and have the feed of G95 and G94, also without G96
// before them: Fundamentals 10.2004 (6FC5298-7AB00-0BP1) p. 7-40. G972 leaves it.
void Translator::set_feed_code(int number) {
  constexpr int kPerRevolution = 95, kPerMinute = 94;
  if (number == 972) return;
  if (number == 971) number = kPerMinute;
  if (number == 97) {
    number = kPerRevolution;
    if (modes_.feed_code != number) warn_once("G97", "G97: F is in mm/rev, as with G95");
  }
  if (number != modes_.feed_code) feed_.reset();
  modes_.feed_code = number;
}

void Translator::set_units(const Code& code) {
  const bool is_inch = code.name == "G70" || code.name == "G700";
  const bool is_feed_inch = code.name == "G700";
  if (is_feed_inch != modes_.is_feed_inch || is_inch != modes_.is_inch) feed_.reset();
  modes_.is_inch = is_inch;
  modes_.is_feed_inch = is_feed_inch;
  modes_.is_full_units = code.name.size() > 3;
}

void Translator::set_plane(const Code& code) {
  const int normal = 19 - number_of(code);
  if (normal == modes_.normal) return;
  require_no_compensation(code.name);
  modes_.normal = normal;
  pole_.reset();
  polar_angle_.reset();
  polar_radius_.reset();
  last_element_.reset();
}

void Translator::set_side(const Block& block, const Code& code) {
  const int side = code.name == "G41" ? 1 : code.name == "G42" ? -1 : 0;
  if (side != 0 && is_tcp_) fail(code.place, "G41 and G42 are not supported with TRAORI");
  if (side != 0 && edge_ == 0 && !block.D) {
    fail(code.place, fmt::format("{} with D0: no tool radius is active; program D1", code.name));
  }
  modes_.side = side;
}

void Translator::set_offset(const Code& code) {
  const int number = number_of(code);
  constexpr int kMax = 9;
  const int offset = number == 500 ? -1 : number < 500 ? number - 53 : number - 500;
  if (offset > kMax) {
    fail(code.place,
         fmt::format("{}: only G54 to G57 and G505 to G509 are supported, mapped to G54 to G59.3",
                     code.name));
  }
  if (offset == modes_.offset) return;
  require_no_compensation(code.name);
  modes_.offset = offset;
  put_offset(offset);
  forget_positions();
}

// G500 is a work offset of zero, G59.3, which G509 would be.
void Translator::put_offset(int offset) {
  constexpr int kLast = 9;
  const bool is_zero = offset == -1;
  const std::string key = is_zero ? "G500" : "G509";
  if (is_zero || offset == kLast) {
    if (warned_.contains(is_zero ? "used G509" : "used G500")) {
      fail("G500 and G509 in one program are not supported; use another work offset");
    }
    warned_.insert("used " + key);
  }
  if (is_zero) {
    note("G10 L2 P9 X0 Y0 Z0 A0 B0 C0 R0");
    warn_once("G500", "G500: the basic frame remains active and is assumed to be zero");
  }
  const int system = is_zero ? kLast : offset;
  note(system <= 6 ? fmt::format("G{}", 53 + system) : fmt::format("G59.{}", system - 6));
}

// G642 with CTOL; G641 with ADIS and G645 blend by other rules. The tolerance of CYCLE832 stays.
void Translator::set_path(const Code& code) {
  if (code.name == "G641" || code.name == "G642" || code.name == "G645") {
    warn_once(
        "smoothing",
        fmt::format(
            "{}: treated as G64: the smoothing tolerance is not evaluated; set it with CYCLE832",
            code.name));
  }
  use_path(code.name == "G60");
}

void Translator::use_path(bool stops_exactly) {
  modes_.stops_exactly = stops_exactly;
  is_programmed_[at(Group::path)] = true;
  note(stops_exactly ? "G61.1" : tolerance_line_);
}

// F of G70 counts in the basic unit of the machine: [F] "Inch or metric dimensions".
double Translator::unit_of_feed(const Place& place) {
  const auto is_metric = variables_.given("$MN_SCALING_SYSTEM_IS_METRIC");
  if (modes_.is_inch && !modes_.is_feed_inch && !is_metric) {
    const std::string why =
        "F with G70 is in the basic unit of the machine (MD10240), which is unknown here; pass "
        "--parameter '$MN_SCALING_SYSTEM_IS_METRIC=1' for mm/min, '=0' for inch/min, or program "
        "G700";
    if (!setup_.accepts_unknown_feeds) fail(place, why);
    warn_once("G70", why + "; the cycle time is unknown");
    return 0.0;
  }
  const bool is_inch = modes_.is_feed_inch || (!modes_.is_full_units && is_metric == 0.0);
  return is_inch ? 25.4 : 1.0;
}

// As programmed; a unit of 0 is unknown.
void Translator::set_feed(const Block& block) {
  if (block.OVR) set_override(*block.OVR);
  if (!block.F || block.has("G4")) return;
  const double F = block.F->value;
  if (!(F > 0.0)) fail(block.F->place, fmt::format("F{:g}: the feed rate must be > 0", F));
  if (path_.has_corner()) warn_of_corner();
  if (modes_.feed_code == 93) {
    feed_ = Feed{Feed::Kind::time, 60.0 / F};
    return;
  }
  feed_unit_ = unit_of_feed(block.F->place);
  feed_ =
      feed_unit_ == 0.0 ? Feed{Feed::Kind::unknown} : Feed{Feed::Kind::per_minute, F * feed_unit_};
}

// [F] "Programmable feedrate override"; the range: Feeds (V1), 6FC5397-0BP10-0BA0, p. 2-30
void Translator::set_override(const Number& OVR) {
  constexpr double kLargest = 200.0;
  if (!(OVR.value > 0.0 && OVR.value <= kLargest)) {
    fail(OVR.place, fmt::format("OVR={:g}: must be > 0 and <= 200", OVR.value));
  }
  override_ = OVR.value / 100.0;
}

// A feed with the revolutions of G95 and the override.
Feed Translator::effective(Feed feed, double override) const {
  if (feed.kind == Feed::Kind::time) feed.value /= override;
  if (feed.kind != Feed::Kind::per_minute) return feed;
  feed.value *= override;
  if (modes_.feed_code != 95) return feed;
  if (!speed_) fail("F with G95 requires an active S");
  if (!(*speed_ > 0.0)) fail("F with G95 requires S > 0");
  feed.value *= *speed_;
  return feed;
}

// Functions that no block has set act as the control is delivered: [F] "G commands", MD20150.
void Translator::warn_of_start(const Block&) {
  if (std::exchange(has_moved_, true)) return;
  std::string names;
  const std::pair<Group, std::string_view> all[] = {
      {Group::plane, "G17"}, {Group::distance, "G90"}, {Group::units, "G71"},
      {Group::feed, "G94"},  {Group::path, "G64"},     {Group::work_offset, "the work offset"}};
  for (const auto& [group, name] : all) {
    if (is_programmed_[at(group)]) continue;
    names += names.empty() ? "" : ", ";
    names += group == Group::work_offset
                 ? (setup_.work_system <= 6 ? fmt::format("G{}", 53 + setup_.work_system)
                                            : fmt::format("G59.{}", setup_.work_system - 6))
                 : std::string(name);
  }
  if (names.empty()) return;
  warn_once("start", fmt::format("a motion block precedes {}: assumed active at the start", names));
}

// ------------------------------------------------------------------------- spindle, M functions

void Translator::set_speed(const Block& block) {
  if (!block.S || block.has("G4") || block.has("G25") || block.has("G26")) return;
  const double S = block.S->value;
  if (S < 0.0) fail(block.S->place, "S must be >= 0");
  require_speed_in_limits(S, block.S->place);
  speed_ = S;
  note(word('S', S));
}

// G25 and G26 limit the working area, beyond which the control stops, and the speed of the spindle,
// which then turns slower or faster than programmed. [F] "Programmable spindle speed limitation"
void Translator::limit(const Block& block, const Code& code) {
  if (block.has_axes()) {
    warn_once("G25", "G25 and G26: limits of the working area are ignored");
  }
  if (!block.S) return;
  (code.name == "G25" ? least_speed_ : most_speed_) = block.S->value;
  if (speed_) require_speed_in_limits(*speed_, block.S->place);
}

void Translator::require_speed_in_limits(double S, const Place& place) const {
  const bool is_low = S > 0.0 && S < least_speed_;
  if (!is_low && S <= most_speed_) return;
  fail(place, fmt::format("S{:g} is {} the limit S{:g} of {}, to which the control clamps it; "
                          "program a speed within the limits",
                          S, is_low ? "below" : "above", is_low ? least_speed_ : most_speed_,
                          is_low ? "G25" : "G26"));
}

// SPOS and M19 leave the spindle still, in an orientation.
void Translator::orient_spindle() {
  warn_once("SPOS", "SPOS and M19: the spindle stops; its orientation is not simulated");
  turn_spindle(0);
}

// M functions of one group would cancel each other.
void Translator::require_one_of(const Block& block, std::initializer_list<int> group) const {
  const Function* first = nullptr;
  for (const Function& one : block.functions) {
    const bool is_of_group = std::find(group.begin(), group.end(), one.number) != group.end();
    if (!is_of_group || (one.spindle != -1 && one.spindle != 1)) continue;
    if (first == nullptr) first = &one;
    if (first->number == one.number) continue;
    fail(one.place, fmt::format("M{} and M{} in one block: they cancel each other", first->number,
                                one.number));
  }
}

void Translator::begin_functions(const Block& block) {
  require_one_of(block, {3, 4, 5, 19});
  require_one_of(block, {8, 9});
  require_one_of(block, {7, 9});
  if (block.SPOS) orient_spindle();
  if (path_.has_corner() && !block.functions.empty()) warn_of_corner();
  for (const Function& one : block.functions) begin_function(one);
}

void Translator::begin_function(const Function& one) {
  constexpr std::array kOfLanguage = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 17, 19, 30};
  if (one.number == 70) {
    fail(one.place, "M70: axis mode of the spindle is not supported; use a rotary axis");
  }
  if (std::find(kOfLanguage.begin(), kOfLanguage.end(), one.number) == kOfLanguage.end()) {
    const bool is_gear = one.number >= 40 && one.number <= 45;
    warn_once(fmt::format("M{}", one.number),
              fmt::format("M{} is ignored: {}; no effect on motion", one.number,
                          is_gear ? "gear stage selection" : "machine-builder function"));
    return;
  }
  const bool is_of_master = one.spindle == -1 || one.spindle == 1;
  if (!is_of_master) {
    warn_once("spindle",
              fmt::format("M{}={} is ignored: a further spindle", one.spindle, one.number));
    return;
  }
  const bool turns_on = one.number == 3 || one.number == 4;
  if (turns_on) {
    if (!speed_) fail(one.place, fmt::format("M{} requires S before it", one.number));
    spindle_ = one.number == 3 ? 1 : -1;
  }
  if (one.number == 19) orient_spindle();
  if (turns_on || one.number == 7 || one.number == 8) note(fmt::format("M{}", one.number));
}

void Translator::end_functions(const Block& block) {
  for (const Function& one : block.functions) {
    const bool is_of_master = one.spindle == -1 || one.spindle == 1;
    if (!is_of_master) continue;
    if (one.number == 5 || one.number == 9) {
      if (one.number == 5) spindle_ = 0;
      note(fmt::format("M{}", one.number));
    }
  }
  for (const Function& one : block.functions) {
    if (one.spindle != -1) continue;
    if (one.number == 0 || one.number == 1) note(fmt::format("M{}", one.number));
    const bool is_end = one.number == 2 || one.number == 17 || one.number == 30;
    if (!is_end) continue;
    if (!returns_.empty()) return leave_subprogram();
    return end_program(one.number == 17 ? 30 : one.number);
  }
}

// G4 F in seconds, G4 S in revolutions of the spindle: [F] "Dwell time".
void Translator::dwell(const Block& block) {
  if (block.F && block.S) fail("G4 accepts either F or S; program one of them");
  if (block.F) return dwell_for(block.F->value);
  if (!block.S) fail("G4 requires F or S");
  if (!speed_ || *speed_ <= 0.0) fail(block.S->place, "G4 S requires an active spindle speed S");
  dwell_for(block.S->value * 60.0 / *speed_);
}

void Translator::dwell_for(double seconds) {
  if (seconds < 0.0) fail(fmt::format("dwell time {:g} s; must be >= 0", seconds));
  if (seconds > 0.0) note("G4 " + word('P', seconds));
}

}  // namespace servomill::controllers::siemens
