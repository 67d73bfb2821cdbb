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
    const int number = number_of(*code);
    if (number != modes_.feed_code) feed_.reset();
    modes_.feed_code = number;
  }
  if (const Code* code = codes_[at(Group::contour_feed)]) {
    modes_.is_contour_feed = code->name == "CFC";
  }
  if (const Code* code = codes_[at(Group::work_offset)]) set_offset(*code);
  if (const Code* code = codes_[at(Group::path)]) set_path(block, *code);
  if (codes_[at(Group::exact_stop)] != nullptr) {
    warn_once("G9", "G9: the exact stop at the end of single blocks is ignored; use G60");
  }
  if (codes_[at(Group::rapid)] != nullptr) {
    warn_once("RTLIOF", "RTLIOF: rapid moves are taken as straight lines, as with RTLION");
  }
  if (const Code* code = codes_[at(Group::compressor)]; code && code->name != "COMPOF") {
    warn_once("compressor",
              code->name + ": lines stay lines; the tolerance of CYCLE832 blends them");
  }
  if (const Code* code = codes_[at(Group::transformation)]) transform(*code);
  if (const Code* code = codes_[at(Group::cutter)]) set_side(block, *code);
  if (const Code* code = codes_[at(Group::motion)]) {
    modes_.motion = motion_named(code->name);
  }
  set_feed(block);
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
  if (side != 0 && is_tcp_) fail(code.place, "G41 and G42 with TRAORI are not supported");
  if (side != 0 && edge_ == 0 && !block.D) {
    fail(code.place, fmt::format("{} with D0: no tool radius is in force; program D1", code.name));
  }
  modes_.side = side;
}

void Translator::set_offset(const Code& code) {
  const int number = number_of(code);
  constexpr int kMax = 9;
  const int offset = number == 500 ? -1 : number < 500 ? number - 53 : number - 500;
  if (offset > kMax) {
    fail(code.place, fmt::format("{}: only G54 to G57 and G505 to G509 are supported, as the work "
                                 "offsets G54 to G59.3",
                                 code.name));
  }
  if (offset == modes_.offset) return;
  require_no_compensation(code.name);
  modes_.offset = offset;
  put_offset(offset);
  forget_linear_positions();
  for (std::size_t i = 3; i < work_.size(); ++i) work_[i].reset();
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
    warn_once("G500", "G500: the basic frame, which stays in force, is taken as zero");
  }
  const int system = is_zero ? kLast : offset;
  note(system <= 6 ? fmt::format("G{}", 53 + system) : fmt::format("G59.{}", system - 6));
}

// G642 with CTOL; G641 with ADIS and G645 blend by other rules.
void Translator::set_path(const Block&, const Code& code) {
  if (code.name == "G60") return note("G61.1");
  if (code.name == "G641" || code.name == "G642" || code.name == "G645") {
    warn_once("smoothing", fmt::format("{}: taken as G64: the tolerance is not read; CYCLE832 "
                                       "gives one",
                                       code.name));
  }
  note("G64");
}

// mm/min. F of G70 counts in the basic unit of the machine: [F] "Inch or metric dimensions".
void Translator::set_feed(const Block& block) {
  if (!block.F || block.has("G4")) return;
  const double F = block.F->value;
  if (!(F > 0.0)) fail(block.F->place, fmt::format("F{:g}: a feed must be > 0", F));
  if (modes_.feed_code == 93) {
    feed_ = Feed{Feed::Kind::time, 60.0 / F};
    return;
  }
  double unit_of_feed = modes_.is_feed_inch ? 25.4 : 1.0;
  const auto is_metric = variables_.given("$MN_SCALING_SYSTEM_IS_METRIC");
  if (!modes_.is_full_units && is_metric == 0.0) unit_of_feed = 25.4;
  if (modes_.is_inch && !modes_.is_feed_inch) {
    const std::string why =
        "F with G70: in the basic unit of the machine (MD10240), which is not in the program; "
        "pass --parameter '$MN_SCALING_SYSTEM_IS_METRIC=1' for mm/min, '=0' for inch/min, or "
        "program G700";
    if (!is_metric && !setup_.accepts_unknown_feeds) fail(block.F->place, why);
    if (!is_metric) {
      warn_once("G70", why + "; the cycle time stays unknown");
      feed_ = Feed{Feed::Kind::unknown};
      return;
    }
  }
  if (modes_.feed_code == 95) {
    if (!speed_ && !block.S) fail(block.F->place, "F with G95: no S is active");
    unit_of_feed *= block.S ? block.S->value : *speed_;
    if (!(unit_of_feed > 0.0)) fail(block.F->place, "F with G95: S must be > 0");
  }
  feed_ = Feed{Feed::Kind::per_minute, F * unit_of_feed};
}

