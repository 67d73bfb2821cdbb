#include "sim/responses/store_response.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "sim/records/hdf5_group.h"
#include "sim/records/nexus.h"
#include "sim/records/output_file.h"

namespace servomill::sim::responses {
namespace {

constexpr std::size_t kModelPoints = 1000;

// Columns of a table of complex numbers over frequency.
struct Columns {
  std::vector<double> frequency, real, imaginary;

  void add(double f, const Complex& value) {
    frequency.push_back(f);
    real.push_back(value.real());
    imaginary.push_back(value.imag());
  }
  void store(records::Hdf5Group& group, const std::string& unit, const char* meaning) const {
    group.list("frequency", frequency, {"Hz", "frequency"});
    group.list("real", real, {unit, fmt::format("real part of {}", meaning)}, "frequency");
    group.list("imaginary", imaginary, {unit, fmt::format("imaginary part of {}", meaning)},
               "frequency");
    records::make_nexus_data(group, {"real", {"frequency"}, {"imaginary"}});
  }
};

void store_lines(records::Hdf5Group group, const MeasuredResponse& response,
                 const std::string& unit) {
  Columns columns;
  std::vector<double> variance, radius;
  for (const ResponseLine& line : response.lines) {
    columns.add(line.frequency, line.value);
    variance.push_back(line.variance);
    radius.push_back(line.radius_95);
  }
  columns.store(group, unit, "the response");
  group.list("variance", variance, {unit + " squared", "of the complex noise of the response"},
             "frequency");
  group.list("radius_95", radius, {unit, "of the circle that contains the response with 95 %"},
             "frequency");
}

// Frequencies at equal ratios from the first line to the last: a resonance may be between two
// lines.
template <class Model>
void store_model(records::Hdf5Group& group, const Model& model, const MeasuredResponse& response,
                 const std::string& unit) {
  const double first = response.lines.front().frequency, last = response.lines.back().frequency;
  Columns columns;
  for (std::size_t n = 0; n < kModelPoints; ++n) {
    const double share = static_cast<double>(n) / static_cast<double>(kModelPoints - 1);
    const double f = first * std::pow(last / first, share);
    columns.add(f, model.at(f));
  }
  columns.store(group, unit, "the fitted model");
}

void store_fit(records::Hdf5Group group, const TwoMassFit& fit, const MeasuredResponse& response,
               const std::string& unit) {
  std::vector<double> number, value, half;
  for (std::size_t k = 0; k < TwoMass::kParameters; ++k) {
    group.attribute(fmt::format("key_{:02}", k), std::string(TwoMass::kNames[k]));
    group.attribute(fmt::format("unit_{:02}", k), std::string(TwoMass::kUnits[k]));
    number.push_back(static_cast<double>(k));
    value.push_back(fit.model.value[k]);
    half.push_back(2.0 * fit.standard(k));
  }
  group.counts("parameter", number, {"1", "number of the parameter: key_NN, unit_NN"});
  group.list("value", value, {"as unit_NN", "fitted value"}, "parameter");
  group.list("half_width", half, {"as unit_NN", "expanded uncertainty, k = 2"}, "parameter");
  group.scalar("noise_ratio", fit.noise_ratio, {"1", "rms misfit over the noise of the lines"});
  group.scalar("median_misfit", fit.median_misfit, {"1", "median of |fit - measured|/|measured|"});
  store_model(group, fit.model, response, unit);
}

void store_roots(records::Hdf5Group group, const std::vector<Root>& roots) {
  records::make_nexus_group(group, "NXcollection");
  if (roots.empty()) return;
  std::vector<double> number, frequency, damping, of_frequency, of_damping;
  for (const Root& root : roots) {
    number.push_back(static_cast<double>(number.size()));
    frequency.push_back(root.frequency);
    damping.push_back(root.damping);
    of_frequency.push_back(2.0 * root.frequency_deviation);
    of_damping.push_back(2.0 * root.damping_deviation);
  }
  group.counts("root", number, {"1", "number of the root, one a conjugate pair"});
  group.list("frequency", frequency, {"Hz", "absolute value"}, "root");
  group.list("frequency_half_width", of_frequency, {"Hz", "expanded uncertainty, k = 2"}, "root");
  group.list("damping", damping, {"1", "- real part over absolute value"}, "root");
  group.list("damping_half_width", of_damping, {"1", "expanded uncertainty, k = 2"}, "root");
}

void store_fit(records::Hdf5Group group, const RationalFit& fit, const MeasuredResponse& response,
               const std::string& unit) {
  store_roots(group.group("zeros"), fit.zeros);
  store_roots(group.group("poles"), fit.poles);
  group.scalar("dead_time", fit.model.dead_time, {"s", "dead time"});
  group.scalar("noise_ratio", fit.noise_ratio, {"1", "rms misfit over the noise of the lines"});
  group.scalar("median_misfit", fit.median_misfit, {"1", "median of |fit - measured|/|measured|"});
  store_model(group, fit.model, response, unit);
}

}  // namespace

std::string response_unit(const SignalName& output, const SignalName& input) {
  if (output.unit.empty() || input.unit.empty()) return "unknown";
  return output.unit == input.unit ? "1" : output.unit + "/" + input.unit;
}

void store_response(const ResponseRecord& record, const std::string& path, bool force) {
  records::OutputFile file(path, force);
  file.remove_unless_committed();
  records::Hdf5Group root = file.root();
  records::make_nexus_group(root, "NXroot", "response");
  root.attribute("kind", "response");
  root.attribute("name", record.recording);
  root.attribute("input", record.input.name);
  root.attribute("output", record.output.name);
  const std::string unit = response_unit(record.output, record.input);
  store_lines(root.group("response"), record.response, unit);
  if (record.fit) store_fit(root.group("two_mass"), *record.fit, record.response, unit);
  if (record.rational) store_fit(root.group("rational"), *record.rational, record.response, unit);
  file.commit();
}

}  // namespace servomill::sim::responses
