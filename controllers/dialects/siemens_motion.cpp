// The motion of one block: its target, the arc to it, path mode and feed.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "controllers/dialects/siemens_arc.h"
#include "controllers/dialects/siemens_frame.h"
#include "controllers/dialects/siemens_state.h"
#include "controllers/dialects/siemens_target.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

// Modes required by every motion.
void check_modes(const SiemensState& state, const SiemensBlock& block,
                 const SiemensContext& context) {
  const auto fail = [&](int column, std::string message) {
    context.fail(block.line, column, std::move(message));
  };
  if (!state.motion) fail(block.column, "positions require an active G0, G1, G2 or G3");
  if (!state.is_cutter_off) {
    fail(block.column, "cutter radius compensation may be active; cancel it with G40");
  }
  for (int a = 3; a < kAxisWords; ++a) {
    const std::optional<SiemensNumber>& word = block.axes[place_of(a)];
    if (word && !state.is_transformation_off) {
      fail(word->column, fmt::format("{}: a transformation may be active; cancel it with TRAFOOF",
                                     siemens_axis_letter(a)));
    }
  }
}

// One block with positions: program coordinates first, then the machine's.
class Motion {
 public:
  Motion(SiemensState& state, const SiemensBlock& block, const SiemensContext& context)
      : state_(state),
        block_(block),
        context_(context),
        frame_(state, block, context),
        target_(state, block, context, frame_),
        arc_(state, block, context, frame_, target_) {}

  MachineAction run() {
    const bool is_arc = *state_.motion >= 2;
    if (is_arc) {
      arc_.check_words();
    } else {
      check_line_words();
    }
    target_.read();
    if (is_arc) arc_.read(out_);
    out_.line = block_.line;
    out_.kind = is_arc                ? ActionKind::arc
                : *state_.motion == 1 ? ActionKind::feed
                                      : ActionKind::rapid;
    finish_positions();
    set_path();
    if (out_.kind != ActionKind::rapid) set_feed();
    if (block_.MEAS) measure();
    return out_;
  }

 private:
  [[noreturn]] void fail(int column, std::string message) const {
    context_.fail(block_.line, column, std::move(message));
  }
  [[noreturn]] void fail(std::string message) const { fail(block_.column, std::move(message)); }

  void check_line_words() const {
    if (block_.has_centre() || block_.CR || block_.TURN) {
      fail(fmt::format("I, J, K, CR and TURN require G2 or G3; G{} is active", *state_.motion));
    }
    refuse_through_point(state_, block_, context_);
  }

  // MEAS=1: to the first signal of probe 1, which deletes the distance to go (840D sl, Job
  // planning 03/2006, 6FC5398-2BP10-1BA0, section 5.7). The axes of the block come to rest where it
  // stopped them.
  void measure() {
    if (block_.MEAS->value != 1.0) {
      fail(block_.MEAS->column, "only MEAS=1, the rising edge of probe 1, is supported");
    }
    if (out_.kind != ActionKind::feed)
      fail(block_.MEAS->column, "MEAS is supported in blocks with G1 only");
    out_.kind = ActionKind::probe;
    if (!context_.rules.MEAS_forgets_positions) return;
    for (int a = 0; a < kAxisWords; ++a) {
      if (target_.is_used[place_of(a)]) state_.position[place_of(a)].reset();
    }
  }

