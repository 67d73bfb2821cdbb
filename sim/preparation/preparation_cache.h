/// Results that the preparation of many similar cases can share: the points of a sweep differ in
/// little.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "controllers/gcode/program_setup.h"
#include "controllers/path/feed_reduction.h"
#include "controllers/path/trajectory.h"
#include "plant/drives/prepared_drives.h"
#include "plant/geometry/volumetric.h"
#include "plant/vocabulary/move_list.h"
#include "plant/vocabulary/stored_text.h"
#include "sim/engine/cutting_load.h"
#include "sim/engine/program_path.h"
#include "sim/model/forward.h"
#include "sim/preparation/circular_sections.h"
#include "sim/preparation/touch_probe.h"
#include "sim/system/shared_cache.h"
#include "sim/system/shared_texts.h"
#include "strategies/strategy.h"

namespace servomill::sim::frequency {
struct Curve;
}  // namespace servomill::sim::frequency
namespace servomill::strategies {
struct LoopResponse;
}  // namespace servomill::strategies
namespace servomill::sim::metrology {
class TriangleMesh;
}  // namespace servomill::sim::metrology

namespace servomill::sim::preparation {

/// Moves of a program, shared by all that was made of them.
using SharedMoves = std::shared_ptr<const MoveList>;

/// A program as the NC of a case reads it, before any strategy.
struct InterpretedProgram {
  /// @param setup  with which the moves were read
  InterpretedProgram(MoveList moves, std::vector<Fault> warnings,
                     const controllers::ProgramSetup& setup);

  /// The first move that controls the tip; nullptr: none does.
  const Move* first_tip_move() const { return first_tip_move_ ? &*first_tip_move_ : nullptr; }

  /// True if a touch probe decides where a move ends.
  bool probes() const { return !touches.empty(); }

  /// The first feed in coordinates that the program has shifted; nullptr: none is.
  std::optional<Move> first_shifted_feed() const;

  std::shared_ptr<const StoredText> text;  // of the program, if a key names it
  MoveList moves;
  std::vector<Fault> warnings;
  std::vector<Touch> touches;                           // of its probing moves
  std::shared_ptr<const model::TouchProbe> probe;       // that made them
  std::map<int, Eigen::Vector3d> tips;                  // p_ST (m) by tool offset number
  Eigen::Vector3d first_tip = Eigen::Vector3d::Zero();  // m, of the first tool that works
  engine::ProgramPath path;
  std::array<int, kAxisWords> first_line{};  // in which an axis leaves the start; 0: none

 private:
  std::optional<Move> first_tip_move_;
};

/// The moves that a strategy made of others, as the NC reads them from its text.
struct RewrittenProgram {
  SharedMoves original;
  std::shared_ptr<const strategies::Strategy> strategy;
  MoveList moves;
  std::shared_ptr<const StoredText> text;
};

/// The planned motion of some moves.
struct PlannedMotion {
  SharedMoves moves;
  controllers::Trajectory trajectory;
  double blocks = 0.0;  // of motion
  std::vector<controllers::FeedReduction> slowed;
};

/// Sections of a planned program as circular tests see them, by name.
struct SectionsOfMotion {
  std::shared_ptr<const InterpretedProgram> program;
  std::shared_ptr<const PlannedMotion> motion;
  std::map<std::string, CircularSection> sections;
};

/// How far nominal points of probes are from the part.
struct PlanDistance {
  std::shared_ptr<const metrology::TriangleMesh> mesh;
  double distance = 0.0;  // m, the largest
};

/// The force of the cut along a program.
struct PlannedCutting {
  std::shared_ptr<const InterpretedProgram> program;
  engine::CuttingTable table;
  std::shared_ptr<const engine::EngagedTeeth> teeth;  // nullptr: the average force acts
  // nullptr: the depth of cut is the nominal one
  std::shared_ptr<const std::vector<engine::DisplacedCut>> displaced;
  // rapid moves through material, shanks in it; of every case that cuts it so
  std::vector<Fault> warnings;
};

/// One for all points of a sweep, for any number of threads. What is taken from it is what would
/// have been computed without, bit for bit: the keys hold every input of a result. Bounded: what
/// was not used for longest is forgotten.
struct PreparationCache {
  static constexpr std::size_t kMoves = 200'000;   // kept in each form: some 100 MB
  static constexpr std::size_t kRows = 1'000'000;  // of forces along programs: some 100 MB
  static constexpr std::size_t kModels = 1'000;
  static constexpr std::size_t kRadii = 20'000;
  static constexpr std::size_t kDrives = 500;

  PreparationCache();

  system::SharedTexts texts;  // of programs
  system::SharedCache<InterpretedProgram> programs;
  system::SharedCache<RewrittenProgram> rewritten;
  system::SharedCache<PlannedMotion> motions;
  system::SharedCache<SectionsOfMotion> circles;
  system::SharedCache<PlannedCutting> cuttings;
  system::SharedCache<plant::VolumetricModel> models;
  system::SharedCache<strategies::Strategy> strategies;
  system::SharedCache<double> spectral_radii;
  system::SharedCache<frequency::Curve> open_loops;  // of position loops
  system::SharedCache<servomill::strategies::LoopResponse> loop_responses;
  system::SharedCache<PlanDistance> plan_distances;
  plant::PreparedDrives drives{kDrives};
};

// Inputs as parts of keys, complete: a member that is added to one of these does not compile here.
void add(system::MemoKey& key, const plant::MachineChain& chain);
void add(system::MemoKey& key, const plant::ErrorModel& errors);
void add(system::MemoKey& key, const controllers::ProgramSetup& setup);
void add(system::MemoKey& key, const controllers::JointLimits& limits);
void add(system::MemoKey& key, const controllers::PathOptions& options);
void add(system::MemoKey& key, const JointLayout& layout);

/// Everything that the linear loops of one axis depend on (sim/frequency/stability.h).
/// @param linear  linearised(machine)
void add_linear_axis(system::MemoKey& key, const model::MachineSettings& linear, int joint);

}  // namespace servomill::sim::preparation
