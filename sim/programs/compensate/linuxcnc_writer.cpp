#include "sim/programs/compensate/linuxcnc_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/gcode/canned_cycles.h"
#include "controllers/gcode/lexer.h"
#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/number_text.h"
#include "controllers/gcode/request.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/programs/compensate/edited_line.h"
#include "sim/programs/compensate/motion_printer.h"
#include "sim/programs/compensate/timed_feed.h"

namespace servomill::sim::programs {

using controllers::Code;
using controllers::ExecutedBlock;
using controllers::Group;

namespace {

constexpr const char* kUnknownCode = "?";

// Tells if a feed of the block moves rotary axes and no linear one.
bool turns_alone(const ExecutedBlock& block) {
  return std::any_of(block.moves.begin(), block.moves.end(), [](const Move& move) {
    return move.kind == MoveKind::feed && !(move.s_end > move.s_begin);
  });
}

// Refuses words that mean something else without subroutines, or where the axes are elsewhere.
void refuse_what_changes_its_meaning(const ExecutedBlock& block) {
  const controllers::Request& request = *block.request;
  const auto fail = [&](Group group, std::string message) {
    throw InputError({*block.file, block.line, request.of(group).column}, std::move(message));
  };
  if (request.code(Group::m_spindle) >= 700 && block.call_depth > 0) {
    fail(Group::m_spindle, fmt::format("M{} in a subroutine: the saved state belongs to the call, "
                                       "and subroutines are unrolled",
                                       request.code(Group::m_spindle) / 10));
  }
  const int code = request.code(Group::g_non_modal);
  if (code == 281 || code == 301) {
    fail(Group::g_non_modal,
         fmt::format("{} would store the corrected position as a machine position",
                     controllers::code_name('G', code)));
  }
  if (request.code(Group::g_tool_length) == 431 && request.motion.code != nullptr) {
    fail(Group::g_tool_length, "G43.1 with a motion: both use the axis words");
  }
  const controllers::ModalState& state = *block.state;
  if (state.compensation.acts() && state.feed_mode == FeedMode::inverse_time &&
      request.motion_code() > 0) {
    throw InputError({*block.file, block.line, request.motion.column},
                     "inverse time (G93) under cutter compensation cannot be unrolled: its moves "
                     "have other lengths; use G94");
  }
  if (state.feed_mode == FeedMode::units_per_revolution && request.motion_code() > 0 &&
      turns_alone(block)) {
    throw InputError({*block.file, block.line, request.motion.column},
                     "rotary axes alone at a feed per revolution (G95) cannot keep their time; use "
                     "G94");
  }
  if (state.feed_mode == FeedMode::units_per_revolution && state.spindle_speed == 0.0 &&
      controllers::is_canned_cycle(request.motion_code())) {
    throw InputError({*block.file, block.line, request.motion.column},
                     "a cycle under G95 while the spindle speed is zero has no feed");
  }
  if (request.code(Group::g_path_control) > 610 &&
      controllers::is_canned_cycle(request.motion_code())) {
    fail(Group::g_path_control,
         fmt::format("{} with a canned cycle, which runs under G61: program it in a separate block",
                     controllers::code_name('G', request.code(Group::g_path_control))));
  }
  const int L = static_cast<int>(std::lround(request['L']));
  const bool sets_position = code == 100 && L == 20;
  const auto P = static_cast<int>(std::lround(request['P']));
  if (sets_position && P != 0 && P != block.state->work_system) {
    fail(Group::g_non_modal,
         fmt::format("G10 L20 P{} of an inactive work offset cannot be corrected", P));
  }
}

// A radius says the same as long as its ends are where they were.
void keep_radius(const EditedLine& line, const Step& step, const AxisWords& at, double grid,
                 MotionWords& words) {
  if (!line.has_word('R') || !line.is_constant_word('R') || step.blocks.size() != 1) return;
  const double half = kHalf * grid;
  if ((at - step.programmed.begin).cwiseAbs().maxCoeff() > half ||
      (step.blocks[0].end - step.programmed.end).cwiseAbs().maxCoeff() > half) {
    return;
  }
  words.kept += 'R';
  std::erase_if(words.words, [](const auto& word) {
    return word.first == 'I' || word.first == 'J' || word.first == 'K';
  });
}

}  // namespace

LinuxCncWriter::LinuxCncWriter(ProgramCorrector& corrector, Summary& summary, int decimals)
    : corrector_(corrector), summary_(summary), decimals_(decimals) {}
LinuxCncWriter::~LinuxCncWriter() = default;

void LinuxCncWriter::put(std::string_view text) {
  text_ += text;
  text_ += end_of_line_;
}

void LinuxCncWriter::put(const EditedLine& line) {
  std::string text;
  for (const std::string& word : line.words) text += word;
  if (text.size() > controllers::kLongestLine) {
    throw InputError({line.file, line.number},
                     fmt::format("becomes a line of {} characters; at most {} are allowed",
                                 text.size(), controllers::kLongestLine));
  }
  if (!text.empty() || line.text.empty()) put(text);
}

// One more line for the same block: the operator's switch decides about it, too.
void LinuxCncWriter::put_beside(const EditedLine& line, std::string_view text) {
  put(fmt::format("{}{}", has_slash(line) ? "/" : "", text));
}

// Behind a block with '/' the operator knows the code in force.
void LinuxCncWriter::forget_motion_code(const EditedLine& line) {
  if (has_slash(line)) motion_ = kUnknownCode;
}

// A '%' opens the program if it is its first line.
bool LinuxCncWriter::take_percent(const Block& block) {
  if (block.block == nullptr || !block.block->percent) return false;
  put(block.text);
  if (is_first_) header_at_ = text_.size();
  is_open_ = is_first_;
  is_first_ = false;
  return true;
}

void LinuxCncWriter::write(const Block& given) {
  Block block = given;
  const bool has_return = !block.text.empty() && block.text.back() == '\r';
  if (has_return) block.text.remove_suffix(1);
  if (has_return && text_.empty() && waiting_.empty()) end_of_line_ = "\r\n";  // the first line
  if (take_percent(block)) return;
  if (block.text.find_first_not_of(" \t") != std::string_view::npos) is_first_ = false;
  if (is_skipped(block)) {
    summary_.unrolled = true;
    return;
  }
  EditedLine line = line_of(block, summary_);
  if (has_o_word(line) || block.is_repeated || block.call_depth > 0) summary_.unrolled = true;
  if (has_o_word(line)) {
    drop_o_words(line);
    if (!block.moves.empty() && block.moves.back().kind == MoveKind::end) put("M2");  // M99
    if (is_empty(line)) return;
  } else if (block.block != nullptr && block.block->deleted) {
    return put(fmt::format("; {}", block.text));
  }
  refuse_slash(line);
  if (block.request != nullptr) {
    refuse_what_changes_its_meaning(block);
    note_path_mode(block);
    const int cutter = block.request->code(Group::g_cutter_compensation);
    if (cutter > 400) {
      summary_.has_cutter_compensation = compensates_cutter_ = true;
      for (std::size_t i = 0; i < line.pieces.size(); ++i) {
        const char c = line.pieces[i].letter;
        const bool goes = c == 'D' || (c == 'L' && cutter % 10 == 1) ||
                          (line.codes[i] != nullptr && line.codes[i]->tenths == cutter &&
                           line.codes[i]->group == Group::g_cutter_compensation);
        if (goes) drop(line, i);
      }
      if (is_empty(line)) return;
    }
    const bool is_place = is_place_of_machine(block);
    line.letters = motion_letters(block);
    line.is_cycle = controllers::is_canned_cycle(block.request->motion_code());
    line.is_motion = block.request->motion.code != nullptr && !is_place &&
                     std::any_of(kAllAxes.begin(), kAllAxes.end(),
                                 [&](Axis axis) { return block.request->has(letter(axis)); });
    line.is_motion = line.is_motion || block.request->has_polar();
    shift_position(block, line);
  }
  waiting_.push_back(std::move(line));
  move(block);
  if (block.request != nullptr && block.request->code(Group::g_cutter_compensation) == 400) {
    compensates_cutter_ = false;
  }
  if (!compensates_cutter_) release_until(0);
}

// The machine is in another place now: words that state the place have to follow.
void LinuxCncWriter::shift_position(const Block& block, EditedLine& line) const {
  const int code = block.request->code(Group::g_non_modal);
  const int L = static_cast<int>(std::lround((*block.request)['L']));
  const bool sets = code == 920 || (code == 100 && (L == 20 || L == 10 || L == 11));
  if (!sets) return;
  const controllers::ModalState& state = *block.state;
  const AxisWords off = state.unrotated(corrector_.out() - state.to_machine(state.position));
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    if (line.pieces[i].kind != PieceKind::word) continue;
    const auto axis = axis_of(line.pieces[i].letter);
    if (!axis) continue;
    const double d = off[index_of(*axis)] / unit_of(index_of(*axis), state.unit);
    if (d == 0.0) continue;
    constexpr int kDecimals = 9;
    const double value = line.value(line.pieces[i].letter) + d;
    line.words[i] =
        fmt::format("{}{}", line.pieces[i].letter, controllers::fixed_text(value, kDecimals));
  }
}

