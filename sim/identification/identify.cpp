#include "sim/identification/identify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/progress.h"
#include "sim/identification/friction_laws.h"
#include "sim/identification/parameter_space.h"
#include "sim/input/implausible.h"

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

// Root mean square of x - y without its mean: two scales count from different zeros.
double rms_without_mean(const std::vector<double>& x, const std::vector<double>& y) {
  double mean = 0.0, sum = 0.0;
  const auto n = static_cast<double>(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) mean += (x[k] - y[k]) / n;
  for (std::size_t k = 0; k < x.size(); ++k) sum += std::pow(x[k] - y[k] - mean, 2) / n;
  return std::sqrt(sum);
}

RecordResult result_of(const AxisRecord& record, Simulated simulated, double feedback_rms) {
  RecordResult out;
  out.record = &record;
  out.simulated = std::move(simulated);
  out.feedback_rms = feedback_rms;
  if (!record.record.scale.empty()) {
    out.scale_rms = rms_without_mean(out.simulated.scale, record.record.scale);
  }
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

// Position rms with the disturbance of a record times a factor.
std::optional<double> rms_with_disturbance(const Prediction& prediction, const Values& values,
                                           const std::vector<char>& mask, std::size_t record,
                                           double factor) {
  AxisRecord changed = *prediction.records()[record];
  for (double& force : changed.record.disturbance) force *= factor;
  const Prediction other = prediction.of_one(changed);
  const std::size_t estimates = prediction.estimates();
  Values own(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(estimates));
  own.push_back(values[estimates + 2 * record]);
  own.push_back(values[estimates + 2 * record + 1]);
  const auto signals = other.simulate({&own, 1});
  if (!signals.front()) return std::nullopt;
  return rms_of_record(other.residual(*signals.front(), {mask}), 0, mask);
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
    if (prediction.records()[r]->record.disturbance.empty()) continue;
    out.back().reversed_rms = rms_with_disturbance(prediction, fit.values, mask[r], r, -1.0);
    out.back().undisturbed_rms = rms_with_disturbance(prediction, fit.values, mask[r], r, 0.0);
  }
  return out;
}

// Estimates that each recording has for itself, for other recordings.
std::vector<Estimate> own_estimates(const std::vector<Estimate>& identified,
                                    const std::vector<const AxisRecord*>& records) {
  std::vector<Estimate> out;
  std::vector<std::string> known;
  for (const Estimate& one : identified) {
    if (one.record == Estimate::kAllRecords) continue;
    if (std::find(known.begin(), known.end(), one.keys.front()) != known.end()) continue;
    known.push_back(one.keys.front());
    for (const AxisRecord* record : records) {
      out.push_back(one);
      out.back().record = record->number;
    }
  }
  return out;
}

// Recordings that the estimation has not seen: only where and how fast they begin is theirs, and
// what each recording has for itself.
std::vector<RecordResult> validate(const Experiment& experiment,
                                   const std::vector<Estimate>& identified, unsigned threads) {
  const auto records = records_for(experiment, true);
  if (records.empty()) return {};
  const config::Document document = with_values(experiment.document, identified);
  const Prediction prediction(document, own_estimates(identified, records), records, threads);
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
  Stage stage("profiles", static_cast<double>(settings.profiles.size()), Steps::unlike);
  for (const std::size_t parameter : settings.profiles) {
    if (identifiable[parameter]) {
      out.profiles.push_back(profile(prediction, out.fit, out.uncertainty, mask, parameter));
    }
    stage.advance();
  }
}

// Values that no machine has, beyond those of the machine that was started from; and values that
// have grown as only a wrong unit makes them grow.
std::vector<std::string> implausible(const Experiment& experiment,
                                     const std::vector<Estimate>& identified, int joint) {
  constexpr double kOtherUnit = 100.0;
  std::vector<std::string> out;
  for (std::size_t k = 0; k < identified.size(); ++k) {
    const double start = experiment.estimates[k].start, now = identified[k].start;
    if (start == 0.0 || std::abs(now) < kOtherUnit * std::abs(start)) continue;
    out.push_back(fmt::format("{} = {:.4g} {} is {:.3g} times its start value",
                              identified[k].keys.front(), now, identified[k].unit,
                              std::abs(now / start)));
  }
  try {
    const auto before =
        input::implausible_values(model_of(experiment.document, {}, {}).machine, joint);
    const auto after = input::implausible_values(
        model_of(with_values(experiment.document, identified), {}, {}).machine, joint);
    const auto key = [](const std::string& text) { return text.substr(0, text.find(' ')); };
    for (const std::string& one : after) {
      const bool was = std::any_of(before.begin(), before.end(), [&](const std::string& other) {
        return key(other) == key(one);
      });
      if (!was) out.push_back(one);
    }
  } catch (const InputError&) {
    // what no machine takes is refused where the machine is written
  }
  return out;
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
  out.estimates = experiment.estimates;
  for (std::size_t k = 0; k < out.estimates.size(); ++k) {
    out.estimates[k].start = out.fit.values[k];
    // a value at its bound is held there: nothing is known about it, nor varied with the others
    if (out.estimates[k].is_at_bound())
      out.fit.jacobian.col(static_cast<Eigen::Index>(k)).setZero();
  }
  out.uncertainty = uncertainty_of(out.fit.jacobian, out.fit.residual, mask);
  add_intervals(prediction, mask, intervals, out);
  out.implausible = implausible(experiment, out.estimates, records.front()->joint);
  out.estimation = results(prediction, out.fit, mask);
  for (std::size_t r = 0; r < out.estimation.size(); ++r) {
    out.estimation[r].effective_samples = out.uncertainty.noise[r].effective_samples(
        static_cast<std::size_t>(std::count(mask[r].begin(), mask[r].end(), char{1})));
  }
  out.validation = validate(experiment, out.estimates, threads);
  if (experiment.compares_laws) compare_laws(experiment, out, threads);
  return out;
}

std::shared_ptr<const Identification> shared_identification(const Experiment& experiment,
                                                            unsigned threads,
                                                            const IntervalSettings& intervals) {
  return std::make_shared<const Identification>(identify(experiment, threads, intervals));
}

}  // namespace servomill::sim::identification
