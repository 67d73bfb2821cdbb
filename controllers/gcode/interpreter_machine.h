/// Memory of the interpreter (interpreter.cpp, motion.cpp, ...), and the steps of a block.
#pragma once

#include <fmt/format.h>

#include <array>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controllers/gcode/arc_geometry.h"
#include "controllers/gcode/canned_cycles.h"
#include "controllers/gcode/flow_state.h"
#include "controllers/gcode/interpreter.h"
#include "controllers/gcode/line_reader.h"
#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/parameters.h"
#include "controllers/gcode/program_text.h"
#include "controllers/gcode/readers/block_reading.h"
#include "controllers/gcode/readers/possible_readers.h"
#include "controllers/gcode/request.h"
#include "controllers/gcode/saved_state.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {

inline constexpr double kUnknownValue = std::numeric_limits<double>::quiet_NaN();  // in surveys
inline constexpr double kIntegerTol = 1e-4;  // as LinuxCNC, for words that must be integers

class Interpreter::Machine {
 public:
  Machine(ProgramText text, ProgramSetup setup)
      : setup_(std::move(setup)),
        tools_at_start_(setup_.tools),
        parameters_({[this](int number) { return system_number(number); },
                     [this](std::string_view name) { return system_name(name); }}),
        reader_(setup_.block_delete, setup_.reader),
        reading_(reading_options(), setup_.additional_offsets) {
    reader_.keep_pieces(setup_.reader != Reader::linuxcnc);
    texts_.push_back({std::move(text), {}, 0});
    load_stored_parameters();
    for (const auto& [name, value] : setup_.parameters) set_initial(name, value);
    for (int system = 1; system <= kWorkSystems; ++system) store_setup_offset(system);
    if (setup_.work_system < 1 || setup_.work_system > kWorkSystems) {
      throw InputError({file(), 0, 0}, fmt::format("work system {}; must be in 1 ... {}",
                                                   setup_.work_system, kWorkSystems));
    }
    state_.tool = setup_.tool;
    load_work_system(1);
    zero_at_start_ = state_.zero();
    load_work_system(setup_.work_system);
    load_stored_shift();
    state_.position = state_.from_account(setup_.start);
    parameters_.commit();
  }

  const Move* next() {
    while (given_ == out_.size()) {
      clear_output();
      if (ended_ || !read_block()) return nullptr;
    }
    return &out_[given_++];
  }

  std::optional<ExecutedBlock> next_block();
  std::vector<Move> rest();

  const std::vector<Fault>& warnings() const { return warnings_; }
  int unread_behind() const { return unread_behind_; }

  /// A system variable of Fanuc and Haas, behind the block that ran last.
  /// @param why  set to the reason where a simulation cannot know it
  std::optional<double> macro_variable(long number, std::string& why) const;
  bool is_inch() const { return state_.unit != mm; }

 private:
  std::optional<double> macro_position(long number, std::string& why) const;
  std::optional<double> macro_tool_length(long number, std::string& why) const;
  int setting_mode(long number) const;
  std::optional<double> macro_mode(long number, std::string& why) const;
  struct Text {
    ProgramText lines;
    PercentRule percent;
    int last_line = 0;       // the farthest that was run
    bool has_title = false;  // comments before the first '%'
  };

  // ---- setup
  ReadingOptions reading_options();
  const PossibleReaders* possible_readers();
  void set_initial(const std::string& name, double value);
  void store_setup_offset(int system);
  void load_stored_parameters();
  void load_stored_shift();

