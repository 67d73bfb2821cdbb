#include "controllers/dialects/heidenhain_control.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "plant/vocabulary/units.h"

namespace servomill::controllers::heidenhain {
namespace {

// [430] p. 468: positions -99 999.9999 to +99 999.9999 mm; 0.00001 inch in programs in INCH
constexpr HeidenhainFormat kLength{99999.9999, 4, true};
constexpr HeidenhainFormat kLengthInch{3937.0, 5, true};
constexpr HeidenhainFormat kAngle{99999.9999, 4, true};
// [430] p. 468: feed rates 0 to 99 999.999
constexpr HeidenhainFormat kFeed{99999.999, 3, false};

constexpr std::array<std::string_view, 9> kKinds = {"L",    "CC",    "C",     "CP",      "TOOL",
                                                    "CYCL", "TRANS", "PLANE", "FUNCTION"};

// Blocks of the dialect that this reader does not cover. A program with them is refused by name.
constexpr std::array<std::string_view, 22> kNotCovered = {
    "CR", "CT", "CTP", "LP", "LN",  "RND",  "CHF",  "APPR", "DEP", "LBL", "CALL",
    "FN", "FL", "FLT", "FC", "FCT", "FPOL", "STOP", "SEL",  "SPL", "TCH", "Q"};

std::optional<int> axis_of_address(std::string_view address, bool& is_increment) {
  is_increment = address.size() == 2 && address.front() == 'I';
  if (is_increment) address.remove_prefix(1);
  if (address.size() != 1) return std::nullopt;
  const auto axis = axis_of(address.front());
  return axis ? std::optional<int>(index_of(*axis)) : std::nullopt;
}

}  // namespace

bool Positioning::has_target() const {
  return std::any_of(target.begin(), target.end(), [](const Target& t) { return t.word; });
}

Control::Control(const ControlSetup& setup, const HeidenhainSettings& settings,
                 const HeidenhainRules& rules, bool is_inch)
    : setup_(setup), settings_(settings), rules_(rules), is_inch_(is_inch) {
  state_.position = setup.start;
  if (!settings.has_tilting) {
    state_.is_tilted = false;
    state_.is_tcp_control = false;
  }
  if (rules.unknown_is_refused) return;
  for (auto& position : state_.position) position = position.value_or(0.0);
  state_.shift.fill(0.0);
  state_.is_mirrored = std::array<bool, 3>{};
  state_.rotation = 0.0;
  state_.is_scaled = state_.is_tilted = state_.is_tcp_control = false;
  state_.is_axis_scaling_off.fill(true);
  state_.is_radius_off = true;
  state_.is_per_revolution = state_.is_shorter_path = state_.is_rotary_feed_in_mm = false;
}

void Control::fail(const Place& place, const std::string& message) const {
  throw InputError(place, message);
}

MachineAction& Control::emit(ActionKind kind, const Place& place) {
  MachineAction action;
  action.kind = kind;
  action.line = place.line;
  action.end = state_.position;
  action.tool = state_.tool.value_or(0);
  action.is_path_mode_known = state_.is_path_mode_known;
  action.path_tolerance = state_.path_tolerance;
  actions_.push_back(action);
  return actions_.back();
}

void Control::finish(const Place& place) const {
  if (cycle_ && cycle_->last == 0) {
    fail(place, fmt::format("cycle {} is incomplete: CYCL DEF {}.1 is missing", cycle_->number,
                            cycle_->number));
  }
}

namespace {

// FN 16: F-PRINT puts numbers out to a file and moves nothing (iTNC 530, formatted output of
// parameters; M for the page).
bool prints_to_file(const HeidenhainBlock& block) {
  const auto& words = block.words;
  return words.size() == 6 && words[1].text == "16:" && words[2].text == "F-PRINT" &&
         words[4].text == "/";
}

}  // namespace

void Control::run(const HeidenhainBlock& block) {
  const HeidenhainWord& first = block.words.front();
  place_ = block.place;
  if (first.text != "CYCL") {
    finish(block.place);
    cycle_.reset();
  }
  if (first.text == "TCH") return run_probe(block);
  if (open_probe_) fail(place_, "TCH PROBE 0.0 requires a following TCH PROBE 0.1");
  if (first.text == "FN" && prints_to_file(block)) return;
  if (first.text == "L") return run_line(block, 1);
  if (first.text == "CC") return run_pole(block);
  if (first.text == "C") return run_circle(block);
  if (first.text == "CP") return run_helix(block);
  if (first.text == "TOOL") {
    const bool is_definition = block.words.size() > 1 && block.words[1].text == "DEF";
    return is_definition ? define_tool(block) : call_tool(block);
  }
  if (first.text == "CYCL") return define_cycle(block);
  if (first.text == "TRANS") return run_trans(block);
  if (first.text == "PLANE") return run_plane(block);
  if (first.text == "FUNCTION") return run_function(block);
  if (first.text == "BLK" && block.words.size() > 1 && block.words[1].text == "FORM") return;
  if (first.address == "M" && !first.rest.empty()) return run_line(block, 0);
  const std::string_view address = first.address;
  if (std::find(kNotCovered.begin(), kNotCovered.end(), address) != kNotCovered.end()) {
    fail(first.place, fmt::format("{}: this block is not covered by the verification", address));
  }
  fail(first.place,
       fmt::format("'{}' does not start a block{}", first.text, did_you_mean(first.text, kKinds)));
}

double Control::unit() const { return is_inch_ ? inch : mm; }

double Control::angle(const HeidenhainWord& word, double max) const {
  return heidenhain_number(word, word.rest, {max, 4, true}) * deg;
}

double Control::coordinate(const HeidenhainWord& word, int axis) const {
  if (axis > index_of(Axis::Z)) return heidenhain_number(word, word.rest, kAngle) * deg;
  return heidenhain_number(word, word.rest, is_inch_ ? kLengthInch : kLength) * unit();
}

void Control::read_coordinate(const HeidenhainWord& word, Positioning& p) const {
  bool is_increment = false;
  const auto axis = axis_of_address(word.address, is_increment);
  if (!axis) fail(word.place, fmt::format("'{}' is not a word of this block", word.text));
  Positioning::Target& target = p.target[static_cast<std::size_t>(*axis)];
  if (target.word) {
    fail(word.place, fmt::format("'{}': {} appears twice in the block", word.text,
                                 letter(kAllAxes[static_cast<std::size_t>(*axis)])));
  }
  target = {&word, coordinate(word, *axis), is_increment};
}

// F500, FMAX, F MAX, FAUTO, FT2.5, FU0.1
void Control::read_feed(const Words& words, std::size_t& at, Positioning& p) const {
  const HeidenhainWord& word = words[at];
  if (p.feed_word != Positioning::FeedWord::none) {
    fail(word.place, fmt::format("'{}': the feed rate appears twice in the block", word.text));
  }
  const bool is_split_max =
      word.text == "F" && at + 1 < words.size() && words[at + 1].text == "MAX";
  if (is_split_max) ++at;
  if (is_split_max || word.text == "FMAX") {
    p.feed_word = Positioning::FeedWord::fmax;
    return;
  }
  if (word.text == "FAUTO") {
    p.feed_word = Positioning::FeedWord::fauto;
    return;
  }
  if (word.address == "F") p.feed_word = Positioning::FeedWord::f;
  if (word.address == "FT") p.feed_word = Positioning::FeedWord::ft;
  if (word.address == "FU") p.feed_word = Positioning::FeedWord::fu;
  if (p.feed_word == Positioning::FeedWord::none) {
    fail(word.place, fmt::format("'{}': this feed is not covered by the verification", word.text));
  }
  p.feed = heidenhain_number(word, word.rest, kFeed);
  if (!(p.feed > 0.0)) fail(word.place, fmt::format("'{}': the feed rate must be > 0", word.text));
}

void Control::read_function(const Words& words, std::size_t& at, Positioning& p) const {
  const HeidenhainWord& word = words[at];
  const double number = heidenhain_number(word, word.rest, {999.0, 0, false});
  if (p.functions_count == 2) {
    fail(word.place,
         fmt::format("'{}': at most two M functions are allowed in the block", word.text));
  }
  p.functions[p.functions_count] = &word;
  p.m[p.functions_count++] = static_cast<int>(number);
  if (number != 140.0) return;
  const bool is_max =
      at + 2 < words.size() && words[at + 1].text == "MB" && words[at + 2].text == "MAX";
  if (!is_max) fail(word.place, "M140: only M140 MB MAX is covered by the verification");
  p.is_retract = true;
  at += 2;
}

Positioning Control::read_words(const HeidenhainBlock& block, std::size_t first) const {
  Positioning p;
  for (std::size_t at = first; at < block.words.size(); ++at) {
    const HeidenhainWord& word = block.words[at];
    if (word.text == "R0") continue;  // checked where it acts
    if (word.text == "RL" || word.text == "RR" || word.text == "R+" || word.text == "R-") {
      fail(word.place, fmt::format("'{}': cutter radius compensation is not covered by the "
                                   "verification",
                                   word.text));
    }
    if (word.text == "DR+" || word.text == "DR-") {
      p.direction = word.text.back() == '+' ? 1 : -1;
    } else if (word.address == "PA" || word.address == "IPA") {
      // [430] p. 468: polar angle -360 to 360, of a helix -5400 to 5400 degrees
      p.is_angle_increment = word.address == "IPA";
      p.radius_angle = angle(word, p.is_angle_increment ? 5400.0 : 360.0);
    } else if (!word.address.empty() && word.address.front() == 'F') {
      read_feed(block.words, at, p);
    } else if (word.address == "M" && !word.rest.empty()) {
      read_function(block.words, at, p);
    } else {
      read_coordinate(word, p);
    }
  }
  check_functions(p);
  return p;
}

}  // namespace servomill::controllers::heidenhain
