/// A run read back from its result file.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/evaluation/comparison.h"
#include "sim/evaluation/probed_part.h"
#include "sim/model/quantity_spec.h"
#include "sim/records/series.h"
#include "sim/run/day_comparison.h"

namespace servomill::sim::run {

/// A run read back.
struct StoredRun {
  std::string scenario_name, title;
  std::vector<std::unique_ptr<records::Series>> series;
  std::vector<std::unique_ptr<std::vector<evaluation::ProbedFeature>>> probes;
  std::vector<evaluation::CaseData> cases;      // point into `series` and `probes`
  std::vector<model::QuantitySpec> quantities;  // of the stored scenario
  std::vector<NamedDay> days;                   // of the cases that have one
};

/// @throws InputError if the file is none of ours or of another schema version
StoredRun read_run(const std::string& path);

}  // namespace servomill::sim::run
