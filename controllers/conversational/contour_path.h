/// The path of the tool along a contour: RND and CHF between elements, radius compensation,
/// approach and departure. Elements are held until the next one is known. All lengths in mm.
///
/// Radius compensation, RL and RR:
/// (1) The block that switches it on leads in a straight line to where the tool stands beside the
///     begin of the next element, perpendicular to it (M); the one that switches it off begins
///     beside the end of the last.
/// (2) Outside corners: an arc about the corner. iTNC 530 (60642x-04) p. 219; the spline that
///     MP7680 selects is not read.
/// (3) Inside corners: the intersection of the paths of the centre. Same page.
/// LinuxCNC's compensation (controllers/gcode/cutter_compensation.h) begins perpendicular to the
/// block that switches it on, and leaves corners below 0.05 rad as they are.
///
/// APPR and DEP: radii and lengths are those of the path of the tool's centre, since the manuals'
/// examples approach with R5 and a tool of radius 10 (M).
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "controllers/conversational/gcode_lines.h"

namespace servomill::controllers::conversational {

/// APPR and DEP: on a line along the tangent (LT) or the normal (LN), on an arc (CT), on a line and
/// an arc (LCT).
struct Run {
  enum class Kind { LT, LN, CT, LCT } kind = Kind::LT;
  Point start = Point::Zero();   // of an approach: where the tool is
  Point target = Point::Zero();  // DEP LCT: the end point
  double length = 0.0;           // LEN, mm
  double radius = 0.0;           // R, mm; signed
  double angle = 0.0;            // CCA, rad
  std::optional<double> depth;   // APPR: coordinate along the normal of the plane
  Feed first;                    // on the way to the auxiliary point
  Feed feed;
  int side = 0;
  int normal = 2;
  Place place;
};

class ContourPath {
 public:
  explicit ContourPath(GcodeLines& lines) : lines_(lines) {}

  void add(Motion motion);
  /// A line that comes behind the motions before it.
  void note(std::string text, const Place& place);
  /// RND (radius) or CHF (length on each side) between the last element and the next.
  /// @throws InputError if nothing precedes it
  void corner(bool is_rounding, double size, const std::optional<Feed>& feed, const Place& place);
  void approach(const Run& run);
  /// @return where it ends, in the plane
  Point depart(const Run& run);
  /// Ends what is held.
  void flush();
  bool is_compensating() const { return side_ != 0; }

 private:
  struct Corner {
    bool is_rounding = true;
    double size = 0.0;
    std::optional<Feed> feed;
    Place place;
  };
  using Entry = std::variant<Motion, GcodeLine>;

  Motion cut_corner(Motion& next);
  void release_held();
  void compensate(Entry entry);
  void compensate(Motion motion);
  void begin_compensation(Motion motion);
  void join(Motion next);
  void round_outside(const Motion& next, const Element& to);
  void finish_compensation();
  void enter_at(const Point& point);
  void put_last();
  void put_waiting();
  void put_approach(const Motion& first, const Element& beside);
  void move_to(const Run& run, const Point& end, const Feed& feed);
  void move_on(const Run& run, const Element& arc, const Feed& feed);

  GcodeLines& lines_;
  std::optional<Motion> held_;      // until no RND or CHF can follow
  std::vector<Entry> behind_held_;  // without motion in the plane
  std::optional<Corner> corner_;

  int side_ = 0;
  std::optional<Motion> entry_;    // the block that switches on, until the next element is known
  std::optional<Run> approach_;    // likewise
  std::optional<Motion> last_;     // programmed
  std::optional<Element> beside_;  // `last_` as the tool moves beside it
  std::vector<Entry> waiting_;     // behind `entry_`, `approach_` or `last_`
};

}  // namespace servomill::controllers::conversational
