#include "sim/engine/servo_axes.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "plant/vocabulary/units.h"

namespace servomill::sim::engine {
namespace {

std::vector<plant::FeedDriveParams> params_of(
    const std::vector<const model::MachineSettings*>& machines, const std::vector<int>& joints) {
  std::vector<plant::FeedDriveParams> params;
  for (const int j : joints) {
    for (const model::MachineSettings* machine : machines) {
      params.push_back(machine->drives[static_cast<std::size_t>(j)]);
    }
  }
  return params;
}

}  // namespace

const ServoKernel& servo_kernel() {
  static const ServoKernel kKernel =
      at_simd_level(simd_level(), []<SimdLevel level>() { return make_servo_kernel<level>(); });
  return kKernel;
}

ServoAxes::ServoAxes(std::vector<const model::MachineSettings*> machines, std::vector<int> joints,
                     const std::vector<model::Instant>& schedule, plant::PreparedDrives* kept)
    : machines_(std::move(machines)),
      joints_(std::move(joints)),
      places_(machines_.size()),
      in_a_row_(machines_.size() == 1 && joints_.size() == kJoints),
      blocks_of_joint_(fills_blocks() && joints_.size() == kJoints ? runs() / kLaneWidth : 0),
      params_(params_of(machines_, joints_)),
      drive_steps_(machines_[0]->integrator == model::Integrator::exact ? drive_steps(schedule)
                                                                        : drive_steps(schedule, 0)),
      last_leg_(drive_steps_.legs.empty() ? 0 : drive_steps_.legs.size() - 1),
      positions_(drive_steps_.most_stops * blocks_of(params_.size())),
      drives_(params_, machines_[0]->nc.periods.base,
              machines_[0]->integrator == model::Integrator::exact ? drive_steps_.steps
                                                                   : std::vector<Tick>(),
              kept, simd_level(), drive_steps_.stretches),
      blocks_(blocks_of(params_.size())),
      state_(params_.size()),
      input_(params_.size()),
      constants_(blocks_),
      servo_inputs_(blocks_),
      servo_state_(blocks_),
      functions_(params_.size()),
      kernel_(servo_kernel()) {
  for (const int j : joints_) {
    first_lane_[static_cast<std::size_t>(j)] = axes_.size();
    for (std::size_t run = 0; run < machines_.size(); ++run) {
      const std::size_t l = axes_.size();
      places_[run][static_cast<std::size_t>(j)] = {block(l), place(l), true};
      axes_.push_back({run, j});
    }
  }
  assert(std::is_sorted(joints_.begin(), joints_.end()));
  linear_joints_ = static_cast<std::size_t>(std::count_if(
      joints_.begin(), joints_.end(), [](int joint) { return joint < kLinearJoints; }));
  if (machines_[0]->integrator == model::Integrator::cvode) {
    cvode_.emplace(params_, machines_[0]->nc.periods.base);
  }
  for (std::size_t l = 0; l < axes_.size(); ++l) describe(l);
}

void ServoAxes::describe(std::size_t l) {
  const model::MachineSettings& machine = machine_of(l);
  const auto j = static_cast<std::size_t>(axes_[l].joint);
  const model::AxisFunctions& functions = machine.nc.functions[j];
  const auto set = [&](auto member, double value) { at(member, l) = value; };
  const auto encoder = [](double step) { return step > 0.0 ? 1.0 / step : 0.0; };
  set(&ServoConstants::r, params_[l].r);
  set(&ServoConstants::per_r, 1.0 / params_[l].r);
  set(&ServoConstants::motor_step, machine.motor[j].step());
  set(&ServoConstants::per_motor_step, encoder(machine.motor[j].step()));
  set(&ServoConstants::scale_step, machine.scale[j].step());
  set(&ServoConstants::per_scale_step, encoder(machine.scale[j].step()));
  set(&ServoConstants::reads_scale,
      functions.position_feedback.kind == controllers::PositionFeedback::scale ? 1.0 : 0.0);
  set(&ServoConstants::feedback_gain, functions.position_feedback.gain);
  set(&ServoConstants::has_winding, params_[l].has_winding() ? 1.0 : 0.0);
  ServoConstants& servo = constants_[block(l)];
  set_lane(servo.cascade, place(l), gains_of(machine.nc.cascade[j]));
  const controllers::CurrentLoopGains current = gains_of(functions.current_loop);
  servo.current.Kp[place(l)] = current.Kp;
  servo.current.Ki_Ti[place(l)] = current.Ki_Ti;
  servo.current.u_max[place(l)] = current.u_max;

  const controllers::SupervisionParams& supervision = functions.supervision;
  const bool rigid = params_[l].is_rigid();  // the motor turns as the slide moves
  set(&ServoConstants::rigid, rigid ? 1.0 : 0.0);
  set(&ServoInputs::most_following_error, supervision.following_error);
  set(&ServoInputs::most_speed,
      std::min(machine.scale[j].fastest(),
               rigid ? params_[l].r * machine.motor[j].fastest() : controllers::kNoLimit));
  set(&ServoInputs::most_motor_speed, rigid ? controllers::kNoLimit : machine.motor[j].fastest());
  always_checked_lanes_.push_back(supervision.standstill < controllers::kNoLimit ||
                                  supervision.encoder_difference < controllers::kNoLimit ||
                                  machine.marks[j].has_value());

  always_checked_ |= always_checked_lanes_.back();
  if (!params_[l].is_linear()) in_sub_steps_.push_back(l);
  if (!machine.motor[j].is_plain() || !machine.screw[j].is_zero()) own_motor_reading_.push_back(l);
  if (!machine.scale[j].is_plain()) own_scale_reading_.push_back(l);
  if (machine.marks[j]) marked_.push_back(l);
  if (functions.backlash.width != 0.0) with_backlash_.push_back(l);
  if (functions.friction.compensates()) with_friction_.push_back(l);
}

void ServoAxes::settle(const Joints& Q, const Joints& displacement, std::size_t run) {
  displace(displacement, run);
  for (const int j : joints_) settle(lane(run, j), Q[j], displacement[j]);
}

// Steady state of one axis: the current balances the gravity load, integral parts hold that
// current, and without them the slide is off by the standing error, so that the first tick causes
// no motion.
void ServoAxes::settle(std::size_t l, double Q, double d) {
  const model::MachineSettings& machine = machine_of(l);
  const auto j = static_cast<std::size_t>(axes_[l].joint);
  const plant::FeedDriveParams& drive = params_[l];
  const model::AxisFunctions& functions = machine.nc.functions[j];
  const controllers::CascadeParams& cascade = machine.nc.cascade[j];
  plant::LaneState state = plant::at_rest(drive, Q);
  const auto current = drive.has_winding() ? controllers::standing_at(functions.current_loop,
                                                                      state.i, drive.R * state.i)
                                           : controllers::StandingCurrent{state.i, {}};
  state.x -= controllers::standing_error(cascade, current.i_cmd);
  state_.set_lane(l, state);
  const double phi = motor_reading(l), scale = scale_reading(l, state.x, now_);
  const double y_motor = drive.r * phi, y_scale = scale + d;
  auto feedback = controllers::standing_at(functions.position_feedback, y_motor, y_scale);
  const double Q_fb =
      controllers::position_feedback(functions.position_feedback, feedback, y_motor, y_scale);

  ServoState& servo = servo_state_[block(l)];
  set_lane(servo.cascade_state, place(l), controllers::standing_at(cascade, phi, current.i_cmd));
  servo.current_state.integral[place(l)] = current.state.integral;
  servo.current_state.u[place(l)] = current.state.u;
  servo.current_state.excess[place(l)] = 0.0;
  input_.blocks[block(l)].command[place(l)] = drive.has_winding() ? current.state.u : state.i;
  input_.blocks[block(l)].active[place(l)] = true;
  const auto set = [&](auto member, double value) { at(member, l) = value; };
  set(&ServoState::phi, phi);
  set(&ServoState::scale, scale);
  set(&ServoState::y_motor, y_motor);
  set(&ServoState::y_scale, y_scale);
  set(&ServoState::difference, feedback.difference);
  set(&ServoState::Q_fb, Q_fb);
  set(&ServoInputs::Q_cmd, Q_fb);
  for (const auto member :
       {&ServoInputs::dQ_ff, &ServoInputs::ddQ_ff, &ServoInputs::v_add, &ServoInputs::tau_add}) {
    set(member, 0.0);
  }
  Functions& own = functions_[l];
  own = {};
  if (const auto& marks = machine.marks[j]) {
    own.marks.emplace(plant::ReferenceMarks(marks->params), marks->allowed);
    own.marks->start(state.x, state.x + d);
  }
  own.backlash = controllers::standing_at(functions.backlash, Q_fb);
  own.supervision =
      controllers::standing_at(functions.supervision, {Q_fb, 0.0, Q_fb, y_motor, y_scale});
}

void ServoAxes::displace(const Joints& displacement, std::size_t run) {
  if (in_a_row_) {
    row(&ServoInputs::virtual_displacement) = displacement;
    return;
  }
  for (std::size_t j = 0; j < kJoints; ++j) {
    const Place& p = places_[run][j];
    if (p.present)
      servo_inputs_[p.block].virtual_displacement[p.place] = displacement[static_cast<int>(j)];
  }
}

void ServoAxes::displace(const JointLanes& displacement, const LaneFlags& lanes, bool rotary,
                         std::size_t first) {
  assert(first < runs() && first % kLaneWidth == 0);
  if (fills_blocks()) {
    return kernel_.displace(&servo_inputs_[block(first)], block(runs()), joints_.data(),
                            rotary ? joints_.size() : linear_joints_, lanes, displacement);
  }
  each_of_eight(first, [&](std::size_t n, std::size_t j, const Place& p) {
    if ((rotary || j < kLinearJoints) && lanes[n]) {
      servo_inputs_[p.block].virtual_displacement[p.place] = displacement[j][n];
    }
  });
}

void ServoAxes::get_readings(JointLanes& Q_meas, std::size_t first) const {
  assert(first < runs() && first % kLaneWidth == 0);
  if (fills_blocks()) {
    return kernel_.get_scales(&servo_state_[block(first)], block(runs()), joints_.data(),
                              joints_.size(), Q_meas);
  }
  each_of_eight(first, [&](std::size_t n, std::size_t j, const Place& p) {
    Q_meas[j][n] = servo_state_[p.block].scale[p.place];
  });
}

void ServoAxes::follow(const AxisSetpoint& set, std::size_t run) {
  if (in_a_row_) {
    row(&ServoInputs::Q_cmd) = set.Q_cmd;
    row(&ServoInputs::dQ_ff) = set.dQ_ff;
    row(&ServoInputs::ddQ_ff) = set.ddQ_ff;
    return;
  }
  if (blocks_of_joint_ > 0) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      ServoInputs& servo = servo_inputs_[block_of(j, run)];
      const auto joint = static_cast<int>(j);
      servo.Q_cmd[run % kLaneWidth] = set.Q_cmd[joint];
      servo.dQ_ff[run % kLaneWidth] = set.dQ_ff[joint];
      servo.ddQ_ff[run % kLaneWidth] = set.ddQ_ff[joint];
    }
    return;
  }
  for (const int j : joints_) {
    const std::size_t l = lane(run, j);
    at(&ServoInputs::Q_cmd, l) = set.Q_cmd[j];
    at(&ServoInputs::dQ_ff, l) = set.dQ_ff[j];
    at(&ServoInputs::ddQ_ff, l) = set.ddQ_ff[j];
  }
}

