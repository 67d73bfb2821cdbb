/// Walks along the moves of a program and corrects one after the other: what the writers of all
/// dialects share.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/gcode/interpreter.h"
#include "sim/programs/axis_flags.h"
#include "sim/programs/compensate/corrected_path.h"
#include "sim/programs/compensate/path_record.h"
#include "sim/programs/compensate/summary.h"

namespace servomill::sim::programs {

/// A move of the program and what became of it.
struct Step {
  const Move* move = nullptr;
  bool is_place = false;      // of the machine
  bool is_corrected = false;  // otherwise it goes where it went
  AxisFlags is_commanded{};   // the move names these axes, or changes their machine coordinates
  AxisFlags was_known{};      // positions that were known before it
  ProgrammedMove programmed;
  AxisWords begin = AxisWords::Zero();  // work coordinates, where the output stands
  std::vector<FittedBlock> blocks;      // at least one
};

class PointUncertainty;
class SmoothedFeeds;

struct WalkOptions {
  FitOptions fit;
  bool corrects_rapids = false;
  Joints lower = Joints::Zero(), upper = Joints::Zero();  // travel; m, rad
  AxisWords start = AxisWords::Zero();                    // machine coordinates; m, rad
  AxisFlags is_start_known{};
  std::string file;  // of the program, for messages
  /// The program is written for a control whose tool change may move any axis, in blocks that all
  /// name absolute positions.
  bool is_for_other_control = false;
};

/// Places of the machine (G53, G28, G30) stay as they are: what stands there is no workpiece.
/// Rapids before every axis of the machine has a known position are not corrected; feeds are
/// refused there. A rapid moves no axis that it does not move in the original: where the correction
/// of another axis changes, that waits for the next move of that axis, or for the next feed.
class ProgramCorrector {
 public:
  /// @param tools, correction, summary  must outlive this
  /// @param record, feeds, uncertainty  receive the path, or nullptr
  ProgramCorrector(const WalkOptions& options, const controllers::ToolTable& tools,
                   Correction& correction, Summary& summary, PathRecord* record = nullptr,
                   SmoothedFeeds* feeds = nullptr, PointUncertainty* uncertainty = nullptr);

  /// Corrects the next motion. The writer then tells where its text leaves the machine.
  /// @throws InputError for a move that cannot be corrected
  Step next(const Move& move, const controllers::ExecutedBlock& block);
  /// @param is_place  of the machine, not to be corrected
  Step next(const Move& move, const controllers::ExecutedBlock& block, bool is_place);
  /// The same step in straight blocks.
  Step without_arcs(Step step);
  /// @param machine  (6; m, rad), as printed
  void arrive(const Step& step, const AxisWords& machine);
  /// From here on no position is known: the tool has been changed, or the operator may have jogged.
  void forget_positions();
  /// Programmed place of an axis, whatever tool changes and stops have made of it; machine
  /// coordinate. nullopt: nothing has named it
  std::optional<double> programmed(Axis axis) const;
  /// The output brings an axis back there.
  /// @param machine  as printed
  void restate(Axis axis, double machine);
  /// Z ends where LinuxCNC has stored a place, which is another place on other controls.
  void arrive_elsewhere(const Move& move);

  /// Position of the output (6; machine coordinates).
  const AxisWords& out() const { return out_; }
  bool has(Axis axis) const { return correction_.layout().joint_of(axis).has_value(); }
  bool is_known(Axis axis) const { return known_[static_cast<std::size_t>(index_of(axis))]; }

 private:
  AxisFlags learn(const Move& move, const controllers::ExecutedBlock& block);
  void refuse_unknown_begin(const Move& move, const controllers::ExecutedBlock& block,
                            const AxisFlags& commanded) const;
  void refuse_unknown_height(const controllers::ExecutedBlock& block,
                             const AxisFlags& was_known) const;
  void refuse(const Move& move, const AxisFlags& was_known) const;
  void fit_feed(Step& step, const FitOptions& options);
  void fit_piece(Step& step, double t_begin, double t_end, const FitOptions& options);
  void turn_directions(const AxisWords& way, const AxisFlags& was_known);
  void note_reversals(const Step& step, const Directions& before);
  void hold_axes(Step& step) const;
  AxisWords uncorrected_end(const Step& step) const;
  void choose_tool(const controllers::ModalState& state);
  bool knows_all() const;
  void know_missing_axes();
  void sample_residual(const Step& step);
  void warn_of_travel(const Step& step);
  void count(const Step& step);

  const WalkOptions& options_;
  const controllers::ToolTable& tools_;
  Correction& correction_;
  Summary& summary_;
  PathRecord* record_;
  SmoothedFeeds* feeds_;
  PointUncertainty* uncertainty_;
  AxisWords programmed_, out_;   // machine coordinates
  AxisFlags known_{}, named_{};  // named_: since the start, others since positions were lost
  Directions directions_{};      // of travel, as programmed
};

/// Remedy for programs that move the tip and not the axes.
inline constexpr std::string_view kWriteAxes =
    "have the CAM system, or servomill post, output axis positions";

/// True if O-words skip the line.
bool is_skipped(const controllers::ExecutedBlock& block);

/// True if the block moves to a machine position.
bool is_place_of_machine(const controllers::ExecutedBlock& block);

}  // namespace servomill::sim::programs
