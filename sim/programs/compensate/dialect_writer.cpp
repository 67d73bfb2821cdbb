#include "sim/programs/compensate/dialect_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/gcode/canned_cycles.h"
#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/request.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/programs/compensate/edited_line.h"
#include "sim/programs/compensate/line_tokens.h"
#include "sim/programs/named_axes.h"

namespace servomill::sim::programs {
namespace {

using controllers::Code;
using controllers::Group;

// True for codes that are about moves only, or about modes that go into their numbers.
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
    case Group::g_work_plane:
      return code.tenths == 690;
    case Group::g_tool_length:
      return code.tenths == 430 || code.tenths == 490;
    case Group::g_spindle_mode:
      return code.tenths == 970;
    case Group::g_non_modal:
      return code.tenths == 40 || code.tenths == 280 || code.tenths == 300 || code.tenths == 530 ||
             code.tenths == 520 || (code.tenths >= 920 && code.tenths <= 923);
    case Group::m_stop:
      return code.tenths <= 20 || code.tenths == 300 || code.tenths == 600 || code.tenths == 990;
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

// G10 L2 and L20 move work systems: what they make of positions is in the numbers.
bool moves_work_system(const Code& code, const controllers::Request& request) {
  if (code.group != Group::g_non_modal || code.tenths != 100) return false;
  return request['L'] == 2.0 || request['L'] == 20.0;
}

// M48 ... M51: whether the operator's override switches act is no motion.
bool is_override(const Code& code) { return code.group == Group::m_override && code.tenths <= 510; }

struct Remedy {
  bool is_M;
  int first, last;  // tenths
  std::string_view text;
};

constexpr std::array kRemedies = {
    Remedy{false, 100, 100, "enter tools and their lengths at the control"},
    Remedy{false, 281, 301, "program G53 G0 in place of the move to the stored position"},
    Remedy{false, 431, 432, "program G43 H with a length number of the control"},
    Remedy{false, 434, 435, kWriteAxes},
    Remedy{false, 531, 531, kWriteAxes},
    Remedy{false, 682, 682, kWriteAxes},
    Remedy{true, 520, 530, "adaptive feed and feed stop are inputs of LinuxCNC; remove it"},
    Remedy{true, 700, 730, "program the modes that it saves or restores"},
};

std::string_view remedy_of(bool is_M, int tenths) {
  for (const Remedy& one : kRemedies) {
    if (one.is_M == is_M && tenths >= one.first && tenths <= one.last) return one.text;
  }
  return "remove it";
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

DialectWriter::DialectWriter(ProgramCorrector& corrector, Summary& summary,
                             const DialectSettings& settings, std::string file)
    : corrector_(corrector),
      summary_(summary),
      settings_(settings),
      file_(std::move(file)),
      printer_(make_dialect(settings_, lines_)),
      height_(settings.retract_Z) {}
DialectWriter::~DialectWriter() = default;

void DialectWriter::check_codes(const Block& block) {
  if (block.request == nullptr) return;
  for (const auto& chosen : block.request->codes) {
    if (chosen.code == nullptr || is_in_the_moves(*chosen.code)) continue;
    moves_work_systems_ |= moves_work_system(*chosen.code, *block.request);
    has_overrides_ |= is_override(*chosen.code);
    if (moves_work_system(*chosen.code, *block.request) || is_override(*chosen.code)) continue;
    const bool is_M = chosen.code->group >= Group::m_input_output;
    throw InputError({file_, block.line, chosen.column},
                     fmt::format("{} cannot be expressed in {}; {}",
                                 controllers::code_name(is_M ? 'M' : 'G', chosen.code->tenths),
                                 kDialects[static_cast<std::size_t>(settings_.dialect)],
                                 remedy_of(is_M, chosen.code->tenths)));
  }
}

void DialectWriter::note_what_became_numbers(const Block& block) {
  for (const LineToken& piece : line_tokens(block)) {
    if (piece.kind == PieceKind::o_word) summary_.unrolled = true;
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

// One unit for the whole program.
void DialectWriter::note_unit(const Block& block) {
  const bool moves = std::any_of(block.moves.begin(), block.moves.end(),
                                 [](const Move& move) { return is_motion(move.kind); });
  if (!moves) return;
  const bool is_inch = block.state->unit != mm;
  if (!is_inch_) {
    is_inch_ = is_inch;
    printer_->set_inches(is_inch);
  }
  if (*is_inch_ == is_inch || !printer_->set_inches(*is_inch_)) return;
  throw InputError(
      {file_, block.line},
      fmt::format("moves in {}, earlier moves were in {}: {} changes work offsets and tool lengths "
                  "with G20 and G21; write the program in one unit",
                  is_inch ? "inches (G20)" : "mm (G21)", is_inch ? "mm (G21)" : "inches (G20)",
                  kDialects[static_cast<std::size_t>(settings_.dialect)]));
}

void DialectWriter::write(const Block& block) {
  if (has_ended_) return;
  if (block.block != nullptr && block.block->deleted) return printer_->comment(block.text);
  if (is_skipped(block)) summary_.unrolled = true;
  says_path_ =
      says_path_ || (block.request != nullptr && block.request->code(Group::g_path_control) >= 0);
  if (has_slash(block)) return write_optional(block);
  write_always(block);
}

void DialectWriter::write_always(const Block& block) {
  note_what_became_numbers(block);
  check_codes(block);
  note_unit(block);
  try {
    write_moves(block);
  } catch (const Unsayable& what) {
    throw InputError({file_, block.line},
                     fmt::format("{}; it cannot be expressed in {}", what.why,
                                 kDialects[static_cast<std::size_t>(settings_.dialect)]));
  }
}

void DialectWriter::write_moves(const Block& block) {
  if (block.request != nullptr && block.request->has('T') &&
      block.request->code(Group::m_tool) < 0) {
    printer_->preselect(block.state->selected_tool);
  }
  const int code = non_modal_code(block);
  std::size_t last = 0;
  for (std::size_t i = 0; i < block.moves.size(); ++i) {
    if (is_motion(block.moves[i].kind)) last = i;
  }
  for (std::size_t i = 0; i < block.moves.size(); ++i) {
    const Move& move = block.moves[i];
    if (!is_motion(move.kind)) {
      write_other(move, block, i);
    } else if (code == 280 || code == 300) {
      write_reference(move, block, i == last);
    } else {
      if (!is_place_of_machine(block)) restate_axes(move, block);
      write_step(block, corrector_.next(move, block));
    }
  }
}

void DialectWriter::write_other(const Move& move, const Block& block, std::size_t i) {
  const bool ends = !block.moves.empty() && block.moves.back().kind == MoveKind::end;
  const auto code = [&](Group group) {
    return block.request == nullptr ? -1 : block.request->code(group);
  };
  switch (move.kind) {
    case MoveKind::tool:
      return change_tool(move.number, block);
    case MoveKind::spindle: {
      rpm_ = move.value / rpm;
      direction_ = move.direction;
      const bool is_last = i + 1 == block.moves.size() || block.moves[i + 1].kind != move.kind;
      const bool is_ending = ends && code(Group::m_spindle) < 0 && move.direction == 0;
      if (!is_last || is_ending) return;
      const int M = code(Group::m_spindle);
      return printer_->spindle(direction_, rpm_, M >= 30 && M <= 50);
    }
    case MoveKind::coolant: {
      const int M = code(Group::m_coolant);
      coolant_ = move.number;
      if (ends && M < 0) return;
      // where the state is lost, one code says nothing about the other
      const int own = M == 70 ? controllers::kMist : M == 80 ? controllers::kFlood : coolant_;
      if (known_coolant_ || coolant_ == own) known_coolant_ = coolant_;
      skipped_coolant_ = coolant_;
      return printer_->coolant(M == 70 || M == 80 ? M / 10 : 9);
    }
    case MoveKind::dwell:
      if (move.value == 0.0) return;
      restate_spindle_and_coolant();
      return printer_->dwell(move.value);
    case MoveKind::stop:
      return write_stop(move.number);
    case MoveKind::end:
      return write_end();
    case MoveKind::message:
      return printer_->message(move.text);
    default:
      return;
  }
}

// The operator may have jogged behind it. M60 is the builder's on other controls: a stop at which
// the operator exchanges the pallets, from a height that nobody knows.
void DialectWriter::write_stop(int number) {
  constexpr int kPalletStop = 60;
  printer_->end_smoothing();
  if (number == kPalletStop) printer_->message("exchange the pallets (M60)");
  printer_->stop(number == 1 ? 1 : 0);
  if (coolant_ != 0 || skipped_coolant_ != 0) known_coolant_.reset();
  forget_positions();
  lose_axes();
  if (number != kPalletStop) return;
  has_pallets_ = true;
  printer_->retract();
  height_ = settings_.retract_Z;
  has_optional_height_ = false;
}

void DialectWriter::write_end() {
  if (has_ended_) return;
  has_ended_ = true;
  printer_->end_smoothing();
  if (known_coolant_ != 0 || skipped_coolant_ != 0) printer_->coolant(9);
  printer_->retract();
  printer_->spindle(0, 0.0, true);
  printer_->end();
}

// Macros of builders move axes, stop the coolant and leave modes behind.
void DialectWriter::change_tool(int number, const Block& block) {
  tool_ = number;
  printer_->end_smoothing();
  printer_->tool(number, rpm_, block.state->work_system);
  if (coolant_ != 0 || skipped_coolant_ != 0) known_coolant_.reset();
  path_.clear();
  forget_positions();
  height_.reset();
  has_optional_height_ = false;
  lose_axes();
}

void DialectWriter::forget_positions() {
  corrector_.forget_positions();
  out_known_.fill(false);
}

void DialectWriter::lose_axes() {
  is_lost_.fill(true);
  if (!writes_optional_) skipped_lost_.fill(true);
}

// A block names it.
void DialectWriter::find_axis(std::size_t axis) {
  out_known_[axis] = true;
  is_lost_[axis] = false;
  if (!writes_optional_) skipped_lost_[axis] = false;
}

void DialectWriter::restate_spindle_and_coolant() {
  if (!printer_->is_spindle_known()) printer_->spindle(direction_, rpm_, true);
  if (known_coolant_ != coolant_) restate_coolant();
  known_coolant_ = coolant_;
}

std::vector<std::string> DialectWriter::warnings() const {
  std::vector<std::string> out = printer_->warnings();
  if (has_overrides_) {
    out.emplace_back("M48 ... M51 are omitted: the override switches remain active");
  }
  if (moves_work_systems_) {
    out.emplace_back(
        "G10 acts only within this program: the work offsets of the control are unchanged");
  }
  if (has_pallets_) {
    out.emplace_back("M60 is a stop (M0) at which the operator exchanges the pallets");
  }
  if (arcs_to_lines_ > 0) {
    out.push_back(fmt::format("arcs in G18 and G19 written as lines: {}; {}", arcs_to_lines_,
                              printer_->why_lines()));
  }
  return out;
}

std::string DialectWriter::rounding() const {
  const bool is_inch = printer_->unit(Axis::X) != mm;
  return is_inch ? fmt::format("{:g} inch", std::pow(10.0, -printer_->decimals(Axis::X)))
                 : fmt::format("{:g} um", settings_.resolution / um);
}

std::string DialectWriter::finish(const std::vector<std::string>& header) {
  write_end();
  std::vector<std::string> body;
  body.swap(lines_);
  printer_->begin(header);
  lines_.insert(lines_.end(), body.begin(), body.end());
  return printer_->text();
}

}  // namespace servomill::sim::programs
