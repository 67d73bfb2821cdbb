// Frames of the program, poles, transformations; G4, G63 and what else takes the words of a block.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/siemens/codes.h"
#include "controllers/siemens/translator.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::siemens {

void Translator::require_no_compensation(std::string_view what) const {
  if (modes_.side == 0 && !path_.is_compensating()) return;
  fail(fmt::format(
      "{} is not allowed with G41 or G42 active; program G40 and a move in the plane first", what));
}

void Translator::forget_linear_positions() {
  for (std::size_t i = 0; i < 3; ++i) work_[i].reset();
  pole_.reset();
  polar_radius_.reset();
  polar_angle_.reset();
  last_element_.reset();
}

void Translator::forget_positions() {
  forget_linear_positions();
  for (std::size_t i = 3; i < work_.size(); ++i) work_[i].reset();
}

// Values of frames and poles are absolute, or count from what the function itself says.
void Translator::refuse_measures(const Block& block, const Code& code) const {
  const auto check = [&](const std::optional<Number>& number) {
    if (!number || number->measure == Measure::modal) return;
    fail(number->place, fmt::format("{} does not accept AC, IC, DC, ACP or ACN", code.name));
  };
  for (const auto& number : block.axes) check(number);
  check(block.AP);
}

// Returns true if the words of the block belong to a function that moves nothing.
bool Translator::act(const Block& block) {
  const Code* code = codes_[static_cast<std::size_t>(Group::action)];
  if (code == nullptr) return false;
  if (code->name == "G63") return false;
  if (code->name == "G4") {
    if (moves(block)) fail(code->place, "G4 must be in a block without axis words");
    dwell(block);
  } else if (code->name == "G25" || code->name == "G26") {
    limit(block, *code);
  } else if (code->name.starts_with("G11")) {
    pole(block, *code);
  } else {
    set_frame(block, *code);
  }
  return true;
}

// TRANS, ROT, SCALE and MIRROR replace the whole programmable frame, ATRANS, AROT, ASCALE and
// AMIRROR add to it in its own coordinates; without words they delete it. [F] "Frame instructions"
void Translator::set_frame(const Block& block, const Code& code) {
  require_no_compensation(code.name);
  refuse_measures(block, code);
  const bool is_additive = code.name.front() == 'A';
  const std::string name = is_additive ? code.name.substr(1) : code.name;
  const bool has_words = block.has_axes() || block.RPL;
  if (is_additive && !has_words) fail(code.place, fmt::format("{} requires an axis", code.name));
  Frame frame = is_additive ? modes_.frame : Frame{};
  if (name == "ROT") {
    rotate_frame(block, frame);
    return use_frame(frame);
  }
  for (std::size_t i = 3; i < block.axes.size(); ++i) {
    if (block.axes[i]) set_rotary(frame, name, i, *block.axes[i]);
  }
  set_linear(frame, name, block);
  use_frame(frame);
}

void Translator::set_rotary(Frame& frame, const std::string& name, std::size_t axis,
                            const Number& number) {
  if (name == "TRANS") {
    frame.translate_rotary(axis, number.value);
  } else if (name == "MIRROR") {
    frame.mirror_rotary(axis);
  } else {
    fail(number.place, "SCALE of a rotary axis is not supported");
  }
}

void Translator::set_linear(Frame& frame, const std::string& name, const Block& block) {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero(), factor = Eigen::Vector3d::Ones();
  for (int i = 0; i < 3; ++i) {
    const auto& number = block.axes[static_cast<std::size_t>(i)];
    if (!number) continue;
    shift[i] = number->value * unit();
    factor[i] = number->value;
    if (name == "MIRROR") frame.mirror(i);
    if (name == "SCALE" && !(number->value > 0.0)) {
      fail(number->place, "SCALE: the factor must be > 0");
    }
  }
  if (name == "TRANS") frame.translate(shift);
  if (name == "SCALE") frame.scale(factor);
}

