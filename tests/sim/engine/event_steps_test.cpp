/// Stepping from event to event gives what stepping every tick gives.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "controllers/gcode/interpreter.h"
#include "plant/drives/drive_bank.h"
#include "plant/vocabulary/units.h"
#include "sim/engine/setpoint.h"
#include "sim/engine/simulate.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"
#include "strategies/registry.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::engine::event_steps_test {
namespace {

// A machine in five-axis motion with feedback hardware, tables and a strategy; encoders without
// steps, so that a difference of rounding stays one.
struct FiveAxisCase {
  model::MachineSettings machine =
      input::read_machine_file(SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml");
  strategies::IdentifiedMachine identified{machine.chain.layout,
                                           plant::VolumetricModel(machine.chain, errors())};
  std::vector<Move> moves = controllers::interpret(
      "G64 P0.01\nG1 X4 Y-3 Z2 B4 C-6 F3000\nX8 Y0 Z3 B2 C3\nM30\n", "p", {});
  controllers::Trajectory trajectory =
      controllers::plan(moves, machine.chain.layout, Joints::Zero(),
                        {machine.nc.v_max, machine.nc.a_max, machine.nc.j_max});
  ProgramPath path{moves, AxisWords::Zero()};
  std::map<int, Eigen::Vector3d> tips = {{0, Eigen::Vector3d::Zero()}};
  std::unique_ptr<strategies::Strategy> strategy;
  model::FeedbackHardware hardware{.connected = true, .signal_delay = 1, .model_period = 6};

  FiveAxisCase(Tick delay, Tick model_period) {
    hardware.signal_delay = delay;
    hardware.model_period = model_period;
    for (std::size_t j = 0; j < kJoints; ++j) {  // another reading at any other tick
      plant::EncoderParams noisy;
      noisy.position_noise = 20.0 * nm;
      machine.scale[j] =
          plant::Encoder(noisy, {.seed = 5, .stream = static_cast<std::uint32_t>(j)});
    }
    machine.motor.fill({});
    identified.Kv.setConstant(machine.nc.cascade[0].Kv);
    const strategies::Entry* entry = strategies::find("feedback");
    Parameters p;
    p.set("max_um", 500.0 * um);
    p.set("max_rate_mm_per_s", 10.0 * mm);
    p.set("extrapolation_time_ms", "auto");
    p.set("velocity_window_ms", 3.0 * ms);
    p.set("prediction", "lag");
    p.set("iterations", "1");
    p.set("axes", "linear");
    strategy = entry->make(p, strategies::Action::impose, identified);
  }

  static plant::ErrorModel errors() {
    plant::ErrorModel out;
    out.component({Axis::Y, Axis::X}) = plant::harmonic(50.0 * um, 10.0 * mm);
    out.component({Axis::Z, Axis::Y}) = plant::polynomial({0.0, 0.005});
    return out;
  }

  CaseInputs inputs() {
    CaseInputs out = {machine,
                      identified.model,
                      nullptr,
                      trajectory,
                      path,
                      tips,
                      model::ServoModel::cascade,
                      hardware,
                      {},
                      strategy.get(),
                      {},
                      100,
                      0.02};
    out.pieces = path.pieces_of(moves);
    return out;
  }
};

// The loop of DESIGN.md 4 as it is written there: every tick asks what is due.
std::vector<Joints> stepped_every_tick(FiveAxisCase& c) {
  const model::LoopPeriods& p = c.machine.nc.periods;
  const std::array<Tick, 1> one = {1};
  const plant::DriveBank drives(c.machine.drives, p.base, one);
  Setpoint setpoint(c.machine.nc, c.trajectory, {});
  controllers::Trajectory::Cursor cursor;
  const Tick model = c.hardware.model_period;
  const auto part = c.strategy->feedback(static_cast<double>(model) * p.base);
  const Joints Q_start = setpoint.settle().Q_cmd;
  plant::DriveState state = drives.at_rest({Q_start.data(), kJoints});
  plant::DriveInput input(kJoints);
  plant::DriveBlock& x = state.blocks.front();
  plant::DriveInputBlock& u = input.blocks.front();
  std::array<controllers::CascadeState, kJoints> loops;
  const auto positions = [&] { return Joints(Eigen::Map<const Joints>(x.x.data())); };
  const auto scales = [&](Tick n) {
    Joints Q;
    for (std::size_t j = 0; j < kJoints; ++j) {
      Q[static_cast<int>(j)] = c.machine.scale[j].read(x.x[j], n);
    }
    return Q;
  };
  Joints d_now = part->settle(positions());
  Joints Q_fb = scales(0) + d_now;
  for (std::size_t j = 0; j < kJoints; ++j) {
    loops[j].phi = drives.motor_angle(state, j);
    loops[j].i_next = loops[j].i_cmd = u.command[j] = x.i[j];
    loops[j].integral = x.i[j] * c.machine.nc.cascade[j].Kt;
  }
  std::vector<Joints> recorded;
  const auto end = static_cast<Tick>(std::ceil((c.trajectory.duration() + 0.02) / p.base));
  for (Tick n = 0; n <= end; ++n) {
    if (n % model == 0) d_now = part->advance(scales(n));
    if ((n + c.hardware.signal_delay) % p.position == 0) {
      Q_fb = scales(n) + d_now;
    }
    if (n % p.position == 0) {
      const AxisSetpoint& set = setpoint.advance(c.trajectory.at(p.seconds(n), cursor));
      for (int j = 0; j < kJoints; ++j) {
        const auto lane = static_cast<std::size_t>(j);
        controllers::position_loop(c.machine.nc.cascade[lane], loops[lane], set.Q_cmd[j], Q_fb[j],
                                   set.dQ_ff[j], set.ddQ_ff[j]);
      }
    }
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (n % p.current == 0) {
        controllers::latch_current_command(loops[j]);
        u.command[j] = loops[j].i_cmd;
      }
      if (n % p.velocity == 0) {
        controllers::velocity_loop(c.machine.nc.cascade[j], loops[j], drives.motor_angle(state, j));
      }
    }
    if (n % 100 == 0) recorded.push_back(positions());
    drives.advance(state, input, 1);
  }
  return recorded;
}

// The readings are taken with the error model or not, the drives pass none, few, or more instants
// of it than they have stops.
class Simulate : public testing::TestWithParam<std::pair<Tick, Tick>> {};

TEST_P(Simulate, FromEventToEventIsWhatEveryTickGives) {
  constexpr double kSameTol = 1e-12;  // m, rad
  FiveAxisCase one(GetParam().first, GetParam().second);
  const std::vector<Joints> wanted = stepped_every_tick(one);
  CaseInputs inputs = one.inputs();
  const StopFlag never = false;
  std::atomic<float> progress = 0.0F;
  const CaseResult result = simulate(inputs, never, progress);
  ASSERT_TRUE(result.outcome.finished) << result.outcome.reason;
  const records::Series& series = result.servo;
  ASSERT_EQ(series.rows(), wanted.size());
  ASSERT_GT(series.rows(), 200U);
  double largest = 0.0, way = 0.0;
  for (std::size_t n = 0; n < series.rows(); ++n) {
    for (int j = 0; j < kJoints; ++j) {
      const bool linear = j < kLinearJoints;
      const char axis = one.machine.chain.layout.letter_of(j);
      const auto column = series.column(linear ? "true_linear" : "true_rotary", axis).value();
      const double is = series.at(n, column) * (linear ? mm : deg);
      largest = std::max(largest, std::abs(is - wanted[n][j]));
      way = std::max(way, std::abs(is));
    }
  }
  RecordProperty("largest_difference", fmt::format("{:.3g}", largest));
  EXPECT_GT(way, 0.05);  // rad of C
  EXPECT_LT(largest, kSameTol);
}

INSTANTIATE_TEST_SUITE_P(DelayAndModelPeriod, Simulate,
                         testing::Values(std::pair<Tick, Tick>{1, 6}, std::pair<Tick, Tick>{2, 6},
                                         std::pair<Tick, Tick>{1, 1}, std::pair<Tick, Tick>{0, 7}));

}  // namespace
}  // namespace servomill::sim::engine::event_steps_test
