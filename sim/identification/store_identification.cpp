#include "sim/identification/store_identification.h"

#include <fmt/format.h>

#include <vector>

#include "plant/vocabulary/axes.h"
#include "sim/identification/experiment.h"
#include "sim/identification/identification.h"
#include "sim/records/hdf5_group.h"
#include "sim/records/nexus.h"
#include "sim/records/output_file.h"

namespace servomill::sim::identification {
namespace {

void store_signals(records::Hdf5Group& group, const RecordResult& one) {
  const Record& r = one.record->record;
  group.attribute("recording", r.name);
  group.attribute("use", r.validation ? "validation" : "estimation");
  std::vector<double> time(r.size()), residual(r.size());
  for (std::size_t k = 0; k < r.size(); ++k) {
    time[k] = r.time(k);
    residual[k] = one.simulated.feedback[k] - r.feedback[k];
  }
  const std::string length = one.record->joint < kLinearJoints ? "m" : "rad";
  const std::string force = one.record->joint < kLinearJoints ? "N" : "N m";
  group.list("time", time, {"s", "time of the recording"});
  const auto signal = [&](const char* name, const std::vector<double>& values,
                          const std::string& unit, const char* meaning) {
    if (!values.empty()) group.list(name, values, {unit, meaning}, "time");
  };
  signal("command", r.command, length, "commanded position");
  signal("feedback", r.feedback, length, "position feedback as recorded");
  signal("simulated_feedback", one.simulated.feedback, length, "position feedback as simulated");
  signal("scale", r.scale, length, "position of the slide as recorded");
  if (!r.scale.empty()) {
    signal("simulated_scale", one.simulated.scale, length, "position of the slide as simulated");
  }
  signal("residual", residual, length, "simulated minus recorded position feedback");
  signal("force", r.force, force, "force of the drive as recorded");
  signal("simulated_force", one.simulated.force, force, "force of the drive as simulated");
  signal("disturbance_force", r.disturbance, force, "external force on the slide");
  records::make_nexus_data(group, {"residual", {"time"}, {}});
}

void store_colour(records::Hdf5Group& group, const AutoregressiveNoise& noise, double period,
                  const std::string& unit) {
  std::vector<double> lag(noise.autocovariance.size());
  for (std::size_t k = 0; k < lag.size(); ++k) lag[k] = period * static_cast<double>(k);
  group.list("lag", lag, {"s", "lag"});
  group.list("residual_autocovariance", noise.autocovariance,
             {unit, "autocovariance of the residual, as an autoregressive process"}, "lag");
}

void store_parameters(records::Hdf5Group group, const Identification& result) {
  records::make_nexus_group(group, "NXcollection");
  const std::size_t count = result.estimates.size();
  std::vector<double> number(count), value(count), half(count), counted(count), covariance;
  for (std::size_t k = 0; k < count; ++k) {
    number[k] = static_cast<double>(k);
    value[k] = result.estimates[k].start;
    half[k] = 2.0 * result.uncertainty.standard(k);
    counted[k] = 2.0 * result.uncertainty.counted[k];
    for (std::size_t j = 0; j < count; ++j) {
      covariance.push_back(result.uncertainty.covariance(static_cast<Eigen::Index>(k),
                                                         static_cast<Eigen::Index>(j)));
    }
    const Estimate& one = result.estimates[k];
    group.attribute(fmt::format("key_{:02}", k), one.keys.front());
    group.attribute(fmt::format("unit_{:02}", k), one.unit.empty() ? "1" : one.unit);
    group.attribute(fmt::format("identifiable_{:02}", k),
                    result.uncertainty.identifiable[k] ? "yes" : "no");
  }
  if (count == 0) return;
  group.counts("parameter", number, {"1", "number of the parameter: key_NN, unit_NN"});
  group.counts("other", number, {"1", "number of the other parameter"});
  group.list("value", value, {"as unit_NN", "identified value"}, "parameter");
  group.list("half_width", half, {"as unit_NN", "expanded uncertainty, k = 2"}, "parameter");
  group.list("half_width_counted", counted,
             {"as unit_NN", "the same, if all samples were independent"}, "parameter");
  group.table("covariance", count, covariance, {"products of the units", "covariance"}, "parameter",
              "other");
}

void store_laws(records::Hdf5Group group, const std::vector<LawResult>& laws) {
  std::vector<double> number, parameters, rms, held_out, error, bic;
  for (const LawResult& law : laws) {
    group.attribute(fmt::format("law_{:02}", number.size()), law.name);
    number.push_back(static_cast<double>(number.size()));
    parameters.push_back(static_cast<double>(law.parameters));
    rms.push_back(law.rms);
    held_out.push_back(law.held_out);
    error.push_back(law.held_out_error);
    bic.push_back(law.bic);
  }
  group.counts("law", number, {"1", "number of the law: law_NN"});
  group.counts("parameters", parameters, {"1", "estimated parameters"}, "law");
  group.list("rms", rms, {"m", "of the residual"}, "law");
  group.list("held_out_rms", held_out, {"m", "of segments excluded from the fit"}, "law");
  group.list("held_out_error", error, {"m", "standard error of held_out_rms"}, "law");
  group.list("bic", bic, {"1", "Bayesian information criterion, relative to the smallest"}, "law");
  records::make_nexus_data(group, {"rms", {"law"}, {"held_out_rms", "held_out_error"}});
}

}  // namespace

void store_identification(const Experiment& experiment, const Identification& result,
                          const std::string& path, bool force) {
  records::OutputFile file(path, force);
  file.remove_unless_committed();
  records::Hdf5Group root = file.root();
  records::make_nexus_group(root, "NXroot", "recording_001");
  root.attribute("kind", "identification");
  root.attribute("experiment", experiment.document.to_toml());
  root.attribute("name", experiment.name);
  store_parameters(root.group("parameters"), result);
  std::size_t number = 0;
  for (const auto* list : {&result.estimation, &result.validation}) {
    for (std::size_t k = 0; k < list->size(); ++k) {
      records::Hdf5Group group = root.group(fmt::format("recording_{:03}", ++number));
      store_signals(group, (*list)[k]);
      if (list != &result.estimation) continue;
      const std::string unit = (*list)[k].record->joint < kLinearJoints ? "m^2" : "rad^2";
      store_colour(group, result.uncertainty.noise[k], (*list)[k].record->record.period, unit);
    }
  }
  if (!result.laws.empty()) store_laws(root.group("laws"), result.laws);
  file.commit();
}

}  // namespace servomill::sim::identification
