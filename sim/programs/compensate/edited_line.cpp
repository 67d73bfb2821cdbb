#include "sim/programs/compensate/edited_line.h"

#include <fmt/format.h>

#include <algorithm>

#include "controllers/gcode/canned_cycles.h"
#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/number_text.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::programs {

using controllers::Code;
using controllers::ExecutedBlock;
using controllers::Group;

namespace {

constexpr std::string_view kAllLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ@^";
std::size_t index(char letter) { return controllers::word_index(letter); }

bool acts_behind_motion(const Code* code) {
  return code != nullptr && code->group == Group::m_stop;
}

// Code of a piece: the one that stands in its column.
const Code* code_of(const LineToken& piece, const controllers::Request& request) {
  if (piece.kind != PieceKind::word || (piece.letter != 'G' && piece.letter != 'M')) return nullptr;
  for (const auto& chosen : request.codes) {
    if (chosen.code != nullptr && chosen.column == static_cast<int>(piece.begin) + 1) {
      return chosen.code;
    }
  }
  return nullptr;
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
void put_numbers(const ExecutedBlock& block, EditedLine& line, Summary& summary) {
  std::size_t assignment = 0;
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    const LineToken& piece = line.pieces[i];
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
void put_messages(const ExecutedBlock& block, EditedLine& line) {
  std::vector<std::size_t> spoken;
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    const LineToken& piece = line.pieces[i];
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

bool changes_what_follows(const EditedLine& line) {
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    const LineToken& piece = line.pieces[i];
    if (piece.kind == PieceKind::assignment) return true;
    if (piece.kind == PieceKind::word && piece.letter == 'T') return true;
    const Code* code = line.codes[i];
    if (code == nullptr) continue;
    // a program that ends there is not written on
    const bool ends = code->group == Group::m_stop && (code->tenths == 20 || code->tenths == 300);
    if (ends || code->group == Group::m_tool) return true;
  }
  return false;
}

}  // namespace

std::string MotionWords::text(bool with_code) const {
  std::string out = prefix;
  if (with_code) out += (out.empty() ? "" : " ") + code;
  for (const auto& [letter, value] : words) {
    out += fmt::format("{}{}{}", out.empty() ? "" : " ", letter, value);
  }
  return out;
}

void drop(EditedLine& line, std::size_t i) {
  line.words[i].clear();
  if (i > 0 && line.pieces[i - 1].kind == PieceKind::blank) {
    line.words[i - 1].clear();
  } else if (i == 0 && line.pieces.size() > 1 && line.pieces[1].kind == PieceKind::blank) {
    line.words[1].clear();
  }
}

EditedLine line_of(const ExecutedBlock& block, Summary& summary) {
  EditedLine line;
  line.file = *block.file;
  line.number = block.line;
  line.text = block.text;
  line.pieces = line_tokens(block);
  line.codes.assign(line.pieces.size(), nullptr);
  for (const LineToken& piece : line.pieces) line.words.emplace_back(piece.of(line.text));
  const controllers::ModalState& state = *block.state;
  line.unit = state.unit;
  line.is_incremental = state.is_incremental;
  line.is_centre_absolute = state.is_centre_absolute;
  line.feed_mode = state.feed_mode;
  line.feed_linear = state.feed_linear;
  if (block.request == nullptr) return line;
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    const LineToken& piece = line.pieces[i];
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

void refuse_slash(const EditedLine& line) {
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    if (line.pieces[i].kind != PieceKind::block_delete || !changes_what_follows(line)) continue;
    throw InputError({line.file, line.number, static_cast<int>(line.pieces[i].begin) + 1},
                     std::string(kSlash));
  }
}

bool has_slash(const EditedLine& line) {
  return std::any_of(line.pieces.begin(), line.pieces.end(),
                     [](const LineToken& piece) { return piece.kind == PieceKind::block_delete; });
}

void drop_o_words(EditedLine& line) {
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    const PieceKind kind = line.pieces[i].kind;
    const bool stays = kind == PieceKind::blank ||
                       (kind == PieceKind::comment && !is_spoken(line.pieces[i].of(line.text)));
    if (!stays) drop(line, i);
  }
}

bool has_o_word(const EditedLine& line) {
  return std::any_of(line.pieces.begin(), line.pieces.end(),
                     [](const LineToken& one) { return one.kind == PieceKind::o_word; });
}

bool is_empty(const EditedLine& line) {
  return std::all_of(line.words.begin(), line.words.end(), [](const std::string& word) {
    return word.find_first_not_of(" \t") == std::string::npos;
  });
}

std::string motion_letters(const ExecutedBlock& block) {
  std::string letters = "XYZABC@^";
  const int code = block.request->motion_code();
  if (code == 20 || code == 30) letters += "IJKRP";
  if (controllers::is_canned_cycle(code)) letters += "IJKRPQL";
  return letters;
}

bool is_motion_word(const EditedLine& line, std::size_t i) {
  return line.pieces[i].kind == PieceKind::word &&
         line.letters.find(line.pieces[i].letter) != std::string::npos;
}

bool is_motion_code(const EditedLine& line, std::size_t i) {
  return line.codes[i] != nullptr && line.codes[i]->group == Group::g_motion;
}

void insert(EditedLine& line, std::string_view word) {
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    if (!is_motion_word(line, i) && !is_motion_code(line, i)) continue;
    line.words[i] =
        line.words[i].empty() ? std::string(word) : fmt::format("{} {}", word, line.words[i]);
    return;
  }
}

// Replaces motion words in place, drops those that the corrected motion lacks, and appends new ones
// after the last of them: comments and other words keep their position in the line.
void weave(EditedLine& line, MotionWords motion, bool needs_code) {
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

void drop_motion(EditedLine& line) {
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    if (is_motion_word(line, i) || is_motion_code(line, i)) drop(line, i);
  }
}

void take_behind(EditedLine& line) {
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    if (!acts_behind_motion(line.codes[i])) continue;
    line.behind += (line.behind.empty() ? "" : " ") + line.words[i];
    drop(line, i);
  }
}

}  // namespace servomill::sim::programs