// Everything that waits before the line of that number, and not that line; all with 0.
void LinuxCncWriter::release_until(int line) {
  while (!waiting_.empty() && (line == 0 || waiting_.front().number != line)) {
    release(waiting_.front());
    waiting_.pop_front();
  }
}

// Without motion, or with what has been woven in.
void LinuxCncWriter::release(EditedLine& line) {
  if (!line.is_released) {
    if (line.is_motion && compensates_cutter_) drop_motion(line);
    put(line);
  }
  line.is_released = true;
  if (!line.behind.empty()) put_beside(line, line.behind);
  line.behind.clear();
}

void LinuxCncWriter::note_motion_code(const EditedLine& line) {
  for (const Code* code : line.codes) {
    if (code == nullptr || code->group != Group::g_motion) continue;
    motion_ = code->tenths <= 30 ? controllers::code_name('G', code->tenths) : "";
  }
}

void LinuxCncWriter::move(const Block& block) {
  const bool is_place = block.request != nullptr && is_place_of_machine(block);
  const bool cycles = !waiting_.empty() && waiting_.back().is_cycle;
  bool has_moved = false;
  for (const Move& one : block.moves) {
    if (is_motion(one.kind)) {
      has_moved = true;
      move(one, block, is_place);
    } else if (has_moved && cycles) {  // everything else the line says
      put_cycle_step(one, block, waiting_.back());
    }
  }
  if (!has_moved && !waiting_.back().is_motion) note_motion_code(waiting_.back());
  forget_motion_code(waiting_.back());
}

