// G28, G30, G53, G92.1 and G10: places of the machine and offsets.
#include <fmt/format.h>

#include <cmath>

#include "controllers/gcode/parameters.h"
#include "controllers/gcode/readers/reading_step.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {

// G0 G28 Z0: the axis words belong to G28.
void ReadingStep::home() {
  const BlockWord* G30 = words.code('G', 300);
  const BlockWord* code = words.has_code('G', 280) ? words.code('G', 280)
                          : G30 != nullptr         ? G30
                                                   : words.code('G', 920);
  if (words.has_code('G', 281)) {
    if (choose(WordDifference::stored_home, words.code('G', 281)->column) == 0) return;
    fail(words.code('G', 281)->column,
         "G28.1: homing is not simulated; use G53 for a machine position");
  }
  if (code == nullptr) return;
  if (G30 != nullptr && words.has('P')) {
    if (words['P'] != 2.0) {
      fail(words.column('P'),
           fmt::format("G30 P{}: the position is unknown here; use G53", words['P']));
    }
    need(ReaderRule::second_home_number, words.column('P'));
    words.erase('P');
  }
  const int motion = motion_code();
  if (motion < 0 || motion == 800) return;
  need(ReaderRule::home_with_motion, words.code('G', motion)->column);
  if (motion <= 30) leave_cycle();
  words.erase(*words.code('G', motion));
  memory.pending_motion = motion;
  memory.is_pending_known = true;
}

// G91 G28 X0 Z100. G90: a survey leaves out the intermediate point. True if the block was one.
bool ReadingStep::distances_of_home(const BlockWord& word) {
  if (!words.has_code('G', 280) && !words.has_code('G', 300)) return false;
  const std::string why =
      "G90 and G91 with G28 or G30: it is undocumented which one applies to the intermediate "
      "point; use two blocks";
  if (!options.accepts_unknown_positions) fail(word.column, why);
  reading_.notes_.push_back({word.column, why + "; omitted here"});
  const bool ends_incremental = tenths_of(word.value) == 910;
  for (const Axis axis : kAllAxes) {
    if (words.has(letter(axis))) words.set(letter(axis), 0.0);
  }
  before.emplace_back("G91");
  behind.emplace_back(ends_incremental ? "G91" : "G90");
  for (BlockWord& one : words.all()) {
    const int tenths = one.letter == 'G' ? tenths_of(one.value) : -1;
    if (tenths == 900 || tenths == 910) words.erase(one);
  }
  return true;
}

// G28 G91 Z0 under G43.4: the axes go where G28 sends them, and then the tip is controlled again.
// Switching the control of the tip moves no axis.
void ReadingStep::home_under_tip_control() {
  if (state.tool_control != ToolControl::rotary_axes || !is_incremental()) return;
  const BlockWord* code = words.code('G', 280);
  if (code == nullptr) code = words.code('G', 300);
  if (code == nullptr || !words.has_axis() || state.plane) return;
  for (const Axis axis : kAllAxes) {
    if (words.has(letter(axis)) && words[letter(axis)] != 0.0) return;
  }
  need(ReaderRule::home_under_tip_control, code->column);
  before.emplace_back("G49");
  behind.push_back(fmt::format("G43.4 H{}", state.tool_offset_number));
}

// G28.2 X0 Y0: one axis after the other, Z first, to machine zero.
void ReadingStep::homing_cycle() {
  BlockWord* code = words.code('G', 282);
  if (code == nullptr) return;
  need(ReaderRule::homing_cycle, code->column);
  for (const char axis : {'Z', 'X', 'Y', 'A', 'B', 'C'}) {
    if (!words.has(axis)) continue;
    behind.push_back(fmt::format("G90 G53 G0 {}0", axis));
    words.erase(axis);
  }
  if (behind.empty()) fail(code->column, "G28.2 requires an axis word");
  if (is_incremental()) behind.emplace_back("G91");
  words.erase(*words.code('G', 282));
  if (memory.pending_motion < 0 && state.motion <= 30) memory.pending_motion = state.motion;
  memory.is_pending_known = true;
}

// G53 alone, and then X1: a place of the machine only where G53 is modal, unless a work offset
// came between.
void ReadingStep::machine_coordinates() {
  BlockWord* code = words.code('G', 530);
  constexpr auto kDifference = WordDifference::lone_machine_coordinates;
  if (has_work_offset()) memory.lone_G53_line = 0;
  if (code == nullptr) {
    if (memory.lone_G53_line == 0 || !words.has_axis()) return;
    if (!chosen_reading(kDifference, memory.lone_G53_column)) {
      throw InputError({file_, memory.lone_G53_line, memory.lone_G53_column},
                       both_readings(kDifference));
    }
    memory.lone_G53_line = 0;
    return;
  }
  if (words.has_axis() && is_incremental()) {
    fail(code->column,
         "G53 with G91: a machine position (an error on LinuxCNC), or a distance (Mitsubishi M700V "
         "p. 508); program G90");
  }
  if (words.has_axis()) return;
  if (!has_work_offset()) {
    memory.lone_G53_line = block_.line;
    memory.lone_G53_column = code->column;
  }
  words.erase(*code);
}

