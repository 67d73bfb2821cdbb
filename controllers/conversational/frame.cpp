#include "controllers/conversational/frame.h"

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"

namespace servomill::controllers::conversational {
namespace {

Point turned(const Point& p, double angle_deg) {
  if (angle_deg == 0.0) return p;
  const double c = std::cos(angle_deg * deg), s = std::sin(angle_deg * deg);
  return {c * p.x() - s * p.y(), s * p.x() + c * p.y()};
}

}  // namespace

bool Frame::is_any_mirrored() const {
  return std::any_of(is_mirrored.begin(), is_mirrored.end(), [](bool one) { return one; });
}

Point Frame::to_work(const Point& program) const {
  const Point p(increment(0, program.x()), increment(1, program.y()));
  return Point(shift[0], shift[1]) + turned(p, rotation);
}

Point Frame::to_program(const Point& work) const {
  const Point p = turned(work - Point(shift[0], shift[1]), -rotation);
  return {increment(0, p.x()) / (scale * scale), increment(1, p.y()) / (scale * scale)};
}

double Frame::increment(std::size_t axis, double program) const {
  const double factor = axis < 3 ? scale : 1.0;
  return (is_mirrored[axis] ? -factor : factor) * program;
}

double Frame::to_work(std::size_t axis, double program) const {
  return shift[axis] + increment(axis, program);
}

double Frame::to_program(std::size_t axis, double work) const {
  const double factor = axis < 3 ? scale : 1.0;
  return (is_mirrored[axis] ? -1.0 : 1.0) * (work - shift[axis]) / factor;
}

// "The result of transformations built up on each other depends on the programming sequence":
// TNC 620 user's manual, workpiece coordinate system. A shift before the others is what programs
// do; mirroring and rotating in either order differ.
std::string Frame::ambiguity() const {
  if (is_any_mirrored() && rotation != 0.0) {
    return "cycles 8 and 10 are both active: their combined effect depends on their order; reset "
           "one";
  }
  return {};
}

}  // namespace servomill::controllers::conversational
