/// Programs in the words of other controls, and the moves that their manuals say follow, worked out
/// by hand: nothing here was taken from a run.
///
/// Notation of moves, in machine coordinates and millimetres, one after the other behind '|':
///   R x y z           rapid; a "?" is a coordinate that is not known
///   F x y z f100      feed move; the feed, mm/min, where it is another one than before
///   CW x y z o i j k  arc to x y z about i j k, clockwise about Z; CCW; in other planes CW18,
///   CCW19 W 0.5             dwell, s S+100 S-100 S0    spindle, rpm T5 C1 P0 E        tool,
///   coolant, stop (M0), end of the program
/// A rapid or feed to where the tool stands and a dwell of nothing are left out, and so is the end.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controllers/gcode/interpreter.h"
#include "controllers/gcode/reader.h"
#include "controllers/gcode/readers/differences.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {

/// Options that the user gives with the program.
struct Given {
  bool has_tools = false;    // T1 10 mm long, diameter 2 mm; T2 20 mm, 4 mm
  bool has_homes = false;    // G28 X-10 Y-20 Z-30, G30 X-1 Y-2 Z-3
  bool has_offsets = false;  // G54 X100 Y200 Z300; G54.1 P3 X10 Y20 Z30
  bool skips_blocks = false;
  bool lacks_lengths = false;
  double feed = 0.0;                                      // mm/min
  int ignored_code = -1;                                  // M code of the builder
  DecimalPoint decimal_point = DecimalPoint::calculator;  // of Fanuc and Haas
  std::string O7_file = {};                               // text of O0007.nc
};

struct RuleExample {
  ReaderRule rule;
  Reader reader;
  std::string program, moves;
  std::string place;   // of the warning
  std::string source;  // that the moves were worked out from
  Given given = {};
};

struct DifferenceExample {
  WordDifference difference;
  int reading;  // 0 or 1
  Reader reader;
  std::string program, moves, source;
  Given given = {};
};

inline ProgramSetup setup_of(const Given& given, Reader reader) {
  ProgramSetup setup;
  setup.reader = reader;
  const bool depends = reader == Reader::fanuc || reader == Reader::haas;
  if (depends) setup.decimal_point = given.decimal_point;
  if (given.has_tools) setup.tools = ToolTable::parse("T1 P1 Z10 D2\nT2 P2 Z20 D4\n", "tools.tbl");
  if (given.has_homes) {
    setup.stored = {{5161, -10.0}, {5162, -20.0}, {5163, -30.0},
                    {5181, -1.0},  {5182, -2.0},  {5183, -3.0}};
  }
  if (given.has_offsets) {
    setup.work_offset[0] << 100 * mm, 200 * mm, 300 * mm, 0, 0, 0;
    setup.start = setup.work_offset[0];
    setup.additional_offsets[3] = (AxisWords() << 10 * mm, 20 * mm, 30 * mm, 0, 0, 0).finished();
  }
  setup.block_delete = given.skips_blocks;
  setup.accepts_unknown_lengths = given.lacks_lengths;
  if (given.ignored_code >= 0) setup.ignored_codes.insert(given.ignored_code);
  if (!given.O7_file.empty()) {
    setup.subroutine_file = [text = given.O7_file](const std::string& name) {
      return name == "7" ? std::optional(ProgramText::of_text(text, "O0007.nc")) : std::nullopt;
    };
  }
  if (given.feed > 0.0) setup.feed = given.feed * mm_per_min;
  return setup;
}

/// Six decimals at most: a nanometre.
inline std::string number_of(double value) {
  if (std::isnan(value)) return "?";
  std::string text = fmt::format("{:.6f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

inline std::string point_of(const Eigen::Vector3d& p) {
  return number_of(p.x() / mm) + " " + number_of(p.y() / mm) + " " + number_of(p.z() / mm);
}

/// Writes moves in the notation above.
class Notation {
 public:
  explicit Notation(const ProgramSetup& setup) : at_(point_of(setup.start.head<3>())) {}

  void add(const Move& move) {
    const std::string text = written(move);
    if (text.empty()) return;
    text_ += (text_.empty() ? "" : " | ") + text;
  }
  std::string text() const {
    constexpr std::string_view kStop = " | S0";
    return text_.ends_with(kStop) ? text_.substr(0, text_.size() - kStop.size()) : text_;
  }

 private:
  std::string written(const Move& move) {
    switch (move.kind) {
      case MoveKind::rapid:
      case MoveKind::feed:
        return straight(move);
      case MoveKind::arc:
        return arc(move);
      case MoveKind::dwell:
        return move.value == 0.0 ? "" : "W " + number_of(move.value);
      case MoveKind::tool:
        return fmt::format("T{}", move.number);
      case MoveKind::spindle:
        return spindle(move);
      case MoveKind::coolant:
        return fmt::format("C{}", move.number);
      case MoveKind::stop:
        return fmt::format("P{}", move.number);
      default:
        return "";
    }
  }
  std::string spindle(const Move& move) {
    const bool stood = std::exchange(direction_, move.direction) == 0;
    if (move.direction == 0) return stood ? "" : "S0";
    return (move.direction > 0 ? "S+" : "S-") + number_of(move.value / rpm);
  }
  std::string straight(const Move& move) {
    const std::string end = end_of(move);
    if (end == at_) return "";
    at_ = end;
    return move.kind == MoveKind::rapid ? "R " + end : "F " + end + feed_of(move);
  }
  std::string arc(const Move& move) {
    const int n = move.arc.normal_axis;
    const std::string plane = n == 2 ? "" : n == 1 ? "18" : "19";
    at_ = end_of(move);
    return (move.arc.turns < 0 ? "CW" : "CCW") + plane + " " + at_ + " o " +
           point_of(move.centre_machine) + feed_of(move);
  }
  static std::string end_of(const Move& move) {
    std::string text = point_of(move.end_machine.head<3>());
    const AxisWords& end = move.end_machine;
    if (end.tail<3>().cwiseAbs().maxCoeff() > 0.0) {
      text += fmt::format(" a{} b{} c{}", number_of(end[3] / deg), number_of(end[4] / deg),
                          number_of(end[5] / deg));
    }
    return text;
  }
  std::string feed_of(const Move& move) {
    const std::string feed = number_of(move.feed / mm_per_min);
    if (feed == feed_) return "";
    feed_ = feed;
    return " f" + feed;
  }

  std::string text_, at_, feed_;
  int direction_ = 0;  // of the spindle
};

/// Reading of a program.
struct Reading {
  std::string moves;  // or the refusal
  std::vector<Fault> warnings;
};

inline Reading read(const std::string& program, Reader reader, const Given& given) {
  const ProgramSetup setup = setup_of(given, reader);
  Notation notation(setup);
  Reading out;
  try {
    Interpreter interpreter(program, "p.nc", setup);
    while (const Move* move = interpreter.next()) {
      notation.add(*move);
    }
    out.moves = notation.text();
    out.warnings = interpreter.warnings();
  } catch (const InputError& error) {
    out.moves = error.what();
  }
  return out;
}

}  // namespace servomill::controllers
