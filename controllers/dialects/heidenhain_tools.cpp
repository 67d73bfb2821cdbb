// TOOL CALL and TOOL DEF.
#include <fmt/format.h>

#include "controllers/dialects/heidenhain_control.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::heidenhain {
namespace {

// [430] p. 468: S 0 to 99 999.999, F likewise; DL -99.9999 to 99.9999; tools 0 to 32 767
constexpr HeidenhainFormat kSpeed{99999.999, 3, false};
constexpr HeidenhainFormat kFeed{99999.999, 3, false};
constexpr HeidenhainFormat kDelta{99.9999, 4, true};
constexpr HeidenhainFormat kToolNumber{32767.0, 0, false};

struct ToolCall {
  std::optional<int> number;
  bool has_axis = false;
  std::optional<double> speed;
  std::optional<double> feed;
  std::optional<double> delta_length;
  bool has_delta_radius = false;
};

[[noreturn]] void reject(const HeidenhainWord& word) {
  throw InputError(word.place,
                   fmt::format("TOOL CALL: '{}' is not covered by the verification", word.text));
}

void read_word(const HeidenhainWord& word, ToolCall& call) {
  if (word.text == "Z") {
    call.has_axis = true;
  } else if (word.text == "X" || word.text == "Y") {
    throw InputError(word.place, fmt::format("TOOL CALL: tool axis {}; must be Z", word.text));
  } else if (word.address == "S") {
    call.speed = heidenhain_number(word, word.rest, kSpeed) * rpm;
  } else if (word.address == "F") {
    call.feed = heidenhain_number(word, word.rest, kFeed);
    if (!(*call.feed > 0.0)) {
      throw InputError(word.place, fmt::format("'{}': the feed rate must be > 0", word.text));
    }
  } else if (word.address == "DL") {
    call.delta_length = heidenhain_number(word, word.rest, kDelta);
  } else if (word.address == "DR") {
    heidenhain_number(word, word.rest, kDelta);
    call.has_delta_radius = true;
  } else {
    reject(word);
  }
}

ToolCall read_call(const HeidenhainBlock& block) {
  ToolCall call;
  for (std::size_t i = 2; i < block.words.size(); ++i) {
    const HeidenhainWord& word = block.words[i];
    const bool is_number = i == 2 && word.address.empty();
    if (is_number && word.text.front() == '"') reject(word);
    if (is_number) {
      call.number = static_cast<int>(heidenhain_number(word, word.text, kToolNumber));
    } else {
      read_word(word, call);
    }
  }
  return call;
}

}  // namespace

// State that a tool change leaves unknown: the builder's macros move axes and switch spindle and
// coolant. Transformations and M functions of the control stay.
void Control::forget_tool_change() {
  if (rules_.tool_call_forgets_positions) forget_positions();
  state_.direction.reset();
  state_.speed.reset();
  state_.feed.reset();
  state_.tool_call_feed.reset();
  state_.has_block_feed = false;
  state_.is_radius_off.reset();
  state_.pole.reset();
}

// TOOL CALL 5 Z S2500 F350 DL+0.2: a tool change. Without a number only S and F change.
void Control::call_tool(const HeidenhainBlock& block) {
  if (block.words.size() < 2 || block.words[1].text != "CALL") {
    fail(place_, "TOOL must be followed by CALL or DEF");
  }
  const ToolCall call = read_call(block);
  if (!call.number) {
    if (call.delta_length || call.has_delta_radius)
      fail(place_, "TOOL CALL: DL and DR require a tool");
    if (call.feed) state_.feed = state_.tool_call_feed = call.feed;
    if (!call.speed) return;
    state_.speed = call.speed;
    if (state_.direction.value_or(0) == 0) return;
    MachineAction& action = emit(ActionKind::spindle, place_);
    action.direction = *state_.direction;
    action.value = *call.speed;
    return;
  }
  if (!call.has_axis) fail(place_, "TOOL CALL requires the tool axis Z");
  if (!state_.is_tcp_control || !state_.is_tilted) {
    fail(place_,
         fmt::format("{} may be active from the previous program: program {} before TOOL CALL",
                     state_.is_tcp_control ? "a tilted plane" : "M128",
                     state_.is_tcp_control ? "PLANE RESET STAY" : "M129"));
  }
  forget_tool_change();
  state_.tool = call.number;
  state_.speed = call.speed;
  if (call.feed) state_.feed = state_.tool_call_feed = call.feed;
  if (rules_.tool_call_changes_length || !state_.length) {
    const auto length = setup_.tool_length.find(*call.number);
    state_.length.reset();
    if (length != setup_.tool_length.end()) state_.length = length->second;
    if (*call.number == 0) state_.length = 0.0;  // [640] p. 170
  }
  const double delta = call.delta_length.value_or(0.0) * unit();
  if (state_.length) *state_.length += rules_.delta_length_adds ? delta : -delta;
  MachineAction& action = emit(ActionKind::tool, place_);
  action.number = *call.number;
}

// TOOL DEF 5 selects the next tool in advance ([430] p. 108). With L and R it would define a tool.
void Control::define_tool(const HeidenhainBlock& block) const {
  if (block.words.size() != 3) {
    fail(place_, "TOOL DEF: only a number, which preselects a tool, is covered");
  }
  heidenhain_number(block.words[2], block.words[2].text, kToolNumber);
}

}  // namespace servomill::controllers::heidenhain
