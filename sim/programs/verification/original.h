/// Actions of the original program: the reference for a written program.
#pragma once

#include <array>
#include <deque>
#include <optional>
#include <string>

#include "controllers/dialects/machine_action.h"
#include "controllers/gcode/interpreter.h"
#include "controllers/gcode/program_setup.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/move.h"

namespace servomill::sim::programs {

using AxisFlags6 = std::array<bool, kAxisWords>;

/// State of spindle and coolant, as far as the program has set it.
struct AuxiliaryState {
  std::optional<int> direction;  // of the spindle
  double speed = 0.0;            // rad/s
  std::optional<int> coolant;    // bits of controllers::kMist, kFlood
  bool operator==(const AuxiliaryState&) const = default;
};

/// A motion, dwell, tool change, stop or end of the program.
struct OriginalAction {
  Move move;
  bool is_machine_position = false;    // G53, G28, G30: not corrected
  bool is_reference_return = false;    // G28, G30
  bool is_to_reference = false;        // the last move of those
  AxisFlags6 is_named{};               // by its block
  AxisFlags6 is_known{}, was_known{};  // positions named so far, and before this action
  /// Positions named before this action, whatever tool changes and stops have made of them.
  AxisFlags6 was_ever_known{};
  AxisWords begin = AxisWords::Zero();             // machine coordinates; m, rad
  Eigen::Vector3d p_ST = Eigen::Vector3d::Zero();  // tip of the tool that works (m)
  AuxiliaryState auxiliary;                        // in force
  bool has_path_mode = false;                      // the program has chosen one
  bool is_of_cycle = false;  // of a canned cycle, which stops at corners or does not

  AxisFlags6 changed() const;
  /// A move of Z to a position of the workpiece.
  bool moves_tip() const;
};

/// The action of a move that is neither spindle nor coolant nor message.
controllers::ActionKind kind_of(MoveKind kind);

struct OriginalOptions {
  AxisFlags6 is_start_known{};
  JointLayout layout;
  /// True if tool changes and stops leave positions unknown (all controls but LinuxCNC).
  bool forgets_positions = false;
};

/// Runs the program anew, with an interpreter of its own.
class Original {
 public:
  Original(controllers::ProgramText text, const controllers::ProgramSetup& setup,
           const OriginalOptions& options);

  /// The next action, or nullptr behind the end. It stays valid until the next call.
  const OriginalAction* next();
  const std::string& line_text() const { return text_; }  // of the block run last
  int line() const { return line_; }
  /// True if the operator's switch decides about a block that has run.
  bool has_optional_blocks() const { return has_optional_blocks_; }

 private:
  void take(const controllers::ExecutedBlock& block);
  void take_motion(const Move& move, const controllers::ExecutedBlock& block, bool is_last);
  void take_other(const Move& move);
  void learn(OriginalAction& action, const controllers::ExecutedBlock& block);

  controllers::ProgramSetup setup_;
  OriginalOptions options_;
  controllers::Interpreter interpreter_;
  std::deque<OriginalAction> waiting_;
  OriginalAction current_;
  AxisWords position_;
  AxisFlags6 known_{}, ever_known_{};
  AuxiliaryState auxiliary_;
  bool has_path_mode_ = false, has_optional_blocks_ = false;
  std::string text_;
  int line_ = 0;
};

}  // namespace servomill::sim::programs
