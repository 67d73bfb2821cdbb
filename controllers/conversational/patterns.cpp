// PATTERN DEF and CYCL CALL PAT. Source: TNC 640 cycle programming, PATTERN DEF, from memory: the
// words of each pattern, that Z is added to Q203, and that the tool goes between the points at the
// height of the call or of Q204, whichever is higher.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/conversational/translator.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::conversational {
namespace {

constexpr int kMaxPoints = 9999;  // in a row

// "(X+25" and "Z+0)": the words of a pattern stand in brackets.
std::vector<HeidenhainWord> without_brackets(std::span<const HeidenhainWord> words) {
  std::vector<HeidenhainWord> out;
  for (HeidenhainWord word : words) {
    std::erase_if(word.text, [](char c) { return c == '(' || c == ')'; });
    std::erase_if(word.rest, [](char c) { return c == '(' || c == ')'; });
    if (word.text.empty()) continue;
    const std::size_t letters = word.text.find_first_of("+-0123456789.,=");
    word.address = word.text.substr(0, letters);
    word.rest = letters == std::string::npos ? "" : word.text.substr(letters);
    out.push_back(std::move(word));
  }
  return out;
}

bool is_kind(const HeidenhainWord& word) {
  constexpr std::array<std::string_view, 6> kKinds = {"POS",   "ROW",  "PAT",
                                                      "FRAME", "CIRC", "PITCHCIRC"};
  return !word.rest.empty() && word.rest.find_first_not_of("0123456789") == std::string::npos &&
         std::find(kKinds.begin(), kKinds.end(), word.address) != kKinds.end();
}

Point turned(const Point& p, double degrees) {
  const double c = std::cos(degrees * deg), s = std::sin(degrees * deg);
  return {c * p.x() - s * p.y(), s * p.x() + c * p.y()};
}

}  // namespace

double Translator::pattern_number(Words& words, std::string_view name, double unit,
                                  std::optional<double> otherwise) const {
  const auto operand = words.take_number(name);
  if (operand) return value(*operand) * unit;
  if (!otherwise) fail(fmt::format("PATTERN DEF requires {}", name));
  return *otherwise;
}

// PATTERN DEF POS1 (X+25 Y+33.5 Z+0) POS2 (...), ROW1, PAT1, FRAME1, CIRC1, PITCHCIRC1.
void Translator::define_pattern(const HeidenhainBlock& block) {
  const auto words = without_brackets(std::span(block.words).subspan(2));
  pattern_.clear();
  std::size_t begin = 0;
  while (begin < words.size()) {
    if (!is_kind(words[begin])) {
      fail(words[begin].place,
           "PATTERN DEF: expected POS, ROW, PAT, FRAME, CIRC or PITCHCIRC with its number");
    }
    std::size_t end = begin + 1;
    while (end < words.size() && !is_kind(words[end])) ++end;
    Words one(std::span<const HeidenhainWord>(words).subspan(begin + 1, end - begin - 1));
    add_pattern(words[begin].address, one);
    one.refuse_rest("PATTERN DEF");
    begin = end;
  }
  if (pattern_.empty()) fail("PATTERN DEF requires at least one pattern");
}

void Translator::add_pattern(const std::string& kind, Words& words) {
  const Point start(pattern_number(words, "X", unit()), pattern_number(words, "Y", unit()));
  const double surface = pattern_number(words, "Z", unit(), 0.0);
  const auto add_point = [&](const Point& p) { pattern_.push_back({p, surface}); };
  if (kind == "POS") return add_point(start);
  if (kind == "CIRC" || kind == "PITCHCIRC") {
    return add_circle(words, start, surface, kind == "CIRC");
  }
  const bool is_row = kind == "ROW";
  const double dx = pattern_number(words, is_row ? "D" : "DX", unit());
  const double dy = is_row ? 0.0 : pattern_number(words, "DY", unit());
  const int nx = whole(pattern_number(words, is_row ? "NUM" : "NUMX", 1.0), kMaxPoints, place_,
                       is_row ? "NUM" : "NUMX");
  const int ny = is_row ? 1 : whole(pattern_number(words, "NUMY", 1.0), kMaxPoints, place_, "NUMY");
  const double rotation = pattern_number(words, "ROT", 1.0, 0.0);
  for (const char* skew : {"ROTX", "ROTY"}) {
    if (!is_row && pattern_number(words, skew, 1.0, 0.0) != 0.0) {
      fail(fmt::format("PATTERN DEF with {}, which distorts the pattern, is not supported; use POS",
                       skew));
    }
  }
  for (int row = 0; row < ny; ++row) {
    for (int i = 0; i < nx; ++i) {
      const bool is_edge = row == 0 || row == ny - 1 || i == 0 || i == nx - 1;
      if (kind == "FRAME" && !is_edge) continue;
      add_point(start + turned({i * dx, row * dy}, rotation));
    }
  }
}

// CIRC is a full circle, PITCHCIRC a part of it, with the step between points or the last angle.
void Translator::add_circle(Words& words, const Point& centre, double surface, bool is_full) {
  const double radius = 0.5 * pattern_number(words, "D", unit());
  const double first = pattern_number(words, "START", 1.0, 0.0);
  const int count = whole(pattern_number(words, "NUM", 1.0), kMaxPoints, place_, "NUM");
  if (count == 0) fail("PATTERN DEF: NUM must be > 0");
  double step = 360.0 / count;
  if (!is_full) {
    const auto given = words.take_number("STEP");
    const auto last = words.take_number("STOP");
    if (given.has_value() == last.has_value()) fail("PITCHCIRC requires either STEP or STOP");
    step = given ? value(*given) : count > 1 ? (value(*last) - first) / (count - 1) : 0.0;
  }
  for (int i = 0; i < count; ++i) {
    pattern_.push_back({centre + turned({radius, 0.0}, first + i * step), surface});
  }
}

// CYCL CALL PAT FMAX M3; without F at the last one.
void Translator::call_pattern(Words& words) {
  if (pattern_.empty()) {
    fail("CYCL CALL PAT requires PATTERN DEF: point tables are not supported");
  }
  const Positioning p = read_positioning(words, "CYCL CALL PAT");
  words.refuse_rest("CYCL CALL PAT");
  if (p.has_target()) fail("CYCL CALL PAT does not accept coordinates");
  if (!cycle_ || cycle_->number == 1) fail("CYCL CALL PAT requires a cycle 200 or higher");
  begin_functions(p);
  is_modal_call_ = false;
  const auto height = work_[2];
  const double surface = q(203);
  for (const PatternPoint& point : pattern_) {
    if (height && work_[2] && *work_[2] < *height) {
      cycle_move({}, frame_.to_program(2, *height));
    }
    Positioning to;
    to.feed = p.feed ? *p.feed : modal_feed();
    set_program_point(to, 2, point.at);
    move_straight(to);
    parameters_.set({'Q', 203}, surface + point.surface / unit());
    drill();
  }
  parameters_.set({'Q', 203}, surface);
  end_functions(p);
}

}  // namespace servomill::controllers::conversational
