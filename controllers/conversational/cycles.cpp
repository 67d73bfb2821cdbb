// CYCL DEF and CYCL CALL: selects the cycle, and executes the cycles that act on definition.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "controllers/conversational/translator.h"

namespace servomill::controllers::conversational {
namespace {

// Reaction of a survey to a cycle that cannot be simulated.
enum class Survey {
  refused,
  called,  // its moves are unknown, and so are the positions after its call
  data     // it moves nothing where it is defined
};

struct Refusal {
  int first, last;
  std::string_view why;
  Survey survey = Survey::refused;
};

constexpr auto kRefusals = std::to_array<Refusal>({
    {3, 6,
     "pockets, slots and contour cycles are not supported; have the CAM system output the moves",
     Survey::called},
    {12, 12, "use CALL PGM"},
    {13, 13, "spindle orientation"},
    {14, 14, "SL cycles are not supported; have the CAM system output the moves", Survey::data},
    {15, 16, "SL cycles are not supported; have the CAM system output the moves", Survey::called},
    {18, 18, "thread cutting requires a position-controlled spindle; use cycle 207"},
    {20, 20, "SL cycles are not supported; have the CAM system output the moves", Survey::data},
    {21, 25, "SL cycles are not supported; have the CAM system output the moves", Survey::called},
    {27, 30, "cylinder surfaces and digitized data are not supported", Survey::called},
    {39, 39, "cylinder surface transformation is not supported", Survey::called},
    {204, 204,
     "back boring: the feed rate of the disengaging move is undocumented; program the moves",
     Survey::called},
    {208, 208,
     "bore milling: the approach path to the wall is internal to the control; program it with CC "
     "and CP IPA",
     Survey::called},
    {210, 215, "pockets, slots and studs are not supported; have the CAM system output the moves",
     Survey::called},
    {230, 233, "face milling is not supported; have the CAM system output the moves",
     Survey::called},
    {241, 241, "single-lip drilling is not supported", Survey::called},
    {253, 254,
     "slots: the roughing path is internal to the control; have the CAM system output the moves",
     Survey::called},
    {251, 267,
     "pockets, slots, studs and threads are not supported; have the CAM system output the moves",
     Survey::called},
    {268, 269, "unknown cycle"},
    {270, 279, "contour cycles are not supported; have the CAM system output the moves"},
    {400, 499, "touch probe cycles are not supported: the measured values are unknown"},
});

constexpr long kApplicationTuning = 392;  // ATC, of machines of DMG MORI

// Cycles with Q parameters; 247 sets the preset.
constexpr auto kOfParameters =
    std::to_array<int>({200, 201, 202, 203, 205, 206, 207, 209, 220, 221, 240, 247});

// Cycles in the form CYCL DEF 7.0, CYCL DEF 7.1; those before 3 and 17 make holes.
constexpr auto kOfSteps = std::to_array<int>({1, 2, 7, 8, 9, 10, 11, 17, 19, 26, 32});

bool is_one_of(std::span<const int> cycles, long number) {
  return std::find(cycles.begin(), cycles.end(), number) != cycles.end();
}

// Values of an old drilling cycle: 1 has set-up clearance, depth, pecking depth, dwell, F; 2 has no
// pecking depth; 17 has set-up clearance, depth, pitch. [407] p. 8-5, 8-7; 17 from memory
std::size_t values_of(int number) { return number == 1 ? 5 : number == 2 ? 4 : 3; }

bool is_old_drilling(int number) { return number == 1 || number == 2 || number == 17; }

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
  if (*number == 13) {
    return warn_once("cycle 13", "CYCL DEF 13: spindle orientation is ignored");
  }
  for (const Refusal& refusal : kRefusals) {
    if (*number < refusal.first || *number > refusal.last) continue;
    const bool can_go_on = setup_.accepts_unknown_positions && refusal.survey != Survey::refused;
    if (!can_go_on) fail(words[2].place, fmt::format("CYCL DEF {}: {}", *number, refusal.why));
    return survey_cycle(static_cast<int>(*number), refusal.why, refusal.survey == Survey::called,
                        words.subspan(3));
  }
  if (*number == kApplicationTuning) {
    return warn_once("cycle 392", "CYCL DEF 392 is ignored: it adapts the drives to the load");
  }
  if (*step >= 0) {
    return define_old_cycle(static_cast<int>(*number), static_cast<int>(*step), block);
  }
  open_cycle_ = -1;
  if (!is_one_of(kOfParameters, *number)) {
    fail(words[2].place, fmt::format("CYCL DEF {}: unknown cycle", *number));
  }
  Words values(words.subspan(3));
  if (*number == 220 || *number == 221) {
    assign_words(values);
    return call_hole_pattern(*number == 220);
  }
  cycle_ = Cycle{static_cast<int>(*number), {}, 0, {}};
  is_modal_call_ = false;
  assign_words(values);
}

// A survey continues after a cycle whose path is the control's own: where it is called, positions
// are unknown.
void Translator::survey_cycle(int number, std::string_view why, bool is_called,
                              std::span<const HeidenhainWord> words) {
  if (is_called) {
    cycle_ = Cycle{number, {}, 0, std::string(why)};
    is_modal_call_ = false;
  }
  open_cycle_ = number;
  const bool has_parameters =
      !words.empty() && std::any_of(words.begin(), words.end(), [](const HeidenhainWord& word) {
        return word.address == "Q" && word.text.find('=') != std::string::npos;
      });
  if (!has_parameters) return;
  Words values(words);
  assign_words(values);
}

// A survey continues after a touch probe cycle: positions and results are unknown, and a preset
// that it sets counts as the one in force.
void Translator::survey_probe(const HeidenhainBlock& block) {
  std::vector<HeidenhainWord> inputs;
  for (const HeidenhainWord& word : block.words) {
    const bool is_input = word.address == "Q" && word.text.find('=') != std::string::npos;
    if (is_input) inputs.push_back(word);
  }
  Words values(inputs);
  assign_words(values);
  forget_probed(block.words);
  for (int number = 115; number <= 166; ++number) {
    if (number > 119 && number < 150) continue;
    parameters_.forget({'Q', number}, "was measured by TCH PROBE");
  }
  require_no_compensation("TCH PROBE");
  leave_positions_unknown("TCH PROBE", "the measured values are unknown");
}

// "TCH PROBE 0.0 REF. PLANE Q5 X-": cycles 0 to 4 name the parameter of the result; 3 and 4 store
// coordinates and a state from it on, four in all (from memory).
void Translator::forget_probed(std::span<const HeidenhainWord> words) {
  constexpr long kResults = 4;
  for (const HeidenhainWord& word : words) {
    const auto first = word.address == "Q" ? integer_of(word.rest) : std::nullopt;
    if (!first) continue;
    for (long number = *first; number < *first + kResults; ++number) {
      parameters_.forget({'Q', static_cast<int>(number)}, "was measured by TCH PROBE");
    }
  }
}

// CYCL DEF 7.0 DATUM SHIFT / CYCL DEF 7.1 X+10: step 0 names the cycle.
void Translator::define_old_cycle(int number, int step, const HeidenhainBlock& block) {
  const std::span<const HeidenhainWord> all(block.words);
  const auto rest = all.subspan(3);
  if (step == 0) {
    if (!is_one_of(kOfSteps, number)) {
      fail(all[2].place, fmt::format("CYCL DEF {}: unknown cycle", number));
    }
    open_cycle_ = number;
    if (is_old_drilling(number)) {
      cycle_ = Cycle{number, {}, values_of(number), {}};
      is_modal_call_ = false;
    }
    return;
  }
  if (open_cycle_ != number) {
    fail(all[2].place,
         fmt::format("CYCL DEF {0}.{1} requires CYCL DEF {0}.0 before it", number, step));
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
    case 19:
      return working_plane(words);
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
  const std::size_t next = cycle_->values.size() + 1;
  if (static_cast<std::size_t>(step) != next) {
    fail(all[2].place,
         fmt::format("CYCL DEF {0}.{1}: expected CYCL DEF {0}.{2}", number, step, next));
  }
  if (!text) fail(fmt::format("cycle {}: expected a number", number));
  std::string number_text = *text;
  if (rest.back().address == "F") number_text = rest.back().rest;
  if (number_text == "MAX") {
    fail(fmt::format("cycle {}: FMAX is not allowed as drilling feed rate", number));
  }
  cycle_->values.push_back(value(operand_of(number_text, rest.back().place)));
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
      fail(
          "CYCL CALL POS with Z shifts the surface, which is not supported; use Q203 and CYCL CALL "
          "POS with X and Y");
    }
    move_straight(p);
  }
  is_modal_call_ = false;
  drill();
  end_functions(p);
}

}  // namespace servomill::controllers::conversational
