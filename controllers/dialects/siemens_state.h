/// State of the control while the reader follows a program. Empty optionals are unknown.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "controllers/dialects/machine_action.h"
#include "controllers/dialects/siemens_block.h"
#include "controllers/dialects/siemens_reader.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {

/// G70, G71, G700, G710.
struct SiemensUnits {
  double length = 0.0;      // m
  bool is_of_feed = false;  // G700, G710; else F counts in the basic unit of the control
};

inline constexpr int kThroughPoint = 4;

struct SiemensState {
  std::optional<int> motion;       // 0 ... 3: G0 ... G3; kThroughPoint: CIP
  std::optional<int> normal_axis;  // of the plane: 2, 1, 0 with G17, G18, G19
  bool is_cutter_off = false;      // G40
  bool is_frame_clear = false;     // TRANS without axes
  bool is_transformation_off = false;
  std::optional<int> work_offset;  // 1 G54 ... 9 G509; more: no number of the operator's; 0: G500
  std::optional<SiemensUnits> units;
  std::optional<bool> is_incremental;
  std::optional<FeedMode> feed_mode;
  std::optional<double> F;       // as programmed
  std::optional<double> S;       // rev/min
  std::optional<int> direction;  // of the spindle
  int coolant = 0;               // bits 0 mist, 1 flood; unknown counts as off
  std::optional<int> path;       // 60, 64, 641, 642; 832
  std::optional<double> ADIS, CTOL;
  std::optional<double> smoothing;  // m; of CYCLE832
  std::optional<bool> is_rapid_linear;

  std::optional<int> tool;      // in the spindle
  std::optional<int> selected;  // T before its M6
  std::optional<int> D;
  KnownPosition position;
  // Offsets that acted when each axis moved last, in machine coordinates; unknown like the
  // position.
  KnownPosition frame_shift, length_shift;
  int tool_of_length = 0;  // whose length the position of its axis contains; 0: none or unknown

  void forget_positions() {
    position = {};
    frame_shift = {};
    length_shift = {};
    tool_of_length = 0;
  }
};

/// Constants during the reading of a program.
struct SiemensContext {
  const std::string& file;
  const ControlSetup& setup;
  const SiemensSettings& settings;
  const SiemensRules& rules;

  [[noreturn]] void fail(int line, int column, std::string message) const {
    throw InputError(Place{file, line, column}, std::move(message));
  }
};

/// The motion of a block that has positions. Changes the position in `state`.
MachineAction siemens_motion(SiemensState& state, const SiemensBlock& block,
                             const SiemensContext& context);

}  // namespace servomill::controllers
