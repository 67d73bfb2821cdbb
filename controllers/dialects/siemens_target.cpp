#include "controllers/dialects/siemens_target.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "plant/vocabulary/units.h"

namespace servomill::controllers {

char siemens_axis_letter(int axis) { return letter(kAllAxes[place_of(axis)]); }

void SiemensTarget::fail(int column, std::string message) const {
  context_.fail(block_.line, column, std::move(message));
}

double SiemensTarget::unit_of(int axis, int column) const {
  if (!is_linear_axis(axis)) return deg;
  if (!state_.units) fail(column, "the unit system is unknown; program G710 or G700");
  return state_.units->length;
}

void SiemensTarget::read() {
  for (int a = 0; a < kAxisWords; ++a) {
    if (!block_.axes[place_of(a)]) continue;
    const SiemensNumber& word = *block_.axes[place_of(a)];
    const double value = word.value * unit_of(a, word.column);
    is_used[place_of(a)] = true;
    words[a] = is_incremental(word, siemens_axis_letter(a))
                   ? start_of_increment(a, word.column) + value
                   : angle_of(a, word.form, value);
  }
  is_commanded = is_used;
  complete_rotated_plane();
}

// Absolute position of an axis; that of a modulo axis in the turn in which it arrives.
double SiemensTarget::angle_of(int a, SiemensForm form, double value) const {
  constexpr double kTurn = 2.0 * std::numbers::pi, kRounding = 1e-9;  // rad
  if (is_linear_axis(a) || !context_.settings.is_modulo[place_of(a - 3)]) return value;
  const double angle = value - std::floor(value / kTurn) * kTurn;
  const std::optional<double> start = frame_.program(state_.position, a);
  if (!start) return value;  // the count of turns begins here
  const bool is_AC = form == SiemensForm::absolute && context_.rules.AC_is_not_shortest;
  if (context_.settings.G90_is_shortest && !is_AC) {
    return *start + std::remainder(angle - *start, kTurn);
  }
  return std::floor((*start + kRounding) / kTurn) * kTurn + angle;
}

bool SiemensTarget::is_incremental(const SiemensNumber& word, char name) const {
  bool incremental = word.form == SiemensForm::incremental;
  if (word.form == SiemensForm::number) {
    if (!state_.is_incremental) fail(word.column, "G90 or G91 must be active");
    incremental = *state_.is_incremental;
  }
  if (incremental && frame_.is_of_machine()) {
    fail(word.column, fmt::format("{}: SUPA requires absolute positions", name));
  }
  return incremental;
}

// SD42440 and SD42442 decide whether an increment carries a new offset along; without a new one
// nothing depends on them. [K2] p. 1-7
double SiemensTarget::start_of_increment(int a, int column) const {
  const std::optional<double> start = frame_.program(state_.position, a);
  if (!start)
    fail(column, fmt::format("an incremental coordinate requires a known position of {}",
                             siemens_axis_letter(a)));
  const bool is_same = state_.frame_shift[place_of(a)] == frame_.offset(a) &&
                       state_.length_shift[place_of(a)] == frame_.length(a);
  if (!is_same && context_.rules.increment_needs_same_offset) {
    fail(column, fmt::format("an increment of {} after a change of work offset or tool length: "
                             "settings determine whether it includes the change",
                             siemens_axis_letter(a)));
  }
  return *start;
}

// Under a rotated work offset X moves both axes of the machine.
void SiemensTarget::complete_rotated_plane() {
  if (frame_.rotation() == 0.0 || !(is_used[0] || is_used[1])) return;
  for (const int a : {0, 1}) {
    if (!is_used[place_of(a)]) add_start(a);
  }
  is_commanded[0] = is_commanded[1] = true;
}

void SiemensTarget::add_start(int a) {
  const std::optional<double> start = frame_.program(state_.position, a);
  if (!start)
    fail(block_.column, fmt::format("the position of {} is unknown", siemens_axis_letter(a)));
  words[a] = *start;
  is_used[place_of(a)] = true;
}

}  // namespace servomill::controllers
