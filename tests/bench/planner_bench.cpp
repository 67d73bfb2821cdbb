/// Reading and planning of a long program: `planner_bench PROGRAM [TOLERANCE_UM]`. With
/// PLANNER_BENCH_QUICK set the plan is not sampled.
///
/// The machine has X Y Z A C, 30 m/min, 3 m/s^2, 50 m/s^3, rotary 50 rpm, 20 rad/s^2, 400 rad/s^3.
/// Prints the time of each stage, the motion time, what the programmed feed alone takes, the
/// largest use of each limit and the largest deviation (on samples of 0.2 ms), and the peak of
/// memory.

#include <fmt/core.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include "controllers/gcode/interpreter.h"
#include "controllers/path/trajectory.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr JointLayout kLayout{{Axis::X, Axis::Y, Axis::Z, Axis::A, Axis::C}};
constexpr double kSampling = 0.2 * ms;

JointLimits machine_limits() {
  JointLimits limits;
  limits.v << 30 * m_per_min, 30 * m_per_min, 30 * m_per_min, 50 * rpm, 50 * rpm;
  limits.a << 3.0, 3.0, 3.0, 20.0, 20.0;
  limits.j << 50.0, 50.0, 50.0, 400.0, 400.0;
  return limits;
}

class Stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

double ratio(const Joints& value, const Joints& limit) {
  return value.cwiseAbs().cwiseQuotient(limit).maxCoeff();
}

// Distance of p to the polyline near the end of move i.
double distance(const std::vector<Move>& moves, std::size_t i, const Joints& Q) {
  const Eigen::Vector3d p = Q.head<3>();
  double least = 1.0;
  constexpr std::size_t kNear = 12;
  for (std::size_t k = i > kNear ? i - kNear : 1; k <= std::min(i + kNear, moves.size() - 1); ++k) {
    const Eigen::Vector3d from = moves[k - 1].end_machine.head<3>();
    const Eigen::Vector3d d = moves[k].end_machine.head<3>() - from;
    const double f =
        d.squaredNorm() > 0.0 ? std::clamp((p - from).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
    least = std::min(least, (from + f * d - p).norm());
  }
  return least;
}

void measure(const Trajectory& path, const std::vector<Move>& moves) {
  const JointLimits limits = machine_limits();
  double v = 0.0, a = 0.0, j = 0.0, feed = 0.0, largest = 0.0, rotary = 0.0;
  Trajectory::Cursor cursor;
  for (double t = 0.0; t < path.duration(); t += kSampling) {
    const auto x = path.at(t, cursor);
    const Move& move = moves[x.move];
    v = std::max(v, ratio(x.dQ_ref, limits.v));
    a = std::max(a, ratio(x.ddQ_ref, limits.a));
    j = std::max(j, ratio(x.dddQ_ref, limits.j));
    if (move.kind == MoveKind::feed) {
      feed = std::max(feed, x.dQ_ref.head<3>().norm() / move.feed);
    }
    largest = std::max(largest, distance(moves, x.move, x.Q_ref));
    if (x.move > 0) {
      const AxisWords &from = moves[x.move - 1].end_machine, &to = moves[x.move].end_machine;
      const double length = move.s_end - move.s_begin;
      const double f = length > 0.0 ? (x.s - move.s_begin) / length : 1.0;
      const Joints Q = kLayout.joints(from + f * (to - from));
      rotary = std::max(rotary, (x.Q_ref - Q).tail<2>().norm());
    }
  }
  fmt::print("use of v {:.6f}, a {:.6f}, j {:.6f}, feed {:.6f}\n", v, a, j, feed);
  fmt::print("largest deviation {:.4f} um, rotary at equal s {:.2f} urad\n", largest / um,
             rotary / 1e-6);
}

int run(const char* file, double tolerance) {
  Stopwatch watch;
  Interpreter interpreter(ProgramText::of_file(file), {});
  MoveList moves;
  double programmed = 0.0;
  while (const Move* next = interpreter.next()) {
    Move move = *next;
    if (move.kind == MoveKind::feed) programmed += (move.s_end - move.s_begin) / move.feed;
    if (tolerance > 0.0) move.path_tolerance = tolerance;
    moves.push_back(move);
  }
  const double reading = watch.lap();
  const double before = peak_megabytes();
  watch.lap();
  const Trajectory path = plan(moves, kLayout, Joints::Zero(), machine_limits());
  const double planning = watch.lap();
  fmt::print("{} moves, {} chains\n", moves.size(), path.chains());
  fmt::print("interpreted in {:.2f} s, planned in {:.2f} s\n", reading, planning);
  fmt::print("motion {:.3f} min, programmed feed alone {:.3f} min\n", path.duration() / minute,
             programmed / minute);
  fmt::print("peak memory {:.0f} MB with the moves, {:.0f} MB with the plan\n", before,
             peak_megabytes());
  std::size_t pieces = 0, phases = 0;
  for (std::size_t n = 0; n < path.chains(); ++n) {
    const auto held = path.chain(n);
    const Trajectory::Chain& chain = *held;
    if (chain.plan == nullptr) continue;
    pieces += chain.plan->path.pieces.size();
    phases += chain.plan->law.phases.size();
  }
  fmt::print("{} pieces, {} phases\n", pieces, phases);
  if (std::getenv("PLANNER_BENCH_QUICK") == nullptr) measure(path, moves.all());
  return 0;
}

}  // namespace
}  // namespace servomill::controllers

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: planner_bench PROGRAM [TOLERANCE_UM]\n");
    return 2;
  }
  return servomill::controllers::run(argv[1], argc > 2 ? std::atof(argv[2]) * servomill::um : 0.0);
}
