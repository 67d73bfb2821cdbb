#include "controllers/conversational/translator.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace servomill::controllers::conversational {
namespace {

constexpr auto kKinds = std::to_array<std::string_view>(
    {"L",   "C",     "CC",    "CP",       "CR",   "CT",   "CTP",   "LP",
     "RND", "CHF",   "APPR",  "DEP",      "TOOL", "CYCL", "LBL",   "CALL",
     "FN",  "PLANE", "TRANS", "FUNCTION", "STOP", "BLK",  "BEGIN", "END"});

struct Refusal {
  std::string_view name;
  std::string_view why;
};

// Blocks of the language that are not supported.
constexpr auto kRefusals = std::to_array<Refusal>({
    {"FL",
     "free contour programming (FK) is not supported; have the control convert it to L and C"},
    {"FLT",
     "free contour programming (FK) is not supported; have the control convert it to L and C"},
    {"FC",
     "free contour programming (FK) is not supported; have the control convert it to L and C"},
    {"FCT",
     "free contour programming (FK) is not supported; have the control convert it to L and C"},
    {"FPOL",
     "free contour programming (FK) is not supported; have the control convert it to L and C"},
    {"FSELECT",
     "free contour programming (FK) is not supported; have the control convert it to L and C"},
    {"LN",
     "lines with surface normals (3-D compensation) are not supported; post-process to L with "
     "M128"},
    {"SPL", "splines are not supported; post-process to lines"},
    {"TCH", "touch probe cycles are not supported: the measured values are unknown"},
    {"SEL", "SEL selects a table or contour outside the program; use CALL PGM or cycle 7"},
    {"DECLARE", "string and contour declarations are not supported"},
    {"QS", "string parameters are not supported"},
    {"PATTERN", "PATTERN must be followed by DEF"},
    {"CONTOUR", "CONTOUR DEF is not supported; program the contour with L and C"},
    {"PARAXCOMP", "parallel axes are not supported"},
});

bool is_program_word(const HeidenhainBlock& block, std::string_view first) {
  return block.words.size() >= 2 && block.words[0].text == first && block.words[1].text == "PGM";
}

}  // namespace

bool Positioning::has_target() const {
  return std::any_of(target.begin(), target.end(), [](const auto& one) { return one.has_value(); });
}

bool Positioning::has(int function) const {
  return std::any_of(functions.begin(), functions.end(),
                     [&](const auto& one) { return one.first == function; });
}

Translator::Translator(std::string text, std::string file, const ProgramSetup& setup)
    : current_file_(file), setup_(setup) {
  files_.push_back(std::make_unique<ProgramFile>(std::move(text), std::move(file)));
  for (const auto& [name, value] : setup_.parameters) {
    std::size_t used = 0;
    const auto parameter = q_name_at(name, used);
    if (parameter && used == name.size()) parameters_.set(*parameter, value);
  }
  tool_ = setup_.tool;
  preset_ = setup_.work_system;
}

std::optional<GcodeLine> Translator::next() {
  auto line = run_.next([this] { run_block(); });
  if (line) current_file_ = line->place.file;
  return line;
}

void Translator::run_block() {
  if (!has_begun_) begin_program();
  block_mark_ = program().mark();
  const auto block = program().next();
  if (!block) return end_of_file({program().file(), program().line(), 0});
  place_ = block->place;
  run_.count_block(place_);
  if (block->is_continued_comment) {
    warn_once("comment", "a comment that ends with '~': the next line is treated as part of it");
  }
  if (block->words.empty() || (block->is_optional && setup_.block_delete)) return;
  execute(*block);
}

void Translator::begin_program() {
  has_begun_ = true;
  const std::vector<Fault>& faults = program().faults();
  if (!faults.empty()) throw InputError(faults);
  const auto block = program().begin();
  place_ = {program().file(), block ? block->place.line : 1, 1};
  if (program().lines_before_begin() > 0) {
    warn_once("title",
              fmt::format("{} lines before BEGIN PGM are ignored", program().lines_before_begin()));
  }
  if (program().has_numbers_with_N()) {
    warn_once("N", "block numbers with N are accepted, although controls write them without N");
  }
  if (program().has_bracket_comments()) {
    warn_once("bracket",
              "words in brackets at the end of a block are treated as a comment; controls use ';'");
  }
  if (!block || !is_program_word(*block, "BEGIN")) {
    fail({program().file(), block ? block->place.line : 1, 1},
         "a conversational program must start with BEGIN PGM");
  }
  place_ = block->place;
  const std::string& last = block->words.back().text;
  if (last != "MM" && last != "INCH") fail("BEGIN PGM must end with MM or INCH");
  is_inch_ = last == "INCH";
  parameters_.set({'Q', 113}, is_inch_ ? 1.0 : 0.0);
  if (is_inch_) {
    warn_once("inch", "F in a program in INCH: treated as tenths of an inch per minute");
  }
  lines_.put("G17 G21 G40 G49 G80 G90 G91.1 G94", place_);
}

