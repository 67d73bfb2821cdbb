/// The reference problem, from the blocks of which scenarios are built, next to a straightforward
/// loop in C (plain.c). What counts is `ns_per_item`, nanoseconds of processor time for one run and
/// one tick of 10 us of five axes, or for one pose; tools/bench makes ratios of it.

#include <benchmark/benchmark.h>

#include <unsupported/Eigen/MatrixFunctions>

#include "plant/kinematics/inverse.h"
#include "tests/bench/plain.h"
#include "tests/known_answers/reference_problem.h"

namespace servomill::reference_problem {
namespace {

constexpr Tick kTicks = 200'000;  // 2 s: each axis moves, stands and reverses

struct PlainProblem {
  std::array<PlainAxis, PLAIN_AXES> axes;
  double vol[21][4];
};

PlainProblem read_plain(const std::string& name, bool friction) {
  const sim::model::MachineSettings machine = read_machine(name, friction);
  PlainProblem problem;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const plant::FeedDriveParams& d = machine.drives[j];
    const controllers::CascadeParams& c = machine.nc.cascade[j];
    const controllers::CurrentLoopParams& u = machine.nc.functions[j].current_loop;
    PlainAxis& p = problem.axes[j];
    p = {d.L,
         d.R,
         d.Kt,
         d.Ke,
         d.J,
         d.b_motor,
         d.r,
         d.M,
         d.k,
         d.c,
         d.b_load,
         d.friction.Fc_positive,
         d.friction.Fs_positive,
         d.friction.vs,
         d.friction.v0,
         c.Kv,
         c.kvf,
         c.kaf,
         c.J,
         c.Kp,
         c.Ki * c.Tv,
         c.i_max,
         u.Kp,
         u.Ki * u.Ti,
         u.u_max,
         {},
         {}};
    // i, w, th, v, x: the matrix of `derivative` without friction
    Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
    A.row(0) << -d.R / d.L, -d.Ke / d.L, 0, 0, 0, 1.0 / d.L;
    A.row(1) << d.Kt, -d.r * d.r * d.c - d.b_motor, -d.r * d.r * d.k, d.r * d.c, d.r * d.k, 0;
    A.row(1) /= d.J;
    A(2, 1) = 1.0;
    A.row(3) << 0, d.c * d.r, d.k * d.r, -d.c - d.b_load, -d.k, 0;
    A.row(3) /= d.M;
    A(4, 3) = 1.0;
    const Eigen::Matrix<double, 6, 6> E = (A * kTick).exp();
    for (int row = 0; row < 5; ++row) {
      for (int column = 0; column < 5; ++column) p.Ad[row][column] = E(row, column);
      p.Bd[row] = E(row, 5);
    }
  }
  const auto rows = read_rows("vol.csv");
  for (std::size_t row = 0; row < 21; ++row) {
    for (std::size_t k = 0; k < 4; ++k) problem.vol[row][k] = rows.at(row).at(k);
  }
  return problem;
}

// Nanoseconds an item; Google Benchmark would print rates.
void count(benchmark::State& state, double items_an_iteration) {
  state.counters["ns_per_item"] =
      benchmark::Counter(1e-9 * items_an_iteration, benchmark::Counter::kIsIterationInvariantRate |
                                                        benchmark::Counter::kInvert);
}

constexpr auto kTicksAsNumber = static_cast<double>(kTicks);

void BM_Plain(benchmark::State& state, const char* file, bool friction) {
  const PlainProblem problem = read_plain(file, friction);
  std::vector<double> log(PLAIN_SIGNALS * (kTicks / kRecord + 1));
  for (auto _ : state) {
    plain_run(problem.axes.data(), problem.vol, friction ? 1 : 0, kTicks, log.data());
    benchmark::DoNotOptimize(log.data());
  }
  count(state, kTicksAsNumber);
}

// Forty signals a row, as the plain loop takes them.
void take_row(std::size_t run, const sim::engine::AxisSetpoint& set,
              const sim::engine::ServoAxes& axes, double* row) {
  Joints::Map(row) = set.Q_cmd;
  Joints::Map(row + 5) = axes.Q_fb(run);
  Joints::Map(row + 10) = axes.Q_true(run);
  Joints::Map(row + 15) = axes.dQ_true(run);
  Joints::Map(row + 20) = axes.motor_angle(run);
  Joints::Map(row + 25) = axes.motor_speed(run);
  Joints::Map(row + 30) = axes.current(run);
  Joints::Map(row + 35) = axes.command(run);
}

void BM_Servomill(benchmark::State& state, const char* file, bool friction) {
  const auto runs = static_cast<std::size_t>(state.range(0));
  std::vector<sim::model::MachineSettings> machines(runs, read_machine(file, friction));
  std::vector<const sim::model::MachineSettings*> all;
  for (std::size_t m = 0; m < runs; ++m) {  // no two alike, as in a sweep
    for (auto& cascade : machines[m].nc.cascade) cascade.Kv *= 1.0 + 1e-3 * static_cast<double>(m);
    all.push_back(&machines[m]);
  }
  std::vector<double> log(PLAIN_SIGNALS * runs * (kTicks / kRecord + 1));
  for (auto _ : state) {
    state.PauseTiming();
    Problem run(all);
    state.ResumeTiming();
    double* row = log.data();
    run.until(kTicks, [&](std::size_t n, const sim::engine::AxisSetpoint& set,
                          const sim::engine::ServoAxes& axes) {
      take_row(n, set, axes, row);
      row += PLAIN_SIGNALS;
    });
    benchmark::DoNotOptimize(log.data());
  }
  count(state, static_cast<double>(runs) * kTicksAsNumber);
}

#define REFERENCE(variant, file, friction)                                             \
  BENCHMARK_CAPTURE(BM_Plain, variant, file, friction)->Unit(benchmark::kMillisecond); \
  BENCHMARK_CAPTURE(BM_Servomill, variant, file, friction)                             \
      ->Arg(1)                                                                         \
      ->Arg(8)                                                                         \
      ->Unit(benchmark::kMillisecond)
REFERENCE(L, "axes.csv", false);
REFERENCE(N, "axes.csv", true);
REFERENCE(N_sharp, "axes_sharp.csv", true);
#undef REFERENCE

// Poses all over the machine.
std::vector<Joints> poses() {
  std::vector<Joints> all(1024, Joints::Zero());
  for (std::size_t n = 0; n < all.size(); ++n) {
    const double s = 0.37 * static_cast<double>(n);
    all[n].head<3>() << 0.05 * std::sin(s), 0.05 * std::cos(1.3 * s), 0.12 * std::sin(0.7 * s);
  }
  return all;
}
const Eigen::Vector3d kTip(0.0, 0.0, -0.15);

void BM_PlainVolumetric(benchmark::State& state) {
  const PlainProblem problem = read_plain("axes.csv", false);
  const std::vector<Joints> Q = poses();
  for (auto _ : state) {
    for (const Joints& at : Q) {
      double e[3];
      plain_volumetric(problem.vol, at[0], at[1], at[2], e);
      benchmark::DoNotOptimize(e);
    }
  }
  count(state, static_cast<double>(Q.size()));
}
BENCHMARK(BM_PlainVolumetric);

void BM_Volumetric(benchmark::State& state) {
  const plant::VolumetricModel model = read_volumetric();
  const std::vector<Joints> Q = poses();
  for (auto _ : state) {
    for (const Joints& at : Q) benchmark::DoNotOptimize(model.joint_offset(at, kTip));
  }
  count(state, static_cast<double>(Q.size()));
}
BENCHMARK(BM_Volumetric);

void BM_VolumetricBatch(benchmark::State& state) {
  const plant::VolumetricModel model = read_volumetric();
  const std::vector<Joints> Q = poses();
  std::vector<Eigen::Vector3d> offset(Q.size());
  for (auto _ : state) {
    model.joint_offsets(Q, kTip, offset);
    benchmark::DoNotOptimize(offset.data());
  }
  count(state, static_cast<double>(Q.size()));
}
BENCHMARK(BM_VolumetricBatch);

// A table-table machine with all of its 43 errors, but for the zero positions of the rotary axes,
// which move an axis within itself: cubic functions of every axis, and location errors.
plant::VolumetricModel five_axis_model() {
  const auto chain = plant::make_chain(plant::parse_structure("[w C' B' X b Y Z (C1) t]"));
  const auto rows = read_rows("vol.csv");
  plant::ErrorModel errors;
  std::size_t next = 0;
  for (const Axis axis : {Axis::X, Axis::Y, Axis::Z, Axis::B, Axis::C}) {
    for (const Axis direction : kAllAxes) {
      errors.component({direction, axis, false}) = plant::polynomial(rows.at(next++ % 18));
    }
  }
  using namespace plant;  // the names of errors
  for (const ErrorName name :
       {"EC0Y"_err, "EB0Z"_err, "EA0Z"_err, "EX0B"_err, "EZ0B"_err, "EA0B"_err, "EC0B"_err,
        "EX0C"_err, "EY0C"_err, "EA0C"_err, "EB0C"_err}) {
    errors.location(name) = 1e-5;
  }
  return {chain, errors};
}

// The rotary axes turn, too.
std::vector<Joints> five_axis_poses() {
  std::vector<Joints> all = poses();
  for (std::size_t n = 0; n < all.size(); ++n) {
    const double s = 0.37 * static_cast<double>(n);
    all[n].tail<2>() << 0.6 * std::sin(0.9 * s), 3.0 * std::cos(0.2 * s);
  }
  return all;
}

template <class Find>
void one_by_one(benchmark::State& state, Find find) {
  const plant::VolumetricModel model = five_axis_model();
  const std::vector<Joints> Q = five_axis_poses();
  for (auto _ : state) {
    for (const Joints& at : Q) benchmark::DoNotOptimize(find(model, at));
  }
  count(state, static_cast<double>(Q.size()));
}

template <class Result, class Find>
void all_at_once(benchmark::State& state, Find find) {
  const plant::VolumetricModel model = five_axis_model();
  const std::vector<Joints> Q = five_axis_poses();
  std::vector<Result> out(Q.size());
  for (auto _ : state) {
    find(model, Q, out);
    benchmark::DoNotOptimize(out.data());
  }
  count(state, static_cast<double>(Q.size()));
}

using plant::VolumetricError, plant::VolumetricModel;

void BM_FiveAxisError(benchmark::State& state) {
  one_by_one(state, [](const VolumetricModel& m, const Joints& Q) { return m.error(Q, kTip); });
}
BENCHMARK(BM_FiveAxisError);

void BM_FiveAxisForward(benchmark::State& state) {
  one_by_one(state, [](const VolumetricModel& m, const Joints& Q) { return m.forward(Q, kTip); });
}
BENCHMARK(BM_FiveAxisForward);

void BM_FiveAxisErrors(benchmark::State& state) {
  all_at_once<VolumetricError>(
      state, [](const VolumetricModel& m, const auto& Q, auto& out) { m.errors(Q, kTip, out); });
}
BENCHMARK(BM_FiveAxisErrors);

void BM_FiveAxisPoses(benchmark::State& state) {
  all_at_once<ToolPose>(
      state, [](const VolumetricModel& m, const auto& Q, auto& out) { m.poses(Q, kTip, out); });
}
BENCHMARK(BM_FiveAxisPoses);

// Tool poses of a machine with both rotary axes anywhere, one near the other.
void BM_FiveAxisInverse(benchmark::State& state, const char* structure, bool is_inclined) {
  plant::MachineChain chain = plant::make_chain(plant::parse_structure(structure));
  if (is_inclined) plant::incline(chain.at(Axis::B), {0.0, 1.0, 1.0});
  std::vector<Joints> Q = poses();
  std::vector<ToolPose> P;
  for (std::size_t n = 0; n < Q.size(); ++n) {
    const double s = 0.037 * static_cast<double>(n);
    Q[n].tail<2>() << 0.7 + 0.5 * std::sin(s), s;
    P.push_back(plant::forward(chain, Q[n], kTip));
  }
  const plant::InverseKinematics inverse(chain);
  Joints at = Q.front();
  for (auto _ : state) {
    for (const ToolPose& pose : P) {
      at = inverse.nearest(pose, kTip, at).Q;
      benchmark::DoNotOptimize(at);
    }
  }
  count(state, static_cast<double>(P.size()));
}
BENCHMARK_CAPTURE(BM_FiveAxisInverse, table_table, "[w C' B' X b Y Z t]", false);
BENCHMARK_CAPTURE(BM_FiveAxisInverse, nutating_head, "[w C' X b Y Z B t]", true);

}  // namespace
}  // namespace servomill::reference_problem
