/// State of a Heidenhain control while it runs a program, and one function for each kind of block.
/// A private part of the reader.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controllers/dialects/heidenhain_block.h"
#include "controllers/dialects/heidenhain_reader.h"

namespace servomill::controllers::heidenhain {

/// Modes and values in force. nullopt: unknown. Programs begin with everything unknown.
struct State {
  KnownPosition position;  // machine coordinates; m, rad

  // from coordinates of the program to those of the preset
  KnownPosition shift;                             // cycle 7, TRANS DATUM; m, rad
  std::optional<std::array<bool, 3>> is_mirrored;  // cycle 8
  std::optional<double> rotation;                  // cycle 10; rad
  std::optional<bool> is_scaled;                   // cycle 11
  std::array<bool, 3> is_axis_scaling_off{};       // cycle 26
  std::optional<bool> is_tilted;                   // cycle 19, PLANE
  std::optional<bool> is_tcp_control;              // M128
  bool has_tilt_angles_zero = false;               // the first of two blocks that end cycle 19
  int preset = 0;                                  // index into ControlSetup::work_offset

  std::optional<bool> is_radius_off;         // R0
  std::optional<bool> is_per_revolution;     // M136
  std::optional<bool> is_shorter_path;       // M126
  std::optional<bool> is_rotary_feed_in_mm;  // M116
  std::optional<double> feed;                // F, in the unit of the program
  bool has_block_feed = false;               // FT or FU was last
  std::optional<double> tool_call_feed;      // F of the last TOOL CALL

  std::optional<int> tool;       // nullopt: no TOOL CALL yet, the tool axis is unknown
  std::optional<double> length;  // m
  std::optional<double> speed;   // rad/s
  std::optional<int> direction;  // of the spindle: 1, -1, 0

  struct Pole {
    int normal = 2;
    std::array<double, 2> at{};  // first and second axis of the plane; m, machine coordinates
  };
  std::optional<Pole> pole;  // CC

  bool is_path_mode_known = false;
  std::optional<double> path_tolerance;

  // wrong rules only
  bool is_fmax_modal = false;
  bool is_m91_modal = false;
};

/// Words of a positioning block.
struct Positioning {
  struct Target {
    const HeidenhainWord* word = nullptr;
    double value = 0.0;  // m, rad
    bool is_increment = false;
  };
  std::array<Target, kAxisWords> target;
  bool has_target() const;

  enum class FeedWord { none, f, fmax, fauto, ft, fu };
  FeedWord feed_word = FeedWord::none;
  double feed = 0.0;                   // the number as written
  std::optional<double> radius_angle;  // PA or IPA; rad
  bool is_angle_increment = false;
  std::optional<int> direction;  // DR+ 1, DR- -1
  const HeidenhainWord* functions[2] = {nullptr, nullptr};
  int m[2] = {-1, -1};
  int functions_count = 0;
  bool is_retract = false;  // M140 MB MAX

  bool has_m(int number) const { return m[0] == number || m[1] == number; }
};

class Control {
 public:
  Control(const ControlSetup& setup, const HeidenhainSettings& settings,
          const HeidenhainRules& rules, bool is_inch);

  void run(const HeidenhainBlock& block);
  /// True after M2, M30.
  bool is_at_end() const { return is_at_end_; }
  /// @throws InputError if a cycle has begun and lacks blocks
  void finish(const Place& place) const;
  std::vector<MachineAction> take_actions() { return std::move(actions_); }

 private:
  using Words = std::vector<HeidenhainWord>;

  // heidenhain_control.cpp: words and coordinates
  Positioning read_words(const HeidenhainBlock& block, std::size_t first) const;
  void read_feed(const Words& words, std::size_t& at, Positioning& p) const;
  void read_function(const Words& words, std::size_t& at, Positioning& p) const;
  void read_coordinate(const HeidenhainWord& word, Positioning& p) const;
  double coordinate(const HeidenhainWord& word, int axis) const;
  double angle(const HeidenhainWord& word, double max) const;
  double unit() const;
  [[noreturn]] void fail(const Place& place, const std::string& message) const;

