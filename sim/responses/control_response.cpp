#include "sim/responses/control_response.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim::responses {
namespace {

const recordings::Channel* find(const recordings::Recording& recording, const std::string& name) {
  for (const recordings::Channel& channel : recording.channels) {
    if (channel.name == name) return &channel;
  }
  return nullptr;
}

}  // namespace

ControlSpectra control_spectra(const recordings::Recording& recording, const std::string& input,
                               const std::string& output) {
  const auto* real = find(recording, fmt::format("signal {} {} cross spectrum re", output, input));
  const auto* imaginary =
      find(recording, fmt::format("signal {} {} cross spectrum im", output, input));
  const auto* of_input = find(recording, fmt::format("signal {} auto spectrum", input));
  const auto* of_output = find(recording, fmt::format("signal {} auto spectrum", output));
  if (real == nullptr || imaginary == nullptr || of_input == nullptr || of_output == nullptr) {
    std::vector<std::string> names;
    for (const recordings::Channel& channel : recording.channels) names.push_back(channel.name);
    throw InputError(
        {recording.file},
        fmt::format(
            "contains no response of signal {} to signal {} computed by the control; it has {}",
            output, input, fmt::join(names, ", ")));
  }
  ControlSpectra out;
  out.frequency = recording.bases[real->base].values;
  out.input = of_input->samples;
  out.output = of_output->samples;
  for (std::size_t k = 0; k < real->samples.size(); ++k) {
    out.cross.emplace_back(real->samples[k], imaginary->samples[k]);
  }
  out.averages = 0;
  const recordings::Channel* series = nullptr;
  while (const auto* next =
             find(recording, fmt::format("signal {} series {}", input, out.averages + 1))) {
    series = next;
    ++out.averages;
  }
  if (series == nullptr) return out;
  const std::vector<double>& t = recording.bases[series->base].values;
  const double step = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
  for (std::size_t k = 0; k < out.frequency.size(); ++k) {
    out.frequency[k] = static_cast<double>(k) / (step * static_cast<double>(t.size()));
  }
  return out;
}

MeasuredResponse control_response(const ControlSpectra& s, const std::string& name,
                                  double excited) {
  assert(s.cross.size() == s.frequency.size() && s.input.size() == s.frequency.size() &&
         s.output.size() == s.frequency.size());
  if (s.averages < 2) {
    throw InputError(
        {name},
        "contains spectra of a single measurement: without averaging their noise is unknown");
  }
  const double greatest = s.input.empty() ? 0.0 : *std::max_element(s.input.begin(), s.input.end());
  if (!(greatest > 0.0)) throw InputError({name}, "has an input without excitation");
  MeasuredResponse out;
  out.periods = s.averages;
  const double freedom = static_cast<double>(s.averages - 1);
  for (std::size_t k = 0; k < s.frequency.size(); ++k) {
    if (!(s.frequency[k] > 0.0) || !(s.input[k] > excited * greatest)) continue;
    ResponseLine line;
    line.frequency = s.frequency[k];
    line.value = std::conj(s.cross[k]) / s.input[k];
    line.input = std::sqrt(s.input[k]);
    line.output = line.value * line.input;
    const double of_input = std::norm(s.cross[k]) / s.input[k];  // part of the output
    line.variance = std::max(s.output[k] - of_input, 0.0) / (s.input[k] * freedom);
    line.radius_95 = std::sqrt(fisher_95(freedom) * line.variance);
    out.lines.push_back(line);
  }
  return out;
}

}  // namespace servomill::sim::responses
