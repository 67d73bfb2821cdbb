// Numbers, codes of one group, codes without effect, dwells.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

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
    {1870, "P", false},
});

// Without effect on motion: clamps, gears, chips, coolant through the spindle or the tool.
constexpr std::array kFunctions = {10, 11, 29, 31, 33, 34, 35, 41,  42, 43,
                                   44, 76, 77, 83, 84, 88, 89, 138, 139};

// Codes that are known by name, and none can be simulated.
struct Refused {
  char letter;
  int tenths;
  std::string_view why;
};
constexpr auto kRefused = std::to_array<Refused>({
    {'G', 283, "sets machine coordinates without a move (TinyG); use G92"},
    {'G', 310, "a move up to what a probe touches, which is not simulated"},
    {'G', 650, "calls a macro of the control, whose text is not in the program"},
    {'G', 660, "calls a macro of the control at each move, whose text is not in the program"},
    {'M', 1040, "heats the extruder of a printer; programs for milling are read here"},
    {'M', 1090, "heats the extruder of a printer; programs for milling are read here"},
    {'M', 1400, "heats the bed of a printer; programs for milling are read here"},
    {'M', 1900, "heats the bed of a printer; programs for milling are read here"},
});

std::string name_of(const BlockWord& word) { return code_name(word.letter, tenths_of(word.value)); }

}  // namespace

bool ReadingStep::is_polar_angle(char letter) const {
  const bool is_polar = words.has_code('G', 160) || memory.polar.is_on;
  return is_polar && !words.has_code('G', 150) && letter == "XYZ"[(normal_axis() + 2) % 3];
}

// X1000 without a point: 1000 mm, or 1000 increments of 0.001 mm (0.0001 inch, 0.001 deg).
void ReadingStep::decimal_points() {
  const bool depends = options.reader == Reader::fanuc || options.reader == Reader::haas;
  if (!depends && options.decimal_point == DecimalPoint::unset) return;
  const bool is_dwell = words.has_code('G', 40) && !words.has('P');
  const bool is_cycle = is_canned_cycle(motion_in_block());  // K counts
  for (BlockWord& word : words.all()) {
    const bool is_length = kLengths.find(word.letter) != std::string_view::npos;
    const bool is_angle = kAngles.find(word.letter) != std::string_view::npos ||
                          (word.letter == 'R' && words.has_code('G', 680)) ||
                          is_polar_angle(word.letter);
    if (!(is_length || is_angle) || word.has_point || !word.is_literal || word.value == 0.0)
      continue;
    if ((is_dwell && word.letter == 'X') || (is_cycle && word.letter == 'K')) continue;
    if (options.decimal_point == DecimalPoint::unset) {
      fail(word.column, both_readings(WordDifference::decimal_point));
    }
    if (options.decimal_point == DecimalPoint::calculator) continue;
    word.value *= unit() == mm || is_angle ? 1e-3 : 1e-4;
    word.is_changed = true;
  }
}

// G70 and G71 take words where they are cycles of a lathe.
void ReadingStep::unit_codes() {
  for (const int tenths : {700, 710}) {
    BlockWord* code = words.code('G', tenths);
    if (code == nullptr || words.has('Q') || words.has('P')) continue;
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
        if (group == Group::g_distance && (words.has_code('G', 280) || words.has_code('G', 300))) {
          fail(word.column,
               "G90 and G91 beside G28 or G30: which of them holds for the way there "
               "no control documents; write two blocks");
        }
        if (tenths_of(last->value) != code->tenths) need(ReaderRule::repeated_group, word.column);
        words.erase(*last);
      }
      last = &word;
    }
  }
}

void ReadingStep::refused_codes() {
  for (const BlockWord& word : words.all()) {
    const int tenths = tenths_of(word.value);
    for (const Refused& one : kRefused) {
      if (word.letter != one.letter || tenths != one.tenths) continue;
      fail(word.column, fmt::format("{}: {}", name_of(word), one.why));
    }
    const bool is_override = word.letter == 'M' && tenths >= 500 && tenths <= 530;
    if (is_override) fail(word.column, both_readings(WordDifference::override_codes));
  }
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
    const bool is_known = tenths % 10 == 0 && std::find(kFunctions.begin(), kFunctions.end(),
                                                        tenths / 10) != kFunctions.end();
    if (!is_known) continue;
    need(ReaderRule::machine_function, word.column);
    words.erase(word);
  }
}

void ReadingStep::smoothing() {
  for (const Switch& one : kSmoothing) {
    BlockWord* code = words.code('G', one.tenths);
    if (code == nullptr || (one.needs_no_axis && words.has_axis())) continue;
    need(ReaderRule::smoothing, code->column);
    words.erase(*code);
    for (const char letter : one.words) words.erase(letter);
  }
}

double ReadingStep::dwell_of(WordDifference difference, const BlockWord& P) {
  const std::optional<int> reading = chosen_reading(difference, P.column);
  if (reading) return P.value * (*reading == 0 ? 1.0 : 1e-3);
  if (!options.accepts_unknown_dwells) fail(P.column, both_readings(difference));
  reading_.notes_.push_back(
      {P.column, both_readings(difference) + "; how long it dwells is left unknown"});
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

}  // namespace servomill::controllers
