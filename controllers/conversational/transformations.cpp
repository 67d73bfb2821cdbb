// Coordinate transformations: cycles 7, 8, 10, 11, 19 and 247, TRANS DATUM, PLANE, M128.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "controllers/conversational/translator.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::conversational {
namespace {

std::optional<std::size_t> axis_of_word(const HeidenhainWord& word, bool& is_increment) {
  std::string_view address = word.address;
  is_increment = address.size() == 2 && address.front() == 'I';
  if (is_increment) address.remove_prefix(1);
  const auto axis = address.size() == 1 ? servomill::axis_of(address.front()) : std::nullopt;
  if (!axis) return std::nullopt;
  return static_cast<std::size_t>(index_of(*axis));
}

}  // namespace

void Translator::require_no_compensation(std::string_view what) {
  if (side_ != 0)
    fail(fmt::format("{} is not allowed with RL or RR active; program R0 first", what));
}

void Translator::set_frame(const Frame& frame) {
  if (frame == frame_) return;
  require_no_compensation("a change of the coordinate system");
  const std::string why = frame.ambiguity();
  if (!why.empty()) fail(why);
  frame_ = frame;
  pole_.reset();
  last_element_.reset();
}

// Values count from the preset, with I from the datum before. [407] p. 8-33
void Translator::datum_shift(const Cycle&, std::span<const HeidenhainWord> words) {
  Frame frame = frame_;
  for (const HeidenhainWord& word : words) {
    bool is_increment = false;
    const auto axis = axis_of_word(word, is_increment);
    if (!axis) {
      if (word.text.front() == '#')
        fail(word.place, "datum tables are not supported; program the shift");
      fail(word.place, fmt::format("'{}': expected an axis and its shift", word.text));
    }
    const double written = value(operand_of(word.rest, word.place)) * (*axis < 3 ? unit() : 1.0);
    frame.shift[*axis] = (is_increment ? frame.shift[*axis] : 0.0) + written;
  }
  const bool is_shifted =
      frame.shift != frame_.shift &&
      std::any_of(frame.shift.begin(), frame.shift.end(), [](double one) { return one != 0.0; });
  if (is_shifted && (frame.rotation != 0.0 || frame.is_any_mirrored() || frame.scale != 1.0)) {
    fail(
        "cycle 7 while cycle 8, 10 or 11 is active: the effect depends on the order; reset that "
        "cycle, program the shift, and define the cycle again");
  }
  set_frame(frame);
}

void Translator::trans_datum(Words& words) {
  if (words.take("DATUM") == nullptr) fail("TRANS must be followed by DATUM");
  if (words.take("RESET") != nullptr) {
    words.refuse_rest("TRANS DATUM RESET");
    Frame frame = frame_;
    frame.shift.fill(0.0);
    return set_frame(frame);
  }
  if (words.take("AXIS") == nullptr) fail("TRANS DATUM: only AXIS and RESET are supported");
  std::vector<HeidenhainWord> axes;
  while (const HeidenhainWord* word = words.take_next()) axes.push_back(*word);
  datum_shift({}, axes);
}

// CYCL DEF 8.1 X Y; without an axis it ends.
void Translator::mirror(std::span<const HeidenhainWord> words) {
  Frame frame = frame_;
  frame.is_mirrored.fill(false);
  for (const HeidenhainWord& word : words) {
    for (const char c : word.text) {
      const auto axis = servomill::axis_of(c);
      if (!axis) fail(word.place, fmt::format("'{}': expected axes", word.text));
      frame.is_mirrored[static_cast<std::size_t>(index_of(*axis))] = true;
    }
  }
  if (frame.is_mirrored[2]) fail("cycle 8: mirroring of the tool axis Z is not supported");
  set_frame(frame);
}

// CYCL DEF 10.1 ROT+35; IROT counts from the angle before.
void Translator::rotate(Words& words) {
  Frame frame = frame_;
  if (const auto ROT = words.take_number("ROT")) {
    frame.rotation = value(*ROT);
  } else if (const auto IROT = words.take_number("IROT")) {
    frame.rotation += value(*IROT);
  } else {
    fail("cycle 10: expected ROT with an angle");
  }
  words.refuse_rest("cycle 10");
  set_frame(frame);
}

void Translator::scale(Words& words) {
  Frame frame = frame_;
  const auto SCL = words.take_number("SCL");
  if (!SCL) fail("cycle 11: expected SCL with a factor");
  words.refuse_rest("cycle 11");
  frame.scale = value(*SCL);
  if (!(frame.scale > 0.0)) fail("cycle 11: the factor must be > 0");
  set_frame(frame);
}

