/// Accessors to a scenario for sources that do not include sim/model/scenario.h.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sim/model/forward.h"

namespace servomill::plant {
struct ErrorModel;  // plant/geometry/error_model.h
}  // namespace servomill::plant

namespace servomill::sim::model {

struct UncertainErrors;  // sim/model/tip_uncertainty.h

const std::string& name_of(const Scenario& scenario);
const std::string& title_of(const Scenario& scenario);
const MachineSettings& machine_of(const Scenario& scenario);
/// Its error models, by name.
const std::map<std::string, plant::ErrorModel>& errors_of(const Scenario& scenario);

/// Identified errors of its machine, where a quantity needs them; or none.
std::shared_ptr<const UncertainErrors> uncertain_errors_of(const Scenario& scenario);

std::vector<std::string> case_names(const Scenario& scenario);

/// True if its recording is limited to windows.
bool has_windows(const Scenario& scenario);

bool has_day(const Scenario& scenario);

}  // namespace servomill::sim::model
