#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "sim/recordings/read_recording.h"
#include "sim/responses/control_response.h"
#include "sim/responses/local_polynomial.h"
#include "sim/responses/response_json.h"
#include "sim/responses/store_response.h"
#include "sim/run/result_file.h"
#include "sim/system/output_name.h"
#include "sim/system/text_table.h"
#include "sim/system/write_file.h"
#include "tools/servomill/command.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {

namespace {

namespace po = boost::program_options;
using sim::responses::MeasuredResponse;
using sim::responses::TwoMass;

void add_response_options(Options& options) {
  const auto text = [](const char* name) { return po::value<std::string>()->value_name(name); };
  options.add()("input", text("CHANNEL"), "excitation: current, torque or position command");
  options.add()("output", text("CHANNEL"), "response: an angle or a position");
  options.add()("period", po::value<double>()->value_name("S"),
                "period of the excitation in s (in samples, if the file has no time); without it "
                "the local polynomial method evaluates the record as a whole, for a chirp or a "
                "pseudo-random binary signal");
  options.add()(
      "of-control",
      "uses the response computed by the control itself; CHANNEL is then the number of a signal");
  options.add()("skip", po::value<int>()->default_value(1)->value_name("N"),
                "periods skipped at the beginning, for the transient");
  options.add()("f-min", po::value<double>()->value_name("HZ"),
                "excludes lines below this frequency");
  options.add()("f-max", po::value<double>()->value_name("HZ"),
                "excludes lines above this frequency");
  options.add()("fit", text("two-mass|N/M|N/M+delay"),
                "fits the two-mass model from current or torque to motor angle, or a rational "
                "function given by the degrees of numerator and denominator, and dead time");
  options.add()("lines", "prints every line, not only the most significant ones");
  options.add()("table", text("OUT.csv"), "writes all lines with their uncertainty");
  options.add()("signals", text("OUT.h5"),
                "writes lines and fit for tools/identification_page.py, which draws them");
  options.add()("time-unit", text("us"), "unit of times without a unit in the file");
  options.add()("force,f", "replaces OUT if it exists");
  options.add()("json", "prints one JSON object with all lines");
}

const sim::recordings::Channel& channel_of(const sim::recordings::Recording& recording,
                                           const Options& options, const char* option) {
  const Place place{fmt::format("--{}", option)};
  if (!options.has(option)) {
    throw InputError(place, "must name a channel of the recording; see servomill recording FILE");
  }
  const auto name = options.get<std::string>(option);
  std::vector<std::string_view> names;
  for (const sim::recordings::Channel& channel : recording.channels) {
    if (channel.name == name) return channel;
    names.push_back(channel.name);
  }
  throw InputError(place, fmt::format("'{}' is not a channel of {}{}", name, recording.file,
                                      did_you_mean(name, names)));
}

// A transform needs every sample, at equal intervals.
void refuse_unusable(const sim::recordings::Recording& recording,
                     const sim::recordings::Channel& channel) {
  const auto& base = recording.bases[channel.base];
  for (std::size_t k = 0; k < channel.samples.size(); ++k) {
    if (!std::isnan(channel.samples[k])) continue;
    throw InputError(
        {recording.file},
        fmt::format("'{}' lacks a sample at {}; a frequency response needs all of them",
                    channel.name, sim::recordings::at_text(base, k)));
  }
  const double mean = (base.values.back() - base.values.front()) /
                      static_cast<double>(std::max<std::size_t>(base.values.size() - 1, 1));
  for (std::size_t k = 1; k < base.values.size(); ++k) {
    if (base.values[k] - base.values[k - 1] < 1.5 * mean) continue;
    throw InputError({recording.file},
                     fmt::format("'{}' has a gap after {}; a frequency response needs samples at "
                                 "equal intervals",
                                 channel.name, sim::recordings::at_text(base, k - 1)));
  }
}

// Samples of one period and their rate.
sim::responses::PeriodSettings periods_of(const Options& options,
                                          const sim::recordings::Base& base) {
  const Place place{"--period"};
  const auto count = static_cast<double>(base.values.size() - 1);
  const double interval = (base.values.back() - base.values.front()) / count;
  const double samples = options.get<double>("period") / interval;
  constexpr double kWhole = 1e-3;  // of a sample and period: a clock's error over one period
  if (!(samples >= 4.0) || std::abs(samples - std::round(samples)) > kWhole * std::sqrt(samples)) {
    throw InputError(place, fmt::format("{:g} is {:.6g} samples of {:g}; it must be an integer "
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
    return (options.has("f-min") && line.frequency < options.get<double>("f-min")) ||
           (options.has("f-max") && line.frequency > options.get<double>("f-max"));
  };
  std::erase_if(response.lines, outside);
  if (response.lines.empty()) {
    throw InputError({"--f-min"}, "leaves no excited line between --f-min and --f-max");
  }
  return response;
}

double degrees(const sim::responses::Complex& value) {
  return std::arg(value) * 180.0 / std::numbers::pi;
}

void print_response(const MeasuredResponse& response, bool all) {
  fmt::print("{} lines from {:g} to {:g} Hz, ", response.lines.size(),
             response.lines.front().frequency, response.lines.back().frequency);
  if (response.lines_per_estimate > 1.0) {
    fmt::print("local polynomials: {:.1f} neighbours carry as much as one",
               response.lines_per_estimate);
  } else {
    fmt::print("mean of {} periods", response.periods);
  }
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
  constexpr int kMaxMarked = 10;
  int count = 0;
  for (const auto& one : sim::responses::extremes(response)) {
    if (one.prominence < kMarked || ++count > kMaxMarked) break;
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
  fmt::print("only these ratios can be identified: the inertias need the torque constant\n");
}

void print_roots(const std::vector<sim::responses::Root>& roots, const char* name,
                 std::vector<std::vector<std::string>>& table) {
  for (const auto& root : roots) {
    table.push_back({root.is_pair ? fmt::format("{} pair", name) : name,
                     fmt::format("{:.5g}", root.frequency),
                     fmt::format("{:.2g}", 2.0 * root.frequency_deviation),
                     root.is_pair ? fmt::format("{:.3g}", root.damping) : "real",
                     root.is_pair ? fmt::format("{:.2g}", 2.0 * root.damping_deviation) : "-"});
  }
}

void print_fit(const sim::responses::RationalFit& fit) {
  std::vector<std::vector<std::string>> table = {
      {"rational function", "Hz", "+- (k = 2)", "damping", "+- (k = 2)"}};
  print_roots(fit.zeros, "zero", table);
  print_roots(fit.poles, "pole", table);
  fmt::print("\n{}", sim::system::text_table(table, 0, {1, 2, 3, 4}));
  if (fit.dead_time_deviation > 0.0) {
    fmt::print("dead time {:.4g} +- {:.2g} ms (k = 2)\n", 1e3 * fit.model.dead_time,
               2e3 * fit.dead_time_deviation);
  }
  fmt::print("median misfit {:.2f} %, {:.1f} times the noise{}\n", 100.0 * fit.median_misfit,
             fit.noise_ratio,
             fit.has_model_error() ? ": the order is too low, or the axis is not linear; the "
                                     "uncertainty includes it"
                                   : "");
}

// "2/4", "2/4+delay".
std::optional<sim::responses::RationalOrder> rational_order(const std::string& text) {
  const std::string_view ending = "+delay";
  std::string_view rest = text;
  sim::responses::RationalOrder order;
  order.with_dead_time = rest.ends_with(ending);
  if (order.with_dead_time) rest.remove_suffix(ending.size());
  const std::size_t slash = rest.find('/');
  const auto degree = [](std::string_view word) {
    const bool is_number =
        !word.empty() && word.size() <= 2 &&
        std::all_of(word.begin(), word.end(), [](char c) { return c >= '0' && c <= '9'; });
    return is_number ? std::stoi(std::string(word)) : -1;
  };
  if (slash == std::string_view::npos) return std::nullopt;
  order.numerator = degree(rest.substr(0, slash));
  order.denominator = degree(rest.substr(slash + 1));
  const bool fits = order.numerator >= 0 && order.denominator >= 1 &&
                    order.numerator <= order.denominator &&
                    order.denominator <= sim::responses::kMaxOrder;
  return fits ? std::optional(order) : std::nullopt;
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
  const bool prints = !options.has("json");
  if (options.has("table")) {
    const auto table = options.get<std::string>("table");
    sim::system::write_text_file(table, csv_of(record.response), force);
    if (prints) fmt::print("written to {}\n", table);
  }
  if (!signals.empty()) {
    sim::responses::store_response(record, signals, force);
    if (prints) fmt::print("written to {}\n", signals);
  }
}

MeasuredResponse measured_response(const sim::recordings::Recording& recording,
                                   const Options& options) {
  if (options.has("of-control")) {
    const auto word = [&](const char* option) {
      return options.has(option) ? options.get<std::string>(option) : std::string();
    };
    return sim::responses::control_response(
        sim::responses::control_spectra(recording, word("input"), word("output")), recording.file);
  }
  const auto& input = channel_of(recording, options, "input");
  const auto& output = channel_of(recording, options, "output");
  if (input.base != output.base) {
    throw InputError({recording.file}, fmt::format("'{}' and '{}' have different rates or times",
                                                   input.name, output.name));
  }
  const auto& base = recording.bases[input.base];
  refuse_unusable(recording, input);
  refuse_unusable(recording, output);
  if (options.has("period")) {
    return sim::responses::maximum_likelihood(input.samples, output.samples,
                                              periods_of(options, base), recording.file);
  }
  sim::responses::LocalPolynomialSettings settings;
  settings.rate =
      static_cast<double>(base.values.size() - 1) / (base.values.back() - base.values.front());
  if (options.has("f-min")) settings.from = options.get<double>("f-min");
  if (options.has("f-max")) settings.to = options.get<double>("f-max");
  return sim::responses::local_polynomial(input.samples, output.samples, settings, recording.file);
}

sim::responses::SignalName signal_name(const sim::recordings::Recording& recording,
                                       const Options& options, const char* option) {
  if (options.has("of-control")) return {"signal " + options.get<std::string>(option), ""};
  const auto& channel = channel_of(recording, options, option);
  return {channel.name, channel.unit};
}

}  // namespace

int response_command(const Arguments& arguments) {
  Options options(
      "response", "RECORDING --input CHANNEL --output CHANNEL --period S [--fit two-mass]",
      "Computes the frequency response of a real axis from a recording with periodic excitation\n"
      "(multisine), by maximum likelihood over its periods, with a confidence interval for every\n"
      "frequency from the scatter of the periods. Fits the two-mass model to it.",
      "RECORDING");
  add_response_options(options);
  if (!options.parse(arguments)) return kDone;
  const std::string file = options.word();
  const std::string fit = options.has("fit") ? options.get<std::string>("fit") : "";
  const auto order = rational_order(fit);
  if (!fit.empty() && fit != "two-mass" && !order) {
    throw InputError(
        {"--fit"},
        fmt::format("unknown model '{}'; must be two-mass, N/M or N/M+delay with degrees "
                    "N <= M of numerator and denominator, M from 1 to {}",
                    fit, sim::responses::kMaxOrder));
  }
  const std::string signals = output_of(options, "signals", ".h5");
  ProgressLine progress(options);
  const auto recording = sim::recordings::read_recording(
      file, options.has("time-unit") ? options.get<std::string>("time-unit") : "");
  if (options.has("table")) refuse_unwritable(options, options.get<std::string>("table"));
  if (!signals.empty()) sim::run::writable_name(signals, options.has("force"));
  const MeasuredResponse response = within(measured_response(recording, options), options);
  const bool prints = !options.has("json");
  if (prints) {  // whatever becomes of the fit
    const auto hidden = progress.hidden();
    print_response(response, options.has("lines"));
  }
  sim::responses::ResponseRecord record;
  record.recording = file;
  record.input = signal_name(recording, options, "input");
  record.output = signal_name(recording, options, "output");
  record.response = response;
  if (order) {
    record.rational = sim::responses::fit_rational(response, *order, file);
    progress.end();
    if (prints) print_fit(*record.rational);
  } else if (!fit.empty()) {
    record.fit = sim::responses::fit_two_mass(response, file);
    progress.end();
    if (prints) print_fit(*record.fit);
  }
  progress.end();
  if (options.has("json")) fmt::print("{}\n", sim::responses::to_json(record));
  write_outputs(record, options, signals);
  return kDone;
}

}  // namespace servomill::tools
