#include "controllers/gcode/printer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/number_text.h"
#include "controllers/gcode/printed_number.h"
#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/spline_curve.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

std::string work_system_code(int system) {
  const auto digits = [](int number) { return std::to_string(number); };
  return system <= 6 ? "G" + digits(53 + system) : "G59." + digits(system - 6);
}

std::string path_code(const Move& move, RepeatedNumber& tolerance) {
  if (move.path_mode == PathMode::exact_path) return "G61";
  if (move.path_mode == PathMode::exact_stop) return "G61.1";
  if (move.path_tolerance == 0.0) return "G64";
  return "G64 P" + tolerance.text(move.path_tolerance / mm);
}

}  // namespace

class ProgramPrinter::Printer {
 public:
  Printer(const PrintOptions& options, TakeLine take)
      : options_(options),
        take_(std::move(take)),
        linear_(options.decimals_mm),
        rotary_(options.decimals_deg),
        machine_before_(options.start) {}

  void print(const Move& move) {
    print_move(move);
    before_ = move.end;
    // what is no motion may tell the place of the tip
    if (is_motion(move.kind)) machine_before_ = move.end_machine;
    is_ended_ = move.kind == MoveKind::end;
  }

  void finish() {
    if (!is_ended_) line("M30");
  }

  void print_header(std::string_view header) {
    while (!header.empty()) {
      const std::size_t end = std::min(header.find('\n'), header.size());
      line(remark(header.substr(0, end)));
      header.remove_prefix(std::min(end + 1, header.size()));
    }
    line("G21 G90 G91.1 G94 G17 G40 G80 G92.1");
  }

 private:
  using Steps = std::array<double, kAxisWords>;

  void line(std::string_view text) { take_(text); }

  void print_move(const Move& move) {
    switch (move.kind) {
      case MoveKind::rapid:
      case MoveKind::feed:
      case MoveKind::arc:
      case MoveKind::spline:
        return print_motion(move);
      case MoveKind::dwell:
        print_modes(move);
        print_feed_mode(move.feed_mode);
        return line(dwell_block(move.value));
      case MoveKind::tool:
        return line(fmt::format("T{} M6", move.number));
      case MoveKind::spindle:
        return print_spindle(move);
      case MoveKind::coolant:
        return print_coolant(move.number);
      case MoveKind::stop:
        return line(fmt::format("M{}", move.number));
      case MoveKind::end:
        return line("M30");
      case MoveKind::message:
        if (move.number == kProgramLine) return print_line(move.text);
        return line(fmt::format("({},{})", move.number == kPrintMessage ? "PRINT" : "MSG",
                                comment_text(move.text)));
    }
  }

  void print_line(const std::string& text) {
    line(text);
    for (std::string* mode : {&work_, &tool_, &path_, &F_, &S_}) mode->clear();
    steps_.reset();
  }

  void print_spindle(const Move& move) {
    const std::string S = significant_text(move.value / rpm);
    const bool only_stops = S_.empty() && move.direction == 0;
    const bool new_speed = S != S_ && !only_stops;
    if (new_speed) line("S" + S);
    if (!only_stops) S_ = S;
    if (!new_speed || move.direction != direction_) {
      line(move.direction > 0 ? "M3" : move.direction < 0 ? "M4" : "M5");
    }
    direction_ = move.direction;
  }

  void print_coolant(int wanted) {
    if ((coolant_ & ~wanted) != 0 || wanted == 0) {
      line("M9");
      coolant_ = 0;
    }
    const bool again = coolant_ == wanted;
    for (const auto& [bit, code] : {std::pair(kMist, "M7"), std::pair(kFlood, "M8")}) {
      if ((wanted & bit) != 0 && (again || (coolant_ & bit) == 0)) {
        line(code);
        if (again) break;
      }
    }
    coolant_ = wanted;
  }

  // Prints the modes of motion: work system, tool offset, path control.
  void print_modes(const Move& move) {
    print_offsets(move);
    change(path_, path_code(move, path_tolerance_), false);
  }
  void print_offsets(const Move& move) {
    change(work_, work_system_code(move.work_offset), true);
    if (move.tool_offset == kOtherToolOffset) {
      throw InputError({{}, move.line, 0},
                       "tool offsets of G43.1 and G43.2 cannot be output; use G43 H");
    }
    change(tool_, tool_code(move.tool_offset), true);
  }

  void print_feed_mode(FeedMode mode) {
    if (change(feed_mode_, feed_mode_code(mode), false)) F_.clear();
  }

  static std::string feed_mode_code(FeedMode mode) {
    return mode == FeedMode::inverse_time       ? "G93"
           : mode == FeedMode::units_per_minute ? "G94"
                                                : "G95";
  }

  std::string tool_code(int offset) const {
    if (options_.tcp_control) return "G43.4 H" + std::to_string(offset);
    return offset == 0 ? "G49" : "G43 H" + std::to_string(offset);
  }

  bool change(std::string& now, const std::string& wanted, bool moves_origin) {
    if (now == wanted) return false;
    now = wanted;
    line(wanted);
    if (moves_origin) steps_.reset();
    return true;
  }