  // ---- reading
  bool read_block();
  void read_executed_line();
  void read_generated_line();
  void read_skipped_line();
  bool may_end_skipping(const OWord& o) const;
  void saw_percent();
  void leave_unread();
  void end_of_text();
  [[noreturn]] void fail_at_end();
  bool goes_on_behind_end();
  bool has_more_words();
  void run_end(ReaderRule rule);
  bool tolerates(ReaderRule rule, int column, const std::string& detail = {});
  template <typename Action>
  void with_place_of_fault(const Action& action);
  void read_as_control();
  CornerToNext corner_to_next();
  void read_pending_line();
  void look_for_missing_points();
  bool is_counted_by_K() const;
  void note_other_arithmetic();
  int original_column(int column) const;
  void execute();
  void run_block();
  void run_flow_of_reader();
  void clear_output() {
    out_.clear();
    given_ = 0;
  }
  ProgramText& text() { return texts_[text_].lines; }
  const ProgramText& text() const { return texts_[text_].lines; }
  const std::string& file() const { return text().file(); }
  int line() const { return text().number(); }
  bool is_of_other_language() const {
    return text().is_generated() && !text().source()->is_of_control();
  }
  [[noreturn]] void fail(int column, std::string message) const {
    throw InputError({file(), line(), column}, std::move(message));
  }
  std::string call_stack() const;

  // ---- flow control (flow_control.cpp)
  void run_flow();
  std::string label_of(const OWord& o) const;
  std::string label_text(const OWord& o) const;
  const std::string& scope_name() const;
  double flow_value(const OWord& o);
  void keep_result(const OWord& o);
  void skip_to(const std::string& label);
  void go_to(const LinePlace& place);
  void count_jump();
  Label& new_label(const std::string& name, Flow flow);
  Label& same_label(const std::string& name, Flow flow);
  Label& known_label(const std::string& name, const OWord& o);
  void begin_subroutine(const std::string& name, const OWord& o);
  void end_subroutine(const std::string& name, const OWord& o);
  void call_subroutine(const std::string& name, const OWord& o);
  void call_subprogram(const std::string& name, const OWord& o);
  void enter_call(const std::string& name, const OWord& o, const LinePlace& return_to);
  void find_subroutine(const std::string& name);
  void call_block(const LocalCall& call);  // M97
  std::optional<LinePlace> place_of_block(int number);
  void leave_call();
  void repeat(const std::string& name, const OWord& o);
  void while_line(const std::string& name, const OWord& o);
  void branch(const std::string& name, const OWord& o);
  void leave_loop(const std::string& name, const OWord& o);
  void end_loop(const std::string& name, const OWord& o);
  void assign_parameters();

  // ---- words
  const Request& request() const { return request_; }
  [[noreturn]] void fail_at(char letter, std::string message) const {
    fail(request_.word(letter).column, std::move(message));
  }
  double unit_of(Axis axis) const { return is_linear(axis) ? state_.unit : deg; }
  bool has_axis(int i) const { return request_.has(letter(axis_at(i))); }
  static Axis axis_at(int i) { return kAllAxes[static_cast<std::size_t>(i)]; }
  /// SI value of an axis word.
  double axis_word(int i) const { return request_[letter(axis_at(i))] * unit_of(axis_at(i)); }
  bool has_any_axis() const {
    for (int i = 0; i < kAxisWords; ++i) {
      if (has_axis(i)) return true;
    }
    return false;
  }
  int integer(char letter, double tolerance = kIntegerTol) const;
  bool has_unknown_dwell() const { return is_rewritten_ && reading_.has_unknown_dwell(); }
  bool has_unknown_feed() const;
  bool positions_below_r() const;

  // ---- steps of a block, in the order of execution
  // Due if the block has the letter or a code of the group: low bits are letters, then groups.
  struct Step {
    void (Machine::*run)();
    std::uint64_t due;
  };
  static constexpr std::uint64_t kAlways = std::uint64_t{1} << 63;
  static constexpr std::uint64_t bit(char letter) { return word_bit(letter); }
  static constexpr std::uint64_t bit(Group group) {
    return std::uint64_t{1} << (kLetters + static_cast<unsigned>(group));
  }
  static constexpr unsigned kLetters = kWordLetters;
  static const std::array<Step, 22> kSteps;
  void message();
  void feed_mode();
  void feed();
  void spindle_speed();
  void select_tool();
  void change_tool();
  void spindle();
  void coolant();
  void override_switches();
  bool is_switch_on() const;
  void output();
  void dwell();
  void plane();
  void units();
  void cutter_compensation();
  void tool_length();
  void set_table_offset(bool is_added);
  bool is_unknown_length(bool is_added, int number, int column);
  void note_height();
  ToolControl tool_control_of(int code) const;
  void refuse_codes_beyond_linuxcnc() const;
  void work_system();
  void work_plane();
  void path_control();
  void distance();
  void non_modal();
  void motion(), move_as(int code, int motion_before);
  void stop();

