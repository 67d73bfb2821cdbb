// TCH PROBE 0: the position at which the probe meets a surface along an axis.
//
// The control moves at rapid to the position in 0.1, probes from there at the feed and over the
// range of its table of touch probes, and retracts to that position (touch probe cycles of the TNC
// 426, 430 and iTNC 530, reference plane; M for the page).
#include <fmt/format.h>

#include "controllers/dialects/heidenhain_control.h"

namespace servomill::controllers::heidenhain {

void Control::run_probe(const HeidenhainBlock& block) {
  const Words& words = block.words;
  if (words.size() < 4 || words[1].text != "PROBE") fail(place_, "TCH requires PROBE and a cycle");
  if (words[2].text == "0.0") return begin_probing(words);
  if (words[2].text == "0.1") return probe(words);
  fail(words[2].place,
       fmt::format("TCH PROBE {}: only cycle 0 is covered by the verification", words[2].text));
}

// TCH PROBE 0.0 REF. PLANE Q5 X-
void Control::begin_probing(const Words& words) {
  if (open_probe_) fail(place_, "TCH PROBE 0.0 appears twice");
  const bool is_whole = words.size() == 7 && words[5].address == "Q" && words[6].text.size() == 2;
  if (!is_whole) fail(place_, "TCH PROBE 0.0 requires REF. PLANE, a parameter and a direction");
  const std::size_t axis = std::string_view("XYZ").find(words[6].text[0]);
  const char sign = words[6].text[1];
  if (axis == std::string_view::npos || (sign != '+' && sign != '-')) {
    fail(words[6].place, fmt::format("'{}': expected a direction such as X-", words[6].text));
  }
  open_probe_ = OpenProbe{static_cast<int>(axis), sign == '+' ? 1 : -1};
}

// TCH PROBE 0.1 X+5 Y+0 Z-5
void Control::probe(const Words& words) {
  if (!open_probe_) fail(place_, "TCH PROBE 0.1 requires a preceding TCH PROBE 0.0");
  const OpenProbe open = *open_probe_;
  open_probe_.reset();
  Positioning p;
  for (std::size_t at = 3; at < words.size(); ++at) read_coordinate(words[at], p);
  for (std::size_t i = 0; i < 3; ++i) {
    if (!p.target[i].word || p.target[i].is_increment) {
      fail(place_, "TCH PROBE 0.1 requires X, Y and Z, absolute");
    }
  }
  if (state_.is_radius_off != true) fail(place_, "TCH PROBE requires an active R0");
  if (!state_.tool)
    fail(place_, "TCH PROBE requires a preceding TOOL CALL: the tool axis is unknown");
  require_frame(place_, false);
  p.feed_word = Positioning::FeedWord::fmax;
  move_to(p, targets(p), new_motion(ActionKind::feed));
  MachineAction action = new_motion(ActionKind::probe);
  action.is_commanded[static_cast<std::size_t>(open.axis)] = true;
  action.direction = open.direction;
  if (!rules_.probe_returns) state_.position[static_cast<std::size_t>(open.axis)].reset();
  action.end = state_.position;
  actions_.push_back(action);
}

}  // namespace servomill::controllers::heidenhain
