#include "sim/frequency/stability.h"

#include <vector>

#include "sim/engine/servo_axes.h"
#include "sim/numerics/decompositions.h"

namespace servomill::sim::frequency {

model::MachineSettings linearised(const model::MachineSettings& machine) {
  model::MachineSettings linear = machine;
  linear.integrator = model::Integrator::exact;  // of a linear drive it is
  for (std::size_t j = 0; j < kJoints; ++j) {
    plant::FeedDriveParams& drive = linear.drives[j];
    drive.F_load = 0.0;
    drive.gap = 0.0;
    // what both directions have is linear
    drive.b_load += std::min(drive.friction.b_positive, drive.friction.b_negative);
    drive.friction = {};
    drive.cogging = {};
    linear.scale[j] = linear.motor[j] = {};
    linear.marks[j].reset();
    linear.screw[j] = {};
    linear.nc.cascade[j] = controllers::without_limits(linear.nc.cascade[j]);
    model::AxisFunctions& functions = linear.nc.functions[j];
    functions.current_loop.u_max = controllers::kNoLimit;
    functions.friction = {};
    functions.backlash = {};
    functions.supervision = {};
  }
  return linear;
}

std::shared_ptr<const model::MachineSettings> shared_linearised(
    const model::MachineSettings& machine) {
  return std::make_shared<const model::MachineSettings>(linearised(machine));
}

double spectral_radius(const model::MachineSettings& machine, int joint, Tick reading_delay) {
  const model::MachineSettings linear = linearised(machine);
  const std::vector<model::Instant> schedule =
      model::make_schedule(engine::loop_rates(machine.nc.periods, reading_delay));
  engine::ServoAxes axes(linear, {joint}, schedule);
  int states = 0;
  axes.each_state(joint, [&](double&) { ++states; });

  // one column for each state that is 1 at the beginning
  Eigen::MatrixXd monodromy(states, states);
  for (int column = 0; column < states; ++column) {
    axes.settle(Joints::Zero(), Joints::Zero());
    axes.follow({});
    int k = 0;
    axes.each_state(joint, [&](double& x) { x = k++ == column ? 1.0 : 0.0; });
    for (const model::Instant& instant : schedule) {
      if (instant.due & model::kFeedbackSample) axes.sample_position_feedback();
      if (instant.due & model::kPositionLoop) {
        axes.compensate_backlash();
        axes.close_position_loops();
      }
      if (instant.due & model::kCurrentLoop) axes.latch_current_commands();
      if (instant.due & model::kVelocityLoop) axes.close_velocity_loops();
      axes.advance(instant.step);
    }
    int row = 0;
    axes.each_state(joint, [&](double& x) { monodromy(row++, column) = x; });
  }
  return numerics::eigenvalues(monodromy).cwiseAbs().maxCoeff();
}

}  // namespace servomill::sim::frequency
