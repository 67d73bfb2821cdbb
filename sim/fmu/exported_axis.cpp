#include "sim/fmu/exported_axis.h"

#include <optional>
#include <string>

#include "plant/vocabulary/input_error.h"
#include "sim/model/scenario.h"

namespace servomill::sim::fmu {

AxisConstants exported_axis(const model::Scenario& scenario, int joint, Tick reading_delay) {
  AxisConstants axis;
  axis.scenario = scenario.name;
  axis.joint = joint;
  axis.axis = scenario.machine.chain.layout.letter_of(joint);
  axis.reading_delay = reading_delay;
  axis.record_period = scenario.record_period;
  axis.machine = scenario.machine;
  return axis;
}

KinematicConstants exported_kinematics(const model::Scenario& scenario) {
  std::optional<std::string> model;
  for (const model::CaseSpec& one : scenario.cases) {
    const std::string its = one.machine_errors.value_or(scenario.machine_errors);
    if (model && *model != its) {
      throw InputError({"--case"}, "is needed: the errors of the machine differ between the cases");
    }
    model = its;
  }
  KinematicConstants out;
  out.chain = scenario.machine.chain;
  if (model && !model->empty()) out.errors = scenario.errors.at(*model);
  return out;
}

}  // namespace servomill::sim::fmu
