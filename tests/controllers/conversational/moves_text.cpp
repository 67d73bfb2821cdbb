#include "moves_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "controllers/gcode/interpreter.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::conversational {
namespace {

// With at most four decimals and without -0.
std::string number(double value) {
  std::string text = fmt::format("{:.4f}", value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string position(const Move& move) {
  std::string out;
  for (int i = 0; i < 3; ++i) out += " " + number(move.end[i] / mm);
  for (int i = 3; i < kAxisWords; ++i) {
    const std::string angle = number(move.end[i] / deg);
    if (angle != "0")
      out += fmt::format(" {}{}", letter(kAllAxes[static_cast<std::size_t>(i)]), angle);
  }
  return out;
}

std::string motion(const Move& move, const Move* before) {
  if (move.kind == MoveKind::rapid) return "rapid" + position(move);
  const bool is_rotary = before != nullptr && (move.end - before->end).head<3>().isZero(1e-12) &&
                         move.kind != MoveKind::arc;
  const std::string feed = " F" + number(move.feed / (is_rotary ? deg : mm) * minute);
  if (move.kind == MoveKind::feed) return "feed" + position(move) + feed;
  std::string out = "arc" + position(move) + " about";
  for (int i = 0; i < 3; ++i) {
    if (i != move.arc.normal_axis) out += " " + number(move.arc.centre[i] / mm);
  }
  return out + fmt::format(" turns {}", move.arc.turns) + feed;
}

std::string action(const Move& move) {
  switch (move.kind) {
    case MoveKind::dwell:
      return "dwell " + number(move.value);
    case MoveKind::tool:
      return fmt::format("tool {}", move.number);
    case MoveKind::spindle:
      return fmt::format("spindle {} S{}", move.direction, number(move.value / rpm));
    case MoveKind::coolant:
      return fmt::format("coolant {}", move.number);
    case MoveKind::stop:
      return fmt::format("stop {}", move.number);
    default:
      return "end";
  }
}

}  // namespace

ProgramSetup example_setup() {
  ProgramSetup setup;
  setup.tools = ToolTable::parse("T1 P1 Z100 D10\nT2 P2 Z50 D20\n", "tools.tbl");
  setup.reader = Reader::any;
  return setup;
}

std::string with_frame(const std::string& lines) {
  return "BEGIN PGM T MM\nTOOL CALL 1 Z S1000\nL X+0 Y+0 Z+0 R0 FMAX\n" + lines + "END PGM T MM\n";
}

std::string text_of(const std::vector<Move>& moves, int frame_lines, int last_line) {
  std::string out;
  const Move* before = nullptr;
  for (const Move& move : moves) {
    const bool is_frame = move.line <= frame_lines || move.line > last_line ||
                          (frame_lines > 0 && move.kind == MoveKind::end);
    if (!is_frame) {
      out += fmt::format("{} {}\n", move.line - frame_lines,
                         is_motion(move.kind) && move.kind != MoveKind::dwell ? motion(move, before)
                                                                              : action(move));
    }
    if (is_motion(move.kind)) before = &move;
  }
  return out;
}

std::string all_moves(const std::string& program, const ProgramSetup& setup) {
  return text_of(interpret(program, "t.h", setup));
}

std::string framed_moves(const std::string& lines, const ProgramSetup& setup) {
  const auto count = static_cast<int>(std::count(lines.begin(), lines.end(), '\n'));
  return text_of(interpret(with_frame(lines), "t.h", setup), kFrameLines, kFrameLines + count);
}

std::string fault_of(const std::string& lines, const ProgramSetup& setup) {
  try {
    interpret(with_frame(lines), "t.h", setup);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace servomill::controllers::conversational