// RPL turns about the axis across the plane; angles of X, Y, Z turn about Z first, then about the
// new Y and the new X (MD10600 = 1, RPY, as delivered). [F] "Programmable rotation"
void Translator::rotate_frame(const Block& block, Frame& frame) {
  if (block.RPL) {
    if (block.has_axes()) fail("ROT does not accept both RPL and axis words");
    return frame.rotate(modes_.normal, block.RPL->value);
  }
  int angles = 0;
  for (const int axis : {2, 1, 0}) {
    const auto& angle = block.axes[static_cast<std::size_t>(axis)];
    if (!angle) continue;
    frame.rotate(axis, angle->value);
    ++angles;
  }
  if (angles > 1 && setting("$MN_FRAME_ANGLE_INPUT_MODE", 1.0) != 1.0) {
    fail("ROT with several angles as Euler angles (MD10600 = 2) is not supported");
  }
  if (angles > 1) {
    warn_once("ROT",
              "ROT with several angles: treated as RPY angles, about Z, the new Y, the new X "
              "(MD10600 = 1)");
  }
  if (block.axes[3] || block.axes[4] || block.axes[5]) fail("ROT accepts only angles X, Y and Z");
}

void Translator::use_frame(const Frame& frame) {
  if (frame == modes_.frame) return;
  modes_.frame = frame;
  pole_.reset();
  polar_angle_.reset();
  last_element_.reset();
}

// G110: from the position programmed last, G111: from the origin of the workpiece, G112: from the
// last pole. [F] "Defining the pole"
Point Translator::pole_origin(const Code& code) {
  if (code.name == "G112") {
    if (!pole_) fail(code.place, "G112 requires a pole");
    return *pole_;
  }
  if (code.name != "G110") return Point::Zero();
  const auto now = program_point(modes_.normal);
  if (!now) fail(code.place, "G110: the position in the plane is unknown here");
  for (const std::size_t axis : plane_axes(modes_.normal)) {
    require_same_offset(axis, {0.0, Measure::incremental, code.place});
  }
  return *now;
}

void Translator::pole(const Block& block, const Code& code) {
  refuse_measures(block, code);
  const Point from = pole_origin(code);
  polar_angle_.reset();
  pole_ = from + (block.is_polar() ? polar_pole(block, code) : cartesian_pole(block, code));
}

Point Translator::polar_pole(const Block& block, const Code& code) {
  polar_radius_.reset();  // whether it is that of the pole from here on is not in the manual
  if (block.has_axes()) {
    fail(code.place, fmt::format("{} accepts either AP and RP or axis words, not both", code.name));
  }
  if (!block.AP || !block.RP) fail(code.place, fmt::format("{} requires AP and RP", code.name));
  const double angle = block.AP->value * deg;
  return block.RP->value * unit() * Point(std::cos(angle), std::sin(angle));
}

Point Translator::cartesian_pole(const Block& block, const Code& code) {
  const auto axes = plane_axes(modes_.normal);
  Point out = Point::Zero();
  for (std::size_t i = 0; i < block.axes.size(); ++i) {
    if (!block.axes[i]) continue;
    if (i != axes[0] && i != axes[1]) {
      fail(block.axes[i]->place,
           fmt::format("{}: the pole must be in the plane of G{}", code.name, 19 - modes_.normal));
    }
    out[i == axes[0] ? 0 : 1] = block.axes[i]->value * unit();
  }
  return out;
}

// TRAORI: positions are those of the tip whatever the rotary axes do.
void Translator::transform(const Code& code) {
  const bool is_on = code.name == "TRAORI";
  if (is_on == is_tcp_) return;
  require_no_compensation(code.name);
  if (!plane_line_.empty())
    fail(code.place, "TRAORI is not allowed in a plane of CYCLE800; program CYCLE800() first");
  if (!modes_.frame.is_plain()) {
    fail(code.place, fmt::format("{} with TRANS, ROT, SCALE or MIRROR active: MD10602 determines "
                                 "whether the frame is deleted; cancel it with TRANS first",
                                 code.name));
  }
  if (is_on && !has_tool_ && tool_ == 0) {
    fail(code.place, "TRAORI requires a preceding tool change: the tool length is unknown");
  }
  warn_once("TRAORI", "TRAORI and TRAFOOF: the work offset remains active (MD10602 may delete it)");
  is_tcp_ = is_on;
  path_.flush();
  put_length();
  const bool is_at_zero = std::all_of(work_.begin() + 3, work_.end(), [](const auto& one) {
    return one.has_value() && *one == 0.0;
  });
  if (!is_at_zero) forget_linear_positions();
}

}  // namespace servomill::controllers::siemens
