/// Translates a Siemens program, block by block, to lines of G-code.
///
/// Units: values stay in mm and degrees (inches are converted on reading). Positions are given in
/// the work coordinate system, in which the lines move.
///
/// Rules that hold throughout, with their sources ([F] is 840D sl, Fundamentals, 6FC5398-1BP40; [J]
/// Job Planning, 6FC5398-2BP40; [C] Cycles, 6FC5398-3BP40: their sections are named from memory;
/// M: no section is known). The verification reader (dialects/siemens_reader.h), which cites pages
/// that were seen, makes the same motions of its worked examples (two_siemens_readers_test).
///  (1) A word acts in the whole block, wherever it stands. [F] "Block rules"
///  (2) G functions of one group cancel each other and stay in force, but for G4, G9, G53, G63,
///      G110 ... G112, G153, SUPA. [F] "G commands"
///  (3) M3, M4, M7 and M8 act before the motion of their block, M5 and M9 after it, M0, M1, M2,
///      M17 and M30 last. M (MD22254: by the machine)
///  (4) A change of the frame or of the length moves nothing; axes that a block does not name stay.
///      [F] "Frames"
///  (5) A parameter, position or mode that has not been set is unknown; a block that depends on it
///      is refused.
#pragma once

#include <array>
#include <functional>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "controllers/gcode/program_setup.h"
#include "controllers/siemens/block.h"
#include "controllers/siemens/codes.h"
#include "controllers/siemens/frame.h"
#include "controllers/siemens/program_file.h"
#include "controllers/siemens/variables.h"
#include "controllers/translation/block_run.h"
#include "controllers/translation/contour_path.h"
#include "controllers/translation/gcode_lines.h"

namespace servomill::controllers::siemens {

using translation::BlockRun;
using translation::ContourPath;
using translation::Element;
using translation::Feed;
using translation::GcodeLine;
using translation::GcodeLines;
using translation::Motion;
using translation::plane_axes;
using translation::Values;
using translation::word;

enum class MotionCode {
  rapid,
  line,
  clockwise,
  counterclockwise,
  through_point,
  tangential,
  thread
};

/// Modal functions, which a subprogram with SAVE restores.
struct Modes {
  MotionCode motion = MotionCode::line;
  int normal = 2;               // of the working plane: 0 G19, 1 G18, 2 G17
  bool is_incremental = false;  // G91
  bool is_inch = false;         // G70, G700
  bool is_feed_inch = false;    // G700
  bool is_full_units = false;   // G700, G710: of F, too
  int feed_code = 94;
  int side = 0;                 // G41: 1, G42: -1
  bool is_contour_feed = true;  // CFC
  bool stops_exactly = false;   // G60
  int offset = 0;               // 0: the one in force at the start; 1 is G54; -1: G500
  Frame frame;
  bool operator==(const Modes&) const = default;
};

class Translator {
 public:
  Translator(std::string text, std::string file, const ProgramSetup& setup);

  /// The next line; nullopt after the end of the program.
  /// @throws InputError at a block with an error, after the lines of all blocks before it
  std::optional<GcodeLine> next();
  /// Blocks read since the last call that other controls may interpret differently.
  std::vector<Fault> take_warnings() { return std::exchange(warnings_, {}); }

 private:
  // translator.cpp: blocks
  void run_block();
  void begin_program();
  void execute(const Line& line);
  void execute_block(const Block& block);
  void sort_codes(const Block& block);
  void end_program(int m);
  [[noreturn]] void fail(std::string message) const {
    throw InputError(place_, std::move(message));
  }
  [[noreturn]] static void fail(const Place& place, std::string message) {
    throw InputError(place, std::move(message));
  }
  void warn_once(const std::string& key, std::string message);
  void note(std::string text) { path_.note({std::move(text), place_}); }
  double setting(const std::string& name, double as_delivered) const;
  double unit() const { return modes_.is_inch ? 25.4 : 1.0; }  // mm

  // checks.cpp
  void refuse_unread(const Block& block);
  void refuse_unread_call(const Block& block, bool is_path);
  void refuse_switched_on(const Block& block) const;
  void warn_of_settings(const Block& block);
  void warn_of_corner();
  void count_block_behind_corner();

  // settings.cpp: modal functions, spindle, M functions
  void set_modes(const Block& block);
  void set_plane(const Code& code);
  void set_units(const Code& code);
  void set_side(const Block& block, const Code& code);
  void set_offset(const Code& code);
  void put_offset(int offset);
  void set_path(const Code& code);
  void use_path(bool stops_exactly);
  void set_feed_code(int number);
  void set_feed(const Block& block);
  double unit_of_feed(const Place& place);
  void set_override(const Number& OVR);
  Feed effective(Feed feed, double override) const;
  void warn_of_start(const Block& block);
  void begin_functions(const Block& block);
  void begin_function(const Function& one);
  void require_one_of(const Block& block, std::initializer_list<int> group) const;
  void end_functions(const Block& block);
  void set_speed(const Block& block);
  void limit(const Block& block, const Code& code);
  void require_speed_in_limits(double S, const Place& place) const;
  void orient_spindle();
  void dwell(const Block& block);
  void dwell_for(double seconds);

