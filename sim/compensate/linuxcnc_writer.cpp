#include "sim/compensate/linuxcnc_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "controllers/gcode/canned_cycles.h"
#include "controllers/gcode/lexer.h"
#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/number_text.h"
#include "controllers/gcode/request.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/compensate/line_pieces.h"

namespace servomill::sim {

using controllers::Code;
using controllers::ExecutedBlock;
using controllers::Group;

// A line with its pieces as they will be written, and the modes that its motion is written in.
struct WovenLine {
  std::string file;
  int number = 0;
  std::string text;
  std::vector<LinePiece> pieces;
  std::vector<const Code*> codes;  // of each piece, where it is a G or M code
  std::vector<std::string> words;  // of each piece; empty: it goes
  std::string behind;              // codes that act behind the motion, where they do not fit in
  std::array<double, controllers::kWordLetters> values{};  // of words, in program units
  std::array<bool, controllers::kWordLetters> has{}, is_constant{};
  bool is_motion = false;  // has words that its moves take
  bool is_cycle = false;
  std::string letters;  // of such words
  bool is_released = false;

  double unit = mm;
  bool is_incremental = false, is_centre_absolute = false;
  FeedMode feed_mode = FeedMode::units_per_minute;
  double feed_linear = 0.0;  // m/s
};

namespace {

constexpr double kStanding = 1e-12;  // m, rounding of offsets

constexpr double kHalf = 0.5 + 1e-6;  // of a grid step

constexpr std::string_view kAllLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ@^";
std::size_t index(char letter) { return controllers::word_index(letter); }
char axis_letter(int i) { return letter(kAllAxes[static_cast<std::size_t>(i)]); }
double unit_of(int axis, double unit) { return axis < kLinearJoints ? unit : deg; }

bool acts_behind_motion(const Code* code) {
  return code != nullptr && code->group == Group::m_stop;
}

// Code of a piece: the one that stands in its column.
const Code* code_of(const LinePiece& piece, const controllers::Request& request) {
  if (piece.kind != PieceKind::word || (piece.letter != 'G' && piece.letter != 'M')) return nullptr;
  for (const auto& chosen : request.codes) {
    if (chosen.code != nullptr && chosen.column == static_cast<int>(piece.begin) + 1) {
      return chosen.code;
    }
  }
  return nullptr;
}

void drop(WovenLine& line, std::size_t i) {
  line.words[i].clear();
  if (i > 0 && line.pieces[i - 1].kind == PieceKind::blank) {
    line.words[i - 1].clear();
  } else if (i == 0 && line.pieces.size() > 1 && line.pieces[1].kind == PieceKind::blank) {
    line.words[1].clear();
  }
}

bool is_spoken(std::string_view comment) {
  std::string start;
  for (const char c : comment.substr(1)) {
    if (c == ',') break;
    if (c != ' ') start += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  }
  return start == "MSG" || start == "DEBUG" || start == "PRINT";
}

// Numbers in place of expressions.
void put_numbers(const ExecutedBlock& block, WovenLine& line, Summary& summary) {
  std::size_t assignment = 0;
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    const LinePiece& piece = line.pieces[i];
    const bool is_assignment = piece.kind == PieceKind::assignment;
    const std::size_t nth = is_assignment ? assignment++ : 0;
    if (piece.is_constant) continue;
    summary.has_expressions = true;
    if (is_assignment && nth < block.assigned.size()) {
      const auto [number, value] = block.assigned[nth];
      const std::string_view text = piece.of(line.text);
      const std::string name =
          number > 0 ? fmt::format("#{}", number) : std::string(text.substr(0, text.find('=')));
      line.words[i] = fmt::format("{}={}", name, controllers::significant_text(value));
    } else if (line.codes[i] != nullptr) {
      line.words[i] = controllers::code_name(piece.letter, line.codes[i]->tenths);
    } else if (piece.kind == PieceKind::word) {
      line.words[i] = fmt::format("{}{}", piece.letter,
                                  controllers::significant_text(line.values[index(piece.letter)]));
    }
  }
}

// Messages as they were given, where they name parameters.
void put_messages(const ExecutedBlock& block, WovenLine& line) {
  std::vector<std::size_t> spoken;
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    const LinePiece& piece = line.pieces[i];
    if (piece.kind == PieceKind::comment && is_spoken(piece.of(line.text))) spoken.push_back(i);
  }
  std::vector<const Move*> given;
  for (const Move& move : block.moves) {
    if (move.kind == MoveKind::message) given.push_back(&move);
  }
  if (given.size() != spoken.size()) return;
  for (std::size_t k = 0; k < spoken.size(); ++k) {
    std::string& word = line.words[spoken[k]];
    const std::size_t comma = word.find(',');
    if (word.find('#') == std::string::npos || comma == std::string::npos) continue;
    word = fmt::format("{} {})", word.substr(0, comma + 1), given[k]->text);
  }
}

