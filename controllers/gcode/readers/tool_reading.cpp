// H and D in blocks of their own, and S as the power of a laser.
#include <fmt/format.h>

#include "controllers/gcode/readers/reading_step.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr int kPowerChanges = 8;  // feeds that change S, beyond which it is no speed of a spindle

}  // namespace

// G234 H1: the tip is controlled, and the rotary axes turn the workpiece with its origin.
void ReadingStep::tip_control_of_haas() {
  BlockWord* code = words.code('G', 2340);
  if (code == nullptr) return;
  need(ReaderRule::haas_tip_control, code->column);
  if (!words.has('H')) fail(code->column, "G234 requires H, the number of the tool length offset");
  code->value = 43.4;
  code->is_changed = true;
}

// Fanuc keeps H; G43 H0 is no length there, and the length of the tool in the spindle here.
void ReadingStep::length_offset() {
  tip_control_of_haas();
  BlockWord* G43 = words.code('G', 430);
  const BlockWord* H = words.find('H');
  const bool is_other =
      words.has_code('G', 432) || words.has_code('G', 434) || words.has_code('G', 435);
  if (is_other) return;
  if (H != nullptr && G43 == nullptr && !words.has_code('G', 490)) {
    need(ReaderRule::modal_length_offset, H->column);
    memory.length_offset = H->value;
    if (state.tool_offset_number == 0) return words.erase('H');
    words.add('G', 43.0, H->column);
    G43 = words.code('G', 430);
    H = words.find('H');
  }
  if (H != nullptr && G43 == nullptr) {  // beside G49
    need(ReaderRule::modal_length_offset, H->column);
    memory.length_offset = H->value;
    return words.erase('H');
  }
  if (G43 == nullptr) return;
  if (H == nullptr && memory.length_offset) {
    words.add('H', *memory.length_offset, G43->column);
    G43 = words.code('G', 430);
    H = words.find('H');
  }
  if (H == nullptr || H->value != 0.0) return;
  if (choose(WordDifference::length_offset_zero, H->column) == 0) return;
  G43->value = 49.0;
  G43->is_changed = true;
  words.erase('H');
}

void ReadingStep::diameter_offset() {
  BlockWord* on = words.code('G', 410);
  if (on == nullptr) on = words.code('G', 420);
  const BlockWord* D = words.find('D');
  const bool is_other = words.has_code('G', 411) || words.has_code('G', 421);
  if (is_other) return;
  if (D != nullptr && on == nullptr) {
    if (state.compensation.is_on && !words.has_code('G', 400)) {
      fail(D->column, "D is not allowed with cutter compensation active; program G40 first");
    }
    need(ReaderRule::modal_diameter_offset, D->column);
    memory.diameter_offset = D->value;
    return words.erase('D');
  }
  if (on == nullptr) return;
  if (D != nullptr) memory.diameter_offset = D->value;
  if (memory.diameter_offset && *memory.diameter_offset != 0.0) {
    if (D == nullptr) words.add('D', *memory.diameter_offset, on->column);
    return;
  }
  if (choose(WordDifference::missing_diameter_offset, on->column) == 0) return;
  words.erase('D');
  words.erase(*words.code('G', tenths_of(on->value)));
}

// M4 S0, and then S500: the beam is switched by S. A spindle is switched on with its speed.
void ReadingStep::idle_beam() {
  const bool is_on = words.has_code('M', 30) || words.has_code('M', 40);
  if (is_on || words.has_code('M', 50)) memory.is_idle_beam = false;
  if (!words.has('S')) return;
  if (is_on) memory.is_idle_beam = words['S'] == 0.0;
  if (is_on || !memory.is_idle_beam || words['S'] == 0.0) return;
  fail(words.column('S'),
       "S after M3 S0 or M4 S0 without another M3 or M4: a laser power; only milling programs are "
       "supported");
}

// A laser's power follows the path; the speed of a spindle does not.
void ReadingStep::laser_power() {
  idle_beam();
  const int motion = motion_in_block();
  const bool is_feed = motion == 10 || motion == 20 || motion == 30;
  if (!is_feed || !words.has('S') || !words.has_axis()) return;
  if (words.has('M')) memory.power_changes = 0;
  if (words.has('M') || words['S'] * rpm == state.spindle_speed) return;
  if (++memory.power_changes == 1) {
    reading_.notes_.push_back({words.column('S'),
                               "S changes in a feed move without M3 or M4: read as a spindle "
                               "speed; a laser power would give the same motion"});
  }
  if (memory.power_changes < kPowerChanges) return;
  fail(words.column('S'),
       "S changes from move to move: a laser power; only milling programs are supported");
}

}  // namespace servomill::controllers