  Steps steps_of(const AxisWords& end) const {
    Steps steps{};
    for (int i = 0; i < kAxisWords; ++i) {
      steps[static_cast<std::size_t>(i)] =
          i < kLinearJoints ? linear_.step_count(end[i] / mm) : rotary_.step_count(end[i] / deg);
    }
    return steps;
  }

  std::string axis_words(const Steps& steps, bool rotary_too = true) const {
    std::string text;
    for (const Axis axis : kAllAxes) {
      if (!rotary_too && !is_linear(axis)) continue;
      const auto i = static_cast<std::size_t>(index_of(axis));
      const bool of_machine = options_.axes.find(letter(axis)) != std::string::npos;
      const bool wanted = steps_ ? steps[i] != (*steps_)[i] : of_machine || steps[i] != 0.0;
      if (!wanted) continue;
      text += ' ';
      text += letter(axis);
      text += (is_linear(axis) ? linear_ : rotary_).text(steps[i]);
    }
    return text;
  }

  // I, J or K that put the centre on the grid, seen from the start as it was printed; absolute if
  // the start is not known, behind a change of offset.
  std::string centre_words(const Move& move) const {
    std::string text;
    for (int k = 1; k <= 2; ++k) {
      const int i = (move.arc.normal_axis + k) % 3;
      const double start = steps_ ? (*steps_)[static_cast<std::size_t>(i)] : 0.0;
      text += fmt::format(" {}{}", "IJK"[i],
                          linear_.text(linear_.step_count(move.arc.centre[i] / mm) - start));
    }
    return text;
  }

  // Does an arc print with equal ends although it is much less than a full circle?
  bool vanishes(const Move& move, const Steps& steps) const {
    const int first = (move.arc.normal_axis + 1) % 3, second = (move.arc.normal_axis + 2) % 3;
    if (!steps_) return false;
    const Steps& start = *steps_;
    const auto same = [&](int i) {
      return start[static_cast<std::size_t>(i)] == steps[static_cast<std::size_t>(i)];
    };
    if (!same(first) || !same(second)) return false;
    const ArcSweep arc(before_.head<3>(), move.end.head<3>(), move.arc.centre, move.arc.normal_axis,
                       move.arc.turns);
    return std::abs(arc.sweep) < std::numbers::pi;
  }

  // F in force for this move, in 1/min under G93, per revolution under G95. A displaced block may
  // move X, Y and Z where the path of the original stands.
  double feed_value(const Move& move) const {
    const AxisWords moved = move.end_machine - machine_before_;
    const double turned = moved.tail<3>().norm(), own = moved.head<3>().norm();
    const double length = move.s_end - move.s_begin;
    if (move.feed_mode == FeedMode::inverse_time) {
      const double way = length > 0.0 ? length : turned > 0.0 ? turned : own;
      return way > 0.0 ? move.feed * minute / way : 1.0;
    }
    const bool moves_xyz = move.kind == MoveKind::arc || length > 0.0 || !linear_.is_zero(own / mm);
    if (move.feed_mode == FeedMode::units_per_revolution) {
      return move.value / (moves_xyz ? mm : deg);
    }
    return move.feed / (moves_xyz ? mm_per_min : deg_per_min);
  }

  // mm of X, Y and Z where they move, else deg of the rotary axes: as printed.
  double printed_length(const Move& move, const Steps& steps) const {
    AxisWords moved = move.end_machine - machine_before_;
    moved.head<3>() /= mm;
    moved.tail<3>() /= deg;
    for (int i = 0; steps_ && i < kAxisWords; ++i) {
      const auto k = static_cast<std::size_t>(i);
      moved[i] = (i < kLinearJoints ? linear_ : rotary_).value(steps[k] - (*steps_)[k]);
    }
    const double own = moved.head<3>().norm();
    return own > 0.0 ? own : moved.tail<3>().norm();
  }

  // Under G93 nothing runs slower than kSlowestInverse, whatever F is. A displaced block that
  // must, since its rotary axes take their time while X, Y and Z hardly move, runs under G94.
  // @return F under G94; nullopt where the move keeps its own mode
  std::optional<double> slow_feed(const Move& move, const Steps& steps) const {
    constexpr double kDigits = 1e-9;  // relative
    if (move.feed_mode != FeedMode::inverse_time || move.kind != MoveKind::feed) return {};
    const double feed = feed_value(move) * printed_length(move, steps);
    const bool is_slow = feed > 0.0 && feed < kSlowestInverse * (1.0 - kDigits);
    return is_slow ? std::optional(feed) : std::nullopt;
  }

  std::string feed_word(double feed) {
    const std::string& F = feed_.text(feed);
    if (feed_mode_ != "G93" && F == F_) return {};
    F_ = F;
    return " F" + F;
  }

