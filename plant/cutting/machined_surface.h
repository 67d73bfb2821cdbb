/// Contact of a straight probe with a part that cutters have machined.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "plant/cutting/probe_target.h"
#include "plant/cutting/removed_volume.h"

namespace servomill::plant {

/// End of a probe's way inwards along the normal.
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

  bool operator==(const Meeting&) const = default;
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

  /// The first material for a ball that comes along the normal: mechanical filtering of scallops.
  /// The ball's nearest point goes from `clearance` outside to `depth` inside; `distance` is that
  /// of this point at the contact. To 50 nm, if nothing narrower than 0.1 um touches the ball.
  ///
  /// Each of the ball's points goes along a line of its own, parallel to the normal, and those in
  /// front are the first of their lines. So the contact is the largest of e - lift over these
  /// lines, e the distance at which a line meets material and lift = r - sqrt(r^2 - rho^2) for a
  /// line beside the axis by rho. Cells of lines are divided until none can hold more: over a cell,
  /// e of the step that its middle meets is convex and largest at a corner.
  ///
  /// blocked: where it starts, the ball has material in it; untouched: as above, on its axis.
  /// @param radius  r, m, > 0
  Meeting touch(const ProbeTarget& target, double radius, double clearance, double depth) const;
  std::vector<Meeting> touch(std::span<const ProbeTarget> targets, double radius, double clearance,
                             double depth, unsigned threads = 0) const;

 private:
  RemovedVolume removed_;
};

}  // namespace servomill::plant
