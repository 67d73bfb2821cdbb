#include "sim/servo_axes.h"

#include <fmt/format.h>

#include <utility>

#include "plant/vocabulary/units.h"

namespace servomill::sim {
namespace {

std::vector<plant::FeedDriveParams> drives_of(const MachineSettings& machine,
                                              const std::vector<int>& joints) {
  std::vector<plant::FeedDriveParams> drives;
  for (const int j : joints) drives.push_back(machine.drives[static_cast<std::size_t>(j)]);
  return drives;
}

std::string_view name_of(controllers::AxisFaultKind fault) {
  switch (fault) {
    case controllers::AxisFaultKind::following_error:
      return "following error";
    case controllers::AxisFaultKind::standstill:
      return "position at standstill";
    case controllers::AxisFaultKind::encoder_difference:
      break;
  }
  return "difference of scale and motor encoder";
}

std::string overspeed(std::string_view name, const plant::Encoder& encoder, double velocity) {
  constexpr double kHzPerkHz = 1e3;
  return fmt::format("signals of the {} at {:.4g} kHz, beyond the {:.4g} kHz of the input", name,
                     encoder.signal_frequency(velocity) / kHzPerkHz,
                     encoder.frequency_limit() / kHzPerkHz);
}

}  // namespace

std::vector<Rate> loop_rates(const LoopPeriods& p, Tick reading_delay) {
  const Tick phase = (p.position - reading_delay % p.position) % p.position;
  return {{kSample, p.position, phase},
          {kPositionLoop, p.position, 0},
          {kVelocityLoop, p.velocity, 0},
          {kCurrentLoop, p.current, 0}};
}

std::vector<Tick> steps_of(const std::vector<Instant>& schedule) {
  std::vector<Tick> steps;
  for (const Instant& instant : schedule) steps.push_back(instant.step);
  return steps;
}

ServoAxes::ServoAxes(const MachineSettings& machine, std::vector<int> joints,
                     const std::vector<Instant>& schedule)
    : machine_(machine),
      joints_(std::move(joints)),
      drives_(drives_of(machine, joints_), machine.nc.periods.base,
              machine.integrator == Integrator::exact ? steps_of(schedule) : std::vector<Tick>()),
      state_(joints_.size()),
      input_(joints_.size()) {
  for (std::size_t n = 0; n < joints_.size(); ++n) drive_lane_[lane(joints_[n])] = n;
  if (machine.integrator == Integrator::cvode) {
    cvode_.emplace(drives_of(machine, joints_), machine.nc.periods.base);
  }
}

void ServoAxes::settle(const Joints& Q, const Eigen::Vector3d& displacement) {
  std::vector<double> x;
  for (const int j : joints_) x.push_back(Q[j]);
  state_ = drives_.at_rest(x);
  for (const int j : joints_) {
    const plant::FeedDriveParams& params = machine_.drives[lane(j)];
    const AxisFunctions& functions = machine_.nc.functions[lane(j)];
    const controllers::CascadeParams& cascade = machine_.nc.cascade[lane(j)];
    const double i = drive().i[drive_lane(j)];
    const auto current = params.has_winding()
                             ? controllers::standing_at(functions.current_loop, i, params.R * i)
                             : controllers::StandingCurrent{i, {}};
    drive().x[drive_lane(j)] -= controllers::standing_error(cascade, current.i_cmd);
    const double phi = motor_reading(j);
    const double d = j < kLinearJoints ? displacement[j] : 0.0;
    Loop& loop = loops_[lane(j)];
    loop = {};
    loop.cascade = controllers::standing_at(cascade, phi, current.i_cmd);
    loop.current = current.state;
    input_.blocks.front().command[drive_lane(j)] = params.has_winding() ? loop.current.u : i;
    loop.feedback =
        controllers::standing_at(functions.position_feedback, params.r * phi,
                                 machine_.scale[lane(j)].read(drive().x[drive_lane(j)]) + d);
    if (const auto& marks = machine_.marks[lane(j)]) {
      loop.marks.emplace(plant::ReferenceMarks(marks->params), marks->allowed);
      loop.marks->start(drive().x[drive_lane(j)], drive().x[drive_lane(j)] + d);
    }
    take_reading(j, d);
    loop.backlash = controllers::standing_at(functions.backlash, Q_read_[j]);
    loop.supervision = controllers::standing_at(
        functions.supervision, {Q_read_[j], 0.0, Q_read_[j], loop.y_motor, loop.y_scale});
  }
}

double ServoAxes::motor_reading(int joint) const {
  const plant::ScrewError& screw = machine_.screw[lane(joint)];
  const double phi =
      screw.is_zero()
          ? drives_.motor_angle(state_, drive_lane(joint))
          : plant::motor_angle(screw, machine_.drives[lane(joint)].r,
                               drive().delta[drive_lane(joint)] + drive().x[drive_lane(joint)],
                               machine_.nc.periods.seconds(now_));
  return machine_.motor[lane(joint)].read(phi, now_);
}

double ServoAxes::scale_reading(int joint) const {
  return machine_.scale[lane(joint)].read(drive().x[drive_lane(joint)], now_);
}

Joints ServoAxes::scale_reading() const {
  Joints Q = Joints::Zero();
  for (const int j : joints_) Q[j] = scale_reading(j);
  return Q;
}

void ServoAxes::take_reading(int joint, double displacement) {
  Loop& loop = loops_[lane(joint)];
  loop.y_scale = scale_reading(joint) + displacement + injected_[lane(joint)].reading;
  loop.y_motor = machine_.drives[lane(joint)].r * motor_reading(joint);
  if (loop.marks && !loop.mark_fault) {
    const double x = drive().x[drive_lane(joint)];
    loop.mark_fault = loop.marks->advance(x, x + displacement);
  }
  Q_read_[joint] =
      controllers::position_feedback(machine_.nc.functions[lane(joint)].position_feedback,
                                     loop.feedback, loop.y_motor, loop.y_scale);
}

void ServoAxes::take_reading(const Eigen::Vector3d& displacement) {
  for (const int j : joints_) take_reading(j, j < kLinearJoints ? displacement[j] : 0.0);
}

void ServoAxes::run_position_loops(const AxisSetPoint& set) {
  for (const int j : joints_) {
    const AxisFunctions& functions = machine_.nc.functions[lane(j)];
    Loop& loop = loops_[lane(j)];
    double v_add = 0.0;
    if (functions.backlash.width != 0.0) {
      const auto ramp =
          controllers::backlash_compensation(functions.backlash, loop.backlash, set.Q_cmd[j]);
      // only the motor cannot see the gap; the other loops gain the time
      const bool unseen = functions.position_feedback.kind == controllers::PositionFeedback::motor;
      // counted off its reading, so that the gap is no following error
      if (unseen) {
        Q_read_[j] -= ramp.offset;
      } else {
        v_add = ramp.rate;
      }
    }
    loop.dq_ff = set.dQ_ff[j];
    controllers::position_loop(machine_.nc.cascade[lane(j)], loop.cascade, set.Q_cmd[j], Q_read_[j],
                               set.dQ_ff[j], set.ddQ_ff[j], v_add);
  }
}

void ServoAxes::run_current_loops() {
  for (const int j : joints_) {
    Loop& loop = loops_[lane(j)];
    controllers::latch_current_command(loop.cascade);
    const double i_cmd = loop.cascade.i_cmd + injected_[lane(j)].current;
    if (machine_.drives[lane(j)].has_winding()) {
      controllers::current_loop(machine_.nc.functions[lane(j)].current_loop, loop.current, i_cmd,
                                drive().i[drive_lane(j)]);
      input_.blocks.front().command[drive_lane(j)] = loop.current.u;
    } else {
      input_.blocks.front().command[drive_lane(j)] = i_cmd;
    }
  }
}

void ServoAxes::run_velocity_loops() {
  for (const int j : joints_) {
    const controllers::CascadeParams& cascade = machine_.nc.cascade[lane(j)];
    const auto& friction = machine_.nc.functions[lane(j)].friction;
    Loop& loop = loops_[lane(j)];
    double tau = 0.0;
    if (friction.compensates()) {  // in lag mode the axis reverses with its speed command
      tau = controllers::friction_compensation(friction, loop.friction,
                                               cascade.kvf > 0.0 ? loop.dq_ff : loop.cascade.v_cmd);
    }
    const double phi = motor_reading(j), v_cmd = loop.cascade.v_cmd;
    loop.cascade.v_cmd += injected_[lane(j)].velocity;
    speed_read_[j] = (phi - loop.cascade.phi) / cascade.Tv;
    speed_error_[j] = loop.cascade.v_cmd / cascade.r - speed_read_[j];
    const bool voltage_limited = machine_.drives[lane(j)].has_winding() && loop.current.limited;
    controllers::velocity_loop(cascade, loop.cascade, phi, tau, voltage_limited);
    loop.cascade.v_cmd = v_cmd;
  }
}

double ServoAxes::motor_speed(int joint) const {
  const plant::FeedDriveParams& params = machine_.drives[lane(joint)];
  return params.is_rigid() ? drive().v[drive_lane(joint)] / params.r : drive().w[drive_lane(joint)];
}

Joints ServoAxes::motor_speed() const {
  Joints w = Joints::Zero();
  for (const int j : joints_) w[j] = motor_speed(j);
  return w;
}

void ServoAxes::inject(int joint, const Injection& injection) {
  injected_[lane(joint)] = injection;
  input_.blocks.front().F[drive_lane(joint)] = -injection.force;
}

std::optional<std::string> ServoAxes::supervise(int joint, const AxisSetPoint& set) {
  const bool linear = joint < kLinearJoints;
  const double unit = linear ? mm : deg;
  const std::string_view unit_name = linear ? "mm" : "deg";
  Loop& loop = loops_[lane(joint)];
  const auto fault = controllers::supervise(
      machine_.nc.functions[lane(joint)].supervision, loop.supervision,
      {set.Q_cmd[joint], set.dQ_ff[joint], Q_read_[joint], loop.y_motor, loop.y_scale});
  if (fault) {
    return fmt::format("{} beyond {:g} {}", name_of(fault->fault), fault->limit / unit, unit_name);
  }
  if (loop.mark_fault) {
    const plant::MarkFault& mark = *loop.mark_fault;
    if (mark.from == mark.to) {
      return fmt::format(
          "counted {} signal periods until the reference mark at {:.3f} {} came again",
          mark.counted, mark.from / unit, unit_name);
    }
    return fmt::format(
        "counted {} signal periods instead of {} between the reference marks at {:.3f} and {:.3f} "
        "{}",
        mark.counted, mark.expected, mark.from / unit, mark.to / unit, unit_name);
  }
  if (plant::DriveBank::unresolved(state_, drive_lane(joint)) > 0) {
    return "friction too stiff for the exact step; use integrator = \"cvode\"";
  }
  const plant::Encoder& scale = machine_.scale[lane(joint)];
  const plant::Encoder& motor = machine_.motor[lane(joint)];
  const double w = motor_speed(joint);
  if (scale.too_fast(drive().v[drive_lane(joint)]))
    return overspeed("scale", scale, drive().v[drive_lane(joint)]);
  if (motor.too_fast(w)) return overspeed("motor encoder", motor, w);
  return std::nullopt;
}

}  // namespace servomill::sim
