/// Reference of a trajectory, shared by all runs that follow or record it.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "controllers/path/trajectory.h"

namespace servomill::sim::engine {

/// Reference of one trajectory some time ago, evaluated once at each instant however many runs
/// follow and record it.
class Reference {
 public:
  Reference(const controllers::Trajectory& trajectory, double delay)
      : trajectory_(trajectory), delay_(delay) {}
  bool is(const controllers::Trajectory& other, double delay) const {
    return &trajectory_ == &other && delay_ == delay;
  }
  const controllers::Trajectory::Sample& at(double t) {
    if (t != t_) sample_ = trajectory_.at(t - delay_, cursor_);
    t_ = t;
    return sample_;
  }

 private:
  const controllers::Trajectory& trajectory_;
  double delay_;
  controllers::Trajectory::Cursor cursor_;
  double t_ = std::numeric_limits<double>::quiet_NaN();
  controllers::Trajectory::Sample sample_;
};

/// References of the trajectories of runs that advance together.
class References {
 public:
  Reference& of(const controllers::Trajectory& trajectory, double delay) {
    for (const auto& reference : all_) {
      if (reference->is(trajectory, delay)) return *reference;
    }
    return *all_.emplace_back(std::make_unique<Reference>(trajectory, delay));
  }

 private:
  std::vector<std::unique_ptr<Reference>> all_;
};

}  // namespace servomill::sim::engine
