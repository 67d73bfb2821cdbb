/// Walks along the moves of a program and corrects one after the other: what the writers of all
/// dialects share.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "controllers/gcode/interpreter.h"
#include "sim/compensate/corrected_path.h"
#include "sim/compensate/path_record.h"
#include "sim/compensate/summary.h"

namespace servomill::sim {

/// A move of the program and what became of it.
struct Step {
  const Move* move = nullptr;
  bool is_corrected = false;  // otherwise it goes where it went
  ProgrammedMove programmed;
  AxisWords begin = AxisWords::Zero();  // work coordinates, where the output stands
  std::vector<FittedBlock> blocks;      // at least one
};

struct WalkOptions {
  FitOptions fit;
  bool splits_rapids = false;
  Joints lower = Joints::Zero(), upper = Joints::Zero();  // travel; m, rad
  AxisWords start = AxisWords::Zero();                    // machine coordinates; m, rad
  std::array<bool, kAxisWords> is_start_known{};
  std::string file;  // of the program, for messages
};

/// Places of the machine (G53, G28, G30) stay as they are: what stands there is no workpiece.
/// Rapids before every axis of the machine has a known position are not corrected; feeds are
/// refused there.
class Walk {
 public:
  /// @param tools, correction, summary  must outlive this
  /// @param record  receives the path, or nullptr
  Walk(const WalkOptions& options, const controllers::ToolTable& tools, Correction& correction,
       Summary& summary, PathRecord* record = nullptr);

  /// Corrects the next motion. The writer then tells where its text leaves the machine.
  /// @throws InputError for a move that cannot be corrected
  Step next(const Move& move, const controllers::ExecutedBlock& block);
  /// @param machine  (6; m, rad), as printed
  void arrive(const Step& step, const AxisWords& machine);

  /// Where the output stands (6; machine coordinates).
  const AxisWords& out() const { return out_; }
  bool is_known(Axis axis) const { return known_[static_cast<std::size_t>(index_of(axis))]; }

 private:
  void learn(const Move& move, const controllers::ExecutedBlock& block);
  void refuse(const Move& move) const;
  void choose_tool(const controllers::ModalState& state);
  bool knows_all() const;
  void look_for_leftover(const Step& step);
  void warn_of_travel(const Step& step);
  void count(const Step& step);

  const WalkOptions& options_;
  const controllers::ToolTable& tools_;
  Correction& correction_;
  Summary& summary_;
  PathRecord* record_;
  AxisWords programmed_, out_;  // machine coordinates
  std::array<bool, kAxisWords> known_{};
};

/// Whether O-words skip the line.
bool is_skipped(const controllers::ExecutedBlock& block);

/// Whether the block goes to a place of the machine.
bool is_place_of_machine(const controllers::ExecutedBlock& block);

}  // namespace servomill::sim
