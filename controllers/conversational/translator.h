/// Translates a conversational program, block by block, to lines of G-code.
///
/// Units: values stay in mm and degrees, as programmed (a program in INCH is converted on reading).
/// Positions are given in the coordinate system in which the lines move: the work coordinate
/// system, or that of the tilted plane under PLANE.
///
/// Rules that hold throughout, with their sources ([530] is the user's manual of the iTNC 530,
/// 60642x-04; [640] that of the TNC 640, 34059x-05; [407] TNC 407/425/426, 280 580; M from memory):
///  (1) L, C, ... start at the position programmed last; increments count from it. [407] p. 1-13
///  (2) FMAX acts in its block only, F until the next F or TOOL CALL with F. M
///  (3) M3, M4, M8, M13, M14, M91, M126 ... M129, M136, M137 act at the start of a block, M0, M1,
///      M2, M5, M6, M9, M30, M99 at its end. M
///  (4) TOOL CALL activates the tool length at once: all positions are those of the tip.
///      [407] p. 4-13
///  (5) A parameter, position or mode that has not been set is unknown; a block that depends on it
///      is refused.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "controllers/conversational/frame.h"
#include "controllers/conversational/program_file.h"
#include "controllers/conversational/q_parameters.h"
#include "controllers/conversational/words.h"
#include "controllers/gcode/program_setup.h"
#include "controllers/translation/block_run.h"
#include "controllers/translation/contour_path.h"
#include "controllers/translation/gcode_lines.h"

namespace servomill::controllers::conversational {

using translation::arc_of_radius;
using translation::BlockRun;
using translation::ContourPath;
using translation::Element;
using translation::Feed;
using translation::GcodeLine;
using translation::GcodeLines;
using translation::Motion;
using translation::plane_axes;
using translation::Run;
using translation::sweep_between;
using translation::tangential_arc;
using translation::Values;
using translation::word;

/// Words of a positioning block.
struct Positioning {
  struct Target {
    Operand value;
    bool is_increment = false;
  };
  std::array<std::optional<Target>, kAxisWords> target;
  std::optional<Target> polar_radius, polar_angle;  // PR, PA
  std::optional<Feed> feed;                         // of this block; FMAX: rapid
  std::optional<int> side;                          // R0, RL, RR
  std::optional<int> direction;                     // DR+, DR-
  std::vector<std::pair<int, Place>> functions;     // M
  std::optional<double> retract;                    // M140 MB, mm
  bool is_retract_to_limit = false;                 // M140 MB MAX

  bool has_target() const;
  bool has(int function) const;
};

/// Drilling cycle in force, by number; its values are Q parameters or, in the old form, `values`.
struct Cycle {
  int number = 0;
  std::vector<double> values;   // of CYCL DEF 1.1, 1.2, ...
  std::size_t value_count = 0;  // that the old form needs
  std::string why_unknown;      // in surveys: the reason why its moves are unknown
};

class Translator {
 public:
  Translator(std::string text, std::string file, const ProgramSetup& setup);

  /// The next line; nullopt after the end of the program.
  /// @throws InputError at a block with an error, after the lines of all blocks before it
  std::optional<GcodeLine> next();
  /// Blocks read since the last call that other controls may interpret differently.
  std::vector<Fault> take_warnings() { return std::exchange(warnings_, {}); }
  /// File of the line returned last.
  const std::string& file() const { return current_file_; }

 private:
  // translator.cpp: blocks
  void run_block();
  void begin_program();
  void end_of_file(const Place& place);
  void execute(const HeidenhainBlock& block);
  bool execute_other(const HeidenhainBlock& block);
  void refuse_unknown(const HeidenhainBlock& block) const;
  [[noreturn]] void fail(std::string message) const {
    throw InputError(place_, std::move(message));
  }
  [[noreturn]] static void fail(const Place& place, std::string message) {
    throw InputError(place, std::move(message));
  }
  void warn_once(const std::string& key, std::string message);
  void note(std::string text) { path_.note({std::move(text), place_}); }
  double value(const Operand& operand) const { return parameters_.value(operand); }
  double unit() const { return is_inch_ ? 25.4 : 1.0; }  // mm
  double length(const Operand& operand) const { return value(operand) * unit(); }
  int whole(double value, int most, const Place& place, std::string_view what) const;

  // flow.cpp: labels, jumps, parameters
  void call(const HeidenhainBlock& block);
  void call_label(const std::string& label, std::span<const HeidenhainWord> rest);
  void call_program(std::span<const HeidenhainWord> words);
  std::size_t file_of_program(ProgramText& text, const std::string& name, const Place& place);
  void label(const HeidenhainBlock& block);
  void go_to(const std::string& label);
  bool run_function(const HeidenhainBlock& block);
  bool read_of_control(int number, std::span<const HeidenhainWord> rest);
  void assign(const QName& name, double value);
  void assign_words(Words& words);
  std::optional<double> feed_of_name(const std::string& text, const Place& place) const;
  void refresh_system_parameters();
  ProgramFile& program() { return *files_[file_]; }

