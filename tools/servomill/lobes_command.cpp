#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/frequency/lobes.h"
#include "sim/model/design.h"
#include "sim/system/json.h"
#include "sim/system/worker_thread.h"
#include "sim/system/write_file.h"
#include "tools/servomill/axis_options.h"
#include "tools/servomill/lobes_inputs.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;

constexpr double kPi = std::numbers::pi;
constexpr double kPerMinute = 1.0 / 60.0;  // 1/s
constexpr int kMaxPoints = 2000;
constexpr int kMaxTeeth = 100;
constexpr std::array<std::string_view, 3> kMillings = {"slot", "up", "down"};

// The mode of --stiffness, --frequency, --damping and --mode-angle, or those of the file.
std::vector<plant::StructuralMode> modes_of(const Options& options, const LobesInputs& given) {
  constexpr std::array<const char*, 3> kNeeded = {"stiffness", "frequency", "damping"};
  const auto has = [&](const char* name) { return options.has(name); };
  if (std::none_of(kNeeded.begin(), kNeeded.end(), has)) {
    if (options.has("mode-angle")) {
      throw InputError({"--mode-angle"}, "needs --stiffness, --frequency and --damping");
    }
    const auto swings = [](const plant::StructuralMode& mode) { return !mode.is_static(); };
    if (std::any_of(given.modes.begin(), given.modes.end(), swings)) return given.modes;
    throw InputError(
        {"servomill lobes"},
        "needs modes of the tool point: [[structural_mode]] of the machine with frequency_Hz, or "
        "--stiffness, --frequency and --damping");
  }
  for (const char* name : kNeeded) {
    if (!has(name)) {
      throw InputError({fmt::format("--{}", name)},
                       "is missing; a mode has --stiffness, --frequency and --damping");
    }
  }
  plant::StructuralMode mode;
  mode.compliance = 1.0 / *positive_option(options, "stiffness", sim::config::kStiffness, "N/um");
  mode.mode.w = 2.0 * kPi * *positive_option(options, "frequency", sim::config::kRate, "Hz");
  mode.mode.zeta = *positive_option(options, "damping", sim::config::kNumber, "1");
  if (mode.mode.zeta >= 1.0) {
    throw InputError({"--damping"},
                     fmt::format("'{}' must be < 1", options.get<std::string>("damping")));
  }
  const double angle =
      quantity_option(options, "mode-angle", sim::config::kAngle, "deg").value_or(0.5 * kPi);
  mode.direction = Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
  return {mode};
}

plant::CuttingCoefficients coefficients_of(const Options& options, const LobesInputs& given) {
  plant::CuttingCoefficients K = given.coefficients.value_or(plant::CuttingCoefficients{});
  bool is_given = given.coefficients.has_value();
  if (options.has("material")) {
    std::vector<std::string_view> names;
    for (const plant::Material& one : plant::materials()) names.push_back(one.name);
    K = plant::materials()[choice_option(options, "material", names)].typical;
    is_given = true;
  }
  const auto Ktc = positive_option(options, "Ktc", sim::config::kPressure, "N/mm^2");
  const auto Krc = quantity_option(options, "Krc", sim::config::kPressure, "N/mm^2");
  if (!is_given && !(Ktc && Krc)) {
    throw InputError({"servomill lobes"},
                     "needs a material: [cutting] of a scenario, --material, or --Ktc and --Krc");
  }
  K.Ktc = Ktc.value_or(K.Ktc);
  K.Krc = Krc.value_or(K.Krc);
  return K;
}

// Angles at which a tooth enters and leaves: up milling begins with a chip of thickness 0.
void set_engagement(const Options& options, plant::FlankEngagement& cut) {
  const std::size_t milling = choice_option(options, "milling", kMillings);
  const auto depth = positive_option(options, "radial-depth", sim::config::kLength, "mm");
  cut.from = 0.0;
  cut.to = kPi;
  if (milling == 0) {
    if (depth) throw InputError({"--radial-depth"}, "needs --milling up or down");
    return;
  }
  if (!depth) throw InputError({"--radial-depth"}, "is missing; up and down milling need it");
  if (!(cut.radius > 0.0)) throw InputError({"--radial-depth"}, "needs --diameter");
  if (*depth > 2.0 * cut.radius) {
    throw InputError({"--radial-depth"},
                     fmt::format("'{}' must be <= {:g} mm, the diameter",
                                 options.get<std::string>("radial-depth"), 2.0 * cut.radius / mm));
  }
  const double immersion = std::acos(1.0 - *depth / cut.radius);
  if (milling == 1) {
    cut.to = immersion;
  } else {
    cut.from = kPi - immersion;
  }
}

