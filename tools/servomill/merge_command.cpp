#include <fmt/format.h>

#include "plant/vocabulary/input_error.h"
#include "sim/run/result_file.h"
#include "sim/sweep/merge.h"
#include "sim/sweep/statistics.h"
#include "sim/system/json.h"
#include "tools/servomill/command.h"
#include "tools/servomill/progress_line.h"
#include "tools/servomill/sweep_lines.h"

namespace servomill::tools {

namespace po = boost::program_options;

namespace {

std::string merge_json(const sim::sweep::Merged& merged, const std::string& out,
                       const std::vector<std::string>& statistics) {
  sim::system::JsonObject points;
  for (std::size_t k = 0; k < merged.counts.size(); ++k) {
    points.integer(sim::run::name_of(static_cast<sim::run::PointStatus>(k)), merged.counts[k]);
  }
  std::vector<std::string> levels;
  for (const SimdLevel level : merged.simd_levels) levels.emplace_back(name_of(level));
  return sim::system::JsonObject()
      .text("file", out)
      .raw("points", points.line())
      .raw("missing", sim::system::json_texts(merged.missing))
      .raw("simd_levels", sim::system::json_texts(levels))
      .raw("statistics", sim::system::json_list(statistics))
      .line();
}

}  // namespace

int merge_command(const Arguments& arguments) {
  Options options("merge", "SHARD.h5... -o OUT.h5 [--partial]",
                  "Joins the tables of the shards of a sweep into the table that a single process "
                  "would have written.",
                  "SHARD.h5");
  options.add()("output,o", po::value<std::string>()->value_name("OUT.h5"), "result file");
  options.add()("partial", "merges the existing points even if shards or points are missing");
  options.add()("force,f", "replaces the result file if it exists");
  options.add()("json", "prints one JSON object: points by status, statistics of samples");
  options.add()("quiet,q", "prints only faults");
  add_plugin_option(options);
  if (!options.parse(arguments)) return kDone;
  load_plugins(options);
  const Place place{"servomill merge"};
  if (options.words().empty()) throw InputError(place, "needs at least one SHARD.h5; see --help");
  if (!options.has("output")) throw InputError(place, "needs the name of the result: -o OUT.h5");

  const auto out = options.get<std::string>("output");
  sim::run::writable_name(out, options.has("force"));
  ProgressLine line(options);
  const sim::sweep::Merged merged =
      sim::sweep::merge_sweeps(options.words(), out, options.has("force"), options.has("partial"));
  const bool json = options.has("json");
  const auto statistics = json && merged.missing.empty()
                              ? sim::sweep::statistics_json(sim::sweep::sample_statistics(out))
                              : std::vector<std::string>();
  line.end();
  for (const std::string& missing : merged.missing) fmt::print(stderr, "{}: {}\n", out, missing);
  tell_mixed_levels(out, merged.simd_levels);
  if (json) {
    fmt::print("{}\n", merge_json(merged, out, statistics));
  } else if (!options.has("quiet")) {
    if (merged.missing.empty()) print_statistics(out);
    fmt::print("{} in {}\n", points_by_status(merged.counts), out);
  }
  return kDone;
}

}  // namespace servomill::tools