void ServoAxes::inject(int joint, const Injection& injection, std::size_t run) {
  const std::size_t l = lane(run, joint);
  at(&ServoInputs::added_velocity, l) = injection.velocity;
  at(&ServoInputs::added_current, l) = injection.current;
  at(&ServoInputs::added_reading, l) = injection.reading;
  input_.blocks[block(l)].F[place(l)] = -injection.force;
}

void ServoAxes::load(const Joints& forces, std::size_t run) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    const Place& p = places_[run][j];
    if (p.present) input_.blocks[p.block].F[p.place] = -forces[static_cast<int>(j)];
  }
}

void ServoAxes::end(std::size_t run) {
  for (const int j : joints_) {
    const std::size_t l = lane(run, j);
    input_.blocks[block(l)].active[place(l)] = false;
    // what it stands at is nobody's concern any more
    for (const auto limit : {&ServoInputs::most_following_error, &ServoInputs::most_speed,
                             &ServoInputs::most_motor_speed}) {
      at(limit, l) = controllers::kNoLimit;
    }
  }
}

Joints ServoAxes::ddQ_true(std::size_t run) const {
  Joints ddQ = Joints::Zero();
  for (const int j : joints_) {
    const std::size_t l = lane(run, j);
    const plant::DriveInputBlock& input = input_.blocks[block(l)];
    ddQ[j] = plant::slide_acceleration(params_[l], state_.lane(l), input.command[place(l)],
                                       input.F[place(l)]);
  }
  return ddQ;
}