  // what is saved and restored, one level for each call of a subroutine
  void saved_modes();  // M70 M71 M72 M73
  SavedModes save_modal_state() const;
  /// True if anything had to be done.
  bool restore_modal_state(const SavedModes& saved);
  bool restore_m_codes(const SavedModes& saved, const SavedModes& now);
  bool restore_g_codes(const SavedModes& saved, const SavedModes& now);
  SavedLevel& saved_level();
  void restore_saved_level(int column);
  // behind the return of a subroutine, when the calls are those of the caller
  void restore_on_return();
  double feed_in_force() const;  // as an F word
  void set_feed_mode(FeedMode mode);
  void set_feed(double F);

  // the tool table while the program runs
  void reload_tools();   // G10 L0
  void set_tool(int L);  // G10 L1 L10 L11
  AxisWords position_for_tool(int system) const;
  AxisWords offset_from_position(const AxisWords& old, int L) const;
  double pocket_of(int number) const;

  void set_offsets();                     // G10
  void set_work_offset(int system);       // G10 L2
  void set_current_position(int system);  // G10 L20
  void load_work_system(int system);
  void refresh_if_active(int system);
  void go_home(int first_parameter);     // G28 G30
  void store_home(int first_parameter);  // G28.1 G30.1
  void shift_position(bool is_g52);      // G92 G52
  void drop_shift(bool forget);          // G92.1 G92.2
  void restore_shift();                  // G92.3
  void store_shift();
  const ToolEntry& tool_named(char letter, int number) const;

  // tool-centre-point control and tilted planes
  std::string rotary_not_at_zero(const AxisWords& machine) const;
  void require_rotary_at_zero(const AxisWords& machine, int column);
  void note_without_machine(int column, const std::string& why);
  AxisWords machine_now(int column) const;
  void stand_at(const AxisWords& machine, int column);
  void orient_tool();  // G53.1
  void refuse_while_tip_is_controlled() const;
  void refuse_rotary_words() const;
  bool has_vector() const;
  Eigen::Vector3d programmed_axis();
  double turn_towards(const Eigen::Vector3d& k, AxisWords& end) const;
  void warn_of_leaning_tool();

  // cutter radius compensation
  void start_compensation();
  double compensation_diameter() const;
  int compensating_tool() const;
  void warn_without_diameter(int column, const std::string& name);
  void refuse_turning_tool(int column, int orientation) const;
  void stop_compensation();
  void refuse_code(Group group) const;
  void refuse_codes_under_compensation();
  void warn(int column, std::string message);
  void compensate(MoveKind kind, const PlaneMove& path, const AxisWords& end, double length,
                  double feed);
  void tell_of_entry(const PlaneMove& path, const Corner& found);
  void turn_corner(MoveKind kind, const PlaneMove& path, const AxisWords& end, double feed);
  void go_around(MoveKind kind, const PlaneMove& path, const Eigen::Vector2d& point,
                 const AxisWords& end, double feed);
  int column_of_cause() const;
  void end_queue_at(const Eigen::Vector2d& point);
  void release_queue();
  void note_unit_of_control(), straight();
  void note_of_long_turn(const AxisWords& begin, const AxisWords& end);
  void synchronised();  // G33, G33.1
  void probe();         // G38.2 ... G38.5
  void require_probing() const;
  void require_known_height() const;
  std::optional<ProbeContact> contact_of(const ProbingMove& move);
  void finish_probing(const ProbingMove& move, const std::optional<ProbeContact>& contact);
  void arc();
  ArcCentre checked_centre(const Eigen::Vector2d& start, const Eigen::Vector2d& end,
                           const Eigen::Vector2d& centre, const ArcTolerance& tolerance);
  ArcCentre arc_centre(const Eigen::Vector2d& start, const Eigen::Vector2d& end, bool clockwise);
  int arc_turns(bool clockwise) const;
  void require_spline_modes(const Request::Chosen& chosen) const;
  void refuse_inside_nurbs(int column, std::string_view name) const;
  void bezier();
  void nurbs_point();
  void end_nurbs();
  void spline(const OpenNurbs& curve, const AxisWords& end, const Request::Chosen& chosen);