void Translator::end_of_file(const Place& place) {
  if (!returns_.empty()) {
    const Return& back = returns_.back();
    fail(place, back.is_program
                    ? std::string("END PGM is missing")
                    : fmt::format("LBL 0 is missing: the program ends within LBL {}", back.name));
  }
  fail(place, "END PGM is missing");
}

// END PGM ends a program that has no M2 or M30 as well.
void Translator::execute(const HeidenhainBlock& block) {
  if (is_program_word(block, "END")) {
    if (!returns_.empty() && !returns_.back().is_program) return end_of_file(block.place);
    if (!returns_.empty()) {
      path_.flush();
      file_ = returns_.back().file;
      program().go_to(returns_.back().mark);
      returns_.pop_back();
      return;
    }
    path_.flush();
    lines_.put("M2", place_);
    run_.end();
    return;
  }
  if (is_program_word(block, "BEGIN")) fail("BEGIN PGM appears twice");
  if (block.words.front().text != "CYCL") open_cycle_ = -1;
  const std::string& first = block.words.front().text;
  if (first == "L") return line(block);
  if (first == "CC") return pole(block);
  if (first == "C") return circle(block, false);
  if (first == "CP") return circle(block, true);
  if (first == "CR") return circle_of_radius(block);
  if (first == "CT") return tangential_circle(block, false);
  if (first == "CTP") return tangential_circle(block, true);
  if (first == "LP") return polar_line(block);
  const std::string& address = block.words.front().address;
  if (address == "RND") return round_or_chamfer(block, true);
  if (address == "CHF") return round_or_chamfer(block, false);
  if (first == "APPR") return approach(block);
  if (first == "DEP") return depart(block);
  if (!execute_other(block)) refuse_unknown(block);
}

bool Translator::execute_other(const HeidenhainBlock& block) {
  const HeidenhainWord& first = block.words.front();
  const std::string second = block.words.size() > 1 ? block.words[1].text : "";
  if (first.text == "TOOL") {
    second == "DEF" ? define_tool(block) : call_tool(block);
  } else if (first.text == "CYCL") {
    second == "CALL" ? call_cycle(block) : define_cycle(block);
  } else if (first.address == "LBL") {
    label(block);
  } else if (first.text == "CALL") {
    call(block);
  } else if (first.text == "PATTERN" && second == "DEF") {
    define_pattern(block);
  } else if (first.text == "PLANE") {
    plane(block);
  } else if (first.text == "TRANS") {
    Words words(std::span(block.words).subspan(1));
    trans_datum(words);
  } else if (first.text == "TCH" && setup_.accepts_unknown_positions) {
    survey_probe(block);
  } else if (first.text == "FUNCTION") {
    plane(block);
  } else if (first.address == "FN" ||
             (first.address == "Q" || first.address == "QL" || first.address == "QR")) {
    return run_function(block);
  } else if (first.text == "STOP" || (first.address == "M" && !first.rest.empty())) {
    line(block);
  } else {
    return first.text == "BLK" && second == "FORM";
  }
  return true;
}

void Translator::refuse_unknown(const HeidenhainBlock& block) const {
  const HeidenhainWord& first = block.words.front();
  for (const Refusal& refusal : kRefusals) {
    if (first.text == refusal.name || first.address == refusal.name) {
      const char* skip =
          block.is_optional ? "; --block-delete skips lines that start with '/'" : "";
      fail(first.place, fmt::format("{}: {}{}", refusal.name, refusal.why, skip));
    }
  }
  fail(first.place,
       fmt::format("'{}' does not start a block{}", first.text, did_you_mean(first.text, kKinds)));
}

void Translator::warn_once(const std::string& key, std::string message) {
  if (warned_.insert(key).second) warnings_.push_back({place_, std::move(message)});
}

}  // namespace servomill::controllers::conversational