double ServoAxes::motor_reading(std::size_t l) const {
  const model::MachineSettings& machine = machine_of(l);
  const auto j = static_cast<std::size_t>(axes_[l].joint);
  const plant::ScrewError& screw = machine.screw[j];
  const plant::LaneState s = state_.lane(l);
  const double phi = screw.is_zero() ? drives_.motor_angle(state_, l)
                                     : plant::motor_angle(screw, params_[l].r, s.delta + s.x,
                                                          machine.nc.periods.seconds(now_));
  return machine.motor[j].read(phi, now_);
}

double ServoAxes::scale_reading(std::size_t l, double x, Tick now) const {
  const auto j = static_cast<std::size_t>(axes_[l].joint);
  return machine_of(l).scale[j].read(x, now);
}

void ServoAxes::read_motors() {
  kernel_.read_motors(constants_.data(), servo_state_.data(), state_.blocks.data(), blocks_);
  for (const std::size_t l : own_motor_reading_) at(&ServoState::phi, l) = motor_reading(l);
}

void ServoAxes::read_scales() {
  kernel_.read_scales(constants_.data(), servo_state_.data(), state_.blocks.data(), blocks_);
  for (const std::size_t l : own_scale_reading_) {
    at(&ServoState::scale, l) = scale_reading(l, state_.blocks[block(l)].x[place(l)], now_);
  }
}

