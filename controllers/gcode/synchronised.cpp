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

void Interpreter::Machine::require_synchronised() const {
  const Request::Chosen& chosen = request().motion;
  const int code = request().motion_code();
  const auto refuse = [&](std::string_view why) {
    fail(chosen.column, fmt::format("{}{}", code_name('G', code), why));
  };
  if (!has_any_axis() && !request().has_polar()) refuse(" without an axis word");
  if (!request().has('K')) {
    refuse(" without K, the lead in a revolution (Fanuc and Haas give it as F)");
  }
  if (request()['K'] == 0.0) refuse(" with K0; the lead must not be zero");
  if (request().has('F')) refuse(" with F; the feed is K times the speed of the spindle");
  if (state_.spindle_direction == 0) refuse(" while the spindle stands still; M3 or M4 first");
  if (state_.spindle_speed == 0.0) refuse(" with zero spindle speed; no S is active");
  if (state_.feed_mode == FeedMode::inverse_time) refuse(" with G93; G94 first");
  if (state_.compensation.acts()) refuse(" with cutter compensation active; G40 first");
  if (state_.controls_tip()) {
    refuse(" while the TCP is controlled; end G43.4, G43.5 or G68.2 first");
  }
  for (int i = kLinearJoints; code == kRigidTapping && i < kAxisWords; ++i) {
    if (has_axis(i)) refuse(" moves X, Y and Z only (LinuxCNC drops the words of rotary axes)");
  }
}

// The lead is that of the way, also where it is oblique.
void Interpreter::Machine::synchronised() {
  require_synchronised();
  const bool is_tap = request().motion_code() == kRigidTapping;
  const AxisWords begin = state_.programmed(), end = programmed_end();
  const double length = (end - begin).head<3>().norm();
  if (!(length > 0.0)) {
    fail(request().motion.column,
         fmt::format("{} has no travel of X, Y or Z", code_name('G', request().motion_code())));
  }
  note_height();
  const double lead = request()['K'] * state_.unit;
  synchronised_to(end, length, lead, is_tap ? Synchronised::tap_in : Synchronised::thread);
  if (is_tap) synchronised_to(begin, length, lead, Synchronised::tap_out);
}

void Interpreter::Machine::synchronised_to(const AxisWords& end, double length, double lead,
                                           Synchronised kind) {
  move_to(MoveKind::feed, end, length, 0.0);
  Move& move = out_.back();
  move.synchronised = kind;
  move.value = lead;
  move.feed_mode = FeedMode::units_per_minute;
  move.feed = std::abs(lead) * state_.spindle_speed / (2.0 * std::numbers::pi);
  move.path_mode = PathMode::exact_stop;
}

}  // namespace servomill::controllers
