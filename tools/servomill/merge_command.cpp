#include <fmt/format.h>

#include "plant/vocabulary/input_error.h"
#include "sim/run/result_file.h"
#include "sim/sweep/merge.h"
#include "tools/servomill/command.h"
#include "tools/servomill/sweep_lines.h"

namespace servomill::tools {

namespace po = boost::program_options;

int merge_command(const Arguments& arguments) {
  Options options("merge", "SHARD.h5... -o OUT.h5 [--partial]",
                  "Joins the tables of the shards of a sweep into the table that a single process "
                  "would have written.",
                  "SHARD.h5");
  options.add()("output,o", po::value<std::string>()->value_name("OUT.h5"), "result file");
  options.add()("partial", "merges the existing points if shards or points are missing");
  options.add()("force,f", "replaces the result file if it exists");
  options.add()("quiet,q", "prints only faults");
  add_plugin_option(options);
  if (!options.parse(arguments)) return kDone;
  load_plugins(options);
  const Place place{"servomill merge"};
  if (options.words().empty()) throw InputError(place, "needs at least one SHARD.h5; see --help");
  if (!options.has("output")) throw InputError(place, "needs the name of the result: -o OUT.h5");

  const auto out = options.get<std::string>("output");
  sim::run::writable_name(out, options.has("force"));
  const sim::sweep::Merged merged =
      sim::sweep::merge_sweeps(options.words(), out, options.has("force"), options.has("partial"));
  for (const std::string& missing : merged.missing) fmt::print(stderr, "{}: {}\n", out, missing);
  tell_mixed_levels(out, merged.simd_levels);
  if (!options.has("quiet")) {
    if (merged.missing.empty()) print_statistics(out);
    fmt::print("{} in {}\n", points_by_status(merged.counts), out);
  }
  return kDone;
}

}  // namespace servomill::tools
