/// Speed of a whole case and of its parts. The figure that counts is `x_real_time`, simulated
/// seconds for one second of processor time; the parts say where the rest goes.

#include <benchmark/benchmark.h>

#include <string>

#include "plant/drives/drive_bank.h"
#include "plant/geometry/volumetric.h"
#include "sim/input/read_scenario.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/prepared_case.h"
#include "sim/run/run.h"
#include "sim/run/run_case.h"

namespace servomill::sim {
namespace {

const model::Scenario& experiment1() {
  static const model::Scenario kScenario =
      input::read_scenario(SERVOMILL_SOURCE_DIR "/scenarios/guevel2025/experiment1.toml");
  return kScenario;
}

// One case of experiment 1: CC424, 10 us base tick, recorded at 1 ms.
void BM_Case(benchmark::State& state, const char* name) {
  const model::CaseSpec& spec = *experiment1().find_case(name);
  const engine::StopFlag stop = false;
  double simulated = 0.0;
  for (auto _ : state) {
    preparation::PreparedCase prepared(experiment1(), spec);
    std::atomic<float> progress = 0.0F;
    simulated += run::run_case(prepared, stop, progress).result.simulated_time;
  }
  state.counters["x_real_time"] = benchmark::Counter(simulated, benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(BM_Case, nominal, "nominal")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Case, table, "table")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Case, feedback, "feedback")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Case, feedback_lead, "feedback_lead")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Case, gcode, "gcode")->Unit(benchmark::kMillisecond);

// Reading, rewriting, printing, reading again and planning, without the simulation.
void BM_Prepare(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        preparation::PreparedCase(experiment1(), *experiment1().find_case("gcode")));
  }
}
BENCHMARK(BM_Prepare)->Unit(benchmark::kMillisecond);

// All five drives over one instant of the schedule.
void BM_DriveBank(benchmark::State& state) {
  const model::MachineSettings& machine = experiment1().machine;
  const std::vector<Tick> steps = {4};
  const plant::DriveBank bank(machine.drives, 10e-6, steps);
  plant::DriveState drives = bank.at_rest(std::vector<double>(kJoints, 0.1));
  plant::DriveInput input(kJoints);
  input.blocks[0].command = drives.blocks[0].i;
  for (auto _ : state) {
    bank.advance(drives, input, 4);
    benchmark::DoNotOptimize(drives);
  }
}
BENCHMARK(BM_DriveBank);

// The same joints with friction, in motion: one step of 100 us. `speed` is in mm/s (100 mrad/s).
void BM_DriveBankWithFriction(benchmark::State& state, plant::FrictionKind kind, double speed) {
  const model::MachineSettings& machine = experiment1().machine;
  auto params = machine.drives;
  for (plant::FeedDriveParams& p : params) {
    p.friction = {.kind = kind,
                  .Fc_positive = 0.6 * p.slide_mass(),
                  .Fc_negative = 0.6 * p.slide_mass(),
                  .Fs_positive = 0.75 * p.slide_mass(),
                  .Fs_negative = 0.75 * p.slide_mass(),
                  .vs = 2e-3,
                  .v0 = 1e-4,
                  .sigma0 = 6e4 * p.slide_mass(),
                  .sigma1 = 40.0 * p.slide_mass()};
  }
  constexpr Tick kTicks = 10, kPeriod = 400;
  const std::vector<Tick> steps = {kTicks};
  const plant::DriveBank bank(params, 10e-6, steps);
  plant::DriveState start = bank.at_rest(std::vector<double>(kJoints, 0.1));
  plant::DriveBlock& block = start.blocks[0];
  block.v.fill(speed);
  for (std::size_t j = 0; j < kJoints; ++j) {
    block.w[j] = speed / params[j].r;
    block.z[j] = speed > 0.02 ? params[j].friction.Fc_positive / params[j].friction.sigma0 : 0.0;
    block.i[j] += params[j].r * 0.6 * params[j].slide_mass() / params[j].Kt;
  }
  plant::DriveInput input(kJoints);
  input.blocks[0].command = block.i;
  plant::DriveState drives = start;
  int n = 0;
  for (auto _ : state) {
    if (n++ % kPeriod == 0) drives = start;
    bank.advance(drives, input, kTicks);
    benchmark::DoNotOptimize(drives);
  }
}
#define BENCH_FRICTION(kind)                                                                   \
  BENCHMARK_CAPTURE(BM_DriveBankWithFriction, kind##_gliding, plant::FrictionKind::kind, 0.1); \
  BENCHMARK_CAPTURE(BM_DriveBankWithFriction, kind##_in_zone, plant::FrictionKind::kind, 0.002)
BENCH_FRICTION(none);
BENCH_FRICTION(set_valued);
BENCH_FRICTION(regularised);
BENCH_FRICTION(lugre);
#undef BENCH_FRICTION

// Evaluation of the feedback hardware, every 60 us.
void BM_ErrorModel(benchmark::State& state) {
  const plant::VolumetricModel model(experiment1().machine.chain,
                                     experiment1().errors.at("imposed"));
  Joints Q = Joints::Zero();
  for (auto _ : state) {
    Q[0] += 1e-9;
    benchmark::DoNotOptimize(model.joint_offset(Q, {0.0, 0.0, -0.11}));
  }
}
BENCHMARK(BM_ErrorModel);

}  // namespace
}  // namespace servomill::sim