// CYCL DEF 26.1 X 1 Y 1: factors of 1 end it. TNC 620 cycle programming (340 56x-02) p. 256
void Translator::scale_axes(Words& words) {
  for (const std::string_view axis : {"X", "Y", "Z", "CCX", "CCY"}) {
    const auto factor = words.take_number(axis);
    if (!factor || axis.starts_with("CC") || value(*factor) == 1.0) continue;
    fail(factor->place,
         fmt::format(
             "cycle 26: {} scaled by {:g}; only factors of 1, which cancel it, are supported", axis,
             value(*factor)));
  }
  words.refuse_rest("cycle 26");
}

// CYCL DEF 19.1 A+0 B+0 C+0, or without angles: ends the tilting, and no axis moves, but that with
// angles the machine may take rotary axes to zero that are not there. Other angles are spatial
// angles or those of the rotary axes, as MP7500 of the iTNC 530 has it (from memory).
void Translator::working_plane(Words& words) {
  std::optional<Operand> zero;
  for (const std::string_view axis : {"A", "B", "C"}) {
    const auto angle = words.take_number(axis);
    if (!angle) continue;
    if (value(*angle) == 0.0) {
      zero = zero ? zero : angle;
      continue;
    }
    if (can_leave_plane_unknown()) return survey_plane("cycle 19 with angles");
    fail(angle->place, fmt::format("cycle 19 with {}: a spatial angle or a rotary axis position, "
                                   "depending on MP7500; use PLANE SPATIAL",
                                   axis));
  }
  while (words.peek() != nullptr &&
         (words.peek()->address == "F" || words.peek()->address == "ABST" ||
          words.peek()->address == "SETUP")) {
    words.take_next();
  }
  words.refuse_rest("cycle 19");
  if (zero) require_rotary_zero(*zero);
  reset_plane("STAY");
}

void Translator::require_rotary_zero(const Operand& zero) {
  const bool may_turn = plane_ ? *plane_ != std::array<double, 3>{} : !rotary_axes_are_at_zero();
  if (!may_turn) return;
  const std::string why =
      "cycle 19 with angles of 0 while rotary axes are not at zero: some machines move them there, "
      "others do not; program cycle 19 without angles, then L";
  if (!can_leave_plane_unknown()) fail(zero.place, why);
  warn_once("cycle 19", why);
  for (std::size_t i = 3; i < work_.size(); ++i) work_[i].reset();
}

// Presets 1 to 9 are the work systems G54 to G59.3.
void Translator::set_preset(double number) {
  if (!(number >= 0.0 && number <= 9.0 && number == std::floor(number))) {
    fail(fmt::format("preset {:g}: only presets 1 to 9 are supported, mapped to G54 to G59.3",
                     number));
  }
  const bool is_manual = number == 0.0;
  if (is_manual ? names_preset_ : names_manual_datum_) {
    fail(
        "preset 0, the manually set datum, together with other presets: the offset between them is "
        "unknown; use presets 1 to 9");
  }
  (is_manual ? names_manual_datum_ : names_preset_) = true;
  if (is_manual) {
    warn_once(
        "preset 0",
        fmt::format(
            "preset 0, the manually set datum: treated as preset {}, which is active at the start",
            setup_.work_system));
  }
  const int preset = is_manual ? setup_.work_system : static_cast<int>(number);
  if (preset == preset_) return;
  require_no_compensation("cycle 247");
  if (plane_ || is_tcp_) fail("cycle 247 is not supported with PLANE or M128 active");
  preset_ = preset;
  note(preset <= 6 ? fmt::format("G{}", 53 + preset) : fmt::format("G59.{}", preset - 6));
  forget_linear_positions();
  for (std::size_t i = 3; i < work_.size(); ++i) work_[i].reset();
}

void Translator::forget_linear_positions() {
  for (std::size_t i = 0; i < 3; ++i) work_[i].reset();
  pole_.reset();
  last_element_.reset();
}

// Positions stay where nothing is turned.
void Translator::tcp_control(bool is_on) {
  if (is_on == is_tcp_) return;
  require_no_compensation("M128 or M129");
  if (is_on && plane_) fail("M128 is not supported in a tilted plane; program PLANE RESET first");
  if (is_on && delta_length_ != 0.0)
    fail("M128 with DL in TOOL CALL is not supported; enter the length in the tool table");
  if (is_on && !has_tool_call_)
    fail("M128 requires a preceding TOOL CALL: the tool length is unknown");
  is_tcp_ = is_on;
  path_.flush();
  lines_.put(fmt::format("{} H{}", is_on ? "G43.4" : "G43", tool_), place_);
  const bool is_at_zero = std::all_of(work_.begin() + 3, work_.end(), [](const auto& one) {
    return one.has_value() && *one == 0.0;
  });
  if (!is_at_zero) forget_linear_positions();
}

}  // namespace servomill::controllers::conversational
