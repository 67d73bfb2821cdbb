/// The passes of the tools of a program through the work frame, in steps that are as good as
/// straight: the material that they remove.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "plant/cutting/removed_volume.h"
#include "plant/kinematics/chain.h"
#include "plant/vocabulary/units.h"
#include "sim/model/work_frame.h"
#include "sim/preparation/cutting_force_plan.h"

namespace servomill::sim::preparation {

/// One move of the program with what turns in the spindle.
struct Stage {
  std::size_t piece;
  int tool;
  const plant::Cutter* cutter;  // nullptr: not known
  double turns;                 // 1/s, of the spindle; 0: it stands
  bool clockwise;
  bool is_straight;
  // ends of the removing steps: shares of the piece, and positions of all passes up to there
  std::vector<double> shares = {};
  std::vector<std::size_t> counts = {};
  Eigen::AlignedBox3d tips = {};  // in G
};

/// Distance (m) behind a cutter within which material that it meets is not yet removed.
constexpr double kBehind = 10 * um;

/// The nominal motion of a program, of which the ideal machine makes positions of the tool.
class ToolPasses {
 public:
  /// @param in  must outlive this
  explicit ToolPasses(const CuttingPlanInputs& in);

  const std::vector<Stage>& stages() const { return stages_; }
  const model::PartFrame& frame() const { return frame_; }

  /// Passes of the cutters over the whole program. Fills in the steps of all stages.
  plant::RemovedVolume remove();

  /// The tool at a share of a stage.
  plant::CutterPosition position(const Stage& stage, double share);

  /// Joints of the last position.
  const Joints& joints() const { return Q_near_; }

  /// Positions of all passes up to the last one that lies well behind a share of a stage.
  /// @pre remove() was called
  std::size_t positions_before(const Stage& stage, double share) const;

 private:
  void add_steps(Stage& stage, double end, const plant::CutterPosition& at_end,
                 std::vector<plant::CutterPosition>& positions, int halvings);

  const CuttingPlanInputs& in_;
  const engine::ProgramPath& path_;
  model::PartFrame frame_;
  Joints Q_near_;  // of the last position: the next one is the nearest to it
  std::vector<Stage> stages_;
};

}  // namespace servomill::sim::preparation
