// Numbers, codes of one group, codes without effect, dwells.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "controllers/gcode/readers/reading_step.h"

namespace servomill::controllers {
namespace {

constexpr std::string_view kLengths = "XYZIJKRQ", kAngles = "ABC";

// Codes that switch smoothing or look-ahead, with the words that they take.
struct Switch {
  int tenths;
  std::string_view words;
  bool needs_no_axis;  // with axis words LinuxCNC has another code of that number
};
constexpr auto kSmoothing = std::to_array<Switch>({
    {50, "P", true},    // G5 P10000
    {51, "QPR", true},  // G5.1 Q1
    {80, "P", true},    // G8 P1
    {620, "", false},   // automatic override in inner corners
    {1030, "P", false},
    {1870, "P", false},
});

// Codes that end what no code read here begins.
constexpr auto kCancels = std::to_array<Switch>({
    {131, "", false},   // G13.1 and G113: interpolation in polar coordinates
    {401, "", false},   // an axis normal to the path
    {502, "", false},   // turning of polygons
    {542, "P", false},  // G54.2 P0: offsets of a rotary table
    {670, "", false},   // modal macros
    {691, "", false},   // synchronous control of two tables
    {1130, "", false},
    {2550, "", false},  // dynamic work offset of Haas
});

// Codes that switch checks of travel limits and spindle speed.
constexpr auto kChecks = std::to_array<Switch>({
    {220, "XYZIJK", false},
    {230, "", false},
    {250, "", false},
    {260, "PQRI", false},
});

// Without effect on motion: clamps, gears, chips, coolant through the spindle or the tool.
constexpr std::array kFunctions = {10, 11, 29, 31, 33, 34, 35, 41,  42, 43,
                                   44, 76, 77, 83, 84, 88, 89, 138, 139};

constexpr int kLocalCall = 970, kMotorsOn = 170;

bool is_idle_function(int code) {
  return std::find(kFunctions.begin(), kFunctions.end(), code) != kFunctions.end();
}

// Codes that are known by name, and none can be simulated.
struct Refused {
  char letter;
  int tenths;
  std::string_view why;
};
constexpr auto kRefused = std::to_array<Refused>({
    {'G', 62, "a NURBS curve; post-process it to lines and arcs"},
    {'G', 71, "cylindrical interpolation; post-process to moves of the rotary axis"},
    {'G', 121,
     "polar coordinate interpolation of a linear and a rotary axis; post-process to moves of both"},
    {'G', 270, "checks with a move that the axes are at the reference point; use G53"},
    {'G', 283, "sets machine coordinates without a move (TinyG); use G92"},
    {'G', 290, "returns through the intermediate point of the last G28; program the moves"},
    {'G', 310, "a probing move, which is not simulated"},
    {'G', 360, "a probing measurement, which is not simulated"},
    {'G', 370, "a tool measurement, which is not simulated"},
    {'G', 440, "subtracts the tool length; use G43 with the opposite sign"},
    {'G', 450, "lengthens a move by a tool offset; program the move"},
    {'G', 460, "shortens a move by a tool offset; program the move"},
    {'G', 470,
     "engraves a text (Haas), or lengthens a move by twice a tool offset (Fanuc); program the "
     "moves"},
    {'G', 480, "shortens a move by twice a tool offset; program the move"},
    {'G', 600,
     "approaches from one direction with an overtravel set in a control parameter; program the "
     "moves"},
    {'G', 650, "calls a control macro that is not in the program"},
    {'G', 660, "calls a control macro that is not in the program at each move"},
    {'G', 770, "back boring with an oriented spindle is not simulated"},
    {'G', 1000,
     "ends a mirror image (Haas), or changes a tool (Brother); choose with --reader haas, or use "
     "G50.1 or M6"},
    {'G', 1010,
     "a mirror image (Haas), or a code of the machine builder; choose with --reader haas, or use "
     "G51.1"},
    {'G', 1070, "cylindrical interpolation; post-process to moves of the rotary axis"},
    {'G', 1120,
     "polar coordinate interpolation of a linear and a rotary axis; post-process to moves of both"},
    {'G', 1410, "3D cutter compensation (Haas); post-process to the path of the tool centre"},
    {'G', 1430, "length compensation on tilted axes (Haas); post-process with G43.4"},
    {'G', 1500, "a pocket cycle (Haas); post-process to the moves of the pocket"},
    {'G', 2540,
     "shifts the work offset with the rotary axes (Haas), using centres of rotation stored in the "
     "control; post-process with G68.2 or G43.4"},
    {'M', 170,
     "ends a Siemens subprogram (use M99), or switches motors on (pass --ignore-code M17, or "
     "remove it)"},
    {'M', 470, "restarts the program endlessly (Mach); use M30"},
    {'M', 960, "enables an interrupt by a signal; signals are not simulated"},
    {'M', 1040, "heats the extruder of a 3D printer; only milling programs are supported"},
    {'M', 1090, "heats the extruder of a 3D printer; only milling programs are supported"},
    {'M', 1400, "heats the bed of a 3D printer; only milling programs are supported"},
    {'M', 1900, "heats the bed of a 3D printer; only milling programs are supported"},
    {'M', 1980, "calls a program from another memory of the control; use M98 and --subs"},
});

std::string name_of(const BlockWord& word) { return code_name(word.letter, tenths_of(word.value)); }

}  // namespace

bool is_known_function(int code) {
  return find_code('M', 10 * code) != nullptr || is_idle_function(code) ||
         10 * code == kLocalCall ||
         std::any_of(kRefused.begin(), kRefused.end(), [&](const Refused& one) {
           return one.letter == 'M' && one.tenths == 10 * code && one.tenths != kMotorsOn;
         });
}

bool ReadingStep::is_polar_angle(char letter) const {
  const bool is_polar = words.has_code('G', 160) || memory.polar.is_on;
  return is_polar && !words.has_code('G', 150) && letter == "XYZ"[(normal_axis() + 2) % 3];
}

// X1000 without a point: 1000 mm, or 1000 increments of 0.001 mm (0.0001 inch, 0.001 deg).
void ReadingStep::decimal_points() {
  const bool depends = options.reader == Reader::fanuc || options.reader == Reader::haas;
  if (!depends && options.decimal_point == DecimalPoint::unset) return;
  for (BlockWord& word : words.all()) decimal_point(word);
}

void ReadingStep::decimal_point(BlockWord& word) const {
  const bool is_dwell = words.has_code('G', 40) && !words.has('P');
  const bool is_cycle = is_canned_cycle(motion_in_block());  // K counts
  const bool is_length = kLengths.find(word.letter) != std::string_view::npos;
  const bool is_angle = kAngles.find(word.letter) != std::string_view::npos ||
                        (word.letter == 'R' && words.has_code('G', 680)) ||
                        is_polar_angle(word.letter);
  if (!(is_length || is_angle) || word.has_point || !word.is_literal || word.value == 0.0) return;
  if ((is_dwell && word.letter == 'X') || (is_cycle && word.letter == 'K')) return;
  if (options.decimal_point == DecimalPoint::unset) {
    fail(word.column, both_readings(WordDifference::decimal_point));
  }
  if (options.decimal_point == DecimalPoint::calculator) return;
  word.value *= unit() == mm || is_angle ? 1e-3 : 1e-4;
  word.is_changed = true;
}

// G70 and G71 take words where they are cycles of a lathe.
void ReadingStep::unit_codes() {
  for (const int tenths : {700, 710}) {
    BlockWord* code = words.code('G', tenths);
    if (code == nullptr || words.has('Q') || words.has('P')) continue;
    if (words.has('L')) {
      fail(code->column,
           fmt::format("{} with L: holes on a circle (Haas); program each hole", name_of(*code)));
    }
    need(ReaderRule::unit_codes, code->column);
    code->value = tenths == 700 ? 20.0 : 21.0;
    code->is_changed = true;
  }
}

// G20 G1 X1 F10: the unit first, then the feed.
void ReadingStep::feed_beside_unit() {
  BlockWord* code = words.code('G', unit() == mm ? 210 : 200);
  const BlockWord* F = words.find('F');
  const bool is_rate = !words.has_code('G', 930) && state.feed_mode != FeedMode::inverse_time;
  if (code == nullptr || F == nullptr || unit() == state.unit || !is_rate) return;
  if (choose(WordDifference::feed_beside_unit, F->column) == 0) return;
  before.push_back(fmt::format("G{}", code->value));
  words.erase(*code);
}

// The last of several G codes of one group counts.
void ReadingStep::repeated_groups() {
  constexpr std::array kGroups = {Group::g_plane,       Group::g_units,   Group::g_feed_mode,
                                  Group::g_distance,    Group::g_retract, Group::g_path_control,
                                  Group::g_work_system, Group::g_motion};
  for (const Group group : kGroups) {
    BlockWord* last = nullptr;
    for (BlockWord& word : words.all()) {
      const Code* code = word.letter == 'G' ? find_code('G', tenths_of(word.value)) : nullptr;
      if (code == nullptr || code->group != group || word.is_erased) continue;
      const bool has_g80 = group == Group::g_motion && last != nullptr &&
                           (code->tenths == 800 || tenths_of(last->value) == 800);
      if (last != nullptr && !has_g80) {
        if (group == Group::g_distance && distances_of_home(word)) break;
        if (tenths_of(last->value) != code->tenths) need(ReaderRule::repeated_group, word.column);
        words.erase(*last);
      }
      last = &word;
    }
  }
}

void ReadingStep::refused_codes() {
  for (BlockWord& word : words.all()) {
    const int tenths = tenths_of(word.value);
    for (const Refused& one : kRefused) {
      if (word.letter != one.letter || tenths != one.tenths) continue;
      if (tenths == kMotorsOn && options.ignored_codes.contains(tenths / 10)) continue;
      const bool is_of_haas = tenths == 1000 || tenths == 1010;
      if (is_of_haas && word.letter == 'G' && options.reader == Reader::haas) continue;
      fail(word.column, fmt::format("{}: {}", name_of(word), one.why));
    }
    const bool is_override = word.letter == 'M' && tenths >= 500 && tenths <= 530;
    if (is_override) override_code(word);
  }
}

// No reading moves an axis, as far as the program tells.
void ReadingStep::override_code(BlockWord& word) {
  const std::optional<int> reading = chosen_reading(WordDifference::override_codes, word.column);
  if (reading == 1) {
    if (BlockWord* P = words.find('P')) words.comment_out(*P);
    return leave_out(ReaderRule::machine_function, word);
  }
  if (reading == 0) return;
  reading_.notes_.push_back({word.column, both_readings(WordDifference::override_codes) +
                                              "; no axis moves while the program runs"});
}

void ReadingStep::machine_functions() {
  for (BlockWord& word : words.all()) {
    if (word.letter != 'M' || word.is_erased) continue;
    const int tenths = tenths_of(word.value);
    if (tenths == 190) {  // oriented, the spindle stands still
      need(ReaderRule::machine_function, word.column);
      for (const char letter : {'P', 'R', 'Q'}) words.erase(letter);
      word.value = 5.0;
      word.is_changed = true;
      continue;
    }
    if (tenths == 120 || tenths == 130) {
      reading_.notes_.push_back(
          {word.column, fmt::format("{}: the brake of the fifth axis (Haas), or the spindle or "
                                    "coolant on other machines; no axis moves",
                                    name_of(word))});
      leave_out(ReaderRule::machine_function, word);
      continue;
    }
    const bool is_ignored = tenths % 10 == 0 && options.ignored_codes.contains(tenths / 10);
    if (tenths % 10 == 0 && (is_ignored || is_idle_function(tenths / 10))) {
      leave_out(is_ignored ? ReaderRule::ignored_function : ReaderRule::machine_function, word);
    } else if (find_code('M', tenths) == nullptr && tenths != kLocalCall) {
      refuse_function(word);
    }
  }
}

// A function of the machine, which programs that are written must not lose in silence.
void ReadingStep::leave_out(ReaderRule rule, BlockWord& word) {
  const int tenths = tenths_of(word.value);
  const std::string name = name_of(word);
  need(rule, word.column, fmt::format("; {} becomes a comment, also in rewritten programs", name));
  if (memory.first_left_out < 0) memory.first_left_out = tenths;
  if (memory.first_left_out != tenths) {
    reading_.notes_.push_back({word.column, fmt::format("{} also becomes a comment", name)});
  }
  words.comment_out(word);
}

// LinuxCNC has M100 to M199 as programs of the user, Mach has macros, and controls of machine tools
// what their builders made.
void ReadingStep::refuse_function(const BlockWord& word) const {
  const std::string name = name_of(word);
  const bool has_none = options.reader == Reader::grbl;
  if (has_none) refuse(word.column, fmt::format("{} is not supported by grbl", name));
  if (options.refuses_code) options.refuses_code(tenths_of(word.value) / 10);
  fail(word.column,
       fmt::format("unknown M code {0}: a machine-builder function, which may mirror or move an "
                   "axis; if {0} does not, pass --ignore-code {0}, or remove it",
                   name));
}

// M7 M8: both are on.
void ReadingStep::coolant_codes() {
  BlockWord* flood = words.code('M', 80);
  const bool has_both = flood != nullptr && words.has_code('M', 70) && !words.has_code('M', 90);
  if (!has_both) return;
  need(ReaderRule::coolant_codes, flood->column);
  before.emplace_back("M8");
  words.erase(*flood);
}

// M3 P100: a power in percent.
void ReadingStep::spindle_power() {
  const bool is_on = words.has_code('M', 30) || words.has_code('M', 40);
  if (!is_on || !words.has('P') || has_words_of_P()) return;
  need(ReaderRule::spindle_power, words.column('P'));
  words.erase('P');
}

// Another code of the block that takes P.
bool ReadingStep::has_words_of_P() const {
  return std::any_of(words.all().begin(), words.all().end(), [](const BlockWord& word) {
    const int tenths = word.letter == 'G' || word.letter == 'M' ? tenths_of(word.value) : -1;
    const bool is_spindle = word.letter == 'M' && (tenths == 30 || tenths == 40);
    const bool is_modal = word.letter == 'G' && (tenths == 0 || tenths == 10 || tenths == 900 ||
                                                 tenths == 910 || tenths == 940);
    return tenths >= 0 && !is_spindle && !is_modal;
  });
}

// Codes without effect here, with the words that they take.
void ReadingStep::idle_codes() {
  const auto leave_out_all = [&](ReaderRule rule, std::span<const Switch> codes) {
    for (BlockWord& word : words.all()) {
      if (word.letter != 'G' || word.is_erased) continue;
      const auto found = std::find_if(codes.begin(), codes.end(), [&](const Switch& one) {
        return one.tenths == tenths_of(word.value) && !(one.needs_no_axis && words.has_axis());
      });
      if (found == codes.end()) continue;
      need(rule, word.column);
      words.erase(word);
      for (const char letter : found->words) words.erase(letter);
    }
  };
  if (const BlockWord* table = words.code('G', 542);
      table != nullptr && !(words.has('P') && words['P'] == 0.0)) {
    fail(table->column,
         "G54.2: the offset rotates with the rotary axes using data stored in the control; "
         "post-process with G68.2 or G43.4");
  }
  leave_out_all(ReaderRule::smoothing, kSmoothing);
  leave_out_all(ReaderRule::cancel_codes, kCancels);
  leave_out_all(ReaderRule::check_codes, kChecks);
}

double ReadingStep::dwell_of(WordDifference difference, const BlockWord& P) {
  const std::optional<int> reading = chosen_reading(difference, P.column);
  if (reading) return P.value * (*reading == 0 ? 1.0 : 1e-3);
  if (!options.accepts_unknown_dwells) fail(P.column, both_readings(difference));
  reading_.notes_.push_back({P.column, both_readings(difference) + "; the dwell time is unknown"});
  reading_.has_unknown_dwell_ = true;
  return 0.0;
}

// G4 P, X and U (which the lines give as X), in seconds.
void ReadingStep::dwell() {
  const BlockWord* code = words.code('G', 40);
  if (code == nullptr) return;
  if (const BlockWord* P = words.find('P')) {
    if (P->has_point || P->value == 0.0) return;
    return words.set('P', dwell_of(WordDifference::dwell_unit, *P));
  }
  const BlockWord* X = words.find('X');
  if (X == nullptr && options.reader == Reader::any) return dwell_of_other_controls();
  if (X == nullptr || !apply(ReaderRule::dwell_word, X->column)) return;
  double seconds = X->value;
  if (!X->has_point && seconds != 0.0) {
    if (options.decimal_point == DecimalPoint::unset) {
      fail(X->column, both_readings(WordDifference::dwell_increments));
    }
    if (options.decimal_point == DecimalPoint::increments) seconds *= 1e-3;
  }
  const int column = X->column;
  words.erase('X');
  words.add('P', seconds, column);
}

// G4 S4: 4 s, or 4 turns.
void ReadingStep::dwell_of_other_controls() {
  const bool has_S = words.has('S');
  const BlockWord* word = has_S ? words.find('S') : words.find('F');
  if (word == nullptr) return;
  const int column = word->column;
  const std::string readings =
      has_S ? "G4 S: seconds (Marlin), or spindle revolutions (Siemens); use G4 P"
            : "G4 F: seconds (Siemens), not supported by other controls; use G4 P";
  if (!options.accepts_unknown_dwells) fail(column, readings);
  reading_.notes_.push_back({column, readings + "; the dwell time is unknown"});
  reading_.has_unknown_dwell_ = true;
  words.erase(has_S ? 'S' : 'F');
  words.add('P', 0.0, column);
}

}  // namespace servomill::controllers