  // heidenhain_frame.cpp: from program to machine
  void require_frame(const Place& place, bool is_machine_position) const;
  double origin(int axis, const Place& place) const;
  double plane_rotation() const;
  bool is_mirrored(int axis) const;
  KnownPosition targets(const Positioning& p) const;
  KnownPosition rotated_targets(const Positioning& p, KnownPosition end) const;
  double machine_target(const Positioning::Target& target, int axis) const;
  double on_shorter_path(double from, double to, const Place& place) const;
  double increment_base(const Positioning::Target& target, int axis) const;
  void forget_positions();

  // heidenhain_motion.cpp
  void run_line(const HeidenhainBlock& block, std::size_t first);
  void move_straight(const Positioning& p);
  void retract(const Positioning& p);
  void run_probe(const HeidenhainBlock& block);
  void begin_probing(const Words& words);
  void probe(const Words& words);
  KnownPosition machine_targets(const Positioning& p) const;
  MachineAction new_motion(ActionKind kind) const;
  void move_to(const Positioning& p, const KnownPosition& end, MachineAction action);
  void set_feed(const Positioning& p, MachineAction& action, const KnownPosition& end);
  double feed_per_minute(double feed, const MachineAction& action, const KnownPosition& end);
  double effective_feed(const Positioning& p);
  void require_radius_off(const Positioning& p, const HeidenhainBlock& block);

  // heidenhain_circles.cpp
  void run_pole(const HeidenhainBlock& block);
  void run_circle(const HeidenhainBlock& block);
  void run_helix(const HeidenhainBlock& block);
  void move_on_arc(const Positioning& p, KnownPosition end, double sweep);
  std::array<double, 2> start_on_plane() const;
  void check_ends(const std::array<double, 2>& start, const std::array<double, 2>& end) const;
  double sweep_to(const std::array<double, 2>& start, const std::array<double, 2>& end,
                  int direction) const;
  double helix_sweep(const Positioning& p, double start_angle) const;
  void require_arc_frame(const Positioning& p) const;

  // heidenhain_functions.cpp: M
  void check_functions(const Positioning& p) const;
  void act_at_start(const Positioning& p);
  void act_at_end(const Positioning& p);
  void act(int m, const HeidenhainWord& word);
  void act_on_mode(int m, const HeidenhainWord& word);
  void stop(int number, const HeidenhainWord& word);
  void turn_spindle(int direction, const HeidenhainWord& word);
  void switch_coolant(bool is_on, const Place& place);
  bool is_at_block_start(int m) const;

  // heidenhain_tools.cpp
  void call_tool(const HeidenhainBlock& block);
  void define_tool(const HeidenhainBlock& block) const;
  void forget_tool_change();

  // heidenhain_cycles.cpp
  void define_cycle(const HeidenhainBlock& block);
  void begin_cycle(int cycle, const HeidenhainBlock& block);
  void continue_cycle(int cycle, int index, const HeidenhainBlock& block);
  void shift_datum(const Words& words, std::size_t first);
  void mirror(const Words& words);
  void rotate(const Words& words, const Place& place);
  void scale(const Words& words, const Place& place);
  void scale_axes(const Words& words);
  void tilt(const Words& words);
  void dwell(const Words& words, const Place& place);
  void set_tolerance(int index, const Words& words);
  void select_preset(const Words& words, const Place& place);
  void run_trans(const HeidenhainBlock& block);
  void run_plane(const HeidenhainBlock& block);
  void run_function(const HeidenhainBlock& block);
  void require_tilting(const Place& place, std::string_view what) const;

  MachineAction& emit(ActionKind kind, const Place& place);

  const ControlSetup& setup_;
  const HeidenhainSettings& settings_;
  const HeidenhainRules& rules_;
  bool is_inch_ = false;
  Place place_;  // of the block that runs
  State state_;
  std::vector<MachineAction> actions_;
  bool is_at_end_ = false;
  struct OpenProbe {
    int axis = 0, direction = 1;
  };
  std::optional<OpenProbe> open_probe_;  // TCH PROBE 0.0 has been read
  struct OpenCycle {
    int number = 0;
    int last = 0;  // index of its block read last
    Place place;
  };
  std::optional<OpenCycle> cycle_;
};

}  // namespace servomill::controllers::heidenhain