  // frames.cpp
  bool act(const Block& block);
  void refuse_measures(const Block& block, const Code& code) const;
  void set_frame(const Block& block, const Code& code);
  void set_rotary(Frame& frame, const std::string& name, std::size_t axis, const Number& number);
  void set_linear(Frame& frame, const std::string& name, const Block& block);
  void rotate_frame(const Block& block, Frame& frame);
  void pole(const Block& block, const Code& code);
  Point pole_origin(const Code& code);
  Point polar_pole(const Block& block, const Code& code);
  Point cartesian_pole(const Block& block, const Code& code);
  void use_frame(const Frame& frame);
  void transform(const Code& code);
  void forget_linear_positions();
  void forget_positions();
  void require_no_compensation(std::string_view what) const;

  // tools.cpp
  void tools(const Block& block);
  int tool_number(const Block& block);
  int named_tool(const std::string& name, const Place& place);
  void change_tool(int number);
  void set_edge(int edge, const Place& place);
  void check_length_axis(bool is_hole);
  void put_length();
  double tool_length() const;
  double tool_radius();
  bool survey_knows_no_radius();

  // motion.cpp
  bool moves(const Block& block) const;
  void move(const Block& block);
  void move_straight(const Block& block);
  void move_to_machine(const Block& block);
  void thread(const Block& block);
  void require_axis_of_pitch(const Block& block) const;
  void require_lengths_kept(std::string_view what) const;
  void tap_with_chuck(const Block& block);
  Motion motion_of(const Block& block);
  Motion straight_motion(const Block& block);
  void add(Motion motion);
  void corner(const Block& block);
  Feed feed_of_block(const Block& block);
  Feed modal_feed(double override);
  Feed modal_feed();
  void store_end(const Motion& motion);

  // positions.cpp
  Values ends(const Block& block, bool& is_incremental);
  struct NamedEnds {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();   // m, program coordinates; 0 where unknown
    Eigen::Vector3d by = Eigen::Vector3d::Zero();  // m, as programmed
    std::array<bool, 3> is_named{}, is_known{};
    bool is_incremental = false;
  };
  NamedEnds named_ends(const Block& block);
  void linear_ends(const Block& block, Values& end, bool& is_incremental);
  bool is_moved(const NamedEnds& named, int axis) const;
  void require_known(const NamedEnds& named, int axis);
  double rotary_end(std::size_t axis, const Number& number);
  bool is_increment(const Number& number) const;
  void require_same_offset(std::size_t axis, const Number& number) const;
  std::optional<double> program_position(std::size_t axis) const;
  std::optional<double> linear_position(int axis) const;
  std::optional<Point> program_point(int normal) const;
  Point work_point(int normal, const Point& program) const;

  // circles.cpp
  void arc(const Block& block);
  void add_arc(const Block& block, Element element, int normal);
  std::optional<Point> end_in_plane(const Block& block, const Point& start);
  std::optional<Point> programmed_centre(const Block& block, const Point& start) const;
  Element about_centre(const Block& block, const Point& start, const Point& centre,
                       const std::optional<Point>& end, double sign);
  Element through_end(const Block& block, const Point& start, const Point& end, double sign);
  void arc_through_point(const Block& block);
  void tangential_arc(const Block& block);
  Point polar_point(const Block& block);
  double coordinate(const Number& number, double now) const;

  // flow.cpp: structures, jumps, repetitions
  bool flow(Scanner& scanner, const std::string& word, const Line& line);
  bool define_or_call(Scanner& scanner, const std::string& word);
  void go_on(Scanner& scanner, const std::string& word, const Line& line);
  static void require_end(Scanner& scanner, std::string_view what);
  static std::string read_target(Scanner& scanner, const std::string& word);
  void branch(Scanner& scanner, const Line& line);
  void loop(Scanner& scanner, const std::string& word, const Line& line);
  void count_loop(Scanner& scanner, const Line& line);
  void end_count_loop(const Line& line);
  void jump(const std::string& word, std::string name);
  void choose(Scanner& scanner);
  struct Repetition {
    std::vector<std::string> labels;
    long times = 1;
  };
  Repetition read_repetition(Scanner& scanner);
  BlockMark behind_end_label(const BlockMark& mark);
  BlockMark end_of_part(const std::vector<BlockMark>& labels, bool is_block,
                        const BlockMark& repeat);
  void repeat(Scanner& scanner, const std::string& word, const Line& line);
  bool end_repetition();
  void go_behind(const Line& line);
  void go_to(const BlockMark& mark);
  void count_jump() { run_.count_jump(place_); }
  double condition(Scanner& scanner);

