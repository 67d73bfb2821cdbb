// The motion code in force, exact stops and the feed.
#include <fmt/format.h>

#include <algorithm>

#include "controllers/gcode/number_text.h"
#include "controllers/gcode/program_setup.h"
#include "controllers/gcode/readers/reading_step.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {

void ReadingStep::leave_cycle() {
  memory.is_in_cycle = false;
  memory.cycle = {};
  memory.motion_before_cycle = memory.pending_motion = -1;
  memory.is_pending_known = false;
}

// I J alone, G2 in force: round the centre, back to where it began.
void ReadingStep::arc_without_axes() {
  const int motion = motion_in_block();
  const bool is_arc = motion == 20 || motion == 30;
  const bool has_centre = words.has('I') || words.has('J') || words.has('K');
  if (!is_arc || motion_code() >= 0 || !has_centre || words.has_axis() || has_axis_taker()) return;
  const int column = words.all().front().column;
  need(ReaderRule::arc_without_axes, column);
  words.add('G', motion / 10.0, column);
  memory.pending_motion = -1;
}

// Groups 01 (G0 ... G3) and 09 (cycles) are apart on Fanuc, one group in LinuxCNC.
void ReadingStep::motion_in_force() {
  const int code = motion_code();
  if (code >= 0 && code <= 30) return leave_cycle();
  if (code > 30 && code != 800) return;
  const bool has_words = words.has_axis() && !has_axis_taker();
  if (code == 800) return cancel_cycle(has_words);
  const bool is_known_to_linuxcnc = memory.pending_motion < 0 && state.motion != 800;
  if (!has_words || is_known_to_linuxcnc) return;
  const int column = words.all().front().column;
  int motion = memory.pending_motion;
  if (motion < 0) {
    rapid_at_start(column);
    motion = 0;
  } else if (state.motion == 800 && motion <= 30) {
    if (!memory.is_pending_known) need(ReaderRule::motion_behind_cycle, column);
    refuse_arc_behind_cycle(motion, column);
  }
  words.add('G', motion / 10.0, column);
  memory.pending_motion = -1;
  if (motion <= 30) leave_cycle();
}

// A feed without F stops a control; what runs is a rapid.
void ReadingStep::rapid_at_start(int column) {
  const bool can_feed = words.has('F') || state.feed_linear != 0.0 || options.feed.has_value();
  if (!can_feed && apply(ReaderRule::rapid_at_start, column)) return;
  const bool is_chosen = chosen_reading(WordDifference::start_motion, column).has_value();
  if (is_chosen) return;
  const std::string readings = both_readings(WordDifference::start_motion);
  if (!options.accepts_unknown_positions) fail(column, readings);
  reading_.notes_.push_back(
      {column, readings + "; treated as a rapid here: the end of the move is the same"});
}

// FreeCAD writes K0 into arcs of the XY plane.
void ReadingStep::arc_centre() {
  const int motion = motion_in_block();
  if (motion != 20 && motion != 30) return;
  BlockWord* centre = words.find("IJK"[normal_axis()]);
  if (centre == nullptr || centre->value != 0.0 || !centre->is_literal) return;
  need(ReaderRule::centre_off_plane, centre->column);
  words.erase(*centre);
}

// G1 X10 R5: LinuxCNC refuses R there.
void ReadingStep::radius_of_line() {
  const int motion = motion_in_block();
  const BlockWord* R = words.find('R');
  if (R == nullptr || motion > 10 || !words.has_axis() || has_axis_taker()) return;
  fail(R->column,
       fmt::format("R with {0}: corner rounding to the next line on lathes and with Fanuc "
                   "parameter 3405#4, an alarm otherwise; program ,R{1:g} after G1, or the arc",
                   code_name('G', motion), R->value));
}

// G80, alone or with axis words.
void ReadingStep::cancel_cycle(bool has_words) {
  const int motion = memory.is_in_cycle           ? memory.motion_before_cycle
                     : memory.pending_motion >= 0 ? memory.pending_motion
                     : state.motion <= 30         ? state.motion
                                                  : -1;
  leave_cycle();
  if (!has_words) {
    memory.pending_motion = motion;
    return;
  }
  BlockWord& code = *words.code('G', 800);
  need(ReaderRule::words_with_g80, code.column);
  if (motion < 0) choose(WordDifference::start_motion, code.column);
  refuse_arc_behind_cycle(motion, code.column);
  code.value = std::max(motion, 0) / 10.0;
  code.is_changed = true;
}

void ReadingStep::refuse_arc_behind_cycle(int motion, int column) const {
  if (motion <= 10) return;
  fail(column, fmt::format("axis words after G80 while {} is active; program the motion code",
                           code_name('G', motion)));
}

// G9: an exact stop at the end of this block.
void ReadingStep::exact_stop() {
  BlockWord* code = words.code('G', 90);
  if (code == nullptr) return;
  need(ReaderRule::exact_stop, code->column);
  words.erase(*code);
  if (state.path_mode != PathMode::continuous) return;
  before.emplace_back("G61.1");
  behind.push_back(state.path_tolerance > 0.0
                       ? "G64 " + word_text('P', state.path_tolerance / state.unit)
                       : "G64");
}

void ReadingStep::feed() {
  if (words.has('F')) memory.has_zero_feed = words['F'] == 0.0;
  const int motion = motion_in_block();
  const bool moves = words.has_axis() || words.has('I') || words.has('J') || words.has('K');
  const bool has_own_feed = motion == 330 || motion == 331;  // that of the thread
  const bool needs = motion > 0 && motion != 800 && moves && !has_own_feed && !has_axis_taker();
  const bool is_other_mode = words.has_code('G', 930) || words.has_code('G', 950) ||
                             state.feed_mode != FeedMode::units_per_minute;
  if (!needs || words.has('F') || is_other_mode || state.feed_linear != 0.0) return;
  if (memory.has_zero_feed) return;  // is refused where it runs
  const BlockWord* code = words.code('G', motion);
  const int column = code != nullptr ? code->column : words.all().front().column;
  if (!options.feed) {
    const std::string why = fmt::format(
        "{} before the first F: Mach keeps the last feed, other controls raise an alarm; "
        "program F, or set the feed with --feed or program.first_feed of a scenario",
        code_name('G', motion));
    if (!options.accepts_unknown_feeds) fail(column, why);
    reading_.notes_.push_back({column, why + "; the cycle time is unknown"});
    reading_.has_unknown_feed_ = true;
    return before.push_back(word_text('F', 1.0));
  }
  if (!apply(ReaderRule::given_feed, column)) return;
  words.add('F', *options.feed * minute / state.unit, column);
}

}  // namespace servomill::controllers