void ServoAxes::read_own_scales_at(const LaneArray* positions, Tick now) {
  for (const std::size_t l : own_scale_reading_) {
    at(&ServoState::scale, l) = scale_reading(l, positions[block(l)][place(l)], now);
  }
}

void ServoAxes::sample_position_feedback() {
  read_scales();
  read_motors();
  kernel_.sample_position_feedback(constants_.data(), servo_inputs_.data(), servo_state_.data(),
                                   blocks_);
  for (const std::size_t l : marked_) {
    Functions& own = functions_[l];
    if (own.mark_fault) continue;
    const double x = state_.blocks[block(l)].x[place(l)];
    own.mark_fault = own.marks->advance(x, x + at(&ServoInputs::virtual_displacement, l));
  }
}

void ServoAxes::compensate_backlash() {
  for (const std::size_t l : with_backlash_) {
    const model::AxisFunctions& functions =
        machine_of(l).nc.functions[static_cast<std::size_t>(axes_[l].joint)];
    const auto ramp = controllers::backlash_compensation(functions.backlash, functions_[l].backlash,
                                                         at(&ServoInputs::Q_cmd, l));
    // Only the motor cannot see the gap; the other loops gain the time. It is counted off the
    // motor's reading, so that the gap is no following error.
    if (functions.position_feedback.kind == controllers::PositionFeedback::motor) {
      at(&ServoState::Q_fb, l) -= ramp.offset;
    } else {
      functions_[l].backlash_velocity = at(&ServoInputs::v_add, l) = ramp.rate;
    }
  }
}

void ServoAxes::add_velocity(const Joints& velocity, std::size_t run) {
  for (const int j : joints_) {
    const std::size_t l = lane(run, j);
    at(&ServoInputs::v_add, l) = functions_[l].backlash_velocity + velocity[j];
  }
}

void ServoAxes::close_position_loops() {
  beyond_limits_ = kernel_.position_loops(constants_.data(), servo_inputs_.data(),
                                          servo_state_.data(), state_.blocks.data(), blocks_);
}

void ServoAxes::latch_current_commands() {
  kernel_.current_loops(constants_.data(), servo_inputs_.data(), servo_state_.data(),
                        state_.blocks.data(), input_.blocks.data(), blocks_);
}

void ServoAxes::close_velocity_loops() {
  for (const std::size_t l : with_friction_) {
    const model::NcSettings& nc = machine_of(l).nc;
    const auto j = static_cast<std::size_t>(axes_[l].joint);
    // in lag mode the axis reverses with its speed command
    const double v = nc.cascade[j].kvf > 0.0 ? at(&ServoInputs::dQ_ff, l)
                                             : servo_state_[block(l)].cascade_state.v_cmd[place(l)];
    at(&ServoInputs::tau_add, l) =
        controllers::friction_compensation(nc.functions[j].friction, functions_[l].friction, v);
  }
  read_motors();
  kernel_.velocity_loops(constants_.data(), servo_inputs_.data(), servo_state_.data(), blocks_);
}

Joints ServoAxes::motor_angle(std::size_t run) const {
  return each_joint(run, [&](const Place& p) {
    const plant::DriveBlock& state = state_.blocks[p.block];
    return (state.delta[p.place] + state.x[p.place]) * constants_[p.block].per_r[p.place];
  });
}

Joints ServoAxes::motor_speed(std::size_t run) const {
  return each_joint(run, [&](const Place& p) {
    const plant::DriveBlock& state = state_.blocks[p.block];
    const ServoConstants& servo = constants_[p.block];
    return servo.rigid[p.place] > 0.0 ? state.v[p.place] * servo.per_r[p.place] : state.w[p.place];
  });
}

Joints ServoAxes::measured_speed(std::size_t run) const {
  return each_joint(run,
                    [&](const Place& p) { return servo_state_[p.block].cascade_state.w[p.place]; });
}

Joints ServoAxes::speed_error(std::size_t run) const {
  return each_joint(run,
                    [&](const Place& p) { return servo_state_[p.block].cascade_state.e[p.place]; });
}

}  // namespace servomill::sim::engine