  // calls.cpp: subprograms, variables
  void define(Scanner& scanner);
  void begin_procedure(Scanner& scanner);
  void define_parameters(Scanner& scanner);
  void call_by_text(Scanner& scanner);
  void call(const Call& call, long repeats);
  void call_subprogram(const Call& call, long repeats);
  ProgramFile* find_program(const std::string& name);
  void enter(ProgramFile* program, const Call& call, long repeats);
  void leave_subprogram();
  void restore(const Modes& modes);
  void execute_calls(const Block& block);
  void call_modal();

  // cycles.cpp
  static bool is_cycle(std::string_view name);
  bool run_cycle(const Call& call);
  bool refuse_cycle(const Call& call);
  void smoothing(const Call& call);
  void pattern(const Call& call);
  std::vector<Point> points_of(const Call& call) const;

  // swivel.cpp: CYCLE800
  Eigen::Matrix3d swivel_of(const Call& call) const;
  bool are_rotary_axes_at_zero() const;
  void swivel(const Call& call);
  void end_swivel();
  void put_beside_plane(Motion motion);

  // cycle_options.cpp
  void refuse_options(const Call& call) const;
  void refuse_alternatives(const Call& call, double AMODE) const;
  void refuse_pattern_options(const Call& call) const;

  // drilling.cpp
  struct Hole;
  double value_of(const Call& call, std::size_t at, std::optional<double> otherwise,
                  std::string_view name) const;
  Hole hole_of(const Call& call) const;
  void cycle_move(const Feed& feed, double height);
  void cycle_move(const Feed& feed, const std::array<std::optional<double>, 3>& to);
  void cycle_dwell(double time);
  Feed cycle_feed(double per_minute);
  bool run_drilling_cycle(const Call& call);
  std::vector<double> strokes_of(const Call& call, const Hole& hole) const;
  double pitch_of(const Call& call, std::size_t at_MPIT, std::size_t at_unit) const;
  void turn_spindle(int direction);
  void drill_82(const Call& call);
  void drill_83(const Call& call);
  void tap_84(const Call& call);
  void tap_840(const Call& call);
  void ream_85(const Call& call);
  void bore_86(const Call& call);
  void bore_88(const Call& call);
  void bore_89(const Call& call);

  std::vector<std::unique_ptr<ProgramFile>> files_;
  ProgramFile* program_ = nullptr;
  struct Return {
    ProgramFile* program = nullptr;
    BlockMark mark;              // where it goes on
    long left = 0;               // runs that follow this one
    bool is_modal = false;       // called behind a motion
    bool is_repetition = false;  // of a part of the program, from `begin` up to `end`
    BlockMark begin;
    std::size_t end = 0;
    Call call;                                             // of a subprogram
    std::optional<Modes> saved;                            // SAVE
    std::vector<std::pair<Reference, Reference>> outputs;  // parameters VAR: ours, the caller's
  };
  std::vector<Return> returns_;
  std::optional<Call> modal_call_;
  bool is_in_modal_call_ = false;

  ProgramSetup setup_;
  GcodeLines lines_;
  ContourPath path_;
  BlockRun run_;
  Variables variables_;
  std::vector<Fault> warnings_;
  std::set<std::string> warned_;
  Place place_;  // of the block
  bool has_begun_ = false;

  std::array<const Code*, kGroups> codes_{};  // of the block, by group
  Modes modes_;
  std::array<bool, kGroups> is_programmed_{};  // groups, since the start
  bool has_moved_ = false;
  Values work_;                             // position programmed last
  Values programmed_;                       // as programmed last, in the frame of that time
  std::array<double, kAxisWords> turns_{};  // full turns of modulo axes, degrees
  std::optional<Point> pole_;               // in program coordinates
  std::optional<double> polar_radius_, polar_angle_;
  std::optional<Element> last_element_;  // in program coordinates
  int last_normal_ = 2;
  int blocks_behind_corner_ = 0;  // RND, CHF or CHR; without motion
  std::optional<Feed> feed_;  // as programmed: of G95 in mm per revolution, without the override
  double feed_unit_ = 1.0;    // mm, of F programmed last
  double override_ = 1.0;     // OVR
  std::string tolerance_line_ = "G64";  // with that of CYCLE832
  std::optional<double> speed_;
  double least_speed_ = 0.0, most_speed_ = std::numeric_limits<double>::infinity();  // G25, G26
  int spindle_ = 0;
  int tool_ = 0, next_tool_ = -1;
  int edge_ = 0;
  bool has_tool_ = false, is_edge_programmed_ = false;
  std::map<std::string, int> tool_names_;
  bool is_tcp_ = false;
  std::string plane_line_;      // G68.2 of CYCLE800; empty: none
  bool has_swivelled_ = false;  // rotary axes stand elsewhere than the program says
  bool is_beside_ = false;      // still offset: G40 was in a block without an axis of the plane
};

}  // namespace servomill::controllers::siemens