  // canned cycles
  void canned_cycle(int motion_before);
  void check_cycle() const;
  void check_cycle_spindle() const;
  double cycle_word(char letter, double kept, bool goes_on) const;
  int cycle_column(char letter) const {
    return request_.has(letter) ? request_.word(letter).column : request_.motion.column;
  }
  CycleHole cycle_hole(bool goes_on);
  void require_known_level();
  double cycle_offsets(const CycleHole& hole, bool goes_on);
  int cycle_repeats(const CycleHole& hole) const;
  void cycle_move(MoveKind kind, const AxisWords& end);
  void do_cycle_step(const CycleStep& step, const AxisWords& over);
  AxisWords confused_tap(const AxisWords& end);

  AxisWords programmed_end() const;
  AxisWords machine_end() const;
  Eigen::Vector2d polar_end(const Eigen::Vector2d& begin) const;
  /// Feed of a move: m/s or rad/s; under G95 a revolution.
  double move_feed(double length, double angle) const;
  std::string zero_feed(const std::string& code) const;
  void require_feed(const Request::Chosen& chosen) const;

  // ---- output
  Move& emit(MoveKind kind);
  void describe(Move& move, MoveKind kind) const;
  void describe_arc(Move& move, const AxisWords& centre, int turns) const;
  /// Under G95 also what it comes to at the speed of the spindle.
  void set_feed(Move& move, double feed) const;
  void move_to(MoveKind kind, const AxisWords& end, double length, double feed);
  void emit_spindle();

  // ---- parameters that the system sets
  double system_number(int number) const;
  void require_height(Axis axis, std::string_view name) const;
  std::optional<double> system_name(std::string_view name) const;

  std::deque<Text> texts_;  // the program and the files of its subroutines
  std::size_t text_ = 0;    // the one that is read
  ProgramSetup setup_;
  ToolTable tools_at_start_;  // G10 changes those of `setup_`
  Parameters parameters_;
  LineReader reader_;
  std::optional<ProgramSetup> setup_at_start_;  // of the reader `any`
  std::shared_ptr<const PossibleReaders> possible_readers_;
  BlockReading reading_;
  std::deque<std::string> pending_lines_;  // of the block read last, as a control reads it
  std::string pending_line_;               // that runs
  std::size_t nth_line_ = 0;               // of those of the block
  bool is_rewritten_ = false;              // `line_` is one of them
  LineUnknowns unknowns_;                  // of `line_`, which another language's block became
  bool has_warned_of_points_ = false;
  std::set<ReaderRule> tolerated_;
  std::set<std::string> noted_;
  std::set<int> assigned_;  // numbered parameters that the program has set; of the reader `any`
  std::string_view line_;   // as it was read last
  LinePlace here_;          // where it begins
  FlowState flow_;
  Block block_;
  Request request_;
  WorkZero zero_at_start_;  // of G54
  ModalState state_;
  ModalState before_;              // the block
  std::vector<SavedLevel> saved_;  // by level of calls
  bool ended_ = false;
  int unread_behind_ = 0;  // line of a closing '%'
  std::vector<Move> out_;
  std::size_t given_ = 0;
  std::vector<std::pair<int, double>> new_numbers_;
  std::vector<Fault> warnings_;
  std::shared_ptr<const WorkPlane> cut_plane_;  // the last in which a tool cut
  bool is_printing_ = false;                    // messages may read what expressions may not
};

}  // namespace servomill::controllers
