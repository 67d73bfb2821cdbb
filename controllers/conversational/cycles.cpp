// CYCL DEF and CYCL CALL: selects the cycle, and executes the cycles that act on definition.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "controllers/conversational/translator.h"

namespace servomill::controllers::conversational {
namespace {

struct Refusal {
  int first, last;
  std::string_view why;
};

constexpr auto kRefusals = std::to_array<Refusal>({
    {4, 6, "pockets and contour cycles are not supported; have the CAM system output the moves"},
    {12, 12, "write CALL PGM"},
    {13, 13, "orientation of the spindle"},
    {14, 16, "SL cycles are not supported; have the CAM system output the moves"},
    {19, 19, "cycle 19 leaves positioning of the rotary axes to the program; use PLANE SPATIAL"},
    {20, 25, "SL cycles are not supported; have the CAM system output the moves"},
    {27, 30, "cylinder surfaces and digitized data are not supported"},
    {39, 39, "cylinder surfaces are not supported"},
    {204, 204,
     "back boring: no manual found gives the feed of the tool displacement; program the moves"},
    {208, 208,
     "bore milling: the approach path to the wall is internal to the control; program it with CC "
     "and CP IPA"},
    {210, 219, "pockets, slots and studs are not supported; have the CAM system output the moves"},
    {220, 221, "patterns are not supported; program the positions with M99"},
    {230, 233, "face milling is not supported; have the CAM system output the moves"},
    {241, 241, "single-lip drilling is not supported"},
    {253, 254,
     "slots: the roughing path is internal to the control; have the CAM system output the moves"},
    {251, 279,
     "pockets, slots, studs and threads are not supported; have the CAM system output the moves"},
    {400, 499, "touch probe cycles are not supported: the measured values are unknown"},
});

constexpr long kApplicationTuning = 392;  // ATC, of machines of DMG MORI

constexpr auto kDrilling = std::to_array<int>({1, 200, 201, 202, 203, 205, 206, 207, 209, 240});

bool is_drilling(int number) {
  return std::find(kDrilling.begin(), kDrilling.end(), number) != kDrilling.end();
}

// The number at the end of the words: their names are those of the control's language ("SET UP 2",
// "ABST 2", "TIEFE-15").
std::optional<std::string> last_number(std::span<const HeidenhainWord> words) {
  if (words.empty()) return std::nullopt;
  const std::string& text = words.back().text;
  std::size_t begin = text.find_first_of("+-0123456789Q");
  const std::size_t q = text.rfind('Q');
  if (q != std::string::npos && q > 0 && begin == q && text[q - 1] >= 'A') begin = q;
  if (begin == std::string::npos) return std::nullopt;
  return text.substr(begin);
}

}  // namespace

void Translator::define_cycle(const HeidenhainBlock& block) {
  const std::span<const HeidenhainWord> words(block.words);
  if (words.size() < 3 || words[1].text != "DEF") fail("CYCL must be followed by DEF or CALL");
  const std::string& head = words[2].text;
  const std::size_t dot = head.find('.');
  const auto number = integer_of(head.substr(0, dot));
  const auto step =
      dot == std::string::npos ? std::optional<long>(-1) : integer_of(head.substr(dot + 1));
  if (!number || !step) fail(words[2].place, fmt::format("'{}' is not a cycle number", head));
  for (const Refusal& refusal : kRefusals) {
    if (*number < refusal.first || *number > refusal.last) continue;
    if (*number == 13) {
      return warn_once("cycle 13", "CYCL DEF 13: spindle orientation is ignored");
    }
    fail(words[2].place, fmt::format("CYCL DEF {}: {}", *number, refusal.why));
  }
  if (*number == kApplicationTuning) {
    return warn_once("cycle 392", "CYCL DEF 392: adapts the drives to the load; ignored");
  }
  if (*step >= 0) {
    return define_old_cycle(static_cast<int>(*number), static_cast<int>(*step), block);
  }
  const bool is_known = is_drilling(static_cast<int>(*number)) || *number == 247;
  if (!is_known || *number == 1) {
    fail(words[2].place, fmt::format("CYCL DEF {}: unknown cycle", *number));
  }
  cycle_ = Cycle{static_cast<int>(*number), {}, true, place_};
  is_modal_call_ = false;
  Words values(words.subspan(3));
  assign_words(values);
}

// CYCL DEF 7.0 DATUM SHIFT / CYCL DEF 7.1 X+10: step 0 names the cycle.
void Translator::define_old_cycle(int number, int step, const HeidenhainBlock& block) {
  const std::span<const HeidenhainWord> all(block.words);
  const auto rest = all.subspan(3);
  if (step == 0) {
    open_cycle_ = number;
    if (number == 1) cycle_ = Cycle{1, {}, false, place_}, is_modal_call_ = false;
    if (number == 7 || number == 8 || number == 9 || number == 10 || number == 11 || number == 26 ||
        number == 32 || number == 1) {
      return;
    }
    const bool is_old = number == 2 || number == 17 || number == 18 || number == 3;
    fail(all[2].place, fmt::format("CYCL DEF {}: {}", number,
                                   is_old ? "this legacy cycle is not supported; use 206, 207 or CP"
                                          : "unknown cycle"));
  }
  if (open_cycle_ != number) {
    fail(all[2].place,
         fmt::format("CYCL DEF {0}.{1} without CYCL DEF {0}.0 before it", number, step));
  }
  Words words(rest);
  switch (number) {
    case 7:
      return datum_shift({}, rest);
    case 8:
      return mirror(rest);
    case 10:
      return rotate(words);
    case 11:
      return scale(words);
    case 26:
      return scale_axes(words);
    default:
      break;
  }
  const auto text = last_number(rest);
  if (number == 9) {
    if (!text) fail("cycle 9: expected a time in seconds");
    return cycle_dwell(value(operand_of(*text, rest.back().place)));
  }
  if (number == 32) {
    if (step > 1) return;  // HSC-MODE and TA choose filters
    const auto T = words.take_number("T");
    const double tolerance = T ? length(*T) : 0.0;
    return note(tolerance > 0.0 ? "G64 " + word('P', tolerance) : "G64");
  }
  if (!text) fail("cycle 1: expected a number");
  std::string number_text = *text;
  if (rest.back().address == "F") number_text = rest.back().rest;
  if (number_text == "MAX") fail("cycle 1: F MAX is not allowed for drilling");
  cycle_->values.push_back(value(operand_of(number_text, rest.back().place)));
  cycle_->is_complete = cycle_->values.size() == 5;
}

// CYCL CALL, CYCL CALL POS X Y Z; with M functions.
void Translator::call_cycle(const HeidenhainBlock& block) {
  Words words(std::span(block.words).subspan(2));
  if (words.take("PAT") != nullptr) return call_pattern(words);
  const bool has_position = words.take("POS") != nullptr;
  const Positioning p = read_positioning(words, "CYCL CALL");
  words.refuse_rest("CYCL CALL");
  if (p.has_target() != has_position) fail("CYCL CALL accepts coordinates only after POS");
  begin_functions(p);
  if (has_position) {
    if (p.target[2]) {
      fail("CYCL CALL POS with Z moves the surface; use Q203 and CYCL CALL POS with X and Y");
    }
    move_straight(p);
  }
  is_modal_call_ = false;
  drill();
  end_functions(p);
}

}  // namespace servomill::controllers::conversational
