#include "sim/responses/response_json.h"

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include "sim/system/json.h"

namespace servomill::sim::responses {
namespace {

using system::JsonObject;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

std::string lines_json(const MeasuredResponse& response) {
  std::vector<std::string> out;
  for (const ResponseLine& line : response.lines) {
    out.push_back(JsonObject()
                      .number("frequency_Hz", line.frequency)
                      .number("magnitude", std::abs(line.value))
                      .number("phase_deg", std::arg(line.value) * 180.0 / std::numbers::pi)
                      .number("radius_95", line.radius_95)
                      .number("variance", line.variance)
                      .line());
  }
  return system::json_list(out);
}

std::string extremes_json(const MeasuredResponse& response) {
  std::vector<std::string> out;
  for (const Extreme& one : extremes(response)) {
    out.push_back(JsonObject()
                      .text("kind", one.is_maximum ? "resonance" : "antiresonance")
                      .number("frequency_Hz", one.frequency)
                      .number("prominence", one.prominence)
                      .line());
  }
  return system::json_list(out);
}

std::string fit_json(const TwoMassFit& fit) {
  std::vector<std::string> parameters;
  for (std::size_t k = 0; k < TwoMass::kParameters; ++k) {
    parameters.push_back(JsonObject()
                             .text("parameter", TwoMass::kNames[k])
                             .text("unit", TwoMass::kUnits[k])
                             .number("value", fit.model.value[k])
                             .number("U", 2.0 * fit.standard(k))
                             .line());
  }
  return JsonObject()
      .raw("parameters", system::json_list(parameters))
      .number("antiresonance_Hz", fit.model.antiresonance())
      .number("resonance_Hz", fit.model.resonance())
      .number("median_misfit", fit.median_misfit)
      .number("noise_ratio", fit.noise_ratio)
      .boolean("has_model_error", fit.has_model_error())
      .line();
}

std::string roots_json(const std::vector<Root>& roots) {
  std::vector<std::string> out;
  for (const Root& root : roots) {
    out.push_back(JsonObject()
                      .boolean("is_pair", root.is_pair)
                      .number("frequency_Hz", root.frequency)
                      .number("U_frequency_Hz", 2.0 * root.frequency_deviation)
                      .number("damping", root.damping)
                      .number("U_damping", root.is_pair ? 2.0 * root.damping_deviation : kUnknown)
                      .line());
  }
  return system::json_list(out);
}

std::string fit_json(const RationalFit& fit) {
  const bool has_dead_time = fit.dead_time_deviation > 0.0;
  return JsonObject()
      .raw("zeros", roots_json(fit.zeros))
      .raw("poles", roots_json(fit.poles))
      .number("dead_time_s", has_dead_time ? fit.model.dead_time : kUnknown)
      .number("U_dead_time_s", has_dead_time ? 2.0 * fit.dead_time_deviation : kUnknown)
      .number("median_misfit", fit.median_misfit)
      .number("noise_ratio", fit.noise_ratio)
      .boolean("has_model_error", fit.has_model_error())
      .line();
}

std::string count_json(std::size_t count) { return count > 0 ? std::to_string(count) : "null"; }

}  // namespace

std::string to_json(const ResponseRecord& record) {
  return JsonObject()
      .text("recording", record.recording)
      .text("input", record.input.name)
      .text("output", record.output.name)
      .text("unit", response_unit(record.output, record.input))
      .raw("periods", count_json(record.response.periods))
      .number("lines_per_estimate", record.response.lines_per_estimate)
      .integer("unexcited_lines", record.response.unexcited)
      .raw("lines", lines_json(record.response))
      .raw("extremes", extremes_json(record.response))
      .raw("two_mass", record.fit ? fit_json(*record.fit) : "null")
      .raw("rational", record.rational ? fit_json(*record.rational) : "null")
      .line();
}

}  // namespace servomill::sim::responses
