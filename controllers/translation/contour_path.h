/// Path of the tool along a contour: RND and CHF between elements, radius compensation, approach
/// and departure. An element is held back until the next one is known. All lengths in mm.
///
/// Radius compensation, RL and RR (G41 and G42):
/// (1) The block that switches it on moves in a straight line to the point one tool radius to the
///     side of the start of the next element, perpendicular to it (M); the block that switches it
///     off starts one tool radius to the side of the end of the last element.
/// (2) Outside corners: an arc about the corner. iTNC 530 (60642x-04) p. 219; the spline that
///     MP7680 selects is not supported.
/// (3) Inside corners: the intersection of the offset paths. Same page.
/// LinuxCNC's compensation (controllers/gcode/cutter_compensation.h) starts perpendicular to the
/// block that switches it on, and leaves corners below 0.05 rad as they are.
///
/// APPR and DEP: radii and lengths apply to the path of the tool centre, since the manuals'
/// examples approach with R5 and a tool of radius 10 (M).
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "controllers/translation/gcode_lines.h"

namespace servomill::controllers::translation {

/// Approach (APPR) or departure (DEP): a line along the tangent (LT) or the normal (LN), an arc
/// (CT), or a line and an arc (LCT).
struct Run {
  enum class Kind { LT, LN, CT, LCT } kind = Kind::LT;
  Point start = Point::Zero();   // APPR: present position of the tool
  Point target = Point::Zero();  // DEP LCT: the end point
  double length = 0.0;           // LEN, mm
  double radius = 0.0;           // R, mm; signed
  double angle = 0.0;            // CCA, rad
  std::optional<double> depth;   // APPR: coordinate along the normal of the plane
  Feed first;                    // of the move to the auxiliary point
  Feed feed;
  int side = 0;
  int normal = 2;
  Place place;
};

/// Names in the language of the program, for messages.
struct ContourWords {
  std::string_view compensation;  // "RL and RR"
  std::string_view cancel;        // "R0"
  std::string_view rapid;         // "FMAX"
  std::string_view feed;          // "F": what to write instead
  std::string_view rounding;      // "RND R", before a number
  std::string_view chamfer;       // "CHF ", likewise
};

class ContourPath {
 public:
  ContourPath(GcodeLines& lines, const ContourWords& words) : lines_(lines), words_(words) {}

  void add(Motion motion);
  /// Adds a line of G-code after the motions added so far, and after their corner.
  void note(GcodeLine note);
  /// An arc; a line that cuts the same length from each side; a line of a length of its own.
  enum class CornerKind { rounding, chamfer, chamfer_width };
  /// Adds a corner between the last element and the next.
  /// @param size  radius of the arc; length on each side; length of the line
  /// @throws InputError if nothing precedes it
  void corner(CornerKind kind, double size, const std::optional<Feed>& feed, const Place& place);
  void approach(const Run& run);
  /// @return its end point, in the plane
  Point depart(const Run& run);
  /// True from RND or CHF up to the next element.
  bool has_corner() const { return corner_.has_value(); }
  /// Writes the elements held back.
  void flush();
  /// True from the block with RL or RR on.
  bool is_compensating() const { return side_ != 0 || (held_ && held_->side != 0); }

 private:
  struct Corner {
    CornerKind kind = CornerKind::rounding;
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
  ContourWords words_;
  std::optional<Motion> held_;      // written once no RND or CHF can follow
  std::vector<Entry> behind_held_;  // entries after `held_` without motion in the plane
  std::optional<Corner> corner_;
  std::vector<GcodeLine> behind_corner_;  // lines between RND or CHF and the next element

  int side_ = 0;
  std::optional<Motion> entry_;    // switches compensation on; waits for the next element
  std::optional<Run> approach_;    // likewise
  std::optional<Motion> last_;     // programmed
  std::optional<Element> beside_;  // `last_`, offset by the tool radius
  std::vector<Entry> waiting_;     // entries after `entry_`, `approach_` or `last_`
};

}  // namespace servomill::controllers::translation
