/// Common part of all commands of the program: options, exit status.
#pragma once

#include <boost/program_options.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace servomill::tools {

/// Exit status of the program.
enum Exit : int {
  kDone = 0,
  kMachineStopped = 1,  // ran, but the machine stopped
  kInputWrong = 2,
  kSystemFailed = 3,
  kInterrupted = 130,  // SIGINT, as shells count it
};

using Arguments = std::vector<std::string>;

struct Command {
  std::string_view name;
  std::string_view synopsis;  // behind the name
  std::string_view summary;
  int (*run)(const Arguments&);
};

int run_command(const Arguments& arguments);
int compare_command(const Arguments& arguments);
int check_command(const Arguments& arguments);
int time_command(const Arguments& arguments);
int canon_command(const Arguments& arguments);
int limits_command(const Arguments& arguments);
int list_command(const Arguments& arguments);
int sweep_command(const Arguments& arguments);
int machine_command(const Arguments& arguments);
int merge_command(const Arguments& arguments);
int bode_command(const Arguments& arguments);
int step_command(const Arguments& arguments);
int lobes_command(const Arguments& arguments);
int fmu_command(const Arguments& arguments);
int tune_command(const Arguments& arguments);
int view_command(const Arguments& arguments);
int budget_command(const Arguments& arguments);
int converge_command(const Arguments& arguments);
int plan_calibration_command(const Arguments& arguments);
int post_command(const Arguments& arguments);
int table_command(const Arguments& arguments);
int compensate_command(const Arguments& arguments);
int calibrate_command(const Arguments& arguments);
int identify_command(const Arguments& arguments);
int identify_heat_command(const Arguments& arguments);
int recording_command(const Arguments& arguments);
int response_command(const Arguments& arguments);
int evaluate_command(const Arguments& arguments);

/// Options of one command: named ones, and words that stand by themselves.
class Options {
 public:
  /// @param words  what words mean, for messages ("SCENARIO.toml"); empty: none allowed
  Options(std::string_view command, std::string_view synopsis, std::string_view summary,
          std::string_view words);

  boost::program_options::options_description_easy_init add() { return description_.add_options(); }

  /// @return false if the help was asked for, or another form of it (command_pages.h), and printed
  /// @throws InputError for options that there are not
  bool parse(const Arguments& arguments);

  bool has(const std::string& name) const { return values_.count(name) > 0; }
  template <class T>
  const T& get(const std::string& name) const {
    return values_[name].as<T>();
  }
  std::vector<std::string> list(const std::string& name) const {
    return has(name) ? get<std::vector<std::string>>(name) : std::vector<std::string>{};
  }
  /// Words as they were given; those that name a scenario as its file, as --machine the file of its
  /// machine (sim/input/scenario_name.h).
  std::vector<std::string> words() const { return list("words"); }
  /// The only word. @throws InputError if there are none or several
  std::string word() const;

 private:
  void remember_files() const;
  void find_named_files();
  bool print_other_form(const Arguments& arguments) const;

  std::string command_, synopsis_, summary_, words_;
  boost::program_options::options_description description_{"Options"};
  boost::program_options::variables_map values_;
};

/// --plugin FILE, of commands that read scenarios.
void add_plugin_option(Options& options);
/// @throws InputError
void load_plugins(const Options& options);

/// Value of an option that names an output, empty without it.
/// @param suffix  that the name must have; empty: any
/// @throws InputError if it has another one
std::string output_of(const Options& options, const char* name, const char* suffix);

/// Before the work, and after the inputs have been read: their faults come first.
/// @param out  a name of output_of, or empty
/// @throws InputError if it exists without --force, or is an input
void refuse_unwritable(const Options& options, const std::string& out);

/// Value of --threads. @throws InputError
unsigned thread_count(const Options& options);

/// "OUT.h5" for a scenario: its name in the current folder unless the user says otherwise.
std::string output_name(const Options& options, const std::string& scenario_name,
                        std::string_view suffix);

/// A result file may have any name, but not that of another format.
/// @throws InputError
void refuse_other_format(const std::string& out);

}  // namespace servomill::tools
