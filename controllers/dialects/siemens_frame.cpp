#include "controllers/dialects/siemens_frame.h"

#include <fmt/format.h>

#include <cmath>

namespace servomill::controllers {
namespace {

constexpr int kLastOffset = 9;  // of ControlSetup

std::string name_of(int work_offset) {
  if (work_offset == 0) return "G500";
  return work_offset <= 4 ? fmt::format("G{}", 53 + work_offset)
                          : fmt::format("G{}", 500 + work_offset);
}

}  // namespace

SiemensFrame::SiemensFrame(const SiemensState& state, const SiemensBlock& block,
                           const SiemensContext& context)
    : state_(state), block_(block), context_(context) {
  is_of_machine_ = block.has(SiemensGroup::suppression);
  if (!is_of_machine_ || !context.rules.SUPA_suppresses_offset) read_offset();
}

void SiemensFrame::fail(std::string message) const {
  context_.fail(block_.line, block_.column, std::move(message));
}

void SiemensFrame::read_offset() {
  if (!state_.is_frame_clear) {
    fail("a programmable frame may be active; clear it with TRANS in a separate block");
  }
  if (!state_.work_offset) fail("no work offset is programmed; the active one is unknown");
  const int number = *state_.work_offset;
  if (number < 1 || number > kLastOffset) {
    fail(fmt::format("{}: the values of this work offset are unknown", name_of(number)));
  }
  const auto index = static_cast<std::size_t>(number - 1);
  const std::optional<AxisWords>& offset = context_.setup.work_offset[index];
  if (!offset) fail(fmt::format("{}: the values of this work offset are unknown", name_of(number)));
  offset_ = *offset;
  if (context_.rules.offset_rotates) rotation_ = context_.setup.work_rotation[index];
}

bool SiemensFrame::length_is_in_force() const {
  if (is_of_machine_ && context_.settings.SUPA_drops_length) return false;
  return state_.D != 0 && state_.tool != 0;
}

std::optional<int> SiemensFrame::axis_of_any_length() const {
  return context_.settings.length_follows_plane ? state_.normal_axis : std::optional<int>(2);
}

int SiemensFrame::length_axis() const {
  if (!length_is_in_force()) return -1;
  const std::optional<int> axis = axis_of_any_length();
  if (!axis) fail("the plane is unknown, so the axis of the tool length is unknown; program G17");
  return *axis;
}

double SiemensFrame::length(int axis) const {
  if (!is_linear(kAllAxes[static_cast<std::size_t>(axis)]) || axis != length_axis()) return 0.0;
  if (!state_.D) {
    fail(fmt::format("{} requires a tool length, but D is unknown here",
                     letter(kAllAxes[static_cast<std::size_t>(axis)])));
  }
  if (!state_.tool) fail(fmt::format("D{}: the tool in the spindle is unknown", *state_.D));
  if (*state_.D != 1) {
    fail(fmt::format("D{} of tool {}: only the length of D1 is known", *state_.D, *state_.tool));
  }
  const auto length = context_.setup.tool_length.find(*state_.tool);
  if (length == context_.setup.tool_length.end()) {
    fail(fmt::format("D1 of tool {}: its length is unknown", *state_.tool));
  }
  return context_.rules.length_is_added ? length->second : -length->second;
}

void SiemensFrame::to_machine(AxisWords& words, const std::array<bool, kAxisWords>& is_used) const {
  if (rotation_ != 0.0 && (is_used[0] || is_used[1])) {
    const double c = std::cos(rotation_), s = std::sin(rotation_);
    const double x = words[0], y = words[1];
    words[0] = c * x - s * y;
    words[1] = s * x + c * y;
  }
  for (int a = 0; a < kAxisWords; ++a) {
    if (is_used[static_cast<std::size_t>(a)]) words[a] += offset(a) + length(a);
  }
}

std::optional<double> SiemensFrame::program(const KnownPosition& machine, int axis) const {
  const auto shifted = [&](int a) {
    return *machine[static_cast<std::size_t>(a)] - offset(a) - length(a);
  };
  if (rotation_ == 0.0 || axis > 1) {
    if (!machine[static_cast<std::size_t>(axis)]) return std::nullopt;
    return shifted(axis);
  }
  if (!machine[0] || !machine[1]) return std::nullopt;
  const double c = std::cos(rotation_), s = std::sin(rotation_);
  return axis == 0 ? c * shifted(0) + s * shifted(1) : -s * shifted(0) + c * shifted(1);
}

}  // namespace servomill::controllers