WovenLine line_of(const ExecutedBlock& block, Summary& summary) {
  WovenLine line;
  line.file = *block.file;
  line.number = block.line;
  line.text = block.text;
  line.pieces = line_pieces(block);
  line.codes.assign(line.pieces.size(), nullptr);
  for (const LinePiece& piece : line.pieces) line.words.emplace_back(piece.of(line.text));
  const controllers::ModalState& state = *block.state;
  line.unit = state.unit;
  line.is_incremental = state.is_incremental;
  line.is_centre_absolute = state.is_centre_absolute;
  line.feed_mode = state.feed_mode;
  line.feed_linear = state.feed_linear;
  if (block.request == nullptr) return line;
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    const LinePiece& piece = line.pieces[i];
    line.codes[i] = code_of(piece, *block.request);
    if (piece.kind == PieceKind::word) line.is_constant[index(piece.letter)] = piece.is_constant;
  }
  for (const char letter : kAllLetters) {
    line.has[index(letter)] = block.request->has(letter);
    line.values[index(letter)] = (*block.request)[letter];
  }
  put_numbers(block, line, summary);
  put_messages(block, line);
  return line;
}

bool changes_what_follows(const WovenLine& line) {
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    const LinePiece& piece = line.pieces[i];
    if (piece.kind == PieceKind::assignment) return true;
    if (piece.kind == PieceKind::word && piece.letter != 'M' && piece.letter != 'S') return true;
    if (line.codes[i] != nullptr && line.codes[i]->group == Group::m_tool) return true;
  }
  return false;
}

void drop_slash(WovenLine& line, Summary& summary) {
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    if (line.pieces[i].kind != PieceKind::block_delete) continue;
    if (!changes_what_follows(line)) continue;
    summary.takes_blocks_with_slash = true;
    drop(line, i);
  }
}

void drop_o_words(WovenLine& line) {
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    const PieceKind kind = line.pieces[i].kind;
    const bool stays = kind == PieceKind::blank ||
                       (kind == PieceKind::comment && !is_spoken(line.pieces[i].of(line.text)));
    if (!stays) drop(line, i);
  }
}

bool has_o_word(const WovenLine& line) {
  return std::any_of(line.pieces.begin(), line.pieces.end(),
                     [](const LinePiece& one) { return one.kind == PieceKind::o_word; });
}

bool is_empty(const WovenLine& line) {
  return std::all_of(line.words.begin(), line.words.end(), [](const std::string& word) {
    return word.find_first_not_of(" \t") == std::string::npos;
  });
}

// Whether a feed of the block moves rotary axes and no linear one.
bool turns_alone(const ExecutedBlock& block) {
  return std::any_of(block.moves.begin(), block.moves.end(), [](const Move& move) {
    return move.kind == MoveKind::feed && !(move.s_end > move.s_begin);
  });
}

