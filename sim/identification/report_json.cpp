#include <fmt/format.h>

#include <limits>
#include <string_view>

#include "plant/vocabulary/axes.h"
#include "sim/identification/experiment.h"
#include "sim/identification/identification.h"
#include "sim/identification/report.h"
#include "sim/system/json.h"

namespace servomill::sim::identification {
namespace {

using system::JsonObject;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// A value that the recordings do not determine has no interval.
std::string parameter_json(const Identification& result, std::size_t k) {
  const Estimate& one = result.estimates[k];
  const bool is_identifiable = result.uncertainty.identifiable[k];
  JsonObject out;
  out.raw("keys", system::json_texts(one.keys)).text("unit", one.unit.empty() ? "1" : one.unit);
  for (const RecordResult& record : result.estimation) {
    if (record.record->number == one.record) out.text("recording", record.record->record.name);
  }
  out.number("value", one.start).boolean("is_identifiable", is_identifiable);
  return out.number("U", is_identifiable ? 2.0 * result.uncertainty.standard(k) : kUnknown).line();
}

std::string record_json(const RecordResult& one, std::string_view use) {
  JsonObject out;
  out.text("recording", one.record->record.name)
      .text("use", use)
      .text("unit", one.record->joint < kLinearJoints ? "m" : "rad")
      .number("position_rms", one.feedback_rms);
  // 0: not recorded
  out.number("force_rms_share", one.force_rms > 0.0 ? one.force_rms : kUnknown);
  out.number("scale_rms", one.scale_rms > 0.0 ? one.scale_rms : kUnknown);
  return out.number("effective_samples", one.effective_samples).line();
}

std::string law_json(const LawResult& law) {
  if (!law.refused.empty()) {
    return JsonObject().text("law", law.name).text("refused", law.refused).line();
  }
  return JsonObject()
      .text("law", law.name)
      .integer("parameters", law.parameters)
      .number("rms", law.rms)
      .number("held_out_rms", law.held_out)
      .number("held_out_error", law.held_out_error)
      .number("bic", law.bic)
      .line();
}

}  // namespace

std::string report_json(const Identification& result) {
  std::vector<std::string> parameters, records, laws;
  for (std::size_t k = 0; k < result.estimates.size(); ++k) {
    parameters.push_back(parameter_json(result, k));
  }
  for (const RecordResult& one : result.estimation) {
    records.push_back(record_json(one, "estimation"));
  }
  for (const RecordResult& one : result.validation) {
    records.push_back(record_json(one, "validation"));
  }
  for (const LawResult& law : result.laws) laws.push_back(law_json(law));
  return JsonObject()
      .raw("parameters", system::json_list(parameters))
      .raw("recordings", system::json_list(records))
      .raw("laws", system::json_list(laws))
      .raw("undetermined", system::json_texts(unidentifiable_sentences(result)))
      .raw("warnings", system::json_texts(warnings(result)))
      .line();
}

}  // namespace servomill::sim::identification
