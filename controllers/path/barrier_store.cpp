#include "controllers/path/barrier_store.h"

#include <algorithm>

namespace servomill::controllers {
namespace {

constexpr std::size_t kPoints = 3;  // of a part

}  // namespace

BarrierStore::BarrierStore(const SmoothPath& path, const SpeedSpline& spline,
                           const PathParts& parts, std::span<const double> v_top,
                           const std::vector<double>& first, std::size_t most_kept)
    : path_(path),
      spline_(spline),
      parts_(parts),
      v_top_(v_top),
      first_c_(first),
      most_kept_(most_kept) {}

void BarrierStore::prepare(const BarrierJoints& joints,
                           const std::array<int, kBarrierJoints>& moving,
                           const BarrierKernel& kernel) {
  joints_ = joints;
  moving_ = moving;
  kernel_ = kernel;
  is_kept_ = parts_.size() <= most_kept_;
  if (is_kept_) form(0, blocks_of(parts_.size()));
}

BarrierStore::Blocks BarrierStore::of(std::size_t first_part, std::size_t last_part) {
  const std::size_t first_group = first_part / kLaneWidth;
  const std::size_t first = kPoints * first_part / kLaneWidth;
  const std::size_t count = blocks_of(kPoints * last_part) - first;
  if (is_kept_) return {&points_[first], first, count};
  form(first_group, blocks_of(last_part) - first_group);
  return {&points_[first - kPoints * first_group], first, count};
}

void BarrierStore::form(std::size_t first_group, std::size_t count) {
  if (groups_.size() < count) groups_.resize(count);
  if (points_.size() < kPoints * count) points_.resize(kPoints * count);
  for (std::size_t n = 0; n < count; ++n) fill(first_group + n, groups_[n]);
  kernel_.form(groups_.data(), count, joints_, first_c_.data(), points_.data());
  if (is_kept_) groups_ = {};
}

void BarrierStore::fill(std::size_t group, BarrierParts& to) const {
  for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
    const std::size_t n = kLaneWidth * group + lane;
    PathPart part = parts_[std::min(n, parts_.size() - 1)];
    if (n >= parts_.size()) part.from = part.to;
    const CubicPiece& piece = path_.pieces[part.piece];
    const auto k = static_cast<std::ptrdiff_t>(part.interval);
    to.before[lane] = spline_.knot(k - 1);
    to.at[lane] = spline_.knot(k);
    to.next[lane] = spline_.knot(k + 1);
    to.after[lane] = spline_.knot(k + 2);
    to.from[lane] = part.from;
    to.to[lane] = part.to;
    to.x[lane] = part.from - piece.s;
    to.b_top[lane] = v_top_[part.piece] * v_top_[part.piece];
    to.interval[lane] = static_cast<std::uint32_t>(part.interval);
    for (std::size_t j = 0; j < joints_.count; ++j) {
      to.c1[j][lane] = piece.c1[moving_[j]];
      to.c2[j][lane] = piece.c2[moving_[j]];
      to.c3[j][lane] = piece.c3[moving_[j]];
    }
  }
}

}  // namespace servomill::controllers
