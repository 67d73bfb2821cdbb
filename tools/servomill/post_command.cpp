#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/programs/post_file.h"
#include "sim/system/json.h"
#include "sim/system/write_file.h"
#include "tools/servomill/command.h"
#include "tools/servomill/post_options.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {
namespace {

// A file may have one a line.
void tell(const std::vector<controllers::Warning>& warnings) {
  constexpr std::size_t kMaxReported = 20;
  for (std::size_t i = 0; i < std::min(kMaxReported, warnings.size()); ++i) {
    fmt::print(stderr, "{}\n", to_string(warnings[i]));
  }
  if (warnings.size() > kMaxReported) {
    fmt::print(stderr, "and {} more warnings\n", warnings.size() - kMaxReported);
  }
}

// Odd things explain faults.
sim::programs::PostProcessedFile post(sim::programs::PostRequest request, ProgressLine& line) {
  std::vector<controllers::Warning> warnings;
  try {
    return sim::programs::post_file(std::move(request), &warnings);
  } catch (const InputError&) {
    line.end();
    tell(warnings);
    throw;
  }
}

std::string post_json(const sim::programs::PostProcessedFile& done, const std::string& name) {
  std::vector<std::string> warnings;
  for (const controllers::Warning& one : done.warnings) warnings.push_back(to_string(one));
  return sim::system::JsonObject()
      .text("file", name)
      .integer("locations", done.locations)
      .integer("points_inserted", done.inserted)
      .text("verified", done.verified)
      .raw("warnings", sim::system::json_texts(warnings))
      .line();
}

std::string program_name(const Options& options) {
  if (options.has("output")) return options.get<std::string>("output");
  return std::filesystem::path(options.word()).stem().string() + ".ngc";
}

}  // namespace

int post_command(const Arguments& arguments) {
  Options options(
      "post", "PART.cls --machine M.toml [-o OUT.ngc] [...]",
      "Post-processes cutter locations to G-code for a machine. PART is an APT cutter location\n"
      "file (GOTO, FEDRAT, RAPID, ...) or, named .csv, a table x,y,z,i,j,k[,feed].\n"
      "\n"
      "Between locations the TCP moves on a straight line and the tool axis on a great circle:\n"
      "points are inserted where axis interpolation would exceed the tolerance. The feed is that\n"
      "of the TCP; each block has inverse-time feed (G93). Every location uses the axis positions\n"
      "nearest to the previous ones, within the travel.\n"
      "\n"
      "The approach to the first location, after a tool change and across rapids that change the\n"
      "tool axis: Z to the retract height, rotary axes, spindle on, X and Y, Z to the clearance,\n"
      "then along the tool axis. The retract reverses this order. The program is read back and\n"
      "compared with the locations before it is written. Bare numbers are in the unit that each\n"
      "option names.",
      "PART.cls");
  add_post_options(options);
  if (!options.parse(arguments)) return kDone;

  const std::string name = program_name(options);
  const bool to_stdout = name == "-";
  ProgressLine line(options);
  sim::programs::PostRequest request = post_request(options);
  if (!to_stdout) sim::system::refuse_unwritable_text(name, options.has("force"));
  const sim::programs::PostProcessedFile post_processed = post(std::move(request), line);
  line.end();
  tell(post_processed.warnings);
  if (to_stdout) {
    std::fwrite(post_processed.program.data(), 1, post_processed.program.size(), stdout);
  } else {
    sim::system::write_text_file(name, post_processed.program, options.has("force"));
  }
  std::FILE* to = to_stdout ? stderr : stdout;
  if (options.has("json")) {
    fmt::print(to, "{}\n", post_json(post_processed, name));
  } else if (!options.has("quiet")) {
    fmt::print(to, "{}: {} locations, {} points between them\n{}\n", name, post_processed.locations,
               post_processed.inserted, post_processed.verified);
  }
  return kDone;
}

}  // namespace servomill::tools
