/// What a straight probe meets of a part that cutters have machined.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "plant/cutting/removed_volume.h"

namespace servomill::plant {

/// A nominal point of the part and the normal there.
struct ProbeTarget {
  Eigen::Vector3d point;   // m
  Eigen::Vector3d normal;  // unit, out of the part
};

/// What became of a probe on its way inwards along the normal.
struct Meeting {
  enum class Kind : std::uint8_t {
    met,        // material at `distance`
    untouched,  // no cutter came near: none was anywhere on the way
    blocked,    // no cutter was where the probe starts, but one was farther in
    through,    // no material up to the depth
  };
  Kind kind = Kind::untouched;
  double distance = 0.0;     // m along the normal from the nominal point; positive: material left
  std::size_t position = 0;  // the cutter left the point on the step to this position
};

/// The surface that the cutter really left: everything that it has not been through is material.
/// So there are scallops, overlap of passes and back-cutting. Exact as RemovedVolume.
class MachinedSurface {
 public:
  /// @pre as RemovedVolume
  explicit MachinedSurface(const std::vector<CutterPass>& passes) : removed_(passes) {}

  const RemovedVolume& removed() const { return removed_; }

  /// The first material for a point that comes along the normal, from `clearance` outside of the
  /// target to `depth` inside.
  /// @param clearance  m, to where a cutter was in any case: within its radius or its flutes
  Meeting meet(const ProbeTarget& target, double clearance, double depth) const;

  /// For each target, on so many threads (0: one for each core). The same for any number.
  std::vector<Meeting> meet(std::span<const ProbeTarget> targets, double clearance, double depth,
                            unsigned threads = 0) const;

 private:
  RemovedVolume removed_;
};

}  // namespace servomill::plant