  void print_motion(const Move& move) {
    if (move.tool_control != ToolControl::none) {
      throw InputError({{}, move.line, 0}, "TCP control and tilted work planes cannot be output");
    }
    if (move.feed_mode == FeedMode::units_per_revolution && S_ == "0") {
      throw InputError({{}, move.line, 0},
                       "a feed per revolution with zero spindle speed cannot be output");
    }
    if (move.synchronised != Synchronised::no) return print_synchronised(move);
    print_modes(move);
    const Steps steps = steps_of(move.end);
    if (move.kind == MoveKind::spline) return print_spline(move, steps);
    const std::optional<double> slow = slow_feed(move, steps);
    print_feed_mode(slow ? FeedMode::units_per_minute : move.feed_mode);
    const bool is_arc = move.kind == MoveKind::arc && !vanishes(move, steps);
    if (is_arc) {
      static constexpr std::array<std::string_view, 3> kPlanes = {"G19", "G18", "G17"};
      change(plane_, std::string(kPlanes[static_cast<std::size_t>(move.arc.normal_axis)]), false);
    }
    std::string text = is_arc                         ? move.arc.turns > 0 ? "G3" : "G2"
                       : move.kind == MoveKind::rapid ? "G0"
                                                      : "G1";
    const std::string words = axis_words(steps);
    text += words;
    if (is_arc) {
      text += centre_words(move);
      if (std::abs(move.arc.turns) > 1) text += fmt::format(" P{}", std::abs(move.arc.turns));
    } else if (words.empty()) {
      text += " X" + linear_.text(steps[0]);  // a motion without axis words would be none
    }
    if (move.kind != MoveKind::rapid) text += feed_word(slow.value_or(feed_value(move)));
    const bool is_absolute = is_arc && !steps_;
    if (is_absolute) line("G90.1");
    line(text);
    if (is_absolute) line("G91.1");
    steps_ = steps;
  }

  // G33.1 includes the return. G33 and G33.1 end at rest whatever the path mode, and have no F.
  void print_synchronised(const Move& move) {
    if (move.synchronised == Synchronised::tap_out) return;
    constexpr double kShortest = 2.0;
    if (linear_.step_count((move.s_end - move.s_begin) / mm) < kShortest) {
      throw InputError({{}, move.line, 0}, "a G33 move shorter than the output resolution");
    }
    print_offsets(move);
    if (feed_mode_ == feed_mode_code(FeedMode::inverse_time)) {
      print_feed_mode(FeedMode::units_per_minute);
    }
    const bool is_tap = move.synchronised == Synchronised::tap_in;
    const Steps steps = steps_of(move.end);
    line(fmt::format("{}{} K{}", is_tap ? "G33.1" : "G33", axis_words(steps, !is_tap),
                     significant_text(move.value / mm)));
    if (!is_tap) steps_ = steps;
  }

  // A NURBS has no feed in inverse time: its own is that of G94.
  void print_spline(const Move& move, const Steps& steps) {
    const bool per_revolution = move.feed_mode == FeedMode::units_per_revolution;
    print_feed_mode(per_revolution ? move.feed_mode : FeedMode::units_per_minute);
    change(plane_, "G17", false);
    const SplineCurve& curve = move.spline->curve;
    line(fmt::format("G5.2 P{} L{}{}", significant_text(curve.weights()[0]), curve.order(),
                     feed_word(per_revolution ? move.value / mm : move.feed / mm_per_min)));
    for (std::size_t i = 1; i < curve.weights().size(); ++i) {
      const Eigen::Vector3d& p = move.spline->points[i];
      line(fmt::format("X{} Y{} P{}", linear_.text(linear_.step_count(p.x() / mm)),
                       linear_.text(linear_.step_count(p.y() / mm)),
                       significant_text(curve.weights()[i])));
    }
    line("G5.3");
    if (steps_) steps_ = steps;  // else the next motion names all axes
  }

  const PrintOptions options_;
  const TakeLine take_;
  PrintedGrid linear_;
  PrintedGrid rotary_;
  bool is_ended_ = false;
  AxisWords before_ = AxisWords::Zero();  // end of the move before
  AxisWords machine_before_;              // end of the motion before, in the machine
  std::optional<Steps> steps_;            // what was printed for it; nullopt: name all axes
  RepeatedNumber path_tolerance_, feed_;
  std::string work_, tool_, path_, plane_ = "G17", feed_mode_ = "G94", F_, S_ = "0";
  int direction_ = 0;
  int coolant_ = 0;
};

ProgramPrinter::ProgramPrinter(const PrintOptions& options, std::string_view header, TakeLine take)
    : printer_(std::make_unique<Printer>(options, std::move(take))) {
  printer_->print_header(header);
}
ProgramPrinter::~ProgramPrinter() = default;
void ProgramPrinter::print(const Move& move) { printer_->print(move); }
void ProgramPrinter::finish() { printer_->finish(); }

PrintedProgram print_program(std::span<const Move> moves, const PrintOptions& options,
                             std::string_view header) {
  PrintedProgram out;
  int index = -1;
  ProgramPrinter printer(options, header, [&](std::string_view line) {
    out.text += line;
    out.text += '\n';
    out.move_of_line.push_back(index);
  });
  for (const Move& move : moves) {
    ++index;
    printer.print(move);
  }
  index = -1;
  printer.finish();
  return out;
}

}  // namespace servomill::controllers
