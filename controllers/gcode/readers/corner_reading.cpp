// ,R and ,C: the corner between two lines in the plane.
#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "controllers/gcode/readers/reading_step.h"

namespace servomill::controllers {

// Two lines that meet in the plane.
struct PlaneCorner {
  Eigen::Vector2d begin, corner, end;

  // From the corner to where an arc of that radius touches the lines.
  double tangent(double radius) const { return radius / std::tan(0.5 * angle()); }
  // Between the lines, 0 ... pi.
  double angle() const { return std::atan2(std::abs(cross()), to_begin().dot(to_end())); }
  // > 0: counterclockwise
  double cross() const {
    const Eigen::Vector2d u = -to_begin(), w = to_end();
    return u.x() * w.y() - u.y() * w.x();
  }
  Eigen::Vector2d to_begin() const { return (begin - corner).normalized(); }
  Eigen::Vector2d to_end() const { return (end - corner).normalized(); }
  // That a corner takes of each line.
  double way(char letter, double size) const { return letter == 'R' ? tangent(size) : size; }
  // The reason why there can be no such corner, or nothing.
  std::string fault(std::string_view name, double size) const;
  double shortest() const { return std::min((begin - corner).norm(), (end - corner).norm()); }
};

std::string PlaneCorner::fault(std::string_view name, double size) const {
  constexpr double kSmallest = 1e-6;  // rad
  const bool is_corner =
      shortest() > 0.0 && angle() > kSmallest && angle() < std::numbers::pi - kSmallest;
  if (!is_corner || size <= 0.0) {
    return fmt::format("'{}{:g}': the lines form no corner", name, size);
  }
  const double taken = way(name.back(), size);
  if (taken <= shortest()) return {};
  return fmt::format("'{}{:g}' requires {:.4g} of each line; the shorter one is {:.4g}", name, size,
                     taken, shortest());
}

namespace {

Eigen::Vector2d in_plane(const Eigen::Vector3d& p, int first, int second) {
  return {p[first], p[second]};
}

}  // namespace

// The reason why a block is no line in the plane beside a corner; empty if it is one.
std::string ReadingStep::no_line_for(std::string_view corner, int motion) const {
  if (motion != 10) {
    return fmt::format(
        "'{}' is supported only between lines (G1), not next to {}; program the corner", corner,
        motion < 0 ? "this block" : code_name('G', motion));
  }
  for (const BlockWord& word : words.all()) {
    if (word.is_erased) continue;
    const bool is_of_plane =
        word.letter >= 'X' && word.letter <= 'Z' && word.letter - 'X' != normal_axis();
    const int tenths = word.letter == 'G' ? tenths_of(word.value) : -1;
    const bool is_allowed_code =
        tenths == 10 || tenths == 900 || tenths == 910 || word.letter == 'M';
    const bool is_rate = word.letter == 'F' || word.letter == 'S' || word.letter == 'N';
    if (is_of_plane || is_allowed_code || is_rate) continue;
    return fmt::format(
        "'{}' is not supported with {} in this or the next block; program the corner", corner,
        tenths >= 0 ? code_name('G', tenths) : std::string(1, word.letter));
  }
  return {};
}

// Replaces ,R or ,C by the arc or chamfer that it stands for. The corner is tangent to both lines,
// so the next block must be known in full before this one can end.
void ReadingStep::corner() {
  if (!reading_.corner_) return;
  BlockWord size = reading_.corner_->size;
  const bool is_arc = size.letter == 'R';
  const std::string_view name = is_arc ? ",R" : ",C";
  const bool is_other_frame = memory.frame.is_active() || memory.polar.is_on;
  if (is_other_frame || state.feed_mode == FeedMode::inverse_time) {
    fail(size.column,
         fmt::format(
             "'{}' is supported only in G94, without G16, G51, G54.1 and G68; program the corner",
             name));
  }
  if (const std::string why = no_line_for(name, motion_in_block()); !why.empty()) {
    fail(size.column, why);
  }
  const bool is_next_move = reading_.next_words_ && reading_.next_words_->has_axis();
  if (!is_next_move) {
    fail(size.column,
         fmt::format("'{}' requires a linear move with plain numbers in the next block", name));
  }
  ReadingStep next(reading_, *reading_.next_words_, state, file_, reading_.corner_->next);
  next.decimal_points();
  const int next_motion = next.motion_code() < 0 ? 10 : next.motion_code();
  if (const std::string why = next.no_line_for(name, next_motion); !why.empty()) {
    fail(size.column, why);
  }
  const bool has_distance = next.words.has_code('G', 900) || next.words.has_code('G', 910);
  if (has_distance && next.words.has_code('G', 910) != is_incremental()) {
    fail(size.column,
         fmt::format("'{}' is not supported with {} in the next block; program the corner", name,
                     is_incremental() ? "G90" : "G91"));
  }
  const bool depends = options.reader == Reader::fanuc || options.reader == Reader::haas ||
                       options.decimal_point != DecimalPoint::unset;
  if (depends) decimal_point(size);

  const int first = (normal_axis() + 1) % 3, second = (normal_axis() + 2) % 3;
  Eigen::Vector3d p = state.programmed().head<3>() / unit();
  PlaneCorner lines;
  lines.begin = in_plane(p, first, second);
  const auto take = [&](const BlockWords& from) {
    for (const int axis : {first, second}) {
      if (const BlockWord* word = from.find("XYZ"[axis])) {
        p[axis] = word->value + (is_incremental() ? p[axis] : 0.0);
      }
    }
    return in_plane(p, first, second);
  };
  lines.corner = take(words);
  lines.end = take(next.words);

  if (const std::string why = lines.fault(name, size.value); !why.empty()) fail(size.column, why);
  need(ReaderRule::corner, size.column);
  write_corner(lines, size);
}

// Under G91 a line counts from the end of the line before, which the corner has cut off.
void ReadingStep::shift_behind_corner() {
  if (memory.behind_corner.isZero(0.0) || !words.has_axis()) return;
  const Eigen::Vector3d shift = std::exchange(memory.behind_corner, Eigen::Vector3d::Zero());
  for (int i = 0; i < 3 && is_incremental(); ++i) {
    const char axis = "XYZ"[i];
    if (shift[i] == 0.0) continue;
    words.set(axis, (words.has(axis) ? words[axis] : 0.0) + shift[i], words.all().front().column);
  }
}

// The line to where the corner begins, and the corner.
void ReadingStep::write_corner(const PlaneCorner& lines, const BlockWord& size) {
  const bool is_arc = size.letter == 'R';
  const double way = lines.way(size.letter, size.value);
  const Eigen::Vector2d from = lines.corner + way * lines.to_begin();
  const Eigen::Vector2d to = lines.corner + way * lines.to_end();
  const char a = "XYZ"[(normal_axis() + 1) % 3], b = "XYZ"[(normal_axis() + 2) % 3];
  const bool counts_on = is_incremental();
  const Eigen::Vector2d first = counts_on ? Eigen::Vector2d(from - lines.begin) : from;
  const Eigen::Vector2d second = counts_on ? Eigen::Vector2d(to - from) : to;
  if (counts_on) {
    memory.behind_corner.setZero();
    memory.behind_corner[a - 'X'] = (lines.corner - to).x();
    memory.behind_corner[b - 'X'] = (lines.corner - to).y();
  }
  if (words.has(a)) words.set(a, first.x());
  if (words.has(b)) words.set(b, first.y());
  if (!is_arc) {
    behind.push_back(word_text(a, second.x()) + " " + word_text(b, second.y()));
    return;
  }
  behind.push_back(fmt::format("{} {} {} {}", lines.cross() > 0.0 ? "G3" : "G2",
                               word_text(a, second.x()), word_text(b, second.y()),
                               word_text('R', size.value)));
  memory.pending_motion = 10;  // of group 01, behind the arc of the control
  memory.is_pending_known = true;
}

}  // namespace servomill::controllers
