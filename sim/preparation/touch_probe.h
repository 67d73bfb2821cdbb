/// Probing moves of a case meet the bodies of its scenario.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "controllers/gcode/probing.h"
#include "plant/geometry/reversal_memory.h"
#include "plant/geometry/volumetric.h"
#include "sim/model/touch_probe.h"
#include "sim/model/work_frame.h"
#include "sim/preparation/touch.h"
#include "strategies/strategy.h"

namespace servomill::sim::preparation {

/// Strategies at work on one tool.
struct StrategyParts {
  std::vector<std::shared_ptr<const strategies::Strategy>> strategies;  // that made the parts
  std::vector<std::unique_ptr<strategies::SetpointPart>> setpoints;
  std::unique_ptr<strategies::FeedbackPart> feedback;
};

/// The NC shows Q. The axes then stand at Q_true, with the offsets of the strategies at rest
///
///     Q_true + d(Q_true) = Q + offset(Q)                                                      (1)
///
/// and the stylus where the machine with its actual errors has it at Q_true. Scales are taken to
/// be right, and servo lag to be latched with the position, as controls do.
class TouchedBodies : public controllers::Probed {
 public:
  struct Setting {
    std::shared_ptr<const model::TouchProbe> probe;
    std::shared_ptr<const plant::VolumetricModel> machine;  // actual
    model::PartFrame frame;                                 // of the bodies
    Joints start = Joints::Zero();                          // m, rad, where the program begins
    Joints a_max = Joints::Zero();                          // m/s^2, rad/s^2
    /// @param p_ST  m, of the tool
    std::function<StrategyParts(const Eigen::Vector3d& p_ST)> strategies;
  };
  explicit TouchedBodies(Setting setting);

  std::optional<controllers::ProbeContact> contact(const controllers::ProbingMove& move) override;
  const std::vector<Touch>& touches() const { return touches_; }

  /// Joints of the axes where the NC shows Q, by (1).
  Joints true_joints(const Joints& Q, const Eigen::Vector3d& p_ST);

 private:
  struct Way;
  double gap(const Way& way, double share);
  std::optional<double> switching_share(const Way& way);
  double stopping_share(const Way& way) const;
  StrategyParts& parts(const Eigen::Vector3d& p_ST);

  Setting setting_;
  plant::ReversalMemory memory_;
  std::vector<double> directions_;
  std::vector<std::pair<Eigen::Vector3d, StrategyParts>> parts_;  // by p_ST
  std::vector<Touch> touches_;
};

}  // namespace servomill::sim::preparation
