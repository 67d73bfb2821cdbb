// Canned cycles in the forms of Fanuc and Haas.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "controllers/gcode/readers/reading_step.h"

namespace servomill::controllers {
namespace {

constexpr int kDrilling = 810, kBoringAtFeed = 850, kFineBoring = 760, kBoring = 860,
              kBackBoring = 870;

bool is_cycle_of_controls(int tenths) { return tenths == kFineBoring || is_canned_cycle(tenths); }
// The cycle that LinuxCNC runs in place of it.
int strict_code(int tenths) { return tenths == kFineBoring ? kBoring : tenths; }
bool has_dwell(int tenths) {
  return tenths == 820 || tenths == kBoring || tenths == 880 || tenths == 890;
}
bool is_tapping(int tenths) { return tenths == 740 || tenths == 840; }
bool is_pecking(int tenths) { return tenths == 730 || tenths == 830; }

enum Kept : std::size_t { kR, kBottom, kP, kQ };

}  // namespace

char ReadingStep::normal_letter() const { return "XYZ"[normal_axis()]; }

void ReadingStep::cycles() {
  if (words.has_code('G', 980) || words.has_code('G', 990)) memory.has_retract_mode = true;
  const int explicit_code = motion_code();
  const bool continues =
      explicit_code < 0 && memory.is_in_cycle && words.has_axis() && !has_axis_taker();
  const int code = explicit_code >= 0           ? explicit_code
                   : memory.pending_motion >= 0 ? memory.pending_motion
                                                : state.motion;
  if (explicit_code >= 0 ? !is_cycle_of_controls(code)
                         : !continues || !is_cycle_of_controls(code)) {
    return;
  }
  if (explicit_code >= 0) begin_cycle(code);
  if (code == kFineBoring) fine_boring();
  const int strict = strict_code(code);
  cycle_count(code);
  cycle_levels(strict);
  cycle_words(strict);
  cycle_dwell(strict);
  cycle_without_hole(code);
  if (!words.has_axis()) return;
  retract_mode();
  approach_from_below();
  tapping(strict);
  leave_at_feed(strict);
}

void ReadingStep::begin_cycle(int code) {
  if (!memory.is_in_cycle) {
    memory.motion_before_cycle = memory.pending_motion >= 0 && memory.pending_motion <= 30
                                     ? memory.pending_motion
                                 : state.motion <= 30 ? state.motion
                                                      : -1;
  }
  memory.is_in_cycle = true;
  memory.pending_motion = -1;
  const BlockWord& word = *words.code('G', code);
  if (code == kBackBoring && words.has('Q')) {
    fail(word.column,
         "G87 with Q: back boring with an oriented spindle is not simulated; use G87 I J K of "
         "LinuxCNC");
  }
  if (is_pecking(code) && (words.has('I') || words.has('J'))) {
    fail(word.column,
         fmt::format("{} with I, J, K (Haas): decreasing pecks are not simulated; use Q",
                     code_name('G', code)));
  }
}

// The shift by Q, or by I and J, moves the tool off the wall by some tenths of a millimetre; its
// direction is a parameter of the control.
void ReadingStep::fine_boring() {
  BlockWord* code = words.code('G', kFineBoring);
  if (code == nullptr) return;
  if (!words.has('R') && !memory.cycle.values[kR]) {
    fail(code->column,
         "G76 without R: lathe threading (LinuxCNC), or fine boring (Fanuc, Haas), which requires "
         "R");
  }
  need(ReaderRule::fine_boring, code->column);
  code->value = 86.0;
  code->is_changed = true;
  for (const char letter : {'Q', 'I', 'J'}) words.erase(letter);
}

// Words that the block lacks and another cycle gave; words that it gives are kept.
void ReadingStep::cycle_words(int code) {
  KeptCycle& kept = memory.cycle;
  const std::array letters = {'R', normal_letter(), 'P', 'Q'};
  const bool is_fresh = state.motion != code;
  int column = words.all().front().column;
  if (const BlockWord* word = words.code('G', code)) column = word->column;
  for (const std::size_t k : {kR, kBottom, kP, kQ}) {
    const bool uses = k < kP || (k == kP ? has_dwell(code) || is_tapping(code) : is_pecking(code));
    if (!uses || !is_fresh || words.has(letters[k]) || !kept.values[k]) continue;
    if (memory.pending_motion < 0) need(ReaderRule::cycle_memory, column);
    words.add(letters[k], *kept.values[k], column);
  }
  for (const std::size_t k : {kR, kBottom, kQ}) {
    if (words.has(letters[k])) kept.values[k] = words[letters[k]];
  }
  const double base = is_incremental() ? initial_level() : 0.0;
  if (words.has('R')) kept.r_level = words['R'] + base;
  const double bottom_base = is_incremental() ? kept.r_level : 0.0;
  const bool moves_bottom = words.has(letters[kBottom]) || (words.has('R') && is_incremental());
  if (moves_bottom && kept.values[kBottom]) {
    kept.bottom_level = *kept.values[kBottom] + bottom_base;
  }
  kept.is_incremental = is_incremental();
}

// Z of the tool before the row of cycles.
double ReadingStep::initial_level() const {
  const int n = normal_axis();
  Eigen::Vector3d p = state.programmed().head<3>();
  if (state.cycle.has_level) p[n] = state.cycle.level * state.unit;
  return memory.frame.from_work(p)[n] / state.unit;
}

// G90 G81 X1 Z-2 R1, then G91 X1: the hole is as deep as the one before.
void ReadingStep::cycle_levels(int code) {
  const KeptCycle& kept = memory.cycle;
  const bool is_kept = kept.values[kR] && kept.values[kBottom];
  const char bottom = normal_letter();
  const bool lacks = !words.has('R') || !words.has(bottom);
  if (!is_kept || !lacks || !words.has_axis() || kept.is_incremental == is_incremental()) return;
  const int column = words.all().front().column;
  const bool goes_on = state.motion == code;
  if (goes_on && choose(WordDifference::cycle_distance, column) == 0) return;
  if (!goes_on && memory.pending_motion < 0) need(ReaderRule::cycle_memory, column);
  const double base = is_incremental() ? initial_level() : 0.0;
  if (!words.has('R')) words.add('R', kept.r_level - base, column);
  if (!words.has(bottom)) {
    words.add(bottom, kept.bottom_level - (is_incremental() ? words['R'] + base : 0.0), column);
  }
}

// In seconds.
void ReadingStep::cycle_dwell(int code) {
  const bool can_dwell = has_dwell(code) || is_tapping(code);
  if (const BlockWord* P = words.find('P')) {
    if (words['P'] < 0.0) fail(P->column, fmt::format("P{:g}; must be >= 0", words['P']));
    if (P->is_literal && !P->has_point && P->value != 0.0 && !P->is_changed) {
      words.set('P', dwell_of(WordDifference::cycle_dwell_unit, *P));
    }
    memory.cycle.values[kP] = words['P'];
    if (!can_dwell && words['P'] == 0.0) return words.erase('P');
    const bool is_unused = code == kDrilling || code == kBoringAtFeed;
    if (!is_unused || !apply(ReaderRule::cycle_unused_dwell, P->column)) return;
    return words.erase('P');
  }
  if (!has_dwell(code) || state.motion == code || memory.cycle.values[kP]) return;
  const BlockWord* word = words.code('G', code);
  const int column = word != nullptr ? word->column : words.all().front().column;
  need(ReaderRule::cycle_without_dwell, column);
  words.add('P', 0.0, column);
}

// K of Fanuc is L of LinuxCNC.
void ReadingStep::cycle_count(int code) {
  const bool is_back_boring = code == kBackBoring;
  if (const BlockWord* K = is_back_boring ? nullptr : words.find('K')) {
    const int column = K->column;
    if (words.has('L')) fail(column, "K and L are not allowed in one block: both repeat the cycle");
    need(ReaderRule::cycle_repeats, column);
    words.add('L', words['K'], column);
    words.erase('K');
  }
}

// With L0 the words are kept only.
void ReadingStep::cycle_without_hole(int code) {
  if (!words.has('L') || words['L'] != 0.0) return;
  need(ReaderRule::cycle_without_hole, words.column('L'));
  for (const char letter : {'X', 'Y', 'Z', 'R', 'P', 'Q', 'L'}) words.erase(letter);
  if (BlockWord* word = words.code('G', strict_code(code))) words.erase(*word);
  memory.pending_motion = strict_code(code);
}

// Decides between G98 and G99 if neither was read and the tool is above R.
void ReadingStep::retract_mode() {
  if (memory.has_retract_mode || !words.has('R')) return;
  const double level = initial_level();
  const double R = words['R'] + (is_incremental() ? level : 0.0);
  constexpr double kSameLevel = 1e-9;
  if (level <= R + kSameLevel) return;
  const int column = words.column('R');
  memory.has_retract_mode = true;
  if (choose(WordDifference::retract_level, column) == 1) words.add('G', 98.0, column);
}

// The order of rising to R and going to the hole decides what is on the way.
void ReadingStep::approach_from_below() {
  constexpr double kSamePlace = 1e-9;
  const KeptCycle& kept = memory.cycle;
  if (state.is_height_unknown || !kept.values[kR]) return;
  const int n = normal_axis();
  const Eigen::Vector3d at =
      memory.frame.from_work(state.programmed().head<3>().eval()) / state.unit;
  if (at[n] >= kept.r_level - kSamePlace) return;
  bool moves = false;
  for (int i = 0; i < 3; ++i) {
    const char letter = "XYZ"[i];
    if (i == n || !words.has(letter)) continue;
    moves |= std::abs(words[letter] - (is_incremental() ? 0.0 : at[i])) > kSamePlace;
  }
  if (!moves) return;
  const int column = words.all().front().column;
  if (choose(WordDifference::cycle_from_below, column) == 1) reading_.positions_below_r_ = true;
}

// Cycles that leave the hole at feed do so up to R, and go on to the initial level of G98 at
// rapid; in LinuxCNC all of it is at feed.
void ReadingStep::leave_at_feed(int code) {
  const bool is_of_control = options.reader == Reader::fanuc || options.reader == Reader::haas;
  const bool is_r_level =
      words.has_code('G', 990) || (!words.has_code('G', 980) && state.retracts_to_r);
  const bool repeats = words.has('L') && words['L'] > 1.0;
  if (!is_of_control || !(is_tapping(code) || code == 890) || is_r_level || repeats) return;
  const double level = initial_level();
  const double rise = level - memory.cycle.r_level;
  if (memory.frame.is_active() || !(rise > 0.0)) return;
  if (BlockWord* G98 = words.code('G', 980)) words.erase(*G98);
  words.add('G', 99.0, words.all().front().column);
  behind.push_back("G0 " + word_text(normal_letter(), is_incremental() ? rise : level));
  behind.emplace_back("G98");
  memory.pending_motion = code;
  memory.is_pending_known = true;
}

void ReadingStep::tapping(int code) {
  if (!is_tapping(code) || state.spindle_direction != 0) return;
  if (words.has_code('M', 30) || words.has_code('M', 40) || words.has_code('M', 50)) return;
  const BlockWord* word = words.code('G', code);
  const int column = word != nullptr ? word->column : words.all().front().column;
  need(ReaderRule::tapping_spindle, column);
  words.add('M', code == 840 ? 3.0 : 4.0, column);
}

}  // namespace servomill::controllers
