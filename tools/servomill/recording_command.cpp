#include <fmt/format.h>

#include "plant/vocabulary/input_error.h"
#include "sim/recordings/read_recording.h"
#include "sim/recordings/survey.h"
#include "sim/recordings/write_recording.h"
#include "sim/run/result_file.h"
#include "sim/system/output_name.h"
#include "tools/servomill/command.h"
#include "tools/servomill/json_list.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {

namespace {

namespace po = boost::program_options;

// Everything that is known to be wrong with the output before anything is read.
void refuse_output(const std::string& out, bool force) {
  if (out.empty()) throw InputError({"--output"}, "the name of the result file is empty");
  sim::system::output_target(out, sim::system::existing_of(force));
  sim::recordings::refuse_unknown_kind(out);
  if (out.ends_with(".h5")) sim::run::writable_name(out, force);
}

}  // namespace

int recording_command(const Arguments& arguments) {
  Options options("recording", "FILE... [-o OUT.h5|OUT.csv]",
                  "Prints the contents of recordings of real axes: channels, units, rates, gaps,\n"
                  "clipping, missing samples. Also converts a recording. The format of a file is\n"
                  "recognised by its contents: " +
                      sim::recordings::format_names() + ".",
                  "FILE");
  options.add()("output,o", po::value<std::string>()->value_name("OUT"),
                "writes the recording as OUT.h5 or OUT.csv");
  options.add()("time-unit", po::value<std::string>()->value_name("us"),
                "unit of times without a unit in the file; default: s");
  options.add()("force,f", "replaces OUT if it exists");
  options.add()("json", "prints a JSON list, one object per FILE");
  options.add()("quiet,q", "prints only faults");
  if (!options.parse(arguments)) return kDone;
  const Place place{"servomill recording"};
  const auto files = options.words();
  if (files.empty()) throw InputError(place, "needs a FILE; see --help");
  const std::string out = options.has("output") ? options.get<std::string>("output") : "";
  if (options.has("output")) {
    if (files.size() > 1) throw InputError(place, "-o takes one FILE");
    refuse_output(out, options.has("force"));
  }
  const std::string time_unit =
      options.has("time-unit") ? options.get<std::string>("time-unit") : "";
  const bool prints = !options.has("quiet") && !options.has("json");
  JsonList list;
  ProgressLine line(options);
  Stage stage("files", static_cast<double>(files.size()), Steps::unlike);
  for (const std::string& file : files) {
    const sim::recordings::Recording recording = sim::recordings::read_recording(file, time_unit);
    const std::string survey = options.has("json") ? sim::recordings::survey_json(recording)
                               : prints            ? sim::recordings::survey(recording)
                                                   : "";
    if (!out.empty()) sim::recordings::write_recording(recording, out, options.has("force"));
    stage.advance();
    const auto hidden = line.hidden();
    if (options.has("json")) list.add(survey);
    if (!prints) continue;
    fmt::print("{}", survey);
    if (!out.empty()) fmt::print("written to {}\n", out);
  }
  line.end();
  if (options.has("json")) list.end();
  return kDone;
}

}  // namespace servomill::tools