// Before the next block that does something.
void LinuxCncWriter::note_path_mode(const Block& block) {
  if (!controllers::is_canned_cycle(block.request->motion_code())) end_exact_path();
  if (block.request->code(Group::g_path_control) < 0) return;
  says_path_ = true;
  const bool has_Q = block.request->has('Q');
  naive_cam_tolerance_ = has_Q ? std::max((*block.request)['Q'], 0.0) * block.state->unit : -1.0;
}

// The rapid to the height of R keeps the mode of the program.
void LinuxCncWriter::begin_exact_path(const Move& one, const Block& block, const EditedLine& line) {
  const controllers::ModalState& state = *block.state;
  if (one.path_mode != PathMode::exact_path || state.path_mode == PathMode::exact_path) return;
  if (!path_behind_cycle_.empty()) return;
  path_behind_cycle_ = state.path_mode == PathMode::exact_stop ? "G61.1" : "G64";
  if (state.path_mode == PathMode::continuous && state.path_tolerance > 0.0) {
    path_behind_cycle_ +=
        fmt::format(" P{}", controllers::significant_text(state.path_tolerance / state.unit));
  }
  if (state.path_mode == PathMode::continuous && naive_cam_tolerance_ >= 0.0) {
    path_behind_cycle_ +=
        fmt::format(" Q{}", controllers::significant_text(naive_cam_tolerance_ / state.unit));
  }
  assumes_G64_ = assumes_G64_ || !says_path_;
  put_beside(line, "G61");
}

