/// Laws of the trajectory on random programs. SERVOMILL_RANDOM_PROGRAMS sets how many.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "controllers/path/trajectory.h"
#include "plant/vocabulary/arc_sweep.h"
#include "programs.h"

namespace servomill::controllers::test::random_programs_test {
namespace {

constexpr double kRounding = 1e-7;    // of a limit, rounding of sums over windows
constexpr double kBoundGrid = 0.005;  // of the bound, its grid of 500 points a chain
constexpr double kMeanRatio = 1.5;    // 1.40 measured on 10^4 programs
constexpr double kSkipped = 2e-9;     // m, blocks shorter than 1 nm are joined to the next

unsigned program_count() {
  const char* text = std::getenv("SERVOMILL_RANDOM_PROGRAMS");
  return text != nullptr ? static_cast<unsigned>(std::strtoul(text, nullptr, 10)) : 150U;
}

double tolerance_of(const Move& move, const PathOptions& options) {
  if (move.path_mode != PathMode::continuous) return options.exact_tolerance;
  return move.path_tolerance > 0.0 ? move.path_tolerance : options.tolerance;
}

// Distance of X Y Z to the programmed line (at the same fraction) or circle.
double deviation(const Trajectory::Sample& sample, const Move& move, const AxisWords& from) {
  const Eigen::Vector3d p = sample.Q_ref.head<3>();
  const double length = move.s_end - move.s_begin;
  if (move.kind != MoveKind::arc) {
    const double f = length > 0.0 ? (sample.s - move.s_begin) / length : 0.0;
    return (p - from.head<3>() - f * (move.end_machine - from).head<3>()).norm();
  }
  const ArcSweep arc = arc_sweep(move, from.head<3>());
  // nearest point of the helix: Newton from the fraction of the length
  double f = (sample.s - move.s_begin) / length;
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector3d d = arc.derivative(f);
    f = std::clamp(f + d.dot(p - arc.point(f)) / d.squaredNorm(), 0.0, 1.0);
  }
  return (p - arc.point(f)).norm();
}

// Rounding of a third difference of samples: sixteen units in the last place of 1 m; rotary
// positions are divided by the rotary radius of 0.1 m.
Joints rounding_of_positions() {
  Joints out = Joints::Constant(16 * 2.2e-16);
  out.tail<2>() *= 10.0;
  return out;
}

struct Extremes {
  double v = 0.0, a = 0.0, j = 0.0;           // of |value| / limit, analytic
  double fd_v = 0.0, fd_a = 0.0, fd_j = 0.0;  // the same from differences of samples
  double feed = 0.0, deviation = 0.0;         // of feed, of tolerance
};

double ratio(const Joints& value, const Joints& limit) {
  return value.cwiseAbs().cwiseQuotient(limit).maxCoeff();
}

Extremes extremes(const Program& program, const Trajectory& path, const JointLimits& limits,
                  const PathOptions& options) {
  std::vector<AxisWords> from;
  AxisWords at = kLayout.words(program.start());
  for (const Move& move : program.moves()) {
    from.push_back(at);
    if (is_motion(move.kind)) at = move.end_machine;
  }
  Extremes worst;
  Trajectory::Cursor cursor;
  const double dt = std::max(100 * us, path.duration() / 20000.0);
  Joints Q1 = path.start(), Q2 = Q1, Q3 = Q1;
  for (int n = 0; n * dt < path.duration() + 4 * dt; ++n) {
    const Trajectory::Sample x = path.at(n * dt, cursor);
    const Move& move = program.moves()[x.move];
    worst.v = std::max(worst.v, ratio(x.dQ_ref, limits.v));
    worst.a = std::max(worst.a, ratio(x.ddQ_ref, limits.a));
    worst.j = std::max(worst.j, ratio(x.dddQ_ref, limits.j));
    const auto excess = [&](const Joints& difference, double dt_n, const Joints& limit) {
      return ratio((difference.cwiseAbs() - rounding_of_positions()).cwiseMax(0.0) / dt_n, limit);
    };
    worst.fd_v = std::max(worst.fd_v, excess(x.Q_ref - Q1, dt, limits.v));
    worst.fd_a = std::max(worst.fd_a, excess(x.Q_ref - 2 * Q1 + Q2, dt * dt, limits.a));
    worst.fd_j =
        std::max(worst.fd_j, excess(x.Q_ref - 3 * Q1 + 3 * Q2 - Q3, dt * dt * dt, limits.j));
    Q3 = Q2, Q2 = Q1, Q1 = x.Q_ref;
    if (move.kind == MoveKind::feed || move.kind == MoveKind::arc) {
      const bool rotary_only =
          move.kind == MoveKind::feed && (move.end_machine - from[x.move]).head<3>().isZero(0.0);
      const double speed = rotary_only ? x.dQ_ref.tail<2>().norm() : x.dQ_ref.head<3>().norm();
      worst.feed = std::max(worst.feed, speed / move.feed);
    }
    if (n % 8 == 0) {
      worst.deviation = std::max(worst.deviation, (deviation(x, move, from[x.move]) - kSkipped) /
                                                      tolerance_of(move, options));
    }
  }
  return worst;
}

void expect_laws(const Program& program, const Trajectory& path, const Extremes& x) {
  EXPECT_LE(x.v, 1.0 + kRounding);
  EXPECT_LE(x.a, 1.0 + kRounding);
  EXPECT_LE(x.j, 1.0 + kRounding);
  EXPECT_LE(x.fd_v, 1.0 + kRounding);
  EXPECT_LE(x.fd_a, 1.0 + kRounding);
  EXPECT_LE(x.fd_j, 1.0 + kRounding);
  EXPECT_LE(x.feed, 1.0 + kRounding);
  EXPECT_LE(x.deviation, 1.0 + kRounding);
  Trajectory::Cursor cursor;
  const auto end = path.at(path.duration(), cursor);
  EXPECT_EQ(end.Q_ref, kLayout.joints(program.at()));
  EXPECT_TRUE(end.dQ_ref.isZero(0.0) && end.ddQ_ref.isZero(0.0));
  const auto nearly = path.at(path.duration() - 1e-7, cursor);
  EXPECT_LE((nearly.Q_ref - end.Q_ref).norm(), 1e-12);
}

TEST(RandomPrograms, KeepEveryLimitAndReachTheEnd) {
  const JointLimits limits = machine_limits();
  const PathOptions options;
  const unsigned count = program_count();
  double sum = 0.0, largest = 0.0, time = 0.0, bounds = 0.0;
  std::size_t moves = 0;
  Extremes all;
  for (unsigned seed = 0; seed < count; ++seed) {
    const Program program = random_program(seed);
    SCOPED_TRACE(fmt::format("seed {}", seed));
    const Trajectory path = program.plan();
    const Extremes x = extremes(program, path, limits, options);
    expect_laws(program, path, x);
    const double bound = time_bound(path, program.moves(), limits, options);
    EXPECT_GE(path.duration(), bound * (1.0 - kBoundGrid));
    time += path.duration();
    bounds += bound;
    sum += path.duration() / bound;
    largest = std::max(largest, path.duration() / bound);
    moves += program.moves().size();
    all.j = std::max(all.j, x.j);
    all.fd_j = std::max(all.fd_j, x.fd_j);
    all.a = std::max(all.a, x.a);
    all.deviation = std::max(all.deviation, x.deviation);
    if (HasFailure()) break;
  }
  EXPECT_LE(sum / count, kMeanRatio);
  fmt::print(
      "{} programs, {} moves: motion time / lower bound: mean {:.3f}, largest {:.3f}, of "
      "the sums {:.3f}\nlargest use of a {:.6f}, j {:.6f}, j from differences {:.6f}, tolerance "
      "{:.6f}\n",
      count, moves, sum / count, largest, time / bounds, all.a, all.j, all.fd_j, all.deviation);
}

// Stretches of a motion meet in motion, without a jump of position, velocity or acceleration, and
// the lines and arc lengths of the blocks go on.
TEST(RandomPrograms, KeepEveryLimitInStretches) {
  const JointLimits limits = machine_limits();
  std::size_t moving = 0;
  for (unsigned seed = 0; seed < program_count() && !HasFailure(); ++seed) {
    const Program program = random_program(seed);
    PathOptions options;
    options.stretch = 16 + seed % 100;
    SCOPED_TRACE(fmt::format("seed {}, stretches of {} vertices", seed, options.stretch));
    const Trajectory path = program.plan(options);
    expect_laws(program, path, extremes(program, path, limits, options));
    Trajectory::Cursor one, other;
    for (std::size_t n = 0; n < path.chains(); ++n) {
      const auto held = path.chain(n);
      const Trajectory::Chain& chain = *held;
      if (chain.t == 0.0) continue;
      const auto before = path.at(std::nextafter(chain.t, 0.0), one), at = path.at(chain.t, other);
      EXPECT_LE((at.Q_ref - before.Q_ref).norm(), 1e-12);
      EXPECT_LE((at.dQ_ref - before.dQ_ref).norm(), 1e-9);
      EXPECT_LE((at.ddQ_ref - before.ddQ_ref).norm(), 1e-6);
      if (at.dQ_ref.isZero(1e-6)) continue;
      ++moving;
      EXPECT_LE((chain.begin - at.Q_ref).norm(), 1e-12);
      EXPECT_EQ(before.line, at.line);
      EXPECT_NEAR(before.s, at.s, 1e-9);
    }
  }
  EXPECT_GT(moving, program_count());
}

}  // namespace
}  // namespace servomill::controllers::test::random_programs_test
