/// State of a Fanuc control that runs a program, as far as the program and the operator determine
/// it. Every mode may be unknown.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "controllers/dialects/fanuc_reader.h"
#include "controllers/dialects/fanuc_words.h"

namespace servomill::controllers {

/// Groups of which a block may hold one code each (B-63944EN, preparatory functions).
enum class FanucGroup : std::uint8_t {
  one_shot,      // 00: G4 G9 G28 G30 G31 G52 G53 G92.1
  motion,        // 01
  plane,         // 02
  distance,      // 03
  feed_mode,     // 05
  unit,          // 06
  cutter,        // 07
  length,        // 08
  cycle,         // 09
  return_level,  // 10
  scaling,       // 11
  spindle_mode,  // 13
  work_system,   // 14
  path,          // 15
  rotation,      // 16
  polar,         // 17
  mirror,        // 22
  contour,       // G5.1
  count
};

struct FanucModes {
  std::optional<int> motion;       // 0 ... 3
  std::optional<int> normal_axis;  // of the plane
  std::optional<bool> is_incremental;
  std::optional<FeedMode> feed_mode;
  std::optional<double> unit;      // m
  std::optional<int> work_system;  // 1: G54
  std::optional<PathMode> path;
  bool is_cutter_off = false, is_cycle_off = false, is_scaling_off = false, is_rotation_off = false,
       is_polar_off = false, is_surface_speed_off = false;
  /// By axis: G51.1, a shift by G52, a shift by G92
  std::array<bool, kAxisWords> is_mirror_off{}, is_local_off{}, is_shift_off{};
};

/// Tool length. The displayed mode and the vector that acts are kept apart: G53 cancels the latter
/// only.
struct FanucLength {
  enum class Mode : std::uint8_t { unknown, off, on };
  Mode mode = Mode::unknown;
  double sign = 1.0;           // G43 1, G44 -1
  std::optional<int> number;   // H
  std::optional<double> acts;  // m; nullopt: unknown
  bool is_suspended = false;   // cancelled by G53, G28 or G30 while G43 stays displayed
};

class FanucMachine {
 public:
  FanucMachine(const std::string& file, const ControlSetup& setup, const FanucSettings& settings,
               const FanucRules& rules);

  /// @return false at the end of the program
  bool run(const FanucBlock& block);
  std::vector<MachineAction> take_actions() { return std::move(actions_); }

 private:
  using Group = FanucGroup;
  struct Code {
    int tenths = -1;
    int column = 0;
  };

  [[noreturn]] void fail(int column, const std::string& message) const;
  [[noreturn]] void fail(const std::string& message) const { fail(1, message); }
  void take_absent_functions();

  // reading of the block
  void read_codes();
  void read_M(const FanucWord& word);
  bool has(Group group) const { return code(group) >= 0; }
  int code(Group group) const { return codes_[static_cast<std::size_t>(group)].tenths; }
  int column(Group group) const { return codes_[static_cast<std::size_t>(group)].column; }
  const FanucWord* word(char letter) const { return block_->find(letter); }
  bool names_axis() const;
  bool has_centre() const;
  double dimension(const FanucWord& word, bool is_linear) const;
  int integer(char letter, int max) const;

  // modes
  void set_modes();
  void set_unit();
  void set_cancels();
  void set_feed();
  void set_spindle();
  bool is_switch() const;
  void run_switch();
  void check_function(int tenths, int column) const;
  void check_words() const;
  void check_modes_of_motion() const;

  // tool length
  void set_length();
  void change_length(FanucLength::Mode mode, double sign, int number, int column);
  double length_of(int number, int column) const;
  double acting_length(int column);
  void suspend_length();

  // auxiliary functions
  void run_M();
  void change_tool();
  void run_spindle(int M);
  void run_coolant(int M);
  void forget_positions();

  // motion
  void run_dwell();
  void run_machine_position();
  void run_reference_return();
  void run_skip();
  void run_motion();
  MachineAction action(ActionKind kind) const;
  void move_to(MachineAction action);
  double target(int axis, const FanucWord& word);
  double within_a_turn(int axis, double machine, double offset, int column) const;
  void set_target(MachineAction& out);
  void set_arc(MachineAction& out) const;
  void set_action_feed(MachineAction& out) const;
  double required(int axis, int column, const char* reason) const;

  const std::string& file_;
  const ControlSetup& setup_;
  const FanucSettings& settings_;
  const FanucRules& rules_;
  std::vector<MachineAction> actions_;

  const FanucBlock* block_ = nullptr;
  std::array<Code, static_cast<std::size_t>(Group::count)> codes_{};
  Code M_;

  FanucModes modes_;
  FanucLength length_;
  KnownPosition position_;  // machine coordinates
  std::optional<double> feed_;
  std::optional<double> speed_;   // rad/s
  std::optional<int> direction_;  // of the spindle
  int coolant_ = 0;               // bits that the program has set
  std::optional<int> selected_, tool_;
  bool is_modal_machine_ = false;     // a wrong rule keeps G53
  bool is_modal_exact_stop_ = false;  // a wrong rule keeps G9
};

}  // namespace servomill::controllers
