/// The steps that prepare a case, each of which asks the cache first.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "controllers/path/trajectory.h"
#include "plant/geometry/volumetric.h"
#include "sim/model/forward.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/preparation/touch_probe.h"
#include "strategies/strategy.h"

namespace servomill::sim::preparation {

using SharedModel = std::shared_ptr<const plant::VolumetricModel>;
using SharedProgram = std::shared_ptr<const InterpretedProgram>;
using SharedStrategy = std::shared_ptr<const strategies::Strategy>;
using SharedCutting = std::shared_ptr<const PlannedCutting>;
using SharedMotion = std::shared_ptr<const PlannedMotion>;

/// All steps throw InputError with what they find wrong.
class CasePreparation {
 public:
  /// All must outlive this.
  CasePreparation(const model::Scenario& scenario, const model::CaseSpec& spec,
                  PreparationCache& cache);

  /// Position (m, rad) from which the program starts.
  const Joints& start() const { return start_; }

  /// The original program as the NC reads it.
  SharedProgram program() const;

  /// Duration (s) of the program at its feeds alone: no plan is faster.
  double least_time(const InterpretedProgram& program) const;

  /// Model of the errors of that name; without a name, of a machine without errors.
  SharedModel model(const std::string& name) const;
  /// The same for the chain of another machine.
  SharedModel model(const std::string& name, const plant::MachineChain& chain) const;

  const plant::ErrorModel& errors(const std::string& name) const;

  /// @param tip  p_ST (m) of the first tool that works
  SharedStrategy strategy(const model::StrategySpec& spec, const Eigen::Vector3d& tip) const;
  /// Warnings of the margins that its term in the position loops leaves.
  std::vector<std::string> check_added_gain(const model::StrategySpec& strategy,
                                            const AddedGain& added) const;

  /// The program that a strategy makes of `moves`, as LinuxCNC reads its text.
  std::shared_ptr<const RewrittenProgram> rewritten(const SharedMoves& moves,
                                                    const SharedStrategy& strategy) const;

  /// The planned motion along `moves`.
  /// @param program  the original one
  SharedMotion motion(const SharedMoves& moves, const InterpretedProgram& program) const;
  /// @param feed  factor on all feeds
  SharedMotion motion(const SharedMoves& moves, const InterpretedProgram& program,
                      const controllers::JointLimits& limits, double feed = 1.0) const;
  /// Limits of the axes.
  controllers::JointLimits limits() const;

  /// The cutting force along the original program; nullptr: this case runs in air.
  SharedCutting cutting(const SharedProgram& program) const;

  /// The largest distance (m) of a nominal point from the part; 0 without a part.
  double distance_of_plan() const;

 private:
  double added_gain(const model::StrategySpec& spec) const;
  /// Position loops that the strategy knows; nullptr: none.
  std::shared_ptr<const strategies::IdentifiedLoops> identified_loops(
      const model::StrategySpec& spec) const;
  SharedStrategy make(const model::StrategySpec& spec,
                      const strategies::IdentifiedMachine& machine) const;
  /// The surroundings of probing moves; nullptr without a touch probe.
  std::shared_ptr<TouchedBodies> touched_bodies() const;
  StrategyParts parts_at_rest(const Eigen::Vector3d& tip) const;
  void add_probing(system::MemoKey& key) const;
  controllers::ProgramSetup setup_of_rewritten() const;
  controllers::TipMotions tip_motions(const MoveList& moves, const InterpretedProgram& program,
                                      const controllers::JointLimits& limits,
                                      const controllers::PathOptions& options) const;
  void rewrite(const strategies::Strategy& strategy, const MoveList& moves,
               const PutMove& put) const;
  PlannedMotion plan(const SharedMoves& moves, const InterpretedProgram& program,
                     const controllers::JointLimits& limits,
                     const controllers::PathOptions& options) const;

  const model::Scenario& scenario_;
  const model::CaseSpec& spec_;
  const model::MachineSettings& machine_;
  Joints start_;
  PreparationCache& cache_;
};

}  // namespace servomill::sim::preparation
