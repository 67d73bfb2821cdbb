/// Positions of a program, as far as the program and the user have given them: a position that
/// nobody has named is unknown, per axis, and never 0.
#pragma once

#include <array>
#include <set>
#include <string>
#include <utility>

#include "controllers/gcode/interpreter.h"
#include "controllers/gcode/modal_state.h"
#include "sim/programs/axis_flags.h"

namespace servomill::sim::programs {

/// Inputs whose value the user has given.
struct GivenPlaces {
  std::array<AxisFlags, controllers::kWorkSystems> work_offset{};  // G54 ... G59.3
  std::set<int> tool_lengths;      // numbers of tools of known length
  bool has_stored_places = false;  // of G28 and G30: a parameter file
  bool has_machine = false;        // that turns the rotary axes of G53.1 and G43.5

  /// A block with G10: L2 gives work offsets, L20 by the position; L1 gives a tool.
  /// @param position_is_known  of the machine, before the block
  void learn_G10(const controllers::ExecutedBlock& block, const AxisFlags& position_is_known);
};

/// First number of the work systems G54.1 P0 ... next to 1 ... 9.
inline constexpr int kAdditionalSystem = 100;
/// "G54" ... "G59.3", "G54.1 P3".
std::string work_system_name(int system);

/// Known positions of one move.
struct MoveKnowledge {
  AxisWords begin_work = AxisWords::Zero();     // m, rad, in the coordinates of Move::end
  AxisWords begin_machine = AxisWords::Zero();  // m, rad
  AxisFlags begin_work_is_known{}, begin_machine_is_known{};
  AxisFlags end_work_is_known{}, end_machine_is_known{};
  bool is_place = false;   // of the machine (G53, G28, G30)
  bool is_tilted = false;  // in a tilted work plane
  int work_system = 1;     // 1 ... 9, G54 ... G59.3; kAdditionalSystem + P of G54.1 P
  AxisWords system_offset = AxisWords::Zero();  // of G54.1 P from the system of Move::end; m
  bool distance_is_known = false;               // on every axis that moves
};

/// Follows the lines of a program in order.
class KnownPositions {
 public:
  /// @param start  where the interpreter begins (6; machine coordinates), none of it known
  KnownPositions(GivenPlaces given, const AxisWords& start)
      : given_(std::move(given)), at_(start) {}

  /// Takes the words and offsets of the next line, before its moves.
  /// @pre block.state is set
  void begin_line(const controllers::ExecutedBlock& block);

  /// The next motion of that line.
  MoveKnowledge next(const Move& move, const controllers::ExecutedBlock& block, bool is_last);

 private:
  struct Offsets {
    int work_system = 1, tool = 0;
    AxisWords work = AxisWords::Zero(), shift = AxisWords::Zero(), tool_offset = AxisWords::Zero();
    bool is_rotated = false, controls_tip = false;
    int additional_system = 0;
    bool is_additional_known = true;
    bool has_tool_axis = false;  // G43.5: the tool axis is programmed, not the rotary axes
  };

  static Offsets offsets_of(const controllers::ExecutedBlock& block);
  void follow_shift(const controllers::ExecutedBlock& block);
  bool tool_is_known(const Offsets& now) const;
  bool offset_is_known(std::size_t i) const;
  void learn_place(const controllers::ExecutedBlock& block);
  void learn(const Move& move, const controllers::ExecutedBlock& block, bool is_last);

  GivenPlaces given_;
  Offsets offsets_;
  AxisFlags work_{}, machine_{};  // positions that are known
  AxisFlags shift_ = {true, true, true, true, true, true};
  AxisWords at_;  // machine coordinates, where known
  AxisWords at_begin_of_line_ = AxisWords::Zero();
  AxisFlags work_at_begin_of_line_{};
};

}  // namespace servomill::sim::programs
