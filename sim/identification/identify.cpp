#include "sim/identification/identify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/identification/friction_laws.h"

namespace servomill::sim::identification {
namespace {

std::vector<const AxisRecord*> records_for(const Experiment& experiment, bool validation) {
  std::vector<const AxisRecord*> out;
  for (const AxisRecord& one : experiment.records) {
    if (one.record.validation == validation) out.push_back(&one);
  }
  return out;
}

double rms_of(const std::vector<double>& x, const std::vector<double>& y) {
  double sum = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double difference = y.empty() ? x[k] : x[k] - y[k];
    sum += difference * difference;
  }
  return std::sqrt(sum / static_cast<double>(x.size()));
}

RecordResult result_of(const AxisRecord& record, Simulated simulated, double feedback_rms) {
  RecordResult out{&record, std::move(simulated), feedback_rms};
  if (!record.record.force.empty()) {
    const double whole = rms_of(record.record.force, {});
    out.force_rms = whole > 0.0 ? rms_of(out.simulated.force, record.record.force) / whole : 0.0;
  }
  return out;
}

double rms_of_record(const Eigen::VectorXd& residual, Eigen::Index begin,
                     const std::vector<char>& mask) {
  const auto count = std::count(mask.begin(), mask.end(), char{1});
  const double sum = residual.segment(begin, static_cast<Eigen::Index>(mask.size())).squaredNorm();
  return count == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(count));
}

// Simulated with values of all parameters.
std::vector<RecordResult> results(const Prediction& prediction, const Fit& fit, const Mask& mask) {
  const auto signals = prediction.simulate({&fit.values, 1});
  std::vector<RecordResult> out;
  Eigen::Index begin = 0;
  for (std::size_t r = 0; r < prediction.records().size(); ++r) {
    out.push_back(result_of(*prediction.records()[r], signals.front()->of_record[r],
                            rms_of_record(fit.residual, begin, mask[r])));
    begin += static_cast<Eigen::Index>(mask[r].size());
  }
  return out;
}

// Recordings that the estimation has not seen: only where and how fast they begin is theirs.
std::vector<RecordResult> validate(const Experiment& experiment,
                                   const std::vector<Estimate>& identified, unsigned threads) {
  const auto records = records_for(experiment, true);
  if (records.empty()) return {};
  const config::Document document = with_values(experiment.document, identified);
  const Prediction prediction(document, {}, records, threads);
  const Mask mask = prediction.all_samples();
  return results(prediction, fit(prediction, prediction.start(), mask), mask);
}

void add_inverse_dynamics(const AxisRecord& record, Identification& out) {
  if (record.record.force.empty()) return;
  try {
    out.inverse_dynamics.push_back(inverse_dynamics(record.record, false, {.held = false}));
    for (const bool by_direction : {false, true}) {
      out.inverse_dynamics.push_back(inverse_dynamics(record.record, by_direction));
    }
  } catch (const InputError&) {
    out.inverse_dynamics.clear();  // too short for its filters: the simulation may still do
  }
}

// Intervals on request; nothing to compute if nothing is identifiable.
void add_intervals(const Prediction& prediction, const Mask& mask, const IntervalSettings& settings,
                   Identification& out) {
  const std::vector<bool>& identifiable = out.uncertainty.identifiable;
  const bool any = std::find(identifiable.begin(), identifiable.end(), true) != identifiable.end();
  if (settings.bootstrap.replicas > 0 && any) {
    out.bootstrap = bootstrap(out.fit, out.uncertainty, mask, settings.bootstrap);
  }
  for (const std::size_t parameter : settings.profiles) {
    if (!identifiable[parameter]) continue;
    out.profiles.push_back(profile(prediction, out.fit, out.uncertainty, mask, parameter));
  }
}

}  // namespace

Identification identify(const Experiment& experiment, unsigned threads,
                        const IntervalSettings& intervals) {
  Identification out;
  const auto records = records_for(experiment, false);
  add_inverse_dynamics(*records.front(), out);
  const Prediction prediction(experiment.document, experiment.estimates, records, threads);
  const Mask mask = prediction.all_samples();
  out.fit = fit(prediction, prediction.start(), mask);
  out.uncertainty = uncertainty_of(out.fit.jacobian, out.fit.residual, mask);
  add_intervals(prediction, mask, intervals, out);
  out.estimates = experiment.estimates;
  for (std::size_t k = 0; k < out.estimates.size(); ++k) out.estimates[k].start = out.fit.values[k];
  out.estimation = results(prediction, out.fit, mask);
  for (std::size_t r = 0; r < out.estimation.size(); ++r) {
    out.estimation[r].effective_samples = out.uncertainty.noise[r].effective_samples(
        static_cast<std::size_t>(std::count(mask[r].begin(), mask[r].end(), char{1})));
  }
  out.validation = validate(experiment, out.estimates, threads);
  if (experiment.compares_laws) compare_laws(experiment, out, threads);
  return out;
}

}  // namespace servomill::sim::identification
