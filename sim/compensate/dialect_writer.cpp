#include "sim/compensate/dialect_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>

#include "controllers/gcode/canned_cycles.h"
#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/request.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/compensate/line_pieces.h"

namespace servomill::sim {
namespace {

using controllers::Code;
using controllers::Group;

// A name that every control takes.
std::string program_name(const std::string& file) {
  std::string out;
  for (const char c : std::filesystem::path(file).stem().string()) {
    const bool is_plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || c == '_';
    out += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : is_plain ? c : '_';
  }
  return out.empty() ? "PROGRAM" : out;
}

// Whether moves, or modes that go into their numbers, are all that a code is about.
bool is_in_the_moves(const Code& code) {
  switch (code.group) {
    case Group::g_motion:
    case Group::g_plane:
    case Group::g_distance:
    case Group::g_arc_distance:
    case Group::g_feed_mode:
    case Group::g_units:
    case Group::g_cutter_compensation:
    case Group::g_retract:
    case Group::g_work_system:
    case Group::g_path_control:
      return true;
    case Group::g_tool_length:
      return code.tenths == 430 || code.tenths == 490;
    case Group::g_spindle_mode:
      return code.tenths == 970;
    case Group::g_non_modal:
      return code.tenths == 40 || code.tenths == 280 || code.tenths == 300 || code.tenths == 530 ||
             code.tenths == 520 || (code.tenths >= 920 && code.tenths <= 923);
    case Group::m_stop:
      return code.tenths <= 20 || code.tenths == 300 || code.tenths == 990;
    case Group::m_tool:
      return code.tenths == 60;
    case Group::m_spindle:
      return code.tenths <= 50;
    case Group::m_coolant:
      return true;
    default:
      return false;
  }
}

std::string comment_text(std::string_view piece) {
  const bool is_round = piece.front() == '(';
  std::string_view text = piece.substr(1, piece.size() - (is_round ? 2 : 1));
  const std::size_t first = text.find_first_not_of(" \t");
  return std::string(first == std::string_view::npos ? std::string_view() : text.substr(first));
}

bool is_spoken(std::string_view text) {
  for (const std::string_view key : {"MSG", "DEBUG", "PRINT", "msg", "debug", "print"}) {
    if (text.starts_with(key) && text.find(',') != std::string_view::npos) return true;
  }
  return false;
}

}  // namespace

DialectWriter::DialectWriter(Walk& walk, Summary& summary, Dialect dialect, std::string file)
    : walk_(walk),
      summary_(summary),
      dialect_(dialect),
      file_(std::move(file)),
      name_(program_name(file_)),
      printer_(make_dialect(dialect, lines_)) {}
DialectWriter::~DialectWriter() = default;

void DialectWriter::check_codes(const Block& block) const {
  if (block.request == nullptr) return;
  for (const auto& chosen : block.request->codes) {
    if (chosen.code == nullptr || is_in_the_moves(*chosen.code)) continue;
    const bool is_M = chosen.code->group >= Group::m_input_output;
    throw InputError({file_, block.line, chosen.column},
                     fmt::format("{} cannot be said for {}",
                                 controllers::code_name(is_M ? 'M' : 'G', chosen.code->tenths),
                                 kDialects[static_cast<std::size_t>(dialect_)]));
  }
}

void DialectWriter::note_what_became_numbers(const Block& block) {
  for (const LinePiece& piece : line_pieces(block)) {
    if (piece.kind == PieceKind::o_word) summary_.unrolled = true;
    if (piece.kind == PieceKind::block_delete) summary_.takes_blocks_with_slash = true;
    if (!piece.is_constant) summary_.has_expressions = true;
    if (piece.kind != PieceKind::comment) continue;
    const std::string text = comment_text(piece.of(block.text));
    if (!text.empty() && !is_spoken(text)) printer_->comment(text);
  }
  if (block.is_repeated || block.call_depth > 0) summary_.unrolled = true;
  if (block.request == nullptr) return;
  const int motion = block.request->motion_code();
  summary_.has_cycles |= controllers::is_canned_cycle(motion);
  summary_.has_cutter_compensation |= block.request->code(Group::g_cutter_compensation) > 400;
}

void DialectWriter::write(const Block& block) {
  if (block.block != nullptr && block.block->deleted) return printer_->comment(block.text);
  if (is_skipped(block)) summary_.unrolled = true;
  says_path_ =
      says_path_ || (block.request != nullptr && block.request->code(Group::g_path_control) >= 0);
  note_what_became_numbers(block);
  check_codes(block);
  try {
    say(block);
  } catch (const Unsayable& what) {
    throw InputError({file_, block.line},
                     fmt::format("{}; that cannot be said for {}", what.why,
                                 kDialects[static_cast<std::size_t>(dialect_)]));
  }
}

void DialectWriter::say(const Block& block) {
  if (block.request != nullptr && block.request->has('T') &&
      block.request->code(Group::m_tool) < 0) {
    printer_->preselect(block.state->selected_tool);
  }
  for (const Move& move : block.moves) {
    if (is_motion(move.kind)) {
      say_step(block, walk_.next(move, block));
    } else {
      say_other(move);
    }
  }
}

void DialectWriter::say_other(const Move& move) {
  switch (move.kind) {
    case MoveKind::tool:
      tool_ = move.number;
      return printer_->tool(move.number, rpm_);
    case MoveKind::spindle:
      rpm_ = move.value / rpm;
      return printer_->spindle(move.direction, rpm_);
    case MoveKind::coolant: {
      const int added = move.number & ~coolant_;
      if (move.number == 0) printer_->coolant(9);
      if ((added & controllers::kMist) != 0) printer_->coolant(7);
      if ((added & controllers::kFlood) != 0) printer_->coolant(8);
      coolant_ = move.number;
      return;
    }
    case MoveKind::dwell:
      return printer_->dwell(move.value);
    case MoveKind::stop:
      return printer_->stop(move.number);
    case MoveKind::end:
      return printer_->end();
    case MoveKind::message:
      return printer_->message(move.text);
    default:
      return;
  }
}

// What holds for motion, said before the first that it holds for.
void DialectWriter::say_modes(const Block& block, const Step& step) {
  const Move& move = *step.move;
  if (move.feed_mode != FeedMode::units_per_minute && move.feed_mode != FeedMode::inverse_time) {
    throw Unsayable{"feeds per revolution (G95)"};
  }
  if (move.work_offset != work_system_) printer_->work_system(move.work_offset);
  work_system_ = move.work_offset;
  const std::string path =
      fmt::format("{} {}", static_cast<int>(move.path_mode), move.path_tolerance);
  // a canned cycle follows its path exactly, whatever is in force
  const bool is_of_cycle =
      block.request != nullptr && controllers::is_canned_cycle(block.request->motion_code());
  if (path != path_ && says_path_ && !is_of_cycle) {
    printer_->path_mode(move.path_mode, move.path_tolerance);
    path_ = path;
  }
  const bool minds_length =
      move.kind != MoveKind::rapid || step.programmed.begin[2] != step.programmed.end[2];
  if (is_place_of_machine(block) || !minds_length) return;
  const bool is_new = move.tool_offset != tool_offset_;
  // the control may take a length of itself
  if (is_new || dialect_ == Dialect::heidenhain) {
    printer_->tool_length(move.tool_offset, tool_);
    must_name_Z_ = is_new;
  }
  tool_offset_ = move.tool_offset;
}

void DialectWriter::say_step(const Block& block, const Step& step) {
  const Move& move = *step.move;
  const controllers::ModalState& state = *block.state;
  say_modes(block, step);
  DialectMotion motion;
  motion.is_rapid = move.kind == MoveKind::rapid;
  motion.is_place = is_place_of_machine(block);
  // work coordinates without rotation and shift
  AxisWords origin = AxisWords::Zero();
  if (!motion.is_place) origin = state.work_offset + state.tool_offset;
  const double turned = step.programmed.turns_axes()
                            ? (step.programmed.end - step.programmed.begin).tail<3>().norm()
                            : 0.0;
  const double length = step.programmed.length();
  AxisWords at = walk_.out() - origin;
  const double grid = std::pow(10.0, -printer_->decimals());
  for (const FittedBlock& fitted : step.blocks) {
    const AxisWords target = step.programmed.frame.machine(fitted.end) - origin;
    motion.words.clear();
    double way = 0.0;
    for (const Axis axis : kAllAxes) {
      const int i = index_of(axis);
      const double unit = is_linear(axis) ? mm : deg;
      const double value = std::round(target[i] / unit / grid) * grid;
      const bool is_forced = axis == Axis::Z && must_name_Z_ && walk_.is_known(Axis::Z);
      const bool moves = std::abs(target[i] - at[i]) > 0.5 * grid * unit;
      if (!moves && !is_forced) continue;
      if (is_linear(axis)) way = std::hypot(way, value * unit - at[i]);
      motion.words.emplace_back(axis, value);
      at[i] = value * unit;
    }
    if (motion.words.empty()) continue;
    must_name_Z_ = false;
    const double share = std::max(fitted.t_end - fitted.t_begin, 1e-6);
    motion.is_inverse = !motion.is_rapid && turned > 0.0 && way > 0.0;
    motion.feed = motion.is_inverse
                      ? move.feed * minute / ((length > 0.0 ? length : turned) * share)
                      : move.feed / (length > 0.0 ? mm_per_min : deg_per_min);
    printer_->motion(motion);
  }
  walk_.arrive(step, at + origin);
}

std::string DialectWriter::finish(const std::vector<std::string>& header) {
  std::vector<std::string> body;
  body.swap(lines_);
  printer_->begin(name_, header);
  lines_.insert(lines_.end(), body.begin(), body.end());
  return printer_->text(name_);
}

}  // namespace servomill::sim
