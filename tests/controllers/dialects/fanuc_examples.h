/// Fanuc programs with their actions, worked out by hand from the manuals.
///
/// Machine coordinates (mm): G54 at X200 Y250 Z-100, G55 at X300 Y200 Z-95 B10, G56 unknown;
/// lengths H1 50, H2 55.5, H3 120. Nothing is known of the start.
#pragma once

#include <string_view>
#include <vector>

namespace servomill::controllers {

struct FanucExample {
  const char* name;
  /// Settings under which it holds: conditions such as "EVO=0 IS-B"; "" all.
  std::string_view settings;
  std::string_view program;
  std::string_view actions;  // or "error: ...": the message with line and column
};

// Line 1 ... 5. An action of the body is of line 6 at least.
#define FANUC_BEGIN FANUC_MODES("G17 G40 G80 G90 G94 G97 G69 G15 G50")
#define FANUC_MODES(modes) "G21\n" modes "\n" FANUC_SHIFTS
#define FANUC_SHIFTS                \
  "G50.1 X0. Y0. Z0. A0. B0. C0.\n" \
  "G52 X0. Y0. Z0. A0. B0. C0.\n"   \
  "G92.1 X0. Y0. Z0. A0. B0. C0.\n"
/// Positions, modes at the start, places of the machine and the tool length.
std::vector<FanucExample> fanuc_frame_examples();
/// Tool changes, stops, feeds, arcs and everything else.
std::vector<FanucExample> fanuc_motion_examples();

inline const std::vector<FanucExample>& fanuc_examples() {
  static const std::vector<FanucExample> examples = [] {
    std::vector<FanucExample> all = fanuc_frame_examples();
    for (const FanucExample& one : fanuc_motion_examples()) all.push_back(one);
    return all;
  }();
  return examples;
}

}  // namespace servomill::controllers
