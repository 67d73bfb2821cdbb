/// One block on its way through the rules of a control. Private to block_reading.cpp and the files
/// of the rules.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controllers/gcode/modal_groups.h"
#include "controllers/gcode/readers/block_reading.h"

namespace servomill::controllers {

struct HaasCircles;
struct PlaneCorner;

class ReadingStep {
 public:
  ReadingStep(BlockReading& reading, BlockWords& block_words, const ModalState& modal_state,
              const std::string& file, const Block& block)
      : words(block_words),
        state(modal_state),
        memory(reading.memory_),
        options(reading.options_),
        file_(file),
        block_(block),
        reading_(reading) {}

  /// All rules, one after the other.
  void run();

  BlockWords& words;
  const ModalState& state;
  ReadingMemory& memory;
  const ReadingOptions& options;
  std::vector<std::string> before, behind;  // lines around that of `words`

 private:
  void foreign_codes();
  void curve_codes();
  // words_reading.cpp
  void decimal_points();
  void decimal_point(BlockWord& word) const;
  bool is_polar_angle(char letter) const;
  void unit_codes();
  void feed_beside_unit();
  void repeated_groups();
  void machine_functions();
  void leave_out(ReaderRule rule, BlockWord& word);
  void refuse_function(const BlockWord& word) const;
  void override_code(BlockWord& word);
  void coolant_codes();
  void exact_stop();
  void spindle_power();
  bool has_words_of_P() const;
  void idle_codes();
  void refused_codes();
  void dwell();
  void dwell_of_other_controls();
  // home_reading.cpp
  void home();
  bool distances_of_home(const BlockWord& word);
  void home_under_tip_control();
  void homing_cycle();
  void machine_coordinates();
  bool has_work_offset() const;
  void presets();
  void inputs();
  void system_input(int column);
  // tool_reading.cpp
  void length_offset();
  void diameter_offset();
  void idle_beam();
  void laser_power();
  // subprogram_reading.cpp
  void subprograms();
  void drop_words_of_earlier_turn();
  void call_behind_words();
  void local_call();
  // motion_reading.cpp
  void arc_without_axes();
  void motion_in_force();
  void rapid_at_start(int column);
  void arc_centre();
  void radius_of_line();
  void cancel_cycle(bool has_words);
  void leave_cycle();
  void refuse_arc_behind_cycle(int motion, int column) const;
  void feed();
  // haas_reading.cpp
  void circular_pocket();
  void circular_pocket_of_mach(BlockWord& code, bool is_clockwise);
  void circular_pocket_of_haas(BlockWord& code, bool is_clockwise);
  void circles_of_haas(const HaasCircles& circles, bool is_clockwise);
  void mirror_of_haas();
  void tip_control_of_haas();
  // corner_reading.cpp
  void shift_behind_corner();
  void corner();
  std::string no_line_for(std::string_view corner, int motion) const;
  void write_corner(const PlaneCorner& lines, const BlockWord& size);
  // cycle_reading.cpp
  void cycles();
  void begin_cycle(int code);
  void cycle_words(int code);
  void cycle_levels(int code);
  double initial_level() const;
  void cycle_dwell(int code);
  void cycle_count(int code);
  void cycle_without_hole(int code);
  void fine_boring();
  void retract_mode();
  void approach_from_below();
  void tapping(int code);
  void leave_at_feed(int code);
  char normal_letter() const;
  // frame_reading.cpp
  void frame_codes();
  void frames();
  void polar_mode();
  void polar_origin(int column);
  void scaling();
  void scale_inputs(BlockWord& code);
  void mirror();
  void rotation();
  void centre_of_mach(const BlockWord& code);
  void additional_offset();
  void refuse_unknown_system(const std::string& name, int P);
  bool is_additional_G54() const;
  void refuse_frame_change(const BlockWord& code) const;
  void polar_words();
  void refuse_lone_axis(const Eigen::Vector3d& now);
  void frame_words();
  void frame_centre();

  /// Notes a rule that the block needs. False if the reader lacks it.
  bool apply(ReaderRule rule, int column, std::string detail = {});
  /// The same; a reader that lacks the rule refuses the word.
  void need(ReaderRule rule, int column, std::string detail = {});
  /// Which of two readings counts: that of the reader, or of all controls that would read the
  /// program.
  /// @throws InputError if that is neither
  int choose(WordDifference difference, int column);
  std::optional<int> chosen_reading(WordDifference difference, int column);
  /// P without a decimal point, in seconds; of an unknown unit 0 and noted.
  double dwell_of(WordDifference difference, const BlockWord& P);
  /// Ends with what servomill cannot read; a trial is undetermined.
  [[noreturn]] void fail(int column, std::string message) const;
  /// Ends with what the control does not read.
  [[noreturn]] void refuse(int column, std::string message) const;

  /// Ten times the motion code of the block, or -1.
  int motion_code() const;
  /// ... or that in force.
  int motion_in_block() const;
  /// G4, G10, G28, G92, ...: takes axis words, or none are of a motion.
  bool has_axis_taker() const;
  bool has_unknown_code() const;
  int normal_axis() const;
  bool is_incremental() const;
  double unit() const;

  const std::string& file_;
  const Block& block_;
  BlockReading& reading_;
};

}  // namespace servomill::controllers
