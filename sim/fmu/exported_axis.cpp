#include "sim/fmu/exported_axis.h"

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

}  // namespace servomill::sim::fmu