plant::FlankEngagement engagement_of(const Options& options, const LobesInputs& given) {
  plant::FlankEngagement cut{.coefficients = coefficients_of(options, given),
                             .teeth = given.cutter.teeth,
                             .helix = given.cutter.helix,
                             .radius = given.cutter.radius};
  if (const auto diameter = positive_option(options, "diameter", sim::config::kLength, "mm")) {
    cut.radius = 0.5 * *diameter;
  }
  if (options.has("teeth")) cut.teeth = options.get<int>("teeth");
  if (cut.teeth == 0) throw InputError({"--teeth"}, "is missing; the file gives no tool");
  if (cut.teeth < 1 || cut.teeth > kMaxTeeth) {
    throw InputError({"--teeth"}, fmt::format("'{}' must be 1 to {}", cut.teeth, kMaxTeeth));
  }
  if (const auto helix = quantity_option(options, "helix", sim::config::kAngle, "deg")) {
    if (!(*helix >= 0.0 && *helix <= 60.0 * deg)) {
      throw InputError({"--helix"},
                       fmt::format("'{}' must be 0 to 60 deg", options.get<std::string>("helix")));
    }
    cut.helix = *helix;
  }
  if (cut.helix > 0.0 && !(cut.radius > 0.0)) throw InputError({"--helix"}, "needs --diameter");
  set_engagement(options, cut);
  return cut;
}

sim::frequency::LobesRequest request_of(const Options& options) {
  const LobesInputs given = lobes_inputs(options);
  sim::frequency::LobesRequest out;
  const double feed = *quantity_option(options, "feed-angle", sim::config::kAngle, "deg");
  const Eigen::Vector3d e1(std::cos(feed), std::sin(feed), 0.0);
  const Eigen::Vector3d e2(-std::sin(feed), std::cos(feed), 0.0);
  out.modes = sim::frequency::modes_across(modes_of(options, given), e1, e2);
  if (out.modes.empty()) {
    throw InputError({"servomill lobes"},
                     "all modes of the tool point are along the tool: none vibrates across it");
  }
  out.cut = engagement_of(options, given);
  const auto speed = [&](const char* name) {
    const double rpm = options.get<double>(name);
    if (!(rpm >= 1.0 && rpm <= 1e6)) {
      throw InputError({fmt::format("--{}", name)},
                       fmt::format("'{:g}' must be 1 to 1e6 rpm", rpm));
    }
    return rpm * kPerMinute;
  };
  out.from = speed("speed-min");
  out.to = speed("speed-max");
  if (!(out.to > out.from)) {
    throw InputError({"--speed-max"}, fmt::format("'{:g}' must be above --speed-min, {:g}",
                                                  out.to / kPerMinute, out.from / kPerMinute));
  }
  out.points = options.get<int>("points");
  if (out.points < 2 || out.points > kMaxPoints) {
    throw InputError({"--points"}, fmt::format("'{}' must be 2 to {}", out.points, kMaxPoints));
  }
  out.deepest = *positive_option(options, "depth-max", sim::config::kLength, "mm");
  return out;
}

std::string_view name_of(plant::Chatter kind) {
  constexpr std::array<std::string_view, 3> kNames = {"Hopf", "flip", "fold"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.9g}", value) : std::string();
}

std::string to_csv(const std::vector<sim::frequency::LobesPoint>& points) {
  std::string out =
      "speed_rpm,limit_mm,frequency_Hz,kind,zeroth_order_mm,zeroth_order_frequency_Hz\n";
  for (const auto& one : points) {
    const bool has_limit = std::isfinite(one.limit.depth);
    out += fmt::format(
        "{},{},{},{},{},{}\n", number(one.turns / kPerMinute), number(one.limit.depth / mm),
        has_limit ? number(one.limit.frequency) : std::string(),
        has_limit ? name_of(one.limit.kind) : std::string_view(),
        number(one.zeroth_order.depth / mm),
        std::isfinite(one.zeroth_order.depth) ? number(one.zeroth_order.frequency) : std::string());
  }
  return out;
}

