#include "plant/cutting/machined_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <exception>
#include <limits>
#include <mutex>
#include <queue>
#include <thread>

namespace servomill::plant {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kTargetsAtOnce = 64;  // of a thread

Meeting::Kind kind_of(FreeWay::Kind kind) {
  switch (kind) {
    case FreeWay::Kind::untouched:
      return Meeting::Kind::untouched;
    case FreeWay::Kind::blocked:
      return Meeting::Kind::blocked;
    case FreeWay::Kind::ends:
      return Meeting::Kind::met;
    case FreeWay::Kind::through:
      break;
  }
  return Meeting::Kind::through;
}

constexpr double kContactTolerance = 20e-9;  // m
constexpr double kSmallestCell = 50e-9;      // m, half a side
constexpr std::size_t kMaxSteps = 24;

// Lines parallel to the normal, over a square beside the ball's axis.
struct Cell {
  double bound;  // e - lift is no larger
  double u, v, half;

  double nearest() const {  // to the axis
    return std::hypot(std::max(std::abs(u) - half, 0.0), std::max(std::abs(v) - half, 0.0));
  }
  bool operator<(const Cell& other) const { return bound < other.bound; }
};

// A ball on its way along the normal of a target.
class BallContact {
 public:
  BallContact(const RemovedVolume& removed, const ProbeTarget& target, double radius,
              double clearance, double depth)
      : removed_(removed),
        target_(target),
        radius_(radius),
        clearance_(clearance),
        depth_(depth),
        U_(target.normal.unitOrthogonal()),
        V_(target.normal.cross(U_)) {}

  Meeting find() {
    std::priority_queue<Cell> cells;
    cells.push({std::numeric_limits<double>::infinity(), 0.0, 0.0, radius_});
    Meeting best = {Meeting::Kind::through, -depth_, 0};
    while (!cells.empty() && cells.top().bound > best.distance + kContactTolerance) {
      const Cell cell = cells.top();
      cells.pop();
      const double rho = std::hypot(cell.u, cell.v), start = back(rho);
      const FreeWay way = removed_.free_way(line(cell.u, cell.v, start));
      if (rho < radius_) {
        if (way.kind == FreeWay::Kind::untouched || way.kind == FreeWay::Kind::blocked) {
          return {rho == 0.0 ? kind_of(way.kind) : Meeting::Kind::blocked, 0.0, 0};
        }
        const double distance = start - way.end - lift(rho);
        if (way.kind == FreeWay::Kind::ends && distance > best.distance) {
          best = {Meeting::Kind::met, distance, way.position};
        }
      }
      if (way.kind == FreeWay::Kind::ends) remember(way);
      if (cell.half > kSmallestCell) divide(cell, best.distance, cells);
    }
    if (best.kind == Meeting::Kind::through) best.distance = 0.0;
    return best;
  }

 private:
  // From `start` above the target to where the ball would give up.
  Ray line(double u, double v, double start) const {
    return {target_.point + start * target_.normal + u * U_ + v * V_, -target_.normal,
            start + depth_ + radius_};
  }

  double half_chord(double rho) const {
    return std::sqrt(std::max(radius_ * radius_ - rho * rho, 0.0));
  }
  double lift(double rho) const { return radius_ - half_chord(rho); }
  // Distance of the ball from the surface at the start.
  double back(double rho) const { return clearance_ + radius_ + half_chord(rho); }

  // The latest first: what a neighbour met.
  void remember(const FreeWay& way) {
    const auto known = std::find_if(ways_.begin(), ways_.end(),
                                    [&](const FreeWay& one) { return one.step == way.step; });
    if (known != ways_.end()) ways_.erase(known);
    ways_.insert(ways_.begin(), way);
    if (ways_.size() > kMaxSteps) ways_.pop_back();
  }

  void divide(const Cell& cell, double best, std::priority_queue<Cell>& cells) const {
    const double half = 0.5 * cell.half;
    for (const double u : {cell.u - half, cell.u + half}) {
      for (const double v : {cell.v - half, cell.v + half}) {
        Cell part = {cell.bound, u, v, half};
        const double nearest = part.nearest();
        if (nearest >= radius_) continue;
        for (const FreeWay& way : ways_) {
          part.bound = std::min(part.bound, largest(way, part) - lift(nearest));
          if (part.bound <= best + kContactTolerance) break;
        }
        if (part.bound > best + kContactTolerance) cells.push(part);
      }
    }
  }

  // e of a step over a cell.
  double largest(const FreeWay& way, const Cell& cell) const {
    const double start = back(0.0);
    double least_way = std::numeric_limits<double>::infinity();
    for (const double u : {cell.u - cell.half, cell.u + cell.half}) {
      for (const double v : {cell.v - cell.half, cell.v + cell.half}) {
        least_way = std::min(least_way, removed_.leave(way, line(u, v, start)));
      }
    }
    return start - least_way;
  }

  const RemovedVolume& removed_;
  const ProbeTarget& target_;
  double radius_, clearance_, depth_;
  Vector3d U_, V_;
  std::vector<FreeWay> ways_;
};

// Calls `work` for 0 .. count - 1, each once.
template <class Work>
void for_each_on_threads(std::size_t count, unsigned threads, const Work& work) {
  if (threads == 0) threads = std::max(std::thread::hardware_concurrency(), 1U);
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto run = [&] {
    try {
      while (true) {
        const std::size_t begin = next.fetch_add(kTargetsAtOnce);
        if (begin >= count) return;
        for (std::size_t i = begin; i < std::min(begin + kTargetsAtOnce, count); ++i) work(i);
      }
    } catch (...) {
      next = count;
      const std::scoped_lock lock(mutex);
      failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> pool;
    for (std::size_t t = 1; t < threads && t * kTargetsAtOnce < count; ++t) pool.emplace_back(run);
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace

Meeting MachinedSurface::meet(const ProbeTarget& target, double clearance, double depth) const {
  assert(std::abs(target.normal.norm() - 1.0) < 1e-9 && clearance + depth > 0.0);
  const FreeWay way = removed_.free_way(
      {target.point + clearance * target.normal, -target.normal, clearance + depth});
  return {kind_of(way.kind), way.kind == FreeWay::Kind::ends ? clearance - way.end : 0.0,
          way.position};
}

std::vector<Meeting> MachinedSurface::meet(std::span<const ProbeTarget> targets, double clearance,
                                           double depth, unsigned threads) const {
  std::vector<Meeting> meetings(targets.size());
  for_each_on_threads(targets.size(), threads,
                      [&](std::size_t i) { meetings[i] = meet(targets[i], clearance, depth); });
  return meetings;
}

Meeting MachinedSurface::touch(const ProbeTarget& target, double radius, double clearance,
                               double depth) const {
  assert(std::abs(target.normal.norm() - 1.0) < 1e-9 && clearance + depth > 0.0 && radius > 0.0);
  return BallContact(removed_, target, radius, clearance, depth).find();
}

std::vector<Meeting> MachinedSurface::touch(std::span<const ProbeTarget> targets, double radius,
                                            double clearance, double depth,
                                            unsigned threads) const {
  std::vector<Meeting> meetings(targets.size());
  for_each_on_threads(targets.size(), threads, [&](std::size_t i) {
    meetings[i] = touch(targets[i], radius, clearance, depth);
  });
  return meetings;
}

}  // namespace servomill::plant