// What means something else in a program without subroutines, or where the axes stand elsewhere.
void refuse_what_changes_its_meaning(const ExecutedBlock& block) {
  const controllers::Request& request = *block.request;
  const auto fail = [&](Group group, std::string message) {
    throw InputError({*block.file, block.line, request.of(group).column}, std::move(message));
  };
  if (request.code(Group::m_spindle) >= 700 && block.call_depth > 0) {
    fail(Group::m_spindle,
         fmt::format("M{} in a subroutine: what it saves belongs to the call, and subroutines are "
                     "unrolled",
                     request.code(Group::m_spindle) / 10));
  }
  const int code = request.code(Group::g_non_modal);
  if (code == 281 || code == 301) {
    fail(Group::g_non_modal,
         fmt::format("{} would store the corrected place as that of the machine",
                     controllers::code_name('G', code)));
  }
  if (request.code(Group::g_tool_length) == 431 && request.motion.code != nullptr) {
    fail(Group::g_tool_length, "G43.1 beside a motion: both take the axis words");
  }
  const controllers::ModalState& state = *block.state;
  if (state.compensation.acts() && state.feed_mode == FeedMode::inverse_time &&
      request.motion_code() > 0) {
    throw InputError({*block.file, block.line, request.motion.column},
                     "inverse time (G93) under cutter compensation cannot be unrolled: its moves "
                     "are of other lengths; use G94");
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
  const int L = static_cast<int>(std::lround(request['L']));
  const bool sets_position = code == 100 && L == 20;
  const auto P = static_cast<int>(std::lround(request['P']));
  if (sets_position && P != 0 && P != block.state->work_system) {
    fail(Group::g_non_modal,
         fmt::format("G10 L20 P{} of a work system that is not in force cannot be corrected", P));
  }
}

// Letters that belong to motion: those of its axes, and what arcs and cycles take.
std::string motion_letters(const ExecutedBlock& block) {
  std::string letters = "XYZABC@^";
  const int code = block.request->motion_code();
  if (code == 20 || code == 30) letters += "IJKRP";
  if (controllers::is_canned_cycle(code)) letters += "IJKRPQL";
  return letters;
}

bool is_motion_word(const WovenLine& line, std::size_t i) {
  return line.pieces[i].kind == PieceKind::word &&
         line.letters.find(line.pieces[i].letter) != std::string::npos;
}

bool is_motion_code(const WovenLine& line, std::size_t i) {
  return line.codes[i] != nullptr && line.codes[i]->group == Group::g_motion;
}

// Puts a word before those of motion; there is one at least.
void insert(WovenLine& line, std::string_view word) {
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    if (!is_motion_word(line, i) && !is_motion_code(line, i)) continue;
    line.words[i] =
        line.words[i].empty() ? std::string(word) : fmt::format("{} {}", word, line.words[i]);
    return;
  }
}

// The words that a block of motion has.
struct MotionWords {
  std::string code;    // G0 ... G3
  std::string prefix;  // G93 where the block needs it
  std::vector<std::pair<char, std::string>> words;
  std::string kept;  // letters of words that stay as they are written

  std::string text(bool with_code) const {
    std::string out = prefix;
    if (with_code) out += (out.empty() ? "" : " ") + code;
    for (const auto& [letter, value] : words) {
      out += fmt::format("{}{}{}", out.empty() ? "" : " ", letter, value);
    }
    return out;
  }
};

