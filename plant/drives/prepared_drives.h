/// Coefficients of a drive that are costly to compute, kept for all lanes that have the same one.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "plant/drives/exact_step.h"
#include "plant/drives/feed_drive.h"
#include "plant/vocabulary/ticks.h"

namespace servomill::plant {

/// A step with stops on the way, at which positions are wanted.
struct Stretch {
  Tick step = 0;
  std::vector<Tick> stops{};  // ticks after its beginning, rising
  bool operator==(const Stretch&) const = default;
};

/// One drive, ready to be moved by steps of certain lengths.
struct PreparedDrive {
  /// The drive over one of the steps while the force against its slide is constant: rows
  /// (i, w, delta, v, x), columns (i, w, delta, v, x, command, force).
  struct Hold {
    Eigen::Matrix<double, 5, 7> end;
    Eigen::Matrix<double, 1, 7> middle;  // v at half the step
  };

  /// The row of the position of `Hold`, and of Propagator over a whole stretch (zero if the drive
  /// is not smooth), at a stop.
  struct Stop {
    Eigen::Matrix<double, 1, 7> hold;
    std::array<double, Propagator::kColumns> parabola{};
  };

  /// @param steps  ticks, without repetition; the lengths of stretches are among them
  PreparedDrive(const FeedDriveParams& params, double base_period, std::vector<Tick> steps,
                std::vector<Stretch> stretches = {});

  FeedDriveParams params;
  double base_period;  // s
  std::vector<Tick> steps;
  std::vector<Stretch> stretches;
  std::vector<Hold> hold;          // one for each step
  std::vector<Stop> stops;         // stretch after stretch
  std::optional<ExactStep> exact;  // of a drive that is not linear

  /// True if its friction is a smooth function of its state, so that the kernel moves it.
  bool smooth() const;
  /// The same as `hold` for a force that is a parabola, of smooth drives; and rungs of the Ladder.
  std::vector<Propagator> whole, rungs;
};

/// Keeps prepared drives from one bank to the next: those that were made last. May be shared by
/// threads.
class PreparedDrives {
 public:
  /// @param most  how many are kept; one drive takes some 100 kB with friction, 1 kB without
  explicit PreparedDrives(std::size_t most = 64) : most_(most) {}

  /// The drive from the store, or made now.
  std::shared_ptr<const PreparedDrive> get(const FeedDriveParams& params, double base_period,
                                           const std::vector<Tick>& steps,
                                           const std::vector<Stretch>& stretches = {});

 private:
  std::mutex mutex_;
  std::size_t most_, oldest_ = 0;
  std::vector<std::shared_ptr<const PreparedDrive>> drives_;
};

}  // namespace servomill::plant
