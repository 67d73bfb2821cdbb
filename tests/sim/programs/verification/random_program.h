/// Random milling programs of every class, each from a seed.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace servomill::sim::programs {

/// Tools 1 and 2 (diameters 6 and 8 mm), all work systems; rotary axes A and C on request.
/// Interrupted programs consist of little else than optional blocks ('/'), stops, reference moves
/// and tool changes, each next to each.
class RandomProgram {
 public:
  struct Options {
    bool has_rotary_axes = false;
    bool is_interrupted = false;
    int steps = 18;
  };

  RandomProgram(std::uint32_t seed, const Options& options);
  const std::string& text() const { return text_; }

 private:
  using Step = void (RandomProgram::*)();

  // numbers
  double uniform(double low, double high);
  unsigned pick(unsigned n) { return static_cast<unsigned>(random_() % n); }
  bool one_in(unsigned n) { return pick(n) == 0; }
  std::string number(double mm_value) const;
  std::string word(char letter, double mm_value) const;
  std::string axis(int i, double to);
  void line(const std::string& text) { text_ += text + "\n"; }
  std::vector<Step> mixed_steps();
  std::vector<Step> interrupted_steps();

  // blocks
  void begin();
  void end();
  void approach();
  void change_tool();
  void rapid();
  void feed();
  void arc();
  void helix();
  void full_circle();
  void increments();
  void polar();
  void shift();
  void work_system();
  void coolant();
  void spindle();
  void dwell();
  void stop();
  void machine_position();
  void home();
  void cycle();
  void pocket();
  void loop();
  void expression();
  void rotate();
  void by_time();
  void per_revolution();
  void path_mode();
  void slash();
  void plane();

  // seldom ones (random_program_seldom.cpp)
  void arc_by_radius();
  void arc_about_absolute_centre();
  void contour();
  void subroutine();
  void branch();
  void repeat();
  void spindle_cycle();
  void repeated_cycle();
  void side_cycle();
  void other_home();
  void suspended_shift();
  void stored_offset();
  void other_length();
  void message();
  void preselect();
  void pallet();
  void switch_unit();
  void machine_feed();
  void saved_state();
  void spelling();
  void optional_cut();
  void rotate_far();
  void rotate_with_all();

  // interrupted programs (random_program_interrupted.cpp)
  void optional_block();
  void optional_reference();
  void bare_stop();
  void bare_reference();
  void reference_of_all();
  void bare_tool_change();
  void single_axis();
  void naming();

  std::mt19937 random_;
  Options options_;
  std::string text_;
  std::array<double, 3> at_{};  // mm, in the coordinates in force
  bool is_inch_ = false, is_incremental_ = false, runs_ = false, has_tool_ = false;
  int normal_ = 2, tool_ = 1, loops_ = 0;
};

}  // namespace servomill::sim::programs
