// Cycles 7 to 11, 19, 26, 32 and 247, TRANS, PLANE and FUNCTION. The syntax is M.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "controllers/dialects/heidenhain_control.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::heidenhain {
namespace {

constexpr std::array<int, 8> kCycles = {7, 8, 9, 10, 11, 19, 26, 32};

struct CycleWord {
  int cycle = 0;
  int index = -1;  // -1 in the form without blocks: CYCL DEF 247
};

// "7.0", "247"
std::optional<CycleWord> parse_cycle(std::string_view text) {
  CycleWord word;
  std::size_t at = 0;
  while (at < text.size() && at < 3 && text[at] >= '0' && text[at] <= '9') {
    word.cycle = word.cycle * 10 + (text[at++] - '0');
  }
  if (at == 0) return std::nullopt;
  if (at == text.size()) return word;
  if (text[at] != '.' || at + 2 != text.size() || text[at + 1] < '0' || text[at + 1] > '9') {
    return std::nullopt;
  }
  word.index = text[at + 1] - '0';
  return word;
}

// "ROT+30", "ROT +30"
double cycle_value(const std::vector<HeidenhainWord>& words, std::string_view address,
                   const HeidenhainFormat& format, const Place& place) {
  const bool is_split = words.size() == 5 && words[3].text == address;
  const bool is_one = words.size() == 4 && words[3].address == address;
  if (!is_split && !is_one) {
    throw InputError(place, fmt::format("the cycle requires {} and a value", address));
  }
  const HeidenhainWord& word = words.back();
  return heidenhain_number(word, is_split ? word.text : word.rest, format);
}

}  // namespace

void Control::require_tilting(const Place& place, std::string_view what) const {
  if (!settings_.has_tilting) {
    fail(place, fmt::format("{}: a control without the tilting option rejects it", what));
  }
}

void Control::define_cycle(const HeidenhainBlock& block) {
  const Words& words = block.words;
  if (words.size() < 3 || words[1].text != "DEF") {
    fail(place_, "CYCL: only CYCL DEF with a number is covered by the verification");
  }
  const auto word = parse_cycle(words[2].text);
  if (!word) fail(words[2].place, fmt::format("'{}' is not a cycle number", words[2].text));
  const bool is_known = std::find(kCycles.begin(), kCycles.end(), word->cycle) != kCycles.end();
  if (word->cycle == 247 && word->index < 0) {
    finish(place_);
    cycle_.reset();
    return select_preset(words, place_);
  }
  if (!is_known || word->index < 0) {
    fail(words[2].place, fmt::format("cycle {}: not covered by the verification", words[2].text));
  }
  if (word->index == 0) return begin_cycle(word->cycle, block);
  continue_cycle(word->cycle, word->index, block);
}

void Control::begin_cycle(int cycle, const HeidenhainBlock& block) {
  finish(block.place);
  cycle_ = OpenCycle{cycle, 0, block.place};
}

void Control::continue_cycle(int cycle, int index, const HeidenhainBlock& block) {
  const int most = cycle == 7 ? 6 : cycle == 32 ? 2 : 1;
  if (!cycle_ || cycle_->number != cycle || index != cycle_->last + 1 || index > most) {
    fail(block.words[2].place, fmt::format("CYCL DEF {}.{} does not follow CYCL DEF {}.{}", cycle,
                                           index, cycle, std::min(index, most + 1) - 1));
  }
  cycle_->last = index;
  if (cycle == 7) return shift_datum(block.words, 3);
  if (cycle == 8) return mirror(block.words);
  if (cycle == 9) return dwell(block.words, block.place);
  if (cycle == 10) return rotate(block.words, block.place);
  if (cycle == 11) return scale(block.words, block.place);
  if (cycle == 19) return tilt(block.words);
  if (cycle == 26) return scale_axes(block.words);
  set_tolerance(index, block.words);
}

// Cycle 7, TRANS DATUM AXIS: counted from the preset, or from the shift before where incremental.
// Together with cycles 8 and 10 the order of definition matters, which is not covered.
void Control::shift_datum(const Words& words, std::size_t first) {
  if (words.size() <= first) fail(place_, "a datum shift requires an axis");
  for (std::size_t at = first; at < words.size(); ++at) {
    const HeidenhainWord& word = words[at];
    if (word.text.front() == '#') {
      fail(word.place, fmt::format("'{}': the datum table is unknown", word.text));
    }
    Positioning p;
    read_coordinate(word, p);
    for (std::size_t i = 0; i < p.target.size(); ++i) {
      if (!p.target[i].word) continue;
      double value = p.target[i].value * (rules_.shift_adds ? 1.0 : -1.0);
      if (p.target[i].is_increment || !rules_.shift_replaces_shift) {
        if (!state_.shift[i])
          fail(word.place, "an incremental shift requires a known previous shift");
        value += *state_.shift[i];
      }
      const bool is_changed = is_mirrored(0) || is_mirrored(1) || state_.rotation.value_or(0) != 0;
      if (value != 0.0 && is_changed) {
        fail(word.place, "a datum shift while cycle 8 or 10 is active is not covered");
      }
      state_.shift[i] = value;
    }
  }
  state_.pole.reset();
}

