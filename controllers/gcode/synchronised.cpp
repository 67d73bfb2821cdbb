// G33 and G33.1: the axes follow the angle of the spindle.
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string_view>

#include "controllers/gcode/interpreter_machine.h"
#include "controllers/gcode/message_text.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr int kRigidTapping = 331;

}  // namespace

// The lead is that of the way, also where it is oblique.
void Interpreter::Machine::synchronised() {
  const int code = request().motion_code();
  const auto refuse = [&](std::string_view why) {
    fail(request().motion.column, fmt::format("{}{}", code_name('G', code), why));
  };
  if (!has_any_axis() && !request().has_polar()) refuse(" requires an axis word");
  if (!request().has('K')) {
    refuse(" requires K, the lead per revolution (F on Fanuc and Haas)");
  }
  if (request()['K'] == 0.0) refuse(" with K0; the lead must not be zero");
  if (request().has('F')) refuse(" does not accept F; the feed rate is K times the spindle speed");
  if (state_.spindle_direction == 0) refuse(" requires a running spindle; program M3 or M4 first");
  if (state_.spindle_speed == 0.0) refuse(" with zero spindle speed; no S is active");
  if (state_.feed_mode == FeedMode::inverse_time)
    refuse(" is not allowed with G93; program G94 first");
  if (state_.compensation.acts())
    refuse(" is not allowed with cutter compensation active; program G40 first");
  if (state_.controls_tip()) {
    refuse(" is not allowed under TCP control; cancel G43.4, G43.5 or G68.2 first");
  }
  const bool is_tap = code == kRigidTapping;
  for (int i = kLinearJoints; is_tap && i < kAxisWords; ++i) {
    if (has_axis(i)) refuse(" moves X, Y and Z only (LinuxCNC ignores rotary axis words)");
  }
  const AxisWords begin = state_.programmed(), end = programmed_end();
  const double length = (end - begin).head<3>().norm();
  if (!(length > 0.0)) refuse(" requires travel in X, Y or Z");
  note_height();
  const double lead = request()['K'] * state_.unit;
  const auto move_synchronised = [&](const AxisWords& to, Synchronised kind) {
    move_to(MoveKind::feed, to, length, 0.0);
    Move& move = out_.back();
    move.synchronised = kind;
    move.value = lead;
    move.feed_mode = FeedMode::units_per_minute;
    move.feed = std::abs(lead) * state_.spindle_speed / (2.0 * std::numbers::pi);
    move.path_mode = PathMode::exact_stop;
  };
  move_synchronised(end, is_tap ? Synchronised::tap_in : Synchronised::thread);
  if (is_tap) move_synchronised(begin, Synchronised::tap_out);
}

}  // namespace servomill::controllers