  // positioning.cpp: words and coordinates
  Positioning read_positioning(Words& words, std::string_view block);
  bool read_word(Words& words, Positioning& p, std::string_view block);
  bool read_target(Words& words, Positioning& p);
  bool read_side(Words& words, Positioning& p);
  bool read_feed(Words& words, Positioning& p);
  bool read_function(Words& words, Positioning& p);
  Feed modal_feed();
  void forget_feeds(const std::string& why);
  Feed feed_of(const Positioning& p);
  double feed_per_minute(const Operand& operand) const;
  bool counts_from_unknown(const Positioning& p) const;
  Values ends(const Positioning& p, bool& is_incremental);
  void ends_in_plane(const Positioning& p, Values& end, bool& is_incremental);
  double rotary_end(std::size_t axis, double program, const Place& place);
  std::optional<Point> work_point(int normal) const;
  std::optional<Point> program_point(int normal) const;
  void set_program_point(Positioning& p, int normal, const Point& point) const;
  static Positioning::Target target_of(const Operand& operand, bool is_increment);

  // motion.cpp: lines
  void line(const HeidenhainBlock& block);
  void polar_line(const HeidenhainBlock& block);
  void move_straight(const Positioning& p);
  void move_to_machine(const Positioning& p);
  void move_to_reference(const Positioning& p);
  void retract(const Positioning& p);
  void retract_to_limit(const Positioning& p);
  Motion motion_of(const Positioning& p);
  void add(Motion motion);
  void end_compensation(bool names_both);
  void store_end(const Motion& motion);
  void begin_functions(const Positioning& p);
  void end_functions(const Positioning& p);
  void set_side(const Positioning& p);
  std::optional<Point> polar_point(const Positioning& p, int normal) const;
  void round_or_chamfer(const HeidenhainBlock& block, bool is_rounding);
  double tool_radius(const Place& place) const;
  bool survey_knows_no_radius();

  // circles.cpp
  void pole(const HeidenhainBlock& block);
  void circle(const HeidenhainBlock& block, bool is_polar);
  void helix(const Positioning& p, int normal);
  void circle_of_radius(const HeidenhainBlock& block);
  void tangential_circle(const HeidenhainBlock& block, bool is_polar);
  void add_arc(const Positioning& p, int normal, Element program_arc);
  void require_arc(const Positioning& p) const;

  // approach.cpp
  void approach(const HeidenhainBlock& block);
  void depart(const HeidenhainBlock& block);
  std::pair<Run, Positioning> read_run(const HeidenhainBlock& block, Run::Kind kind,
                                       std::string_view name);

  // functions.cpp: M
  void start_function(int m, const Place& place);
  void end_function(int m, const Place& place);
  void stop(int m);

  // tools.cpp
  void call_tool(const HeidenhainBlock& block);
  void define_tool(const HeidenhainBlock& block);
  int named_tool(Words& words);
  void change_tool(int number);
  void take_tools_of_program();

  // transformations.cpp: cycles 7, 8, 10, 11, 19, 247, M128
  void datum_shift(const Cycle& cycle, std::span<const HeidenhainWord> words);
  void trans_datum(Words& words);
  void mirror(std::span<const HeidenhainWord> words);
  void rotate(Words& words);
  void scale(Words& words);
  void scale_axes(Words& words);
  void working_plane(Words& words);
  void require_rotary_zero(const Operand& zero);
  void set_preset(double number);
  void set_frame(const Frame& frame);
  void tcp_control(bool is_on);
  void forget_linear_positions();
  void require_no_compensation(std::string_view what);

  // tilted_plane.cpp
  void plane(const HeidenhainBlock& block);
  void function_block(Words& words);
  int plane_options(Words& words);
  void retract_before_plane(Words& words, const std::string& behaviour);
  bool can_leave_plane_unknown() const;
  void survey_plane(const std::string& what);
  void enter_plane(const std::array<double, 3>& angles);
  void tilt(const std::array<double, 3>& angles, const std::string& behaviour, Words& words);
  std::string turn_of_plane(const Eigen::Matrix3d& R, int seq);
  bool turn_to_plane(const Positioning& p);
  void reset_plane(const std::string& behaviour);
  bool rotary_axes_are_at_zero() const;