// CYCL DEF 8.1 X Y; without axes it ends the mirroring.
void Control::mirror(const Words& words) {
  std::array<bool, 3> axes{};
  for (std::size_t at = 3; at < words.size(); ++at) {
    const HeidenhainWord& word = words[at];
    if (word.text != "X" && word.text != "Y") {
      fail(word.place, fmt::format("cycle 8 with '{}': only X and Y are covered", word.text));
    }
    axes[word.text == "X" ? 0 : 1] = true;
  }
  state_.is_mirrored = axes;
  state_.pole.reset();
  if (!axes[0] && !axes[1]) return;
  const bool is_shifted = state_.shift[0].value_or(1.0) != 0.0 || state_.shift[1].value_or(1) != 0;
  const bool is_rotated = state_.rotation.value_or(1.0) != 0.0 ||
                          setup_.work_rotation[static_cast<std::size_t>(state_.preset)] != 0.0;
  if (is_shifted || is_rotated) {
    fail(place_, "cycle 8 while a datum shift or a rotation is active, or may be, is not covered");
  }
}

// CYCL DEF 10.1 ROT+30, about the datum, in degrees
void Control::rotate(const Words& words, const Place& place) {
  state_.rotation = cycle_value(words, "ROT", {360.0, 4, true}, place) * deg;
  state_.pole.reset();
  if (*state_.rotation == 0.0) return;
  const bool is_shifted = state_.shift[0].value_or(1.0) != 0.0 || state_.shift[1].value_or(1) != 0;
  const bool may_be_mirrored = !state_.is_mirrored || is_mirrored(0) || is_mirrored(1);
  if (is_shifted || may_be_mirrored) {
    fail(place, "cycle 10 while a datum shift or cycle 8 is active, or may be, is not covered");
  }
}

// CYCL DEF 11.1 SCL 1: which axes another factor acts on depends on MP7410. M
void Control::scale(const Words& words, const Place& place) {
  const double factor = cycle_value(words, "SCL", {99.999999, 6, true}, place);
  if (factor != 1.0) {
    fail(words.back().place,
         "cycle 11 with a factor other than 1 is not covered: the scaled axes depend on MP7410");
  }
  state_.is_scaled = false;
}

// CYCL DEF 26.1 X 1 Y 1: a factor of 1 ends the scaling of the same axis (TNC 620 cycle programming
// p. 256).
void Control::scale_axes(const Words& words) {
  if (words.size() <= 3) fail(place_, "cycle 26 requires an axis");
  for (std::size_t at = 3; at < words.size(); ++at) {
    const HeidenhainWord& word = words[at];
    const std::size_t axis = std::string_view("XYZ").find(word.address);
    if (word.address.size() != 1 || axis == std::string_view::npos) {
      fail(word.place, fmt::format("cycle 26 with '{}': only X, Y and Z are covered", word.text));
    }
    const bool is_split = word.rest.empty() && at + 1 < words.size();
    const HeidenhainWord& number = is_split ? words[++at] : word;
    const double factor =
        heidenhain_number(number, is_split ? number.text : number.rest, {99.999999, 6, true});
    if (factor != 1.0) fail(number.place, "cycle 26 with a factor other than 1 is not covered");
    state_.is_axis_scaling_off[axis] = true;
  }
}

// Cycle 19 ends with two definitions: all angles 0, then none.
void Control::tilt(const Words& words) {
  require_tilting(place_, "cycle 19");
  if (words.size() == 3) {
    if (!state_.has_tilt_angles_zero) {
      fail(place_, "cycle 19 without angles requires cycle 19 with angles of 0 first");
    }
    state_.is_tilted = false;
    return;
  }
  std::array<bool, 3> is_zero{};
  for (std::size_t at = 3; at < words.size(); ++at) {
    Positioning p;
    read_coordinate(words[at], p);
    for (std::size_t i = 3; i < 6; ++i) {
      if (p.target[i].word && p.target[i].value == 0.0) is_zero[i - 3] = true;
    }
  }
  if (words.size() != 6 || !is_zero[0] || !is_zero[1] || !is_zero[2]) {
    fail(place_, "cycle 19: only A+0 B+0 C+0, then no angle, is covered");
  }
  state_.has_tilt_angles_zero = true;
  state_.is_tilted.reset();
}

