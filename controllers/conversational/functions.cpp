// M functions.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "controllers/conversational/translator.h"

namespace servomill::controllers::conversational {
namespace {

// `feed`: refused, but a survey continues with unknown feeds.
enum class Effect { start, end, none, refused, feed };

struct Function {
  int number;
  Effect effect;
  std::string_view text;  // of a refusal, or of what is read without effect
};

// M functions of the controls, from 90 on. Those below are the machine builder's but for the first.
constexpr auto kFunctions = std::to_array<Function>({
    {0, Effect::end, ""},
    {1, Effect::end, ""},
    {2, Effect::end, ""},
    {3, Effect::start, ""},
    {4, Effect::start, ""},
    {5, Effect::end, ""},
    {6, Effect::end, ""},
    {8, Effect::start, ""},
    {9, Effect::end, ""},
    {13, Effect::start, ""},
    {14, Effect::start, ""},
    {30, Effect::end, ""},
    {89, Effect::end, ""},
    {90, Effect::none, "smoothing of corners without radius compensation"},
    {91, Effect::start, ""},
    {92, Effect::start, ""},
    {94, Effect::start, ""},
    {97, Effect::refused, "machining of small contour steps is not supported"},
    {98, Effect::refused, "complete machining of open corners is not supported"},
    {99, Effect::end, ""},
    {101, Effect::none, "change to a replacement tool"},
    {102, Effect::none, "change to a replacement tool"},
    {103, Effect::feed, "the plunging feed factor is not supported; program F"},
    {104, Effect::refused, "the manually set datum is unknown"},
    {105, Effect::none, "selection of the Kv factor"},
    {106, Effect::none, "selection of the Kv factor"},
    {107, Effect::none, "error message for oversized replacement tools"},
    {108, Effect::none, "error message for oversized replacement tools"},
    {109, Effect::feed, "feed of the cutting edge on arcs is not supported; use M111"},
    {110, Effect::feed, "feed of the cutting edge on arcs is not supported; use M111"},
    {111, Effect::start, ""},
    {112, Effect::refused, "transitions with a tolerance are not supported; use cycle 32"},
    {113, Effect::none, "end of M112"},
    {114, Effect::refused, "compensation of the machine geometry is not supported; use M128"},
    {115, Effect::none, "end of M114"},
    {116, Effect::feed, "feed of rotary axes in mm/min is not supported; use M117"},
    {117, Effect::start, ""},
    {118, Effect::none, "handwheel superimposition"},
    {120, Effect::none, "look-ahead of radius compensation"},
    {124, Effect::refused, "omitting points on short lines is not supported"},
    {126, Effect::start, ""},
    {127, Effect::start, ""},
    {128, Effect::start, ""},
    {129, Effect::start, ""},
    {130, Effect::refused,
     "points in the untilted coordinate system are not supported; program PLANE RESET first"},
    {134, Effect::none, "exact stop at transitions with rotary axes"},
    {135, Effect::none, "end of M134"},
    {136, Effect::feed, "F is in um/rev on a TNC 426, in mm/rev on an iTNC 530; use FU"},
    {137, Effect::start, ""},
    {138, Effect::refused, "the selection of tilting axes is not supported"},
    {140, Effect::start, ""},
    {141, Effect::none, "suppression of touch-probe monitoring"},
    {142, Effect::none, "deletion of modal program data"},
    {143, Effect::refused, "deletion of the basic rotation: the basic rotation is unknown"},
    {144, Effect::refused, "compensation of the machine kinematics is not supported; use M128"},
    {145, Effect::start, ""},
    {148, Effect::none, "retraction at an NC stop"},
    {149, Effect::none, "end of M148"},
    {150, Effect::none, "suppression of limit-switch messages"},
});

const Function* find_function(int m) {
  const auto* found = std::find_if(kFunctions.begin(), kFunctions.end(),
                                   [m](const Function& one) { return one.number == m; });
  return found == kFunctions.end() ? nullptr : found;
}

}  // namespace

void Translator::begin_functions(const Positioning& p) {
  for (const auto& [m, place] : p.functions) {
    const Function* function = find_function(m);
    if (function == nullptr || function->effect == Effect::none) {
      warn_once(fmt::format("M{}", m), fmt::format("M{} is ignored: {}; no effect on motion", m,
                                                   function != nullptr ? function->text
                                                   : m < 90            ? "machine-builder function"
                                                                       : "unknown"));
      if (function == nullptr && m >= 90) {
        fail(place, fmt::format("M{}: unknown function", m));
      }
      continue;
    }
    const bool is_refused = function->effect == Effect::refused ||
                            (function->effect == Effect::feed && !setup_.accepts_unknown_positions);
    if (is_refused) fail(place, fmt::format("M{}: {}", m, function->text));
    if (function->effect == Effect::feed) {
      forget_feeds(fmt::format("M{}: {}", m, function->text));
    }
    if (function->effect == Effect::start) start_function(m, place);
  }
}

void Translator::start_function(int m, const Place& place) {
  switch (m) {
    case 3:
    case 4:
    case 13:
    case 14: {
      if (!speed_)
        fail(place, fmt::format("M{} requires S; none programmed since the last TOOL CALL", m));
      spindle_ = m % 10 == 3 ? 1 : -1;
      note(spindle_ > 0 ? "M3" : "M4");
      if (m > 10) note("M8");
      return;
    }
    case 8:
      return note("M8");
    case 94:
      for (std::size_t i = 3; i < work_.size(); ++i) {
        if (work_[i]) revolutions_[i] = 360.0 * std::floor(*work_[i] / 360.0);
      }
      return;
    case 126:
    case 127:
      is_shorter_path_ = m == 126;
      return;
    case 128:
    case 129:
      return tcp_control(m == 128);
    default:
      return;  // M91, M92 and M140 belong to their block; 111, 117, 137, 145 is how it is read
  }
}

// Stops and ends come last in their block, after M99.
void Translator::end_functions(const Positioning& p) {
  constexpr std::array<int, 5> kLast = {0, 1, 2, 6, 30};
  for (const bool is_last : {false, true}) {
    for (const auto& [m, place] : p.functions) {
      const Function* function = find_function(m);
      if (function == nullptr || function->effect != Effect::end) continue;
      if ((std::find(kLast.begin(), kLast.end(), m) != kLast.end()) == is_last) {
        end_function(m, place);
      }
    }
  }
  const bool is_call = p.has(99) || p.has(89);
  if (is_modal_call_ && p.has_target() && !is_call && !p.has(91)) drill();
}

void Translator::end_function(int m, const Place& place) {
  switch (m) {
    case 0:
    case 1:
      return stop(m);
    case 2:
    case 30:
      if (file_ != 0) fail(place, fmt::format("M{} in a program called by CALL PGM", m));
      path_.flush();
      lines_.put(fmt::format("M{}", m), place_);
      run_.end();
      return;
    case 5:
      spindle_ = 0;
      return note("M5");
    case 9:
      return note("M9");
    case 89:
      is_modal_call_ = true;
      return drill();
    case 99:
      is_modal_call_ = false;
      return drill();
    default:
      return;  // M6: TOOL CALL has changed the tool
  }
}

// M0 stops the spindle and the coolant: TNC 155 user's manual p. 15. M1 acts with the operator's
// switch.
void Translator::stop(int m) {
  if (m == 0) {
    if (spindle_ != 0) note("M5");
    spindle_ = 0;
    note("M9");
  }
  note(fmt::format("M{}", m));
}

}  // namespace servomill::controllers::conversational
