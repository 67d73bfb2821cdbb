#include "sim/identification/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "plant/vocabulary/units.h"
#include "sim/identification/interval_report.h"
#include "sim/identification/motion_facts.h"

namespace servomill::sim::identification {
namespace {

// " of a.csv" where each recording has its own value.
std::string own_record(const Identification& result, const Estimate& one) {
  if (one.record == Estimate::kAllRecords) return {};
  for (const RecordResult& record : result.estimation) {
    if (record.record->number == one.record) return " of " + record.record->record.name;
  }
  return {};
}

std::string parameter_name(const Identification& result, std::size_t p) {
  if (p < result.estimates.size()) {
    const Estimate& one = result.estimates[p];
    return one.keys.front() + own_record(result, one);
  }
  const std::size_t own = p - result.estimates.size();
  return fmt::format("{} at the start of {}", own % 2 == 0 ? "position" : "speed",
                     result.estimation[own / 2].record->record.name);
}

std::string parameters(const Identification& result) {
  Lines table({"parameter", "value", "+- (k = 2)", "unit", "relative", "counted"});
  for (std::size_t k = 0; k < result.estimates.size(); ++k) {
    const Estimate& one = result.estimates[k];
    const double half = 2.0 * result.uncertainty.standard(k);
    if (!result.uncertainty.identifiable[k]) {
      table.add({names_of(one) + own_record(result, one), fmt::format("{:.5g}", one.start),
                 one.is_at_bound() ? "at its bound" : "unidentifiable", one.unit, "-", "-"});
      continue;
    }
    table.add({names_of(one) + own_record(result, one), with_uncertainty(one.start, half),
               fmt::format("{:.2g}", half), one.unit,
               fmt::format("{:.2g} %", 100.0 * half / std::abs(one.start)),
               fmt::format("{:.2g}", 2.0 * result.uncertainty.counted[k])});
  }
  return table.text() +
         "+- takes the autocorrelation of the residual into account; \"counted\" assumes "
         "independent samples.\n";
}

std::string inverse_dynamics_table(const Identification& result) {
  if (result.inverse_dynamics.empty()) return {};
  std::string out =
      "inverse dynamics (filters: position 100 Hz, force 40 Hz, Butterworth of order "
      "4, forwards and backwards)\n";
  for (const InverseDynamics& one : result.inverse_dynamics) {
    Lines table({fmt::format("{}, force {}", one.by_direction ? "by direction" : "symmetric",
                             one.held ? "held" : "at its sample (literature)"),
                 "value", "+- (k = 2)", "counted"});
    for (std::size_t k = 0; k < one.values.size(); ++k) {
      const double half = 2.0 * one.uncertainty.standard(k);
      table.add({one.names[k], with_uncertainty(one.values[k], half), fmt::format("{:.2g}", half),
                 fmt::format("{:.2g}", 2.0 * one.uncertainty.counted[k])});
    }
    out += table.text() + fmt::format("misfit {:.2f} % of the force\n", 100.0 * one.misfit);
  }
  const SymmetryTest test = test_symmetry(result.inverse_dynamics.back());
  out += fmt::format(
      "symmetric viscous friction is {}: the directions differ by {:.1f} standard "
      "deviations\n",
      test.rejected() ? "rejected" : "not rejected", std::abs(test.viscous));
  return out;
}

std::string record_table(const Identification& result) {
  Lines table({"recording", "use", "duration", "position rms", "force rms", "effective"});
  const auto add = [&](const RecordResult& one, const char* use) {
    const Record& r = one.record->record;
    table.add({r.name, use, fmt::format("{:.3g} s", r.period * static_cast<double>(r.size())),
               fmt::format("{:.3g} {}", one.feedback_rms / um, r.micro()),
               one.force_rms > 0.0 ? fmt::format("{:.2f} %", 100.0 * one.force_rms) : "-",
               one.effective_samples > 0.0
                   ? fmt::format("{:.0f} of {}", one.effective_samples, r.size())
                   : "-"});
  };
  for (const RecordResult& one : result.estimation) add(one, "estimation");
  for (const RecordResult& one : result.validation) add(one, "validation");
  std::string out = table.text();
  for (const auto* list : {&result.estimation, &result.validation}) {
    for (const RecordResult& one : *list) {
      if (one.scale_rms == 0.0) continue;
      out += fmt::format(
          "{}: the position of the scale is predicted within {:.3g} {} rms (not fitted)\n",
          one.record->record.name, one.scale_rms / um, one.record->record.micro());
    }
  }
  return out;
}

std::string law_table(const Identification& result) {
  if (result.laws.empty()) return {};
  const char* micro = result.estimation.front().record->record.micro();
  Lines table({"friction law", "parameters", "rms", "held out", "+-", "BIC"});
  for (const LawResult& law : result.laws) {
    if (!law.refused.empty()) {
      table.add({law.name, "-", "-", "-", "-", law.refused});
      continue;
    }
    table.add({law.name, fmt::format("{}", law.parameters),
               fmt::format("{:.3f} {}", law.rms / um, micro),
               fmt::format("{:.3f} {}", law.held_out / um, micro),
               fmt::format("{:.3f}", law.held_out_error / um), fmt::format("{:.0f}", law.bic)});
  }
  std::string out = "\n" + table.text();
  if (result.simplest_law) {
    out += fmt::format("the simplest law that is not worse than the best: {}\n",
                       result.laws[*result.simplest_law].name);
  }
  return out;
}

// How much of what the axis lags behind its command the model explains.
double unexplained(const RecordResult& one) {
  const Record& r = one.record->record;
  if (r.command.empty()) return 0.0;
  double sum = 0.0, mean = 0.0;
  const double n = static_cast<double>(r.size());
  for (std::size_t k = 0; k < r.size(); ++k) mean += (r.command[k] - r.feedback[k]) / n;
  for (std::size_t k = 0; k < r.size(); ++k) {
    const double error = r.command[k] - r.feedback[k] - mean;
    sum += error * error / n;
  }
  return sum > 0.0 ? one.feedback_rms / std::sqrt(sum) : 0.0;
}

// Root mean square of the recorded position about its mean.
double rms_of_motion(const Record& record) {
  double mean = 0.0, sum = 0.0;
  const auto n = static_cast<double>(record.size());
  for (const double x : record.feedback) mean += x / n;
  for (const double x : record.feedback) sum += (x - mean) * (x - mean) / n;
  return std::sqrt(sum);
}

// A recorded disturbance that makes the prediction worse has the wrong sign or is none.
std::string disturbance_warning(const RecordResult& one) {
  constexpr double kClearly = 0.9;
  const double limit = kClearly * one.feedback_rms;
  const auto text = [&](double rms, const char* way, const char* remedy) {
    return fmt::format(
        "{0}: {1} of disturbance_force the position rms is {2:.3g} {5} in place of {3:.3g} {5}; "
        "{4}",
        one.record->record.name, way, rms / um, one.feedback_rms / um, remedy,
        one.record->record.micro());
  };
  if (one.reversed_rms.value_or(limit) < limit) {
    return text(*one.reversed_rms, "with the opposite sign", "set factor = -1");
  }
  if (one.undisturbed_rms.value_or(limit) < limit) {
    return text(*one.undisturbed_rms, "without the force",
                "it does not act on the slide, or has the wrong unit or delay");
  }
  return {};
}

// Laws that are much farther from the parts of the recording that their fit did not see.
std::optional<std::string> law_warning(const std::vector<LawResult>& laws) {
  constexpr double kFar = 2.0;  // of the rms of the fit; laws that are determined stay within 1.3
  std::vector<std::string> names;
  for (const LawResult& law : laws) {
    if (law.refused.empty() && law.held_out > kFar * law.rms) names.push_back(law.name);
  }
  if (names.empty()) return std::nullopt;
  return fmt::format(
      "friction law '{}': the held-out error is above {:g} times the rms of the fit, since two "
      "thirds of the recording do not determine all values; compare the laws on a longer recording "
      "with more reversals",
      fmt::join(names, "', '"), kFar);
}

}  // namespace

std::vector<std::string> unidentifiable_sentences(const Identification& result) {
  std::vector<std::string> out;
  for (std::size_t k = 0; k < result.estimates.size(); ++k) {
    if (!std::isfinite(result.fit.scales[k])) {
      out.push_back(fmt::format("{}: the recordings do not depend on it; the start value is kept",
                                parameter_name(result, k)));
    }
  }
  for (const UnidentifiableDirection& one : result.uncertainty.unidentifiable) {
    std::vector<std::string> names;
    for (const std::size_t p : one.parameters) names.push_back(parameter_name(result, p));
    out.push_back(fmt::format(
        "{}: only {} identifiable; fix one of them, or record a motion that "
        "separates them",
        fmt::join(names, ", "),
        names.size() == 2 ? "one combination of the two is" : "combinations of them are"));
  }
  return out;
}

std::vector<std::string> warnings(const Identification& result) {
  constexpr double kForeignLoop = 0.25;
  std::vector<std::string> out;
  if (!result.fit.converged) {
    out.push_back(fmt::format("the fit has not converged: {}", result.fit.message));
  }
  for (std::size_t k = 0; k < result.estimates.size(); ++k) {
    const Estimate& one = result.estimates[k];
    if (one.is_at_bound()) {
      out.push_back(
          fmt::format("{} has ended at its bound {:g} {}", one.keys.front(), one.start, one.unit));
    }
  }
  for (const std::string& one : result.implausible) {
    const std::string& file = result.estimation.front().record->record.name;
    out.push_back(fmt::format(
        "{}: {}: a channel has the wrong unit or factor, or the loop is not that of the recording",
        file, one));
  }
  for (const auto* list : {&result.estimation, &result.validation}) {
    for (const RecordResult& one : *list) {
      const double share = unexplained(one);
      if (const std::string said = disturbance_warning(one); !said.empty()) out.push_back(said);
      if (one.force_rms > kForeignLoop) {
        out.push_back(
            fmt::format("{}: the simulated force is {:.0f} % off the recorded one; the loop is not "
                        "that of the recording, or the force has the wrong factor",
                        one.record->record.name, 100.0 * one.force_rms));
      }
      if (share < kForeignLoop) continue;
      out.push_back(
          fmt::format("{}: the model leaves {:.0f} % of the following error unexplained; the loop "
                      "is not that of the recording, or the model is incomplete",
                      one.record->record.name, 100.0 * share));
    }
  }
  if (const auto said = law_warning(result.laws)) out.push_back(*said);
  return out;
}

std::vector<std::string> faults(const Identification& result) {
  std::vector<std::string> out;
  if (!result.fit.converged) {
    out.push_back(
        fmt::format("the fit has not converged{}{}; start from the printed values, or estimate "
                    "fewer parameters",
                    result.fit.message.empty() ? "" : ": ", result.fit.message));
  }
  for (const RecordResult& one : result.estimation) {
    const double motion = rms_of_motion(one.record->record);
    if (one.feedback_rms < motion || one.feedback_rms == 0.0) continue;
    out.push_back(fmt::format(
        "{0}: the simulation is {1:.3g} {3} rms off the recording, whose motion "
        "is {2:.3g} {3} rms itself; the loop is not that of the recording",
        one.record->record.name, one.feedback_rms / um, motion / um, one.record->record.micro()));
  }
  if (!result.uncertainty.covariance.allFinite()) {
    out.emplace_back("the covariance of the values is not finite");
  }
  return out;
}

bool has_value_at_bound(const Identification& result) {
  return std::any_of(result.estimates.begin(), result.estimates.end(),
                     [](const Estimate& one) { return one.is_at_bound(); });
}

std::string report(const Experiment& experiment, const Identification& result) {
  std::string out;
  for (const AxisRecord& record : experiment.records) {
    for (const std::string& note : record.notes) out += note + "\n";
  }
  for (const RecordResult& one : result.estimation) {
    if (one.record->record.command.empty()) continue;
    const std::string facts =
        motion_facts_text(motion_facts(one.record->record), one.record->record.is_rotary);
    if (!facts.empty()) out += one.record->record.name + ": " + facts;
  }
  out += inverse_dynamics_table(result) + "\n";
  out += parameters(result) + "\n" + interval_tables(result) + record_table(result);
  for (const std::string& sentence : unidentifiable_sentences(result))
    out += "unidentifiable: " + sentence + "\n";
  for (const std::string& sentence : warnings(result)) out += "warning: " + sentence + "\n";
  return out + law_table(result);
}

}  // namespace servomill::sim::identification