// CYCL DEF 9.1 DWELL 1.5, in seconds; the name depends on the language of the control.
void Control::dwell(const Words& words, const Place& place) {
  if (words.size() < 4) fail(place, "cycle 9 requires a time");
  const HeidenhainWord& word = words.back();
  const double time = heidenhain_number(word, word.rest, {3600.0, 3, true});
  if (time < 0.0) fail(word.place, fmt::format("'{}': the time must be >= 0", word.text));
  emit(ActionKind::dwell, place).value = time * (rules_.dwell_is_in_seconds ? 1.0 : ms);
}

// CYCL DEF 32.1 T0.05, CYCL DEF 32.2 HSC-MODE:1 TA0.5; without T the machine's own tolerance.
void Control::set_tolerance(int index, const Words& words) {
  if (index == 2) return;  // filters and the tolerance of rotary axes: no property of a motion
  if (words.size() == 3) {
    state_.is_path_mode_known = true;
    state_.path_tolerance.reset();
    return;
  }
  if (words.size() != 4 || words[3].address != "T")
    fail(place_, "cycle 32 requires T and a tolerance");
  const double value = heidenhain_number(words[3], words[3].rest, {99999.9999, 5, false}) * unit();
  if (!(value > 0.0)) fail(words[3].place, "cycle 32: the tolerance must not be 0");
  state_.is_path_mode_known = true;
  state_.path_tolerance = value;
}

// CYCL DEF 247 DATUM SETTING ~ Q339=+1: whether it also ends cycles 7 to 11 depends on the
// software, so that only what was reset before stays known.
void Control::select_preset(const Words& words, const Place& place) {
  const HeidenhainWord& word = words.back();
  if (words.size() < 4 || word.address != "Q" || word.rest.rfind("339=", 0) != 0) {
    fail(place, "cycle 247 requires Q339 and a preset number");
  }
  const std::string digits = word.rest.substr(4);
  const double number = heidenhain_number(word, digits, {99999.0, 0, true});
  const int index = static_cast<int>(number) - setup_.first_preset;
  const auto presets = static_cast<int>(setup_.work_offset.size());
  if (number < 0.0 || index < 0 || index >= presets) {
    fail(word.place,
         fmt::format("'{}': presets {} to {} are covered", word.text,
                     std::max(setup_.first_preset, 0), setup_.first_preset + presets - 1));
  }
  if (rules_.preset_changes_offset) state_.preset = index;
  for (auto& shift : state_.shift) {
    if (shift && *shift != 0.0) shift.reset();
  }
  if (is_mirrored(0) || is_mirrored(1)) state_.is_mirrored.reset();
  if (state_.rotation && *state_.rotation != 0.0) state_.rotation.reset();
  state_.pole.reset();
}

// TRANS DATUM RESET, TRANS DATUM AXIS X+10
void Control::run_trans(const HeidenhainBlock& block) {
  const Words& words = block.words;
  const bool is_datum = words.size() >= 3 && words[1].text == "DATUM";
  if (is_datum && words.size() == 3 && words[2].text == "RESET") {
    state_.shift.fill(0.0);
    state_.pole.reset();
    return;
  }
  if (is_datum && words[2].text == "AXIS") return shift_datum(words, 3);
  fail(place_, "TRANS: only TRANS DATUM RESET and TRANS DATUM AXIS are covered");
}

void Control::run_plane(const HeidenhainBlock& block) {
  const Words& words = block.words;
  require_tilting(place_, "PLANE");
  if (words.size() != 3 || words[1].text != "RESET" || words[2].text != "STAY") {
    fail(place_, "PLANE: only PLANE RESET STAY, which moves no axis, is covered");
  }
  state_.is_tilted = false;
  state_.pole.reset();
}

// FUNCTION RESET TCPM ends M128, too.
void Control::run_function(const HeidenhainBlock& block) {
  const Words& words = block.words;
  if (words.size() != 3 || words[1].text != "RESET" || words[2].text != "TCPM") {
    fail(place_, "FUNCTION: only FUNCTION RESET TCPM is covered by the verification");
  }
  require_tilting(place_, "FUNCTION RESET TCPM");
  state_.is_tcp_control = false;
}

}  // namespace servomill::controllers::heidenhain
