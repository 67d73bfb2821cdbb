/// Common part of the minimum zones of circles, planes and cylinders: a search for the zone between
/// two surfaces at one distance from each other.
#pragma once

#include <cstddef>

#include "sim/metrology/linear_program.h"
#include "sim/metrology/points.h"

namespace servomill::sim::metrology {

/// A shape that moves among points.
class ZoneShape {
 public:
  virtual ~ZoneShape() = default;
  virtual std::size_t points() const = 0;
  /// Distance of a point from the shape as it lies now; an offset that all share does not matter.
  virtual double distance(std::size_t point) const = 0;
  /// How it changes with each motion of the shape (up to 4); of the order of 1.
  virtual SmallVector gradient(std::size_t point) const = 0;
  virtual void move(const SmallVector& motions) = 0;
  /// Keeps the present location as the best so far.
  virtual void keep() = 0;
  /// One of cells() parts of the shape, to begin with the extreme points of each.
  virtual std::size_t cell(std::size_t point) const = 0;
  virtual std::size_t cells() const = 0;
  /// Length that distinguishes rounding from a width.
  virtual double size() const = 0;
  /// Motions of one step are at most this many widths of the zone.
  virtual double reach() const = 0;

  /// Least and greatest distance of all points.
  Spread spread() const;
};

/// Moves the shape about and keeps it where the range of distances is smallest. For small motions
/// distances are linear, and the best motion is a linear program; it is solved for the points that
/// matter, again from the new place with the points that then stick out, until none does.
/// @pre the shape lies well among the points, whose range is small against size()
void narrow_zone(ZoneShape& shape);

}  // namespace servomill::sim::metrology
