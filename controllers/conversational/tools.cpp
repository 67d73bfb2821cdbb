// TOOL CALL and TOOL DEF.
#include <fmt/format.h>

#include <cmath>

#include "controllers/conversational/translator.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::conversational {

// TOOL CALL "MILL 10": the names are those of the control's tool table. Without any table here,
// each name is a tool of unknown length, with a number that no program writes.
int Translator::named_tool(Words& words) {
  constexpr int kFirst = 30001;
  const HeidenhainWord* word = words.take_next();
  const Place place = word->place;
  std::string name = word->text;
  while ((name.size() < 2 || name.back() != '"') && words.peek() != nullptr) {
    name += " " + words.take_next()->text;
  }
  if (!setup_.tools.empty()) {
    fail(place, "tool names are not supported with --tools; use the tool number");
  }
  const auto [found, is_new] =
      tool_names_.try_emplace(name, kFirst + static_cast<int>(tool_names_.size()));
  if (is_new) {
    warn_once(
        name,
        fmt::format(
            "TOOL CALL {}: treated as tool {} of unknown length; pass a tool table with --tools",
            name, found->second));
  }
  return found->second;
}

// TOOL CALL 5 Z S2000 F500 DL+0.1 DR-0.05, TOOL CALL S3000.
void Translator::call_tool(const HeidenhainBlock& block) {
  Words words(std::span(block.words).subspan(1));
  if (words.take("CALL") == nullptr) fail("TOOL must be followed by CALL or DEF");
  std::optional<int> number;
  if (const HeidenhainWord* word = words.peek()) {
    const char first = word->text.front();
    if (first == '"') number = named_tool(words);
    if (!number &&
        ((first >= '0' && first <= '9') || (first == 'Q' && word->address.starts_with('Q')))) {
      const Place at = word->place;
      const double written = value(operand_of(word->text, at));
      words.take_next();
      if (written != std::floor(written)) {
        fail(at, "indexed tools (5.1) are not supported; the tool number must be an integer");
      }
      number = whole(written, 32767, at, "TOOL CALL");
    }
  }
  for (const char* axis : {"X", "Y", "U", "V", "W"}) {
    if (words.take(axis) != nullptr) {
      fail(fmt::format("tool axis {} is not supported; only Z", axis));
    }
  }
  words.take("Z");
  const auto S = words.take_number("S");
  const auto F = words.take_number("F");
  const auto DL = words.take_number("DL");
  const auto DR2 = [&]() -> std::optional<Operand> {
    // "DR2+0.1" begins with the letters DR
    const HeidenhainWord* word = words.peek();
    if (word == nullptr || word->address != "DR" || !word->rest.starts_with("2")) return {};
    const bool has_sign = word->rest.size() > 1 &&
                          (word->rest[1] == '+' || word->rest[1] == '-' || word->rest[1] == '=');
    if (!has_sign) return {};
    words.take_next();
    return Operand{};
  };
  if (DR2()) warn_once("DR2", "DR2 is ignored");
  const auto DR = words.take_number("DR");
  if (DR2()) warn_once("DR2", "DR2 is ignored");
  words.refuse_rest("TOOL CALL");
  require_no_compensation("TOOL CALL");
  if (number && is_tcp_)
    fail("TOOL CALL is not allowed with M128; cancel it with M129");  // [530] p. 290
  if (number && plane_)
    fail("TOOL CALL is not supported in a tilted plane; program PLANE RESET first");
  path_.flush();
  if (number) change_tool(*number);
  if (S) {
    speed_ = value(*S);
    if (*speed_ < 0.0) fail(S->place, "S must be >= 0");
    lines_.put(word('S', *speed_), place_);
  }
  if (F) feed_ = tool_call_feed_ = feed_per_minute(*F);
  if (number || DL || DR) {
    delta_length_ = DL ? length(*DL) : 0.0;
    delta_radius_ = DR ? length(*DR) : 0.0;
    work_[2].reset();
  }
  refresh_system_parameters();
}

// The same tool again changes S and the oversizes only.
void Translator::change_tool(int number) {
  const bool is_same = has_tool_call_ && number == tool_;
  tool_ = number;
  has_tool_call_ = true;
  if (is_same) return;
  speed_.reset();
  spindle_ = 0;
  tool_call_feed_.reset();
  work_[2].reset();
  lines_.put(fmt::format("T{} M6", number), place_);
  const bool is_known = number != 0 && setup_.tools.find(number) != nullptr;
  lines_.put(is_known ? fmt::format("G43 H{}", number) : "G49", place_);
  if (number == 0 || is_known || !setup_.tools.empty()) return;
  warn_once("length", fmt::format("TOOL CALL {0}: the length of tool {0} is unknown, so machine Z "
                                  "is treated as the TCP position; pass a tool table with --tools",
                                  number));
}

// TOOL DEF 5 announces a tool; with L and R it defines one, where there is no tool table.
void Translator::define_tool(const HeidenhainBlock& block) {
  Words words(std::span(block.words).subspan(2));
  const HeidenhainWord* first = words.take_next();
  if (first == nullptr) fail("TOOL DEF requires a tool number");
  if (first->text.front() == '"') return;
  const int number =
      whole(value(operand_of(first->text, first->place)), 32767, first->place, "TOOL DEF");
  const auto L = words.take_number("L");
  const auto R = words.take_number("R");
  if (words.take_number("F")) {
    warn_once("TOOL DEF F",
              "F in TOOL DEF is undocumented and ignored; the next feed move must program F");
    feed_.reset();
  }
  words.refuse_rest("TOOL DEF");
  if (!L && !R) return;
  const ToolEntry* tool = setup_.tools.entry_of(number);
  if (tool == nullptr)
    fail("TOOL DEF with Q parameters is not supported; write numbers, or pass --tools");
  if (!R && tool->diameter == 0.0) tools_without_radius_.insert(number);
  constexpr double kSame = 1e-6;  // mm
  const bool differs = (L && std::abs(length(*L) - tool->offset[2] / mm) > kSame) ||
                       (R && std::abs(length(*R) - tool->diameter / 2.0 / mm) > kSame);
  if (!differs) return;
  fail(
      fmt::format("TOOL DEF {}: the tool table has L{:g} R{:g}; a control with a tool table uses "
                  "these values, one without uses the block; remove one of them",
                  number, tool->offset[2] / mm, tool->diameter / 2.0 / mm));
}

}  // namespace servomill::controllers::conversational
