/// Runs a macro program: its variables, branches, loops and calls. What is left are blocks.
/// Private to macro_program.cpp, macro_source.cpp, macro_calls.cpp and macro_statements.cpp.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "controllers/gcode/macro/arguments.h"
#include "controllers/gcode/macro/program_places.h"
#include "controllers/gcode/program_setup.h"

namespace servomill::controllers::macro {

class MacroSource final : public LineSource {
 public:
  MacroSource(ProgramText text, const ProgramSetup& setup,
              std::shared_ptr<const ControlState> control);

  bool next(std::string& line, Place& place) override;
  std::vector<Fault> take_warnings() override { return reading_.take_warnings(); }
  bool is_of_control() const override { return true; }
  int original_column(int column) const override { return out_.original_column(column); }
  int call_depth() const override { return static_cast<int>(calls_.size()); }
  std::string call_stack() const override;
  std::optional<ProgramText> written() const override { return files_.front().text().again(); }

 private:
  struct RunningCall {
    MacroCall call;
    std::size_t return_file = 0;
    ProgramText::Mark return_to;
    int line = 0;  // of the call
    std::size_t file = 0;
    ProgramText::Mark body;
    std::optional<std::size_t> modal;  // index of the G66 that calls
    bool is_under_modal = false;       // a G66 is in force that this program is not called by
  };

  // ---- lines (macro_source.cpp)
  bool step();  // false: nothing more
  void read_words_of_line();
  void emit_words(std::vector<MacroWord>& words, const WordUnits& units);
  void choose_dwell(std::vector<MacroWord>& words);
  void emit_as_written() { out_.set(text_), has_line_ = true; }
  void emit(std::string text) { out_.set(text), has_line_ = true; }
  void percent();
  void program_number();
  bool end_of_text();

  // ---- statements (macro_statements.cpp)
  void run_statement(Statement statement, std::size_t begin);
  void assignment(std::size_t begin);
  void write_system_variable(long number, MacroValue value, const Place& place);
  void stop_with_message();
  void condition(std::size_t begin);
  void check_left_out(Statement statement, std::size_t begin);
  void conditional_return(std::size_t begin);
  void while_line(std::size_t begin);
  void end_of_loop();
  const Loop& loop_of_line();
  void go_to(std::size_t begin);
  void jump(long number, const Place& place, std::string_view program);
  void count_jump();
  void nothing_behind(const Cursor& cursor);
  bool has_next_statement(const Cursor& cursor);

  // ---- calls (macro_calls.cpp)
  void call_codes(std::vector<MacroWord>& words, const WordUnits& units);
  void begin_modal(MacroCall call);
  void end_modal(MacroWord& code);
  void call_modal(const std::vector<MacroWord>& words);
  void check_depth(const MacroCall& call);
  void begin_call(MacroCall call, std::optional<std::size_t> modal = {});
  bool find_program(long number);
  void end_call(std::optional<long> block, int column);
  bool turn_again(RunningCall& running);

  ProgramPlaces& places() { return files_[file_]; }
  ProgramText& text() { return files_[file_].text(); }
  const std::string& file() { return text().file(); }
  Place here(int column) { return {file(), text().number(), column}; }
  Expression::Context context() { return {variables_, reading_, file(), text().number()}; }
  [[noreturn]] void refuse(int column, std::string message) {
    reading_.refuse(here(column), std::move(message));
  }

  std::function<std::optional<ProgramText>(const std::string&)> subroutine_file_;
  bool skips_optional_;
  long most_jumps_;
  std::shared_ptr<const ControlState> control_;
  MacroReading reading_;
  Variables variables_;
  std::deque<ProgramPlaces> files_;
  std::size_t file_ = 0;
  std::vector<RunningCall> calls_;
  std::vector<MacroCall> modals_;  // of G66, the innermost last
  std::function<void()> after_;    // the block that was handed out last has run
  std::deque<std::string> more_;   // blocks of the same line
  bool has_number_ = false;        // the program's own O was read
  bool has_ended_ = false;
  long jumps_ = 0, lines_ = 0;

  std::string text_;  // of the line that is read
  Line line_;
  Place line_place_;
  ExpandedLine out_;
  bool has_line_ = false;
  bool is_behind_then_ = false;  // the statement that runs
};

}  // namespace servomill::controllers::macro
