#include "sim/identification/identified_machine.h"

#include <fmt/format.h>

#include "sim/identification/experiment.h"
#include "sim/identification/identification.h"
#include "sim/identification/report.h"

namespace servomill::sim::identification {
namespace {

// One key of the machine and the estimate that gives its value.
struct MachineKey {
  std::string key;
  std::size_t estimate;
};

void refuse_faults(const Experiment& experiment, const Identification& result,
                   const std::string& path) {
  if (experiment.machine_path.empty()) {
    throw InputError({experiment.path},
                     "describes the machine itself; name a machine file (machine = \"FILE\") so "
                     "that the identified values can override it");
  }
  std::vector<Fault> not_written;
  for (const std::string& one : faults(result))
    not_written.push_back({{path}, "not written: " + one});
  if (!not_written.empty()) throw InputError(std::move(not_written));
}

std::vector<std::string> comments(const Experiment& experiment, const Identification& result) {
  std::vector<std::string> out = {fmt::format("Identified from {}:", experiment.name)};
  for (const RecordResult& one : result.estimation) {
    out.push_back(fmt::format("  {}: position rms {:.3g} {}", one.record->record.name,
                              one.feedback_rms * 1e6, one.record->record.micro()));
  }
  const auto unidentifiable = unidentifiable_sentences(result);
  out.insert(out.end(), unidentifiable.begin(), unidentifiable.end());
  return out;
}

// One key of an estimate: a comment, a value that is held, or one with its uncertainty.
void add_key(const Experiment& experiment, const Identification& result, const MachineKey& key,
             std::vector<MachineKey>& keys, input::IdentifiedFile& out) {
  const Estimate& one = result.estimates[key.estimate];
  const std::string unit = one.unit.empty() ? std::string(input::kPlainNumber) : one.unit;
  if (one.record != Estimate::kAllRecords) {
    out.comments.push_back(fmt::format("{} of {}: {:.6g} {}, of this recording alone", key.key,
                                       experiment.records[one.record].record.name, one.start,
                                       one.unit));
  } else if (one.is_at_bound()) {
    out.held.push_back({key.key, unit, one.start, "at its bound"});
  } else if (!result.uncertainty.identifiable[key.estimate]) {
    out.identified.unidentifiable.push_back(key.key);
  } else {
    keys.push_back(key);
    out.identified.keys.push_back(key.key);
    out.identified.units.push_back(unit);
    out.identified.values.push_back(one.start);
  }
}

}  // namespace

input::IdentifiedFile identified_machine(const Experiment& experiment, const Identification& result,
                                         const std::string& path) {
  refuse_faults(experiment, result, path);
  input::IdentifiedFile out;
  out.based_on = input::machine_seen_from(path, experiment.machine_path);
  out.comments = comments(experiment, result);
  std::vector<MachineKey> keys;
  for (std::size_t k = 0; k < result.estimates.size(); ++k) {
    for (const std::string& key : result.estimates[k].keys) {
      if (!key.starts_with("loop.")) add_key(experiment, result, {key, k}, keys, out);
    }
  }
  if (keys.empty()) {
    throw InputError({path}, "not written: the recordings identify no value of the machine");
  }
  const auto count = static_cast<Eigen::Index>(keys.size());
  out.identified.covariance.resize(count, count);
  for (Eigen::Index a = 0; a < count; ++a) {
    for (Eigen::Index b = 0; b < count; ++b) {
      out.identified.covariance(a, b) = result.uncertainty.covariance(
          static_cast<Eigen::Index>(keys[static_cast<std::size_t>(a)].estimate),
          static_cast<Eigen::Index>(keys[static_cast<std::size_t>(b)].estimate));
    }
  }
  return out;
}

}  // namespace servomill::sim::identification
