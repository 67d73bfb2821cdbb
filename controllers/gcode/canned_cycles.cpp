#include "controllers/gcode/canned_cycles.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "controllers/gcode/interpreter_machine.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

using enum CycleStep::Kind;

constexpr double kBackedOff = 0.01 * inch;  // LinuxCNC's default for G73 and G83
constexpr double kMaxSteps = 1e5;           // of a block, which is held in memory

class Steps {
 public:
  explicit Steps(const CycleHole& hole) : hole_(hole) {}

  void rapid_to(double level, bool is_beside = false) { out.push_back({rapid, level, is_beside}); }
  void feed_to(double level) { out.push_back({feed, level}); }
  void wait() { out.push_back({.kind = dwell, .dwell = hole_.dwell}); }
  void turn(int direction) { out.push_back({.kind = spindle, .direction = direction}); }
  void wait_for_operator() { out.push_back({.kind = stop}); }

  // With a full retraction each time (G83) or a short one (G73).
  void peck(bool is_full) {
    double depth = hole_.r - hole_.peck;
    for (; depth > hole_.bottom; depth -= hole_.peck) {
      feed_to(depth);
      if (is_full) rapid_to(hole_.r);
      rapid_to(depth + hole_.backed_off);
    }
    feed_to(hole_.bottom);
    rapid_to(hole_.clear);
  }

  void tap() {
    feed_to(hole_.bottom);
    turn(0);
    turn(-hole_.direction);
    wait();
    feed_to(hole_.clear);
    turn(0);
    turn(hole_.direction);
  }

  // The tool goes beside the hole with its edge turned away, and cuts on the way up.
  void bore_backwards() {
    rapid_to(hole_.r, true);
    turn(0);
    rapid_to(hole_.bottom, true);
    rapid_to(hole_.bottom);
    turn(hole_.direction);
    feed_to(hole_.middle);
    feed_to(hole_.bottom);
    turn(0);
    rapid_to(hole_.bottom, true);
    rapid_to(hole_.clear, true);
    rapid_to(hole_.clear);
    turn(hole_.direction);
  }

  std::vector<CycleStep> out;

 private:
  const CycleHole& hole_;
};

// The same step of the position as a program would write it: rounding to SI and back undone.
double in_unit(double position, double unit) {
  constexpr double kDigits = 1e10;
  const double x = position / unit;
  const double written = std::round(x * kDigits) / kDigits;
  const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * std::abs(x);
  return std::abs(written - x) <= rounding ? written : x;
}

constexpr bool has_dwell(int tenths) {
  return tenths == 820 || tenths == 860 || tenths == 880 || tenths == 890;
}
constexpr bool is_tapping(int tenths) { return tenths == 740 || tenths == 840; }
constexpr bool is_pecking(int tenths) { return tenths == 730 || tenths == 830; }

}  // namespace

// Steps of one hole, in the order of LinuxCNC 2.9 (canned cycles); `clear` is the level of G98 or
// G99.
std::vector<CycleStep> cycle_steps(int tenths, const CycleHole& hole) {
  Steps steps(hole);
  switch (tenths) {
    case 730:
    case 830:
      steps.peck(tenths == 830);
      break;
    case 740:
    case 840:
      steps.tap();
      break;
    case 810:
      steps.feed_to(hole.bottom);
      steps.rapid_to(hole.clear);
      break;
    case 820:
      steps.feed_to(hole.bottom);
      steps.wait();
      steps.rapid_to(hole.clear);
      break;
    case 850:
      steps.feed_to(hole.bottom);
      steps.feed_to(hole.r);
      steps.rapid_to(hole.clear);
      break;
    case 860:
      steps.feed_to(hole.bottom);
      steps.wait();
      steps.turn(0);
      steps.rapid_to(hole.clear);
      steps.turn(hole.direction);
      break;
    case 870:
      steps.bore_backwards();
      break;
    case 880:
      steps.feed_to(hole.bottom);
      steps.wait();
      steps.turn(0);
      steps.wait_for_operator();
      steps.turn(hole.direction);
      break;
    case 890:
      steps.feed_to(hole.bottom);
      steps.wait();
      steps.feed_to(hole.clear);
      break;
    default:
      assert(false && "not a canned cycle");
  }
  return std::move(steps.out);
}

double cycle_step_count(int tenths, const CycleHole& hole) {
  constexpr double kMaxOfOthers = 12.0;
  if (!is_pecking(tenths)) return kMaxOfOthers;
  return 3.0 * (1.0 + (hole.r - hole.bottom) / hole.peck);
}

// ------------------------------------------------------------------------ the interpreter's part