// Replaces the words of motion of a line.
void weave(WovenLine& line, MotionWords motion, bool needs_code) {
  std::size_t last = 0;
  bool has_code = false;
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    const bool is_word = is_motion_word(line, i);
    const bool is_feed = line.pieces[i].kind == PieceKind::word && line.pieces[i].letter == 'F';
    if (is_motion_code(line, i)) {
      has_code = true;
      last = i;
      const std::string name = controllers::code_name('G', line.codes[i]->tenths);
      if (name != motion.code) line.words[i] = motion.code;
      continue;
    }
    if (!motion.prefix.empty() && line.codes[i] != nullptr &&
        line.codes[i]->group == Group::g_feed_mode) {
      drop(line, i);
    }
    if (!is_word && !is_feed) continue;
    const char letter = line.pieces[i].letter;
    if (is_word) last = i;
    if (motion.kept.find(letter) != std::string::npos) continue;
    const auto found = std::find_if(motion.words.begin(), motion.words.end(),
                                    [&](const auto& word) { return word.first == letter; });
    if (found != motion.words.end()) {
      line.words[i] = fmt::format("{}{}", letter, found->second);
      motion.words.erase(found);
    } else if (is_word) {
      drop(line, i);
    }
  }
  const auto begin = line.words.begin();
  const bool is_begin = std::all_of(begin, begin + static_cast<std::ptrdiff_t>(last) + 1,
                                    [](const std::string& word) { return word.empty(); });
  for (const auto& [letter, value] : motion.words) {
    const bool is_first = is_begin && line.words[last].empty();
    line.words[last] += fmt::format("{}{}{}", is_first ? "" : " ", letter, value);
  }
  if (!has_code && needs_code) insert(line, motion.code);
  if (!motion.prefix.empty()) insert(line, motion.prefix);
}

void drop_motion(WovenLine& line) {
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    if (is_motion_word(line, i) || is_motion_code(line, i)) drop(line, i);
  }
}

// Takes what acts behind the motion out of a line whose motion needs more lines.
void take_behind(WovenLine& line) {
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    if (!acts_behind_motion(line.codes[i])) continue;
    line.behind += (line.behind.empty() ? "" : " ") + line.words[i];
    drop(line, i);
  }
}

// Prints numbers of a block in the modes of its line and keeps account of where that leads.
class MotionPrinter {
 public:
  // @param line  that the words go into; nullptr: a line of their own
  MotionPrinter(const WovenLine& modes, const WovenLine* line, int decimals)
      : modes_(modes), line_(line), decimals_(decimals) {}

  MotionWords print(const FittedBlock& block, bool is_rapid, const AxisWords& at) {
    words_ = {};
    words_.code = is_rapid ? "G0" : !block.arc ? "G1" : block.arc->turns > 0 ? "G3" : "G2";
    end_ = at;
    for (int i = 0; i < kAxisWords; ++i) axis(i, block.end[i], at[i]);
    if (block.arc) {
      centre(block, at);
      const int turns = std::abs(block.arc->turns);
      if (turns > 1 || keeps('P', turns, 0.0)) number('P', turns, 0);
    }
    return words_;
  }
  void feed(MotionWords& words, double F) const {
    if (line_ != nullptr && is_constant('F') && line_->values[index('F')] == F) return;
    words.words.emplace_back('F', controllers::significant_text(F));
  }
  const AxisWords& end() const { return end_; }

 private:
  bool is_named(char letter) const {
    return line_ != nullptr && !line_->is_cycle && line_->has[index(letter)];
  }
  bool is_constant(char letter) const {
    return is_named(letter) && line_->is_constant[index(letter)];
  }
  bool keeps(char letter, double value, double half) const {
    return is_constant(letter) && std::abs(line_->values[index(letter)] - value) <= half;
  }
  int decimals(int axis) const {
    constexpr int kMoreOfInches = 2;
    if (axis >= kLinearJoints) return kDecimalsOfDegrees;
    return modes_.unit == mm ? decimals_ : decimals_ + kMoreOfInches;
  }

  // @return as printed
  double number(char letter, double value, int digits) {
    const double grid = std::pow(10.0, -digits);
    if (keeps(letter, value, kHalf * grid)) {
      words_.kept += letter;
      return line_->values[index(letter)];
    }
    words_.words.emplace_back(letter, controllers::fixed_text(value, digits));
    return std::round(value / grid) * grid;
  }