// Functions that no block has set act as the control is delivered: [F] "G commands", MD20150.
void Translator::warn_of_start(const Block&) {
  if (std::exchange(has_moved_, true)) return;
  std::string names;
  const std::pair<Group, std::string_view> all[] = {{Group::plane, "G17"},
                                                    {Group::distance, "G90"},
                                                    {Group::units, "G71"},
                                                    {Group::work_offset, "the work offset"}};
  for (const auto& [group, name] : all) {
    if (is_programmed_[at(group)]) continue;
    names += names.empty() ? "" : ", ";
    names += group == Group::work_offset
                 ? (setup_.work_system <= 6 ? fmt::format("G{}", 53 + setup_.work_system)
                                            : fmt::format("G59.{}", setup_.work_system - 6))
                 : std::string(name);
  }
  if (names.empty()) return;
  warn_once("start", fmt::format("a move before any function of the groups of {}: taken as in "
                                 "force at the start",
                                 names));
}

// ------------------------------------------------------------------------- spindle, M functions

void Translator::set_speed(const Block& block) {
  if (!block.S || block.has("G4") || block.has("G25") || block.has("G26")) return;
  const double S = block.S->value;
  if (S < 0.0) fail(block.S->place, "S must be >= 0");
  if (modes_.feed_code == 95 && speed_ && feed_ && !block.F && *speed_ > 0.0 && S > 0.0) {
    feed_->value *= S / *speed_;  // mm per revolution stay
  }
  speed_ = S;
  note(word('S', S));
}

void Translator::begin_functions(const Block& block) {
  constexpr std::array kOfLanguage = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 17, 19, 30};
  for (const Function& one : block.functions) {
    if (one.number == 70) {
      fail(one.place, "M70: the spindle as an axis is not supported; use a rotary axis");
    }
    if (std::find(kOfLanguage.begin(), kOfLanguage.end(), one.number) == kOfLanguage.end()) {
      const bool is_gear = one.number >= 40 && one.number <= 45;
      warn_once(fmt::format("M{}", one.number),
                fmt::format("M{}: {}; ignored: no effect on motion", one.number,
                            is_gear ? "a gear stage" : "a function of the machine builder"));
      continue;
    }
    const bool is_of_master = one.spindle == -1 || one.spindle == 1;
    if (!is_of_master) {
      warn_once("spindle",
                fmt::format("M{}={}: a further spindle; ignored", one.spindle, one.number));
      continue;
    }
    if (one.number == 3 || one.number == 4) {
      if (!speed_) fail(one.place, fmt::format("M{}: no S before it", one.number));
      spindle_ = one.number == 3 ? 1 : -1;
      note(fmt::format("M{}", one.number));
    }
    if (one.number == 7 || one.number == 8) note(fmt::format("M{}", one.number));
  }
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
  if (block.F) return dwell_for(block.F->value);
  if (!block.S) fail("G4 without F or S");
  if (!speed_ || *speed_ <= 0.0) fail(block.S->place, "G4 S: no S is active");
  dwell_for(block.S->value * 60.0 / *speed_);
}

void Translator::dwell_for(double seconds) {
  if (seconds < 0.0) fail(fmt::format("a dwell of {:g} s", seconds));
  if (seconds > 0.0) note("G4 " + word('P', seconds));
}

}  // namespace servomill::controllers::siemens