void Interpreter::Machine::check_cycle() const {
  const Request::Chosen& chosen = request().motion;
  const std::string name = code_name('G', chosen.code->tenths);
  for (int i = kLinearJoints; i < kAxisWords; ++i) {
    if (has_axis(i)) {
      const char axis = letter(axis_at(i));
      fail_at(axis,
              fmt::format("{} word with {}; rotary axes are not allowed in a cycle", axis, name));
    }
  }
  if (state_.feed_mode == FeedMode::inverse_time) {
    fail(chosen.column, fmt::format("{} with G93; a cycle requires G94 or G95", name));
  }
  if (state_.feed_linear == 0.0) {
    fail(chosen.column, zero_feed(name));
  }
  if (state_.tool_control == ToolControl::tool_axis) {
    fail(chosen.column, fmt::format("{} is not supported with G43.5; use G43.4 or G68.2", name));
  }
  if (state_.is_uvw_plane) {
    fail(
        chosen.column,
        fmt::format(
            "{} is not supported in a plane of U, V and W (G17.1 G18.1 G19.1); use G17, G18 or G19",
            name));
  }
}

double Interpreter::Machine::cycle_word(char letter, double kept, bool goes_on) const {
  if (request().has(letter)) return request()[letter];
  const Request::Chosen& chosen = request().motion;
  if (!goes_on) {
    fail(chosen.column, fmt::format("{} requires {}, which no earlier {} has set",
                                    code_name('G', chosen.code->tenths), letter,
                                    code_name('G', chosen.code->tenths)));
  }
  return kept;
}

void Interpreter::Machine::check_cycle_spindle() const {
  const Request::Chosen& chosen = request().motion;
  const int code = chosen.code->tenths;
  const int wanted = code == 840 ? 1 : code == 740 ? -1 : state_.spindle_direction;
  if (!is_tapping(code) && code != 860 && code != 870 && code != 880) return;
  if (state_.spindle_direction == 0) {
    fail(chosen.column,
         fmt::format("{} requires a running spindle; start it with {}", code_name('G', code),
                     code == 840   ? "M3"
                     : code == 740 ? "M4"
                                   : "M3 or M4"));
  }
  if (state_.spindle_direction != wanted) {
    fail(chosen.column,
         fmt::format("{} with the spindle running {}; it requires {}", code_name('G', code),
                     wanted > 0 ? "counter-clockwise (M4)" : "clockwise (M3)",
                     wanted > 0 ? "M3" : "M4"));
  }
}

// Words of this block, or what the cycle before left.
CycleHole Interpreter::Machine::cycle_hole(bool goes_on) {
  const int code = request().motion_code();
  const char normal = letter(axis_at(state_.normal_axis));
  CycleMemory& kept = state_.cycle;
  kept.r = cycle_word('R', kept.r, goes_on);
  kept.bottom = cycle_word(normal, kept.bottom, goes_on);
  const double from = in_unit(state_.position[state_.normal_axis], state_.unit);
  if (!kept.has_level) kept.level = from;
  kept.has_level = true;
  require_known_level();
  CycleHole hole;
  hole.r = kept.r + (state_.is_incremental ? kept.level : 0.0);
  hole.bottom = kept.bottom + (state_.is_incremental ? hole.r : 0.0);
  if (hole.r < hole.bottom) {
    fail(cycle_column(request().has('R') ? 'R' : normal),
         fmt::format("{}: R = {} is below {} = {}, the bottom", code_name('G', code), hole.r,
                     normal, hole.bottom));
  }
  hole.clear = state_.retracts_to_r ? hole.r : std::max(kept.level, hole.r);
  if (has_dwell(code) || is_tapping(code)) {
    kept.dwell = cycle_word('P', kept.dwell, goes_on || is_tapping(code));
    if (request().has('P') && has_unknown_dwell()) kept.dwell = kUnknownValue;
    if (kept.dwell < 0.0) fail_at('P', fmt::format("P{}; must be >= 0", kept.dwell));
    hole.dwell = kept.dwell;
  }
  if (is_pecking(code)) {
    kept.peck = cycle_word('Q', kept.peck, goes_on);
    if (!(kept.peck > 0.0)) fail_at('Q', fmt::format("Q{}; must be > 0", kept.peck));
    hole.peck = kept.peck;
  }
  if (code == 870) hole.middle = cycle_offsets(hole, goes_on);
  hole.backed_off = kBackedOff / state_.unit;
  hole.direction = state_.spindle_direction;
  return hole;
}

// The level that a row of cycles begins at counts for G98 and under G91.
void Interpreter::Machine::require_known_level() {
  if (!state_.is_height_unknown) return;
  if (state_.is_incremental || !state_.retracts_to_r) {
    fail(request().motion.column,
         "the start Z of the cycle depends on the unknown tool length; program Z first, or pass a "
         "tool table with --tools");
  }
  state_.is_height_unknown = false;
}

// I J K of G87: two of them lead beside the hole, the third is where the bore ends.
double Interpreter::Machine::cycle_offsets(const CycleHole& hole, bool goes_on) {
  CycleMemory& kept = state_.cycle;
  kept.i = cycle_word('I', kept.i, goes_on);
  kept.j = cycle_word('J', kept.j, goes_on);
  kept.k = cycle_word('K', kept.k, goes_on);
  const double middle =
      std::array{kept.i, kept.j, kept.k}[static_cast<std::size_t>(state_.normal_axis)];
  return middle + (state_.is_incremental ? hole.bottom : 0.0);
}