  void finish_positions() {
    AxisWords& words = target_.words;
    const bool keeps_length = context_.rules.D_acts_in_its_block || !block_.D;
    frame_.to_machine(words, target_.is_used);
    for (int a = 0; a < kAxisWords; ++a) {
      if (!target_.is_used[place_of(a)]) continue;
      const double old_length = state_.length_shift[place_of(a)].value_or(0.0);
      const double length = frame_.length(a);
      if (!keeps_length) words[a] += old_length - length;
      const std::optional<double> before = state_.position[place_of(a)];
      moves_[place_of(a)] = !before || *before != words[a] || out_.turns > 1 || out_.turns < -1;
      state_.position[place_of(a)] = words[a];
      state_.frame_shift[place_of(a)] = frame_.offset(a);
      state_.length_shift[place_of(a)] = length;
    }
    out_.is_commanded = target_.is_commanded;
    out_.end = state_.position;
    out_.is_machine_position = frame_.is_of_machine();
    out_.tool = state_.tool.value_or(0);
    const std::optional<int> length_axis = frame_.axis_of_any_length();
    if (length_axis && target_.is_used[place_of(*length_axis)]) {
      state_.tool_of_length = frame_.length_is_in_force() ? out_.tool : 0;
    }
    out_.tool_offset = state_.tool_of_length;
  }

  void set_path() {
    const bool is_exact = block_.has(SiemensGroup::exact_stop) || state_.path == 60;
    out_.is_path_mode_known = is_exact || state_.path.has_value();
    out_.path_mode = is_exact ? PathMode::exact_stop : PathMode::continuous;
    if (!is_exact && state_.path) out_.path_tolerance = tolerance(*state_.path);
    // [P] p. 181: without RTLION each axis runs at its own rate, but only with exact stop.
    const bool is_continuous = out_.is_path_mode_known && !is_exact;
    const auto axes = std::count(out_.is_commanded.begin(), out_.is_commanded.end(), true);
    if (out_.kind == ActionKind::rapid && context_.rules.G60_rapid_may_bend) {
      out_.is_straight = axes <= 1 || is_continuous || state_.is_rapid_linear == true;
    }
  }

  std::optional<double> tolerance(int path) const {
    if (path == 832) return state_.smoothing;
    if (path == 64) return std::nullopt;
    return (path == 641) == context_.rules.ADIS_is_of_G641 ? state_.ADIS : state_.CTOL;
  }

  void set_feed() {
    if (!state_.feed_mode) fail("G93, G94 or G95 is unknown");
    if (!state_.F) fail("no feed rate has been programmed since G93, G94 or G95");
    out_.feed_mode = *state_.feed_mode;
    if (out_.feed_mode == FeedMode::inverse_time) {
      out_.feed = *state_.F / minute;
      return;
    }
    const bool is_arc = out_.kind == ActionKind::arc;
    const bool moves_linear =
        is_arc || std::any_of(moves_.begin(), moves_.begin() + 3, [](bool b) { return b; });
    const bool moves_rotary =
        std::any_of(moves_.begin() + 3, moves_.end(), [](bool b) { return b; });
    if (moves_linear && moves_rotary) {
      fail(
          "linear and rotary axes in one block: settings determine which of them F refers to; use "
          "G93");
    }
    const bool has_linear =
        std::any_of(target_.is_used.begin(), target_.is_used.begin() + 3, [](bool b) { return b; });
    const bool is_angle = moves_rotary || !has_linear;
    const double per = out_.feed_mode == FeedMode::units_per_minute ? minute : 1.0;
    out_.feed = *state_.F * (is_angle ? deg : unit_of_feed()) / per;
  }

  double unit_of_feed() const {
    if (!state_.units) fail("the unit system is unknown; program G710 or G700");
    if (!state_.units->is_of_feed && context_.rules.G71_leaves_F) {
      fail("with G70 and G71, F is in the basic unit of the control; use G700 or G710");
    }
    return state_.units->length;
  }

  SiemensState& state_;
  const SiemensBlock& block_;
  const SiemensContext& context_;
  SiemensFrame frame_;
  MachineAction out_;
  SiemensTarget target_;
  SiemensArc arc_;
  std::array<bool, kAxisWords> moves_{};
};

}  // namespace

MachineAction siemens_motion(SiemensState& state, const SiemensBlock& block,
                             const SiemensContext& context) {
  check_modes(state, block, context);
  return Motion(state, block, context).run();
}

}  // namespace servomill::controllers
