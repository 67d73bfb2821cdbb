/// Canned cycles (G73 G74 G81 ... G89): what the tool does at one hole.
///
/// Levels are coordinates along the normal of the plane, in the unit of the program, as the words
/// are: two levels that the program means to be equal are, then, equal.
#pragma once

#include <cstdint>
#include <vector>

namespace servomill::controllers {

/// @param tenths  ten times a G code
constexpr bool is_canned_cycle(int tenths) {
  return tenths == 730 || tenths == 740 || (tenths > 800 && tenths < 900);
}

/// Words of a cycle that stay in force for the blocks after it; all in the unit of the program,
/// which LinuxCNC does not convert when the unit changes.
struct CycleMemory {
  double r = 0.0, bottom = 0.0;      // words
  double dwell = 0.0;                // s, P
  double peck = 0.0;                 // Q
  double i = 0.0, j = 0.0, k = 0.0;  // of G87
  double level = 0.0;                // where the first cycle of a row began: where G98 goes back to
  bool has_level = false;            // in a row of cycles
};

/// One hole.
struct CycleHole {
  double r = 0.0;      // where feeding begins
  double clear = 0.0;  // where the cycle ends
  double bottom = 0.0;
  double middle = 0.0;      // G87: end of the bore upwards
  double dwell = 0.0;       // s, at the bottom
  double peck = 0.0;        // G73 G83, > 0
  double backed_off = 0.0;  // G73 G83: length of the retraction, and distance to the last depth
  int direction = 0;        // of the spindle before the cycle
};

struct CycleStep {
  enum class Kind : std::uint8_t { rapid, feed, dwell, spindle, stop };
  Kind kind = Kind::rapid;
  double level = 0.0;      // rapid, feed
  bool is_beside = false;  // rapid: not over the hole but I J K beside it (G87)
  double dwell = 0.0;      // s
  int direction = 0;       // spindle
};

/// The steps from r on, over the hole.
/// Source: LinuxCNC 2.9, G-code reference, "Canned Cycles".
std::vector<CycleStep> cycle_steps(int tenths, const CycleHole& hole);

/// How many steps those are, at most.
double cycle_step_count(int tenths, const CycleHole& hole);

}  // namespace servomill::controllers