std::string to_json(const sim::frequency::LobesRequest& request,
                    const std::vector<sim::frequency::LobesPoint>& points) {
  std::vector<std::string> rows;
  for (const auto& one : points) {
    const bool has_limit = std::isfinite(one.limit.depth);
    rows.push_back(sim::system::JsonObject()
                       .number("speed_rpm", one.turns / kPerMinute)
                       .number("limit_mm", one.limit.depth / mm)
                       .number("frequency_Hz", has_limit ? one.limit.frequency : std::nan(""))
                       .text_or_null("kind", has_limit ? name_of(one.limit.kind) : "")
                       .number("zeroth_order_mm", one.zeroth_order.depth / mm)
                       .line());
  }
  return sim::system::JsonObject()
      .integer("teeth", request.cut.teeth)
      .number("entry_deg", request.cut.from / deg)
      .number("exit_deg", request.cut.to / deg)
      .number("Ktc_N_per_mm2", request.cut.coefficients.Ktc * 1e-6)
      .number("Krc_N_per_mm2", request.cut.coefficients.Krc * 1e-6)
      .number("depth_max_mm", request.deepest / mm)
      .raw("points", sim::system::json_list(rows))
      .line();
}

void print_table(const sim::frequency::LobesRequest& request,
                 const std::vector<sim::frequency::LobesPoint>& points) {
  const plant::FlankEngagement& cut = request.cut;
  fmt::print("{} teeth in the cut from {:.4g} to {:.4g} deg, Ktc {:.4g}, Krc {:.4g} N/mm^2\n",
             cut.teeth, cut.from / deg, cut.to / deg, cut.coefficients.Ktc * 1e-6,
             cut.coefficients.Krc * 1e-6);
  for (const plant::ChatterMode& mode : request.modes) {
    fmt::print("mode {:.4g} N/um, {:.4g} Hz, damping {:.4g}, {:.4g} deg from the feed\n",
               mode.stiffness * um, mode.frequency / (2.0 * kPi), mode.damping,
               std::atan2(mode.direction.y(), mode.direction.x()) / deg);
  }
  fmt::print("\n{:>10}  {:>9}  {:>10}  {:<5} {:>12}\n", "speed", "limit", "chatter", "",
             "mean factors");
  const std::string most = fmt::format("> {:.4g} mm", request.deepest / mm);
  for (const auto& one : points) {
    const bool has_limit = std::isfinite(one.limit.depth);
    const double mean = one.zeroth_order.depth;
    fmt::print("{:>6.0f} rpm  {:>9}  {:>10}  {:<5} {:>12}\n", one.turns / kPerMinute,
               has_limit ? fmt::format("{:.3f} mm", one.limit.depth / mm) : most,
               has_limit ? fmt::format("{:.1f} Hz", one.limit.frequency) : std::string("-"),
               has_limit ? name_of(one.limit.kind) : std::string_view("-"),
               std::isfinite(mean) ? fmt::format("{:.3f} mm", mean / mm) : std::string("none"));
  }
  const auto by_depth = [](const auto& a, const auto& b) { return a.limit.depth < b.limit.depth; };
  const auto lowest = std::min_element(points.begin(), points.end(), by_depth);
  const auto highest = std::max_element(points.begin(), points.end(), by_depth);
  if (!std::isfinite(lowest->limit.depth)) {
    fmt::print("\nstable up to {:.4g} mm at all speeds\n", request.deepest / mm);
    return;
  }
  fmt::print("\nlowest limit {:.3f} mm at {:.0f} rpm, highest {} at {:.0f} rpm\n",
             lowest->limit.depth / mm, lowest->turns / kPerMinute,
             std::isfinite(highest->limit.depth)
                 ? fmt::format("{:.3f} mm", highest->limit.depth / mm)
                 : most,
             highest->turns / kPerMinute);
}

