#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "sim/recordings/read_recording.h"
#include "sim/responses/store_response.h"
#include "sim/run/result_file.h"
#include "sim/system/output_name.h"
#include "sim/system/text_table.h"
#include "sim/system/write_file.h"
#include "tools/servomill/command.h"

namespace servomill::tools {

namespace {

namespace po = boost::program_options;
using sim::responses::MeasuredResponse;
using sim::responses::TwoMass;

void add_response_options(Options& options) {
  const auto text = [](const char* name) { return po::value<std::string>()->value_name(name); };
  options.add()("input", text("CHANNEL"), "excitation: current, torque or position command");
  options.add()("output", text("CHANNEL"), "what answers: an angle or a position");
  options.add()("period", po::value<double>()->value_name("S"),
                "period of the excitation in s (samples, where the file knows no time)");
  options.add()("skip", po::value<int>()->default_value(1)->value_name("N"),
                "periods at the beginning, in which the transient has not ended");
  options.add()("from", po::value<double>()->value_name("HZ"), "lines below are left out");
  options.add()("to", po::value<double>()->value_name("HZ"), "lines above are left out");
  options.add()("fit", text("two-mass"),
                "fits the two-mass model from a current or torque to the motor's angle");
  options.add()("lines", "prints every line, not just those that tell most");
  options.add()("table", text("OUT.csv"), "writes all lines with their uncertainty");
  options.add()("signals", text("OUT.h5"),
                "writes lines and fit for tools/identification_page.py, which draws them");
  options.add()("time-unit", text("us"), "unit of times of which the file does not say it");
  options.add()("force,f", "replaces OUT if it exists");
}

const sim::recordings::Channel& channel_of(const sim::recordings::Recording& recording,
                                           const Options& options, const char* option) {
  const Place place{fmt::format("--{}", option)};
  if (!options.has(option)) {
    throw InputError(place, "names a channel of the recording; see servomill recording FILE");
  }
  const auto name = options.get<std::string>(option);
  std::vector<std::string_view> names;
  for (const sim::recordings::Channel& channel : recording.channels) {
    if (channel.name == name) return channel;
    names.push_back(channel.name);
  }
  throw InputError(place, fmt::format("'{}' is no channel of {}{}", name, recording.file,
                                      did_you_mean(name, names)));
}

// Samples of one period and their rate.
sim::responses::PeriodSettings periods_of(const Options& options,
                                          const sim::recordings::Base& base) {
  const Place place{"--period"};
  if (!options.has("period"))
    throw InputError(place, "must be given: the period of the excitation");
  const auto count = static_cast<double>(base.values.size() - 1);
  const double interval = (base.values.back() - base.values.front()) / count;
  const double samples = options.get<double>("period") / interval;
  constexpr double kWhole = 1e-3;  // of a sample and period: a clock's error over one period
  if (!(samples >= 4.0) || std::abs(samples - std::round(samples)) > kWhole * std::sqrt(samples)) {
    throw InputError(place, fmt::format("{:g} is {:.6g} samples of {:g}; it must be a whole number "
                                        "of at least 4",
                                        options.get<double>("period"), samples, interval));
  }
  const int skip = options.get<int>("skip");
  if (skip < 0) throw InputError({"--skip"}, "must be >= 0");
  return {.samples = static_cast<std::size_t>(std::round(samples)),
          .skip = static_cast<std::size_t>(skip),
          .rate = 1.0 / interval};
}

// Without the lines that the user leaves out.
MeasuredResponse within(MeasuredResponse response, const Options& options) {
  const auto outside = [&](const sim::responses::ResponseLine& line) {
    return (options.has("from") && line.frequency < options.get<double>("from")) ||
           (options.has("to") && line.frequency > options.get<double>("to"));
  };
  std::erase_if(response.lines, outside);
  if (response.lines.empty()) {
    throw InputError({"--from"}, "leaves no excited line between --from and --to");
  }
  return response;
}

double degrees(const sim::responses::Complex& value) {
  return std::arg(value) * 180.0 / std::numbers::pi;
}

void print_response(const MeasuredResponse& response, bool all) {
  fmt::print("{} lines from {:g} to {:g} Hz, mean of {} periods", response.lines.size(),
             response.lines.front().frequency, response.lines.back().frequency, response.periods);
  if (response.unexcited > 0) fmt::print(", {} lines between them not excited", response.unexcited);
  fmt::print("\n");
  std::vector<std::vector<std::string>> table = {{"Hz", "magnitude", "+- (95 %)", "phase deg"}};
  const std::size_t step = all ? 1 : std::max<std::size_t>(response.lines.size() / 12, 1);
  for (std::size_t k = 0; k < response.lines.size(); k += step) {
    const auto& line = response.lines[k];
    table.push_back(
        {fmt::format("{:.4g}", line.frequency), fmt::format("{:.4g}", std::abs(line.value)),
         fmt::format("{:.2g}", line.radius_95), fmt::format("{:.1f}", degrees(line.value))});
  }
  fmt::print("{}", sim::system::text_table(table, 0, {0, 1, 2, 3}));
  constexpr double kMarked = 2.0;  // amplitudes
  for (const auto& one : sim::responses::extremes(response)) {
    if (one.prominence < kMarked) break;
    fmt::print("{} at {:.2f} Hz\n", one.is_maximum ? "resonance" : "antiresonance", one.frequency);
  }
}

void print_fit(const sim::responses::TwoMassFit& fit) {
  std::vector<std::vector<std::string>> table = {{"two masses", "value", "+- (k = 2)", "unit"}};
  for (std::size_t k = 0; k < TwoMass::kParameters; ++k) {
    table.push_back({std::string(TwoMass::kNames[k]), fmt::format("{:.4g}", fit.model.value[k]),
                     fmt::format("{:.2g}", 2.0 * fit.standard(k)),
                     std::string(TwoMass::kUnits[k])});
  }
  fmt::print("\n{}", sim::system::text_table(table, 0, {1, 2}));
  fmt::print("antiresonance {:.2f} Hz, resonance {:.2f} Hz, median misfit {:.2f} %\n",
             fit.model.antiresonance(), fit.model.resonance(), 100.0 * fit.median_misfit);
  if (fit.has_model_error()) {
    fmt::print(
        "the misfit is {:.0f} times the noise: structure that two masses do not have; the "
        "uncertainty includes it\n",
        fit.noise_ratio);
  }
  fmt::print("only these ratios can be identified: inertias themselves need the torque constant\n");
}

std::string csv_of(const MeasuredResponse& response) {
  std::string out = "frequency [Hz],real,imaginary,variance,radius_95\n";
  for (const auto& line : response.lines) {
    out += fmt::format("{},{},{},{},{}\n", line.frequency, line.value.real(), line.value.imag(),
                       line.variance, line.radius_95);
  }
  return out;
}

void write_outputs(const sim::responses::ResponseRecord& record, const Options& options,
                   const std::string& signals) {
  const bool force = options.has("force");
  if (options.has("table")) {
    const auto table = options.get<std::string>("table");
    sim::system::write_text_file(table, csv_of(record.response), force);
    fmt::print("written to {}\n", table);
  }
  if (!signals.empty()) {
    sim::responses::store_response(record, signals, force);
    fmt::print("written to {}\n", signals);
  }
}

}  // namespace

int response_command(const Arguments& arguments) {
  Options options(
      "response", "RECORDING --input CHANNEL --output CHANNEL --period S [--fit two-mass]",
      "Frequency response of a real axis from a recording with a periodic excitation\n"
      "(multisine): maximum likelihood over its periods, with an interval for every line\n"
      "from how the periods scatter; and the two-mass model fitted to it.",
      "RECORDING");
  add_response_options(options);
  if (!options.parse(arguments)) return kDone;
  const std::string file = options.word();
  if (options.has("fit") && options.get<std::string>("fit") != "two-mass") {
    throw InputError(
        {"--fit"}, fmt::format("'{}' is not known; two-mass is", options.get<std::string>("fit")));
  }
  const bool force = options.has("force");
  if (options.has("table")) {
    sim::system::output_target(options.get<std::string>("table"), sim::system::existing_of(force));
  }
  const std::string signals = output_of(options, "signals", ".h5");
  if (!signals.empty()) sim::run::writable_name(signals, force);
  const auto recording = sim::recordings::read_recording(
      file, options.has("time-unit") ? options.get<std::string>("time-unit") : "");
  const auto& input = channel_of(recording, options, "input");
  const auto& output = channel_of(recording, options, "output");
  if (input.base != output.base) {
    throw InputError({file}, fmt::format("'{}' and '{}' have different rates or times", input.name,
                                         output.name));
  }
  const auto& base = recording.bases[input.base];
  const MeasuredResponse response =
      within(sim::responses::maximum_likelihood(input.samples, output.samples,
                                                periods_of(options, base), file),
             options);
  print_response(response, options.has("lines"));
  sim::responses::ResponseRecord record{
      file, {input.name, input.unit}, {output.name, output.unit}, response, {}};
  if (options.has("fit")) {
    record.fit = sim::responses::fit_two_mass(response, file);
    print_fit(*record.fit);
  }
  write_outputs(record, options, signals);
  return kDone;
}

}  // namespace servomill::tools
