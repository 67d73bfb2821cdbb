/// Lines of G-code translated from blocks in another language. They are written in LinuxCNC's
/// language, so that every reader of G-code accepts them. Numbers are in mm, degrees and mm/min.
#pragma once

#include <array>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "controllers/gcode/program_text.h"
#include "controllers/translation/contour.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers::translation {

/// Positions of axes in mm and degrees; nullopt: unknown, or not named.
using Values = std::array<std::optional<double>, kAxisWords>;

struct Feed {
  enum class Kind { rapid, per_minute, time, unknown } kind = Kind::rapid;
  double value = 0.0;  // mm/min (deg/min), s
  bool operator==(const Feed&) const = default;
};

/// A straight line or an arc, as it is written.
struct Motion {
  Values words;                    // end, in the coordinates in which G-code moves
  bool is_incremental = false;     // `words` are distances
  bool is_machine = false;         // machine coordinates (M91, SUPA)
  int normal = 2;                  // of the plane of contours: 0 YZ, 1 ZX, 2 XY
  std::optional<Element> element;  // in that plane, where both ends are known and differ
  Feed feed;
  int side = 0;         // of the tool: 1 left of the path (RL, G41), -1 right (RR, G42), 0 on it
  double radius = 0.0;  // of the tool, mm
  bool is_feed_of_contour = false;  // `feed` is that of the programmed arc, not of the tool centre
  Place place;
};

/// A line of G-code and the block from which it was translated.
struct GcodeLine {
  std::string text;
  Place place;
  LineUnknowns unknowns = {};
};

/// First and second axis of a plane.
constexpr std::array<std::size_t, 2> plane_axes(int normal) {
  return {static_cast<std::size_t>((normal + 1) % 3), static_cast<std::size_t>((normal + 2) % 3)};
}

class GcodeLines {
 public:
  void put(std::string text, const Place& place) { put({std::move(text), place}); }
  void put(GcodeLine line) { lines_.push_back(std::move(line)); }
  void put(const Motion& motion);
  bool is_empty() const { return lines_.empty(); }
  GcodeLine take();
  void clear() { lines_.clear(); }

 private:
  void put_plane(int normal, const Place& place);

  std::deque<GcodeLine> lines_;
  int normal_ = 2;
};

/// "X10.5": nine decimals, a picometre.
std::string word(char letter, double value);

}  // namespace servomill::controllers::translation