  void axis(int i, double target, double at) {
    const double unit = unit_of(i, modes_.unit);
    const double grid = std::pow(10.0, -decimals(i));
    const bool changes = std::abs(target - at) > kHalf * grid * unit;
    if (!changes && !is_named(axis_letter(i))) return;
    const double from = modes_.is_incremental ? at : 0.0;
    end_[i] = from + unit * number(axis_letter(i), (target - from) / unit, decimals(i));
  }

  void centre(const FittedBlock& block, const AxisWords& at) {
    for (int k = 1; k <= 2; ++k) {
      const int i = (block.arc->normal_axis + k) % 3;
      const double from = modes_.is_centre_absolute ? 0.0 : at[i];
      number("IJK"[i], (block.arc->centre[i] - from) / modes_.unit, decimals(i));
    }
  }

  static constexpr int kDecimalsOfDegrees = 6;

  const WovenLine& modes_;
  const WovenLine* line_;
  int decimals_;
  MotionWords words_;
  AxisWords end_;
};

// A radius says the same as long as its ends are where they were.
void keep_radius(const WovenLine& line, const Step& step, const AxisWords& at, double grid,
                 MotionWords& words) {
  if (!line.has[index('R')] || !line.is_constant[index('R')] || step.blocks.size() != 1) return;
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

LinuxCncWriter::LinuxCncWriter(Walk& walk, Summary& summary, int decimals)
    : walk_(walk), summary_(summary), decimals_(decimals) {}
LinuxCncWriter::~LinuxCncWriter() = default;

void LinuxCncWriter::put(std::string_view text) {
  text_ += text;
  text_ += end_of_line_;
}

void LinuxCncWriter::put(const WovenLine& line) {
  std::string text;
  for (const std::string& word : line.words) text += word;
  if (text.size() > controllers::kLongestLine) {
    throw InputError({line.file, line.number},
                     fmt::format("becomes a line of {} characters; at most {} are allowed",
                                 text.size(), controllers::kLongestLine));
  }
  if (!text.empty() || line.text.empty()) put(text);
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
  WovenLine line = line_of(block, summary_);
  if (has_o_word(line) || block.is_repeated || block.call_depth > 0) summary_.unrolled = true;
  if (has_o_word(line)) {
    drop_o_words(line);
    if (!block.moves.empty() && block.moves.back().kind == MoveKind::end) put("M2");  // M99
    if (is_empty(line)) return;
  } else if (block.block != nullptr && block.block->deleted) {
    return put(fmt::format("; {}", block.text));
  }
  drop_slash(line, summary_);
  if (block.request != nullptr) {
    refuse_what_changes_its_meaning(block);
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

// Where the machine stands is another place now: what says it has to say so.
void LinuxCncWriter::shift_position(const Block& block, WovenLine& line) const {
  const int code = block.request->code(Group::g_non_modal);
  const int L = static_cast<int>(std::lround((*block.request)['L']));
  const bool sets = code == 920 || (code == 100 && (L == 20 || L == 10 || L == 11));
  if (!sets) return;
  const controllers::ModalState& state = *block.state;
  const AxisWords off = state.unrotated(walk_.out() - state.to_machine(state.position));
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    if (line.pieces[i].kind != PieceKind::word) continue;
    const auto axis = axis_of(line.pieces[i].letter);
    if (!axis) continue;
    const double d = off[index_of(*axis)] / unit_of(index_of(*axis), state.unit);
    if (d == 0.0) continue;
    constexpr int kDecimals = 9;
    const double value = line.values[index(line.pieces[i].letter)] + d;
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
void LinuxCncWriter::release(WovenLine& line) {
  if (!line.is_released) {
    if (line.is_motion && compensates_cutter_) drop_motion(line);
    put(line);
  }
  line.is_released = true;
  if (!line.behind.empty()) put(line.behind);
  line.behind.clear();
}

void LinuxCncWriter::note_motion_code(const WovenLine& line) {
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
      put_cycle_step(one, block);
    }
  }
  if (!has_moved && !waiting_.back().is_motion) note_motion_code(waiting_.back());
}

void LinuxCncWriter::put_cycle_step(const Move& one, const Block& block) {
  if (one.kind == MoveKind::dwell) {
    put(fmt::format("G4 P{}", controllers::significant_text(one.value)));
  } else if (one.kind == MoveKind::spindle) {
    put(one.direction > 0 ? "M3" : one.direction < 0 ? "M4" : "M5");
  } else if (one.kind == MoveKind::stop && block.request->code(Group::m_stop) < 0) {  // of G88
    put(fmt::format("M{}", one.number));
  }
}

void LinuxCncWriter::move(const Move& one, const Block& block, bool is_place) {
  const bool waits = std::any_of(waiting_.begin(), waiting_.end(),
                                 [&](const WovenLine& line) { return line.number == one.line; });
  if (waits) release_until(one.line);
  WovenLine& line = waits ? waiting_.front() : waiting_.back();
  const Step step = walk_.next(one, block);
  if (step.is_corrected) return write_step(step, line, waits && !line.is_released);
  // the words of the line are those of the move
  walk_.arrive(step, step.programmed.frame.machine(step.blocks.back().end));
  if (is_place) return;
  note_motion_code(line);
  if (motion_ != "G0") insert(line, "G0");
  motion_ = "G0";
}

void LinuxCncWriter::write_step(const Step& step, WovenLine& line, bool is_woven_in) {
  const Move& one = *step.move;
  const bool is_rapid = one.kind == MoveKind::rapid;
  const bool is_inverse = line.feed_mode == FeedMode::inverse_time;
  const bool only_turns = !is_rapid && !is_inverse && step.programmed.length() < kStanding &&
                          line.feed_mode == FeedMode::units_per_minute &&
                          step.programmed.turns_axes();
  const double angle = (step.programmed.end - step.programmed.begin).tail<3>().norm();
  bool leaves_inverse = false;
  AxisWords at = step.begin;
  for (const FittedBlock& block : step.blocks) {
    const bool weaves = is_woven_in && !line.is_released;
    MotionPrinter printer(line, weaves ? &line : nullptr, decimals_);
    MotionWords words = printer.print(block, is_rapid, at);
    if (!weaves && !block.arc && words.words.empty()) continue;
    if (weaves && block.arc) keep_radius(line, step, at, std::pow(10.0, -decimals_) * mm, words);
    const double share = block.t_end - block.t_begin;
    const bool moves_linear = printer.end().head<3>() != at.head<3>();
    if (is_inverse && !is_rapid) {
      const double way = (printer.end() - at).head<3>().norm();
      printer.feed(words, share > 0.0 ? line.values[index('F')] / share
                                      : one.feed * minute / std::max(way, 1e-9));
    } else if (only_turns && moves_linear) {
      words.prefix = "G93";
      leaves_inverse = true;
      printer.feed(words, one.feed * minute / (angle * std::max(share, 1e-3)));
    } else if (leaves_inverse) {
      printer.feed(words, one.feed * minute / (angle * std::max(share, 1e-3)));
    }
    const bool needs_code = motion_ != words.code;
    if (weaves) {
      if (step.blocks.size() > 1 || line.is_cycle || leaves_inverse) take_behind(line);
      weave(line, words, needs_code);
      put(line);
      line.is_released = true;
    } else {
      put(words.text(needs_code));
    }
    motion_ = words.code;
    at = printer.end();
  }
  if (leaves_inverse) {
    put(fmt::format("G94 F{}",
                    controllers::significant_text(line.feed_linear * minute / line.unit)));
  }
  walk_.arrive(step, step.programmed.frame.machine(at));
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

}  // namespace servomill::sim
