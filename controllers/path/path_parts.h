/// A path cut at the knots of a speed and where its pieces meet.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "controllers/path/smooth_path.h"

namespace servomill::controllers {

/// A part of one interval between knots and of one piece of the path.
struct PathPart {
  std::size_t interval = 0, piece = 0;
  double from = 0.0, to = 0.0;  // m
};

/// The parts in their order along the path. Places follow from knots and pieces, so that each takes
/// eight bytes.
class PathParts {
 public:
  /// @param path, knots  must outlive this; the knots rise
  /// @param piece        that holds the first knot
  void lay(const SmoothPath& path, std::span<const double> knots, std::size_t piece);

  std::size_t size() const { return parts_.size(); }
  PathPart operator[](std::size_t n) const;
  /// First part of an interval; behind the last interval the number of parts.
  std::size_t first_of(std::size_t interval) const { return first_[interval]; }

 private:
  struct Part {
    std::uint32_t interval, piece;
  };
  double end_of(const Part& part) const;

  const SmoothPath* path_ = nullptr;
  std::span<const double> knots_;
  std::vector<Part> parts_;
  std::vector<std::uint32_t> first_;
};

}  // namespace servomill::controllers
