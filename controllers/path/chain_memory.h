/// Plans of motions from rest to rest that come again: a program of many parts has those of one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_map>
#include <vector>

#include "controllers/path/chain_speeds.h"
#include "controllers/path/polyline.h"
#include "controllers/path/trajectory.h"

namespace servomill::controllers {

/// A plan depends on its vertices and speeds alone, as long as limits and options are the same. The
/// second motion with the same ones is planned again and kept for all further ones, so that a
/// program that repeats nothing holds but a number for each motion.
class ChainMemory {
 public:
  using Plan = std::shared_ptr<const Trajectory::Chain::Plan>;
  /// The plan of a motion: one that was made for the same vertices and speeds, bit for bit, or what
  /// make() returns.
  Plan plan(const Polyline& vertices, const ChainSpeeds& speeds, const std::function<Plan()>& make);

 private:
  struct Known {
    std::vector<std::uint64_t> key;
    Plan plan;
  };
  // by a number of the key; nullptr: a motion of this number came once
  std::unordered_map<std::uint64_t, std::unique_ptr<Known>> known_;
};

}  // namespace servomill::controllers
