#include "controllers/path/path_parts.h"

#include <algorithm>

namespace servomill::controllers {

void PathParts::lay(const SmoothPath& path, std::span<const double> knots, std::size_t piece) {
  path_ = &path;
  knots_ = knots;
  parts_.clear();
  first_.clear();
  const std::size_t intervals = knots.size() - 1;
  first_.reserve(intervals + 1);
  parts_.reserve(intervals + path.pieces.size() - piece);
  for (std::size_t k = 0; k < intervals; ++k) {
    first_.push_back(static_cast<std::uint32_t>(parts_.size()));
    for (double at = knots[k]; at < knots[k + 1];) {
      while (piece + 1 < path.pieces.size() && path.end_of(piece) <= at) ++piece;
      parts_.push_back({static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(piece)});
      at = end_of(parts_.back());
    }
  }
  first_.push_back(static_cast<std::uint32_t>(parts_.size()));
}

double PathParts::end_of(const Part& part) const {
  return std::min(path_->end_of(part.piece), knots_[part.interval + 1]);
}

PathPart PathParts::operator[](std::size_t n) const {
  const Part& part = parts_[n];
  const bool is_first = n == first_[part.interval];
  return {part.interval, part.piece, is_first ? knots_[part.interval] : end_of(parts_[n - 1]),
          end_of(part)};
}

}  // namespace servomill::controllers