void LinuxCncWriter::end_exact_path() {
  if (!path_behind_cycle_.empty()) put(path_behind_cycle_);
  path_behind_cycle_.clear();
}

std::vector<std::string> LinuxCncWriter::assumptions() const {
  if (!assumes_G64_) return {};
  return {
      "G64 without a tolerance is active at the start (no other path mode in "
      "RS274NGC_STARTUP_CODE): it is restored after canned cycles"};
}

void LinuxCncWriter::put_cycle_step(const Move& one, const Block& block, const EditedLine& line) {
  if (one.kind == MoveKind::dwell) {
    put_beside(line, controllers::dwell_block(one.value));
  } else if (one.kind == MoveKind::spindle) {
    put_beside(line, one.direction > 0 ? "M3" : one.direction < 0 ? "M4" : "M5");
  } else if (one.kind == MoveKind::stop && block.request->code(Group::m_stop) < 0) {  // of G88
    put_beside(line, fmt::format("M{}", one.number));
  }
}

void LinuxCncWriter::move(const Move& one, const Block& block, bool is_place) {
  const bool waits = std::any_of(waiting_.begin(), waiting_.end(),
                                 [&](const EditedLine& line) { return line.number == one.line; });
  if (waits) release_until(one.line);
  EditedLine& line = waits ? waiting_.front() : waiting_.back();
  if (line.is_cycle) begin_exact_path(one, block, line);
  const Step step = corrector_.next(one, block);
  if (step.is_corrected) {
    write_step(step, line, waits && !line.is_released);
    return forget_motion_code(line);
  }
  // the words of the line are those of the move
  corrector_.arrive(step, step.programmed.frame.machine(step.blocks.back().end));
  if (is_place) return;
  note_motion_code(line);
  if (motion_ != "G0") insert(line, "G0");
  motion_ = "G0";
  forget_motion_code(line);
}

void LinuxCncWriter::write_step(const Step& step, EditedLine& line, bool is_woven_in) {
  const Move& one = *step.move;
  const bool is_rapid = one.kind == MoveKind::rapid;
  TimedFeed feed(step, line);
  AxisWords at = step.begin;
  for (const FittedBlock& block : step.blocks) {
    const bool weaves = is_woven_in && !line.is_released;
    MotionPrinter printer(line, weaves ? &line : nullptr, decimals_);
    MotionWords words = printer.print(block, is_rapid, at);
    if (!weaves && !block.arc && words.words.empty()) continue;
    if (weaves && block.arc) keep_radius(line, step, at, std::pow(10.0, -decimals_) * mm, words);
    feed.set(words, printer, block, at);
    const bool needs_code = motion_ != words.code;
    if (weaves) {
      if (step.blocks.size() > 1 || line.is_cycle || feed.is_changed()) take_behind(line);
      weave(line, words, needs_code);
      put(line);
      line.is_released = true;
    } else {
      put_beside(line, words.text(needs_code));
    }
    motion_ = words.code;
    at = printer.end();
  }
  if (feed.is_changed()) put_beside(line, feed.restored());
  corrector_.arrive(step, step.programmed.frame.machine(at));
}

std::string LinuxCncWriter::finish(const std::vector<std::string>& header) {
  release_until(0);
  std::string comment;
  for (const std::string& one : header) {
    comment += controllers::remark(one) + end_of_line_;
  }
  text_.insert(header_at_, comment);
  if (is_open_) put("%");
  return std::move(text_);
}

}  // namespace servomill::sim::programs
