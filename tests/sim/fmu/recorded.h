/// Setpoints and recording of a case, for the same axis outside of the run.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/engine/reference.h"
#include "sim/engine/setpoint.h"
#include "sim/engine/simulate.h"
#include "sim/fmu/axis_simulation.h"
#include "sim/model/scenario.h"
#include "sim/preparation/prepared_case.h"

namespace servomill::sim::fmu {

inline constexpr Tick kPosition = 20;  // ticks, of the position loop of the HSM 600U

struct Recorded {
  std::vector<engine::AxisSetpoint> setpoints;  // one a position period; before it: at rest
  engine::CaseResult result;
};

inline Recorded recorded_of(const model::Scenario& scenario, const std::string& name) {
  const preparation::PreparedCase prepared(scenario, *scenario.find_case(name));
  Recorded out;
  engine::CaseInputs in = prepared.inputs();
  engine::Setpoint setpoint(scenario.machine.nc, in.reference, std::move(in.setpoints));
  out.setpoints.push_back(setpoint.settle());
  engine::References references;
  engine::Reference& reference = references.of(in.reference, 0.0);
  const double end = in.reference.duration() + in.settle_time + 1 * ms;
  for (Tick n = 0; scenario.machine.nc.periods.seconds(n) < end; n += kPosition) {
    const double t = scenario.machine.nc.periods.seconds(n);
    out.setpoints.push_back(setpoint.advance(reference.at(t), t));
  }
  engine::CaseInputs inputs = prepared.inputs();
  std::atomic<float> progress = 0.0F;
  out.result = engine::simulate(inputs, engine::StopFlag(false), progress);
  EXPECT_TRUE(out.result.outcome.finished) << out.result.outcome.reason;
  return out;
}

/// Inputs of an axis in the position period that begins at tick n or before.
inline AxisInputs inputs_at(const Recorded& recorded, Tick n, int joint) {
  const engine::AxisSetpoint& set =
      recorded.setpoints.at(static_cast<std::size_t>(n / kPosition) + 1);
  return {set.Q_cmd[joint], set.dQ_ff[joint], set.ddQ_ff[joint], 0.0, 0.0};
}

inline AxisInputs at_rest(const Recorded& recorded, int joint) {
  return {.setpoint = recorded.setpoints.front().Q_cmd[joint]};
}

}  // namespace servomill::sim::fmu