int Interpreter::Machine::cycle_repeats(const CycleHole& hole) const {
  const int repeats = request().has('L') ? integer('L') : 1;
  if (repeats < 1) fail_at('L', fmt::format("L{}; must be at least 1", repeats));
  const int code = request().motion_code();
  const double steps = (3.0 + cycle_step_count(code, hole)) * repeats;
  if (steps > kMaxSteps) {
    fail(cycle_column(repeats > 1 ? 'L' : 'Q'),
         fmt::format("{} would generate {:.0f} moves; must be <= {:.0f}", code_name('G', code),
                     steps, kMaxSteps));
  }
  return repeats;
}

void Interpreter::Machine::cycle_move(MoveKind kind, const AxisWords& end) {
  const double length = (end - state_.position).head<3>().norm();
  move_to(kind, end, length, kind == MoveKind::rapid ? 0.0 : move_feed(length, 0.0));
}

// @param over  the hole, at any level
void Interpreter::Machine::do_cycle_step(const CycleStep& step, const AxisWords& over) {
  const int n = state_.normal_axis;
  AxisWords end = over;
  end[n] = step.level * state_.unit;
  switch (step.kind) {
    case CycleStep::Kind::rapid: {
      const CycleMemory& kept = state_.cycle;
      const Eigen::Vector3d beside(kept.i, kept.j, kept.k);
      for (int k = 0; step.is_beside && k < 3; ++k) {
        if (k != n) end[k] += beside[k] * state_.unit;
      }
      return cycle_move(MoveKind::rapid, end);
    }
    case CycleStep::Kind::feed:
      if (is_tapping(request().motion_code())) end = confused_tap(end);
      return cycle_move(MoveKind::feed, end);
    case CycleStep::Kind::dwell:
      emit(MoveKind::dwell).value = step.dwell;
      return;
    case CycleStep::Kind::spindle:
      state_.spindle_direction = step.direction;
      return emit_spindle();
    case CycleStep::Kind::stop:
      emit(MoveKind::stop).number = 0;
      return;
  }
}

// LinuxCNC sorts the coordinates of a tapping move twice by their plane, which is right in G17
// only.
AxisWords Interpreter::Machine::confused_tap(const AxisWords& end) {
  const int n = state_.normal_axis;
  if (n == 2) return end;
  const int first = (n + 1) % 3, second = (n + 2) % 3;
  AxisWords out = end;
  out[first] = n == 0 ? end[n] : end[second];
  out[second] = n == 0 ? end[first] : end[n];
  out[n] = n == 0 ? end[second] : end[first];
  const std::string message =
      fmt::format("{} outside G17 swaps coordinates, as in LinuxCNC 2.9; use G17 for tapping",
                  code_name('G', request().motion_code()));
  const bool is_said = !warnings_.empty() && warnings_.back().place.line == line() &&
                       warnings_.back().message == message;
  if (!is_said) warn(request().motion.column, message);
  return out;
}

// From below R to the hole, and then up.
bool Interpreter::Machine::positions_below_r() const {
  return setup_.reader != Reader::linuxcnc && reading_.positions_below_r();
}

void Interpreter::Machine::canned_cycle(int motion_before) {
  check_cycle();
  const CycleHole hole = cycle_hole(motion_before == request().motion_code());
  const int repeats = cycle_repeats(hole);
  check_cycle_spindle();
  warn_of_leaning_tool();
  const int n = state_.normal_axis;
  const auto at_level = [&](AxisWords words, double level) {
    words[n] = level * state_.unit;
    return words;
  };
  const auto next_hole = [&](AxisWords words) {
    if (request().has_polar()) words.head<2>() = polar_end(words.head<2>());
    for (int k = 0; k < 3; ++k) {
      if (k == n || !has_axis(k)) continue;
      words[k] = axis_word(k) + (state_.is_incremental ? words[k] : 0.0);
    }
    return words;
  };
  AxisWords over = state_.position;
  double from = in_unit(state_.position[n], state_.unit);
  if (state_.cycle.level < hole.r) {
    const AxisWords begin = positions_below_r() ? next_hole(over) : over;
    if (positions_below_r()) cycle_move(MoveKind::rapid, begin);
    cycle_move(MoveKind::rapid, at_level(begin, hole.r));
    from = hole.r;
  }
  const PathMode path_mode = std::exchange(state_.path_mode, PathMode::exact_path);
  const double path_tolerance = std::exchange(state_.path_tolerance, 0.0);
  const std::vector<CycleStep> steps = cycle_steps(request().motion_code(), hole);
  for (int repeat = 0; repeat < repeats; ++repeat) {
    over = next_hole(over);
    const double level = repeat == 0 && from > hole.r ? from : hole.clear;
    cycle_move(MoveKind::rapid, at_level(over, level));
    if (level > hole.r) cycle_move(MoveKind::rapid, at_level(over, hole.r));
    for (const CycleStep& step : steps) do_cycle_step(step, over);
  }
  state_.position = at_level(over, hole.clear);
  state_.path_mode = path_mode;
  state_.path_tolerance = path_tolerance;
}

}  // namespace servomill::controllers
