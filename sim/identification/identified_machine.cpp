#include "sim/identification/identified_machine.h"

#include <fmt/format.h>

#include "sim/identification/report.h"

namespace servomill::sim::identification {
namespace {

// One key of the machine and the estimate that gives its value.
struct MachineKey {
  std::string key;
  std::size_t estimate;
};

}  // namespace

input::IdentifiedFile identified_machine(const Experiment& experiment, const Identification& result,
                                         const std::string& path) {
  if (experiment.machine_path.empty()) {
    throw InputError({experiment.path},
                     "describes the machine itself; name a machine file (machine = \"FILE\") so "
                     "that the identified values can override it");
  }
  const std::vector<std::string> reasons = faults(result);
  if (!reasons.empty()) {
    std::vector<Fault> not_written;
    for (const std::string& one : reasons) not_written.push_back({{path}, "not written: " + one});
    throw InputError(std::move(not_written));
  }
  input::IdentifiedFile out;
  out.based_on = input::machine_seen_from(path, experiment.machine_path);
  out.comments.push_back(fmt::format("Identified from {}:", experiment.name));
  for (const RecordResult& one : result.estimation) {
    out.comments.push_back(fmt::format("  {}: position rms {:.3g} {}", one.record->record.name,
                                       one.feedback_rms * 1e6, one.record->record.micro()));
  }
  for (const std::string& sentence : unidentifiable_sentences(result))
    out.comments.push_back(sentence);
  std::vector<MachineKey> keys;
  for (std::size_t k = 0; k < result.estimates.size(); ++k) {
    const Estimate& one = result.estimates[k];
    for (const std::string& key : one.keys) {
      if (key.starts_with("loop.")) continue;
      if (one.record != Estimate::kAllRecords) {
        out.comments.push_back(fmt::format("{} of {}: {:.6g} {}, of this recording alone", key,
                                           experiment.records[one.record].record.name, one.start,
                                           one.unit));
        continue;
      }
      if (one.is_at_bound()) {
        out.held.push_back({key, one.unit.empty() ? std::string(input::kPlainNumber) : one.unit,
                            one.start, "at its bound"});
        continue;
      }
      if (!result.uncertainty.identifiable[k]) {
        out.identified.unidentifiable.push_back(key);
        continue;
      }
      keys.push_back({key, k});
      out.identified.keys.push_back(key);
      out.identified.units.push_back(one.unit.empty() ? std::string(input::kPlainNumber)
                                                      : one.unit);
      out.identified.values.push_back(one.start);
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