void add_lobes_options(Options& options) {
  const auto text = [](const char* value) { return po::value<std::string>()->value_name(value); };
  options.add()("tool", po::value<int>()->value_name("N"),
                "tool of the scenario (default: its only one)");
  options.add()("teeth", po::value<int>()->value_name("N"), "number of teeth");
  options.add()("diameter", text("D"), "diameter of the cutter; a bare number is in mm");
  options.add()("helix", text("\"30 deg\""),
                "helix angle of the cutter (default: that of the tool, else 0)");
  options.add()("material", text("NAME"),
                "material with typical coefficients (default: [cutting])");
  options.add()("Ktc", text("K"), "tangential coefficient; a bare number is in N/mm^2");
  options.add()("Krc", text("K"), "radial coefficient; a bare number is in N/mm^2");
  options.add()("milling", po::value<std::string>()->default_value("slot"), "slot, up or down");
  options.add()("radial-depth", text("AE"),
                "radial depth of cut in up and down milling; a bare number is in mm");
  options.add()("feed-angle", po::value<std::string>()->default_value("0 deg"),
                "direction of feed, as angle from X towards Y");
  options.add()("stiffness", text("\"20 N/um\""),
                "modal stiffness of one mode, instead of the modes of the file");
  options.add()("frequency", text("\"500 Hz\""), "its natural frequency");
  options.add()("damping", text("0.03"), "its damping ratio");
  options.add()("mode-angle", text("\"90 deg\""),
                "direction of the mode, as angle from X towards Y (default: Y)");
  options.add()("speed-min", po::value<double>()->default_value(2000.0)->value_name("RPM"),
                "lowest spindle speed");
  options.add()("speed-max", po::value<double>()->default_value(12000.0)->value_name("RPM"),
                "highest speed");
  options.add()("points", po::value<int>()->default_value(41)->value_name("N"), "speeds");
  options.add()("depth-max", po::value<std::string>()->default_value("20 mm"),
                "maximum depth of cut of the search, which begins at a fiftieth of it");
  options.add()("threads", po::value<int>()->default_value(0)->value_name("N"),
                "threads (0: all cores)");
  options.add()("output,o", text("OUT.csv"), "writes the table");
  options.add()("force,f", "replaces an output that exists");
  options.add()("json", "prints one JSON object");
}

}  // namespace

int lobes_command(const Arguments& arguments) {
  Options options(
      "lobes", "[MACHINE.toml|SCENARIO.toml] [--teeth N] [--material NAME] [-o OUT.csv]",
      "Prints stability lobes: the depth of cut at which a milling cutter begins to chatter, over\n"
      "spindle speed. Modes come from [[structural_mode]] of the machine, or one mode from the\n"
      "options; tool and material come from the scenario or the options. Limits are found by\n"
      "semi-discretisation for the actual engagement and helix. Hopf: chatter has a frequency of\n"
      "its own; flip: it repeats after two teeth. The last column is the closed form with mean\n"
      "directional factors, exact for slots with four straight teeth. The flank of the tool cuts,\n"
      "and the tool is along Z.",
      "MACHINE.toml or SCENARIO.toml");
  add_lobes_options(options);
  options.add()("case", po::value<std::string>()->value_name("NAME"),
                "uses the machine of this case of the scenario");
  add_plugin_option(options);
  options.add()("set", po::value<std::vector<std::string>>()->value_name("KEY=VALUE"),
                "changes a key of the file");
  if (!options.parse(arguments)) return kDone;
  const std::string output = output_of(options, "output", ".csv");
  ProgressLine line(options);
  const sim::frequency::LobesRequest request = request_of(options);
  refuse_unwritable(options, output);
  const auto points =
      sim::frequency::stability_lobes(request, sim::system::thread_count(thread_count(options)));
  line.end();
  if (options.has("json")) {
    fmt::print("{}\n", to_json(request, points));
  } else {
    print_table(request, points);
  }
  if (!output.empty()) {
    sim::system::write_text_file(output, to_csv(points), options.has("force"));
    if (!options.has("json")) fmt::print("written to {}\n", output);
  }
  return kDone;
}

}  // namespace servomill::tools
