/// Volume that cutters remove: the union of the bodies that they sweep. Everything in one frame
/// fixed to the workpiece.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "plant/cutting/cutter.h"
#include "plant/cutting/swept_cutter.h"

namespace servomill::plant {

/// Consecutive positions of one cutter. It moves straight from each to the next; its axis turns
/// evenly, the shortest way.
struct CutterPass {
  Cutter cutter;
  std::vector<CutterPosition> positions;
};

/// How far a ray runs through what has been removed, from its start.
struct FreeWay {
  enum class Kind : std::uint8_t {
    untouched,  // nothing has been removed anywhere on the ray
    blocked,    // something has, but not at its start
    ends,       // the removed stretch that holds the start ends at `end`
    through,    // it reaches to the end of the ray
  };
  Kind kind = Kind::untouched;
  double end = 0.0;          // m from the start
  std::size_t position = 0;  // what ends there was cut by the step to this position
  std::uint32_t step = 0;    // for RemovedVolume::leave
};

/// The volume that passes removed, indexed for queries; fixed once it is made, so that any number
/// of threads may ask. Positions are counted on through all passes: position i of the second pass
/// has the number `passes[0].positions.size() + i`.
///
/// Exact but for rounding (1e-15 m) and turns of the axis (1 nm, see swept_cutter.h: a step that
/// turns too far is taken as several).
class RemovedVolume {
 public:
  /// @pre plausible cutters, finite tips, unit axes that turn by less than 90 deg between
  ///      positions; fewer than 2^32 positions
  explicit RemovedVolume(const std::vector<CutterPass>& passes);

  /// Positions of all passes.
  std::size_t position_count() const { return place_of_.size(); }

  /// True if a cutter was at the point.
  bool contains(const Eigen::Vector3d& point) const;

  /// True if a cutter was at the point while it went through the first n positions: from each of
  /// them to the next, up to position n - 1 and not beyond. For n = 0 nothing has been removed.
  /// For what the cutter meets on arriving at position i: contains(point, i).
  bool contains(const Eigen::Vector3d& point, std::size_t n) const;

  /// The stretch of the ray that holds its start: the union of what all steps remove, as far as it
  /// is connected. Material of less than 1 nm between two cuts is none, and steps that would
  /// lengthen the way by less than 1 nm need not be found.
  FreeWay free_way(const Ray& ray) const;

  /// Distance s (m) at which a ray, also one beside that of `way`, leaves the volume removed by the
  /// step that ended `way`; -infinity if it misses that. Concave over parallel rays.
  /// @pre way.kind is ends
  double leave(const FreeWay& way, const Ray& ray) const;

 private:
  // Up to kRunSteps consecutive steps of one cutter: step i goes from place i to place i + 1.
  struct Run {
    std::uint32_t first, last;  // steps first .. last - 1
    std::uint32_t cutter;
    CutterPosition from, to;  // here, too: most runs are looked at no closer
  };
  // A node of the tree over runs: every point that they remove is within `radius` of the box. The
  // left child follows its parent.
  struct Node {
    Eigen::Array3d low, high;
    double radius;
    std::uint32_t first_step;  // of all runs below
    std::uint32_t right;       // 0: this is a leaf
    std::uint32_t run;
  };

  void add(const CutterPass& pass);
  void add_runs(std::uint32_t first_place);
  void add_margins(const Run& run, std::size_t node, std::uint32_t first, std::uint32_t last);
  std::uint32_t add_node(std::uint32_t* begin, std::uint32_t* end);
  Node box_of(const Run& run) const;
  SweptCutter swept(const Run& run, std::size_t run_node, std::uint32_t first,
                    std::uint32_t last) const;
  bool run_contains(std::uint32_t run, const Eigen::Vector3d& point, std::uint32_t end) const;
  struct Advance;
  // A part of a run: steps first .. last - 1, `node` of its margins; no step of it is left beyond
  // `bound` (m along the ray).
  struct Part {
    double bound;
    std::uint32_t run;
    std::uint32_t node;
    std::uint32_t first, last;
  };
  Part bounded(Part part, const Ray& ray, double beyond) const;
  Part whole(std::uint32_t run) const;
  void pass_nearest(const Ray& ray, Advance& state) const;
  std::vector<Part> runs_along(const Ray& ray, double beyond) const;
  void pass(const Part& part, const Ray& ray, Advance& state) const;
  void pass_step(const Part& part, const Ray& ray, Advance& state) const;
  std::size_t position_of(std::uint32_t step) const;

  std::vector<Cutter> cutters_;
  std::vector<CutterPosition> places_;   // positions, and what is between where the axis turns
  std::vector<std::uint32_t> place_of_;  // of each position
  std::vector<Run> runs_;
  // How far places of a part of a run are from the straight way between its ends (m): for each run
  // a binary tree, node i above 2 i + 1 and 2 i + 2.
  std::vector<float> margins_;
  std::vector<Node> nodes_;
};

}  // namespace servomill::plant