bool ReadingStep::has_work_offset() const {
  for (const BlockWord& word : words.all()) {
    const int tenths = word.letter == 'G' ? tenths_of(word.value) : -1;
    if ((tenths >= 540 && tenths <= 593) || tenths == 1540) return true;
  }
  return false;
}

// G92.1 X0: of Fanuc the shift of the axes named goes, of LinuxCNC all of it.
void ReadingStep::presets() {
  BlockWord* code = words.code('G', 921);
  if (code == nullptr || !words.has_axis()) return;
  bool covers_all = true;
  for (int i = 0; i < kAxisWords; ++i) {
    const char axis = letter(kAllAxes[static_cast<std::size_t>(i)]);
    if (words.has(axis) && words[axis] != 0.0) {
      fail(words.column(axis), fmt::format("G92.1 {}{}; must be 0", axis, words[axis]));
    }
    covers_all = covers_all && (words.has(axis) || state.shift[i] == 0.0);
  }
  if (!covers_all && choose(WordDifference::preset_words, code->column) == 1) {
    code->value = 52.0;
    code->is_changed = true;
    return;
  }
  for (const Axis axis : kAllAxes) words.erase(letter(axis));
}

// G10 L10 P H-number R: a length offset; G10 L20 P: an offset of G54.1.
void ReadingStep::inputs() {
  const BlockWord* code = words.code('G', 100);
  if (code == nullptr || !words.has('L')) return;
  const int L = static_cast<int>(std::lround(words['L']));
  if (L == 2) return system_input(code->column);
  if (L == 10 || L == 11) {
    if (choose(WordDifference::tool_table_input, words.column('L')) == 0) return;
    if (L == 11 || is_incremental() || !words.has('R')) {
      fail(words.column('L'),
           "G10 L11 and G10 L10 with G91 add to an unknown offset; use G10 L10 with G90");
    }
    words.set('L', 1.0);
    words.add('Z', words['R'], words.column('R'));
    return words.erase('R');
  }
  if (L == 12 || L == 13) {
    fail(words.column('L'), fmt::format("G10 L{}: a control parameter determines whether R is a "
                                        "radius or a diameter; use a tool table",
                                        L));
  }
  if (L != 20 || choose(WordDifference::work_offset_input, words.column('L')) == 0) return;
  if (!words.has('P') || is_incremental()) {
    fail(words.column('L'), "G10 L20 of Fanuc requires P and G90");
  }
  AxisWords& offset = memory.additional_offsets
                          .try_emplace(static_cast<int>(std::lround(words['P'])), AxisWords::Zero())
                          .first->second;
  for (int i = 0; i < kAxisWords; ++i) {
    const Axis axis = kAllAxes[static_cast<std::size_t>(i)];
    if (!words.has(letter(axis))) continue;
    offset[i] = words[letter(axis)] * (is_linear(axis) ? unit() : deg);
    words.erase(letter(axis));
  }
  need(ReaderRule::additional_work_offset, code->column);
  for (const char letter : {'P', 'L'}) words.erase(letter);
  words.erase(*words.code('G', 100));
}

// G10 L2: P0 and G91 mean something else to LinuxCNC than to Fanuc.
void ReadingStep::system_input(int column) {
  if (!words.has_axis() || !words.has('P')) return;
  const int P = static_cast<int>(std::lround(words['P']));
  if (P == 0 && choose(WordDifference::system_zero, words.column('P')) == 1) {
    for (const Axis axis : kAllAxes) {
      const char name = letter(axis);
      if (words.has(name) && words[name] != 0.0) {
        fail(words.column('P'),
             fmt::format(
                 "G10 L2 P0 {}{} shifts all work systems, which is not supported; set each of them",
                 name, words[name]));
      }
      words.erase(name);
    }
    for (const char name : {'P', 'L'}) words.erase(name);
    return words.erase(*words.code('G', 100));
  }
  if (!is_incremental() || choose(WordDifference::incremental_input, column) == 0) return;
  if (P < 1) return;
  std::string line = fmt::format("G10 L2 P{}", P);
  for (int i = 0; i < kAxisWords; ++i) {
    const Axis axis = kAllAxes[static_cast<std::size_t>(i)];
    const char name = letter(axis);
    if (!words.has(name)) continue;
    const double scale = is_linear(axis) ? unit() / mm : 1.0;
    line += fmt::format(" {}[[#{} / {}] + [{}]]", name, parameter::work_offset(P) + i, scale,
                        words[name]);
    words.erase(name);
  }
  before.push_back(std::move(line));
  for (const char name : {'P', 'L'}) words.erase(name);
  words.erase(*words.code('G', 100));
}

// Surveys go on without the offset.
void ReadingStep::refuse_unknown_system(const std::string& name, int P) {
  const std::string why = fmt::format(
      "{} P{}: this work offset is unknown; set it with --additional-offset "
      "P{}:X=...,Y=...,Z=...",
      name, P, P);
  if (!options.accepts_unknown_positions) fail(words.column('P'), why);
  reading_.notes_.push_back({words.column('P'), why});
}

}  // namespace servomill::controllers