  // patterns.cpp: PATTERN DEF and CYCL CALL PAT
  struct PatternPoint {
    Point at;
    double surface = 0.0;  // added to Q203, mm
  };
  void define_pattern(const HeidenhainBlock& block);
  void add_pattern(const std::string& kind, Words& words);
  void add_circle(Words& words, const Point& centre, double surface, bool is_full);
  void call_pattern(Words& words);
  double pattern_number(Words& words, std::string_view name, double unit,
                        std::optional<double> otherwise = {}) const;

  // cycles.cpp
  void define_cycle(const HeidenhainBlock& block);
  void survey_probe(const HeidenhainBlock& block);
  void forget_probed(std::span<const HeidenhainWord> words);
  void define_old_cycle(int number, int step, const HeidenhainBlock& block);
  void survey_cycle(int number, std::string_view why, bool is_called,
                    std::span<const HeidenhainWord> words);
  void call_cycle(const HeidenhainBlock& block);
  void drill();
  void run_drilling_cycle();
  void leave_moves_out(const std::string& whose, std::string line);
  void leave_positions_unknown(const std::string& whose, const std::string& why);
  void drill_old();
  void tap_old(bool is_rigid);
  void drill_200();
  void ream_201();
  void bore_202();
  void drill_203();
  void peck_205();
  void tap(bool is_rigid);
  void tap_209();
  void centre_240();

  // hole_patterns.cpp: cycles 220 and 221
  void call_hole_pattern(bool is_circle);
  std::vector<Point> points_on_circle() const;
  std::vector<Point> points_on_lines() const;
  void drill_points(const std::vector<Point>& points);
  double q(int number) const;
  struct Hole;
  Hole hole() const;
  void cycle_move(const Feed& feed, double Z);
  void leave_hole(const Hole& hole);
  void cycle_dwell(double seconds);
  Feed cycle_feed(double per_minute) const;

  std::vector<std::unique_ptr<ProgramFile>> files_;
  std::size_t file_ = 0;
  std::string current_file_;
  struct Return {
    std::size_t file = 0;
    BlockMark mark;
    bool is_program = false;
    std::string name;
  };
  std::vector<Return> returns_;
  std::map<std::pair<std::size_t, std::size_t>, long> repeats_;  // by file and position of CALL LBL
  BlockMark block_mark_;                                         // of the block that runs

  ProgramSetup setup_;
  GcodeLines lines_;
  ContourPath path_{lines_, {"RL and RR", "R0", "FMAX", "F", "RND R", "CHF "}};
  BlockRun run_{lines_, path_, setup_.most_jumps};
  QParameters parameters_;
  std::vector<Fault> warnings_;
  std::set<std::string> warned_;
  Place place_;  // of the block
  bool has_begun_ = false, is_skipping_ = false;
  bool is_inch_ = false;

  Values work_;  // position programmed last
  Frame frame_;
  bool is_beside_ = false;     // still offset: R0 was in a block without X and Y
  std::optional<Point> pole_;  // in program coordinates
  int pole_normal_ = 2;
  std::optional<Element> last_element_;  // in program coordinates, for CT
  int last_normal_ = 2;
  std::optional<double> feed_, tool_call_feed_;  // mm/min
  bool was_rapid_ = false;
  bool is_rotary_zero_left_ = false;  // by M91 or PLANE, to positions that `work_` does not hold
  bool is_tool_in_plane_ = true;      // the rotary axes have turned to `plane_`
  bool are_feeds_unknown_ = false;    // in surveys: a function changes them
  int side_ = 0;
  std::optional<bool> is_shorter_path_;  // M126, M127
  std::array<double, kAxisWords> revolutions_{};

  std::map<std::string, int> tool_names_;  // of TOOL CALL "NAME", with the number made up for each
  std::set<int> tools_without_radius_;     // of TOOL DEF with L alone
  int tool_ = 0;
  bool has_tool_call_ = false;
  double delta_length_ = 0.0, delta_radius_ = 0.0;  // of TOOL CALL, mm
  std::optional<double> speed_;                     // rpm
  int spindle_ = 0;
  int preset_ = 1;
  bool names_preset_ = false, names_manual_datum_ = false;  // by cycle 247
  bool is_tcp_ = false;
  std::optional<std::array<double, 3>> plane_;  // SPA, SPB, SPC
  Frame frame_before_plane_;
  std::string plane_line_;  // that tilted it
  std::string plane_turn_;  // of SEQ: takes the rotary axes there, in machine coordinates
  std::optional<Cycle> cycle_;
  bool is_modal_call_ = false;         // M89
  std::vector<PatternPoint> pattern_;  // of PATTERN DEF, in coordinates of the program
  int open_cycle_ = -1;                // of the old form, until its blocks are complete
};

}  // namespace servomill::controllers::conversational
