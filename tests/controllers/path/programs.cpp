#include "programs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/spline_curve.h"

namespace servomill::controllers::test {

void Program::append(Move move, double length) {
  move.line = static_cast<int>(moves_.size()) + 1;
  move.path_mode = path_mode;
  move.path_tolerance = path_tolerance;
  move.s_begin = s_;
  move.s_end = s_ += length;
  moves_.push_back(move);
  if (is_motion(move.kind)) at_ = move.end_machine;
}

Program& Program::line(const AxisWords& to, double feed) {
  Move move;
  move.kind = MoveKind::feed;
  move.end = move.end_machine = to;
  move.feed = feed;
  append(move, (to - at_).head<3>().norm());
  return *this;
}

Program& Program::line(double x, double y, double z, double feed) {
  AxisWords to = at_;
  to.head<3>() << x, y, z;
  return line(to, feed);
}

Program& Program::rapid(const AxisWords& to) {
  Move move;
  move.kind = MoveKind::rapid;
  move.end = move.end_machine = to;
  append(move, (to - at_).head<3>().norm());
  return *this;
}

Program& Program::arc(const Eigen::Vector3d& centre, const Eigen::Vector3d& to, int normal,
                      int turns, double feed) {
  Move move;
  move.kind = MoveKind::arc;
  move.end = at_;
  move.end.head<3>() = to;
  move.end_machine = move.end;
  move.arc.normal_axis = normal;
  move.arc.centre = move.centre_machine = centre;
  move.arc.turns = turns;
  move.feed = feed;
  const ArcSweep sweep = arc_sweep(move, at_.head<3>());
  append(move, std::hypot(sweep.r_begin * sweep.sweep, to[normal] - at_[normal]));
  return *this;
}

Program& Program::spline(int order, const std::vector<Eigen::Vector2d>& points, double feed,
                         std::vector<double> weights) {
  std::vector<Eigen::Vector3d> all = {at_.head<3>()};
  for (const Eigen::Vector2d& p : points) all.emplace_back(p.x(), p.y(), at_[2]);
  if (weights.empty()) weights.assign(all.size(), 1.0);
  Move move;
  move.kind = MoveKind::spline;
  move.spline = std::make_shared<const Spline>(Spline{SplineCurve(order, all, weights), all});
  move.end = at_;
  move.end.head<3>() = all.back();
  move.end_machine = move.end;
  move.feed = feed;
  append(move, move.spline->curve.length());
  return *this;
}

Program& Program::dwell(double seconds) {
  Move move;
  move.kind = MoveKind::dwell;
  move.end = move.end_machine = at_;
  move.value = seconds;
  append(move, 0.0);
  return *this;
}

namespace {

// Uniform numbers that are the same with every standard library.
class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }
  double log_uniform(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }
  int below(int n) { return static_cast<int>(uniform(0.0, n)); }
  Eigen::Vector3d direction() {
    Eigen::Vector3d d;
    do {
      d << uniform(-1, 1), uniform(-1, 1), uniform(-1, 1);
    } while (d.norm() < 0.1 || d.norm() > 1.0);
    return d.normalized();
  }

 private:
  std::mt19937 engine_;
};

void random_arc(Program& program, Dice& dice, double size, double feed) {
  const int normal = dice.below(3), a = (normal + 1) % 3, b = (normal + 2) % 3;
  const double phi = dice.uniform(0, 2 * std::numbers::pi);
  const double sweep = dice.below(5) == 0 ? 0.0 : dice.uniform(0.05, 6.2);
  const double pitch = dice.below(2) == 0 ? 0.0 : dice.uniform(-1, 1) * size;
  const int turns = dice.below(2) == 0 ? 1 : -1;
  const Eigen::Vector3d from = program.at().head<3>();
  Eigen::Vector3d centre = from, to = from;
  centre[a] -= size * std::cos(phi);
  centre[b] -= size * std::sin(phi);
  if (sweep > 0.0) {
    to[a] = centre[a] + size * std::cos(phi + turns * sweep);
    to[b] = centre[b] + size * std::sin(phi + turns * sweep);
  }
  to[normal] += pitch;
  program.arc(centre, to, normal, turns * (1 + (dice.below(6) == 0 ? 1 : 0)), feed);
}

}  // namespace

Program random_program(unsigned seed) {
  Dice dice(seed);
  Program program;
  const int count = 3 + dice.below(25);
  const double smallest = dice.log_uniform(1 * um, 1 * mm);
  const double largest = smallest * dice.log_uniform(1.0, 50 * mm / smallest);
  const double bend = dice.log_uniform(0.01, 3.0);  // how much the direction wanders
  const bool rotary = dice.below(3) == 0;
  Eigen::Vector3d d = dice.direction();
  double feed = dice.log_uniform(1 * mm, 500 * mm);
  for (int i = 0; i < count; ++i) {
    if (dice.below(6) == 0) feed = dice.log_uniform(1 * mm, 500 * mm);
    if (dice.below(8) == 0) {
      program.path_mode = static_cast<PathMode>(dice.below(3));
      program.path_tolerance = dice.below(2) == 0 ? 0.0 : dice.log_uniform(1 * um, 100 * um);
    }
    const double size = dice.log_uniform(smallest, largest);
    const int what = dice.below(20);
    const Eigen::Vector3d wander = dice.direction();
    d = (d + bend * dice.uniform(0, 1) * wander).normalized();
    if (what == 0) d = -d;  // reversal
    AxisWords to = program.at();
    to.head<3>() += size * d;
    if (rotary && dice.below(2) == 0) {
      to[4] += dice.uniform(-1, 1) * size / 0.1;
      to[5] += dice.uniform(-1, 1) * size / 0.05;
    }
    if (what == 1) {
      program.rapid(to);
    } else if (what == 2) {
      program.dwell(dice.uniform(0.0, 0.01));
    } else if (what == 3) {
      AxisWords turn = program.at();
      turn[5] += dice.uniform(-1, 1);
      program.line(turn, dice.log_uniform(0.1, 10.0));
    } else if (what == 4) {
      program.line(program.at(), feed);  // no way to go
    } else if (what <= 8) {
      random_arc(program, dice, size, feed);
    } else {
      program.line(to, feed);
    }
  }
  return program;
}

namespace {

// q' and q'' at a point of the path and the speed programmed there.
struct Station {
  double s = 0.0;
  Joints d1, d2;
  double v_max = 0.0;
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Accelerations that the joints allow at squared speed u.
std::pair<double, double> accelerations(const Station& p, const Joints& a, double u) {
  double low = -kInfinity, high = kInfinity;
  for (int k = 0; k < kJoints; ++k) {
    const double q1 = std::abs(p.d1[k]), q2 = p.d1[k] < 0 ? -p.d2[k] : p.d2[k];
    if (q1 < 1e-12) {
      if (std::abs(q2) * u > a[k]) return {1.0, -1.0};
      continue;
    }
    low = std::max(low, (-a[k] - q2 * u) / q1);
    high = std::min(high, (a[k] - q2 * u) / q1);
  }
  return {low, high};
}

std::vector<Station> stations(const Trajectory::Chain& chain, const std::vector<Move>& moves,
                              const JointLimits& limits, const PathOptions& options,
                              double radius) {
  std::vector<Station> out;
  const double step = chain.plan->path.length() / 500.0;
  std::size_t span = 0;
  for (std::size_t i = 0; i < chain.plan->path.pieces.size(); ++i) {
    const CubicPiece& q = chain.plan->path.pieces[i];
    const double h = chain.plan->path.end_of(i) - q.s;
    const int n = 1 + static_cast<int>(h / step);
    while (span + 1 < chain.spans.size() && q.s + h / 2 > chain.end_of(chain.spans[span])) ++span;
    const Move& move = moves[chain.spans[span].move];
    for (int k = 0; k < n; ++k) {
      const double x = h * (k + 0.5) / n;
      Station p{q.s + x, q.c1 + q.c2 * x + q.c3 * (x * x / 2), q.c2 + q.c3 * x, kInfinity};
      p.d1.tail<2>() /= radius;
      p.d2.tail<2>() /= radius;
      if (move.kind != MoveKind::rapid) {
        const double linear = p.d1.head<3>().norm(), rotary = p.d1.tail<2>().norm();
        p.v_max = move.feed * options.feed_override / (linear > 0 ? linear : rotary);
      }
      for (int j = 0; j < kJoints; ++j) {
        if (p.d1[j] != 0) p.v_max = std::min(p.v_max, limits.v[j] / std::abs(p.d1[j]));
      }
      out.push_back(p);
    }
  }
  return out;
}

double chain_bound(const std::vector<Station>& path, double length, const JointLimits& limits) {
  const std::size_t n = path.size();
  std::vector<double> K(n);  // largest squared speed from which the end can be reached
  for (std::size_t i = n; i-- > 0;) {
    const double ds = (i + 1 < n ? path[i + 1].s : length) - path[i].s;
    const double next = i + 1 < n ? K[i + 1] : 0.0;
    const auto good = [&](double u) {
      const auto [low, high] = accelerations(path[i], limits.a, u);
      return low <= high && u + 2.0 * ds * low <= next;
    };
    double low = 0.0, high = path[i].v_max * path[i].v_max;
    if (good(high)) low = high;
    for (int k = 0; k < 40 && high - low > 1e-6 * high; ++k) {
      const double u = 0.5 * (low + high);
      (good(u) ? low : high) = u;
    }
    K[i] = high;
  }
  double time = 0.0, u = 0.0, s = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double ds = path[i].s - s;
    const Station& from = path[i > 0 ? i - 1 : 0];
    const double a = std::max(accelerations(from, limits.a, u).second, 0.0);
    const double next = std::min(K[i], u + 2.0 * ds * a);
    if (ds > 0.0) time += 2.0 * ds / (std::sqrt(u) + std::sqrt(next));
    u = next;
    s = path[i].s;
  }
  return time + 2.0 * (length - s) / std::sqrt(u);
}

// Least time from rest to rest over a distance on one axis.
double rest_to_rest(double d, double v, double a, double j) {
  const auto ramp = [&](double dv) {
    return dv * j > a * a ? dv / a + a / j : 2.0 * std::sqrt(dv / j);
  };
  if (v * ramp(v) <= d) return d / v + ramp(v);
  double low = 0.0, high = v;
  for (int i = 0; i < 60; ++i) {
    const double peak = 0.5 * (low + high);
    (peak * ramp(peak) <= d ? low : high) = peak;
  }
  return low > 0.0 ? 2.0 * ramp(low) : 0.0;
}

double joint_bound(const Trajectory::Chain& chain, const JointLimits& limits) {
  const Joints d = (chain.end - chain.begin).cwiseAbs();
  double time = 0.0;
  for (int k = 0; k < kJoints; ++k) {
    time = std::max(time, rest_to_rest(d[k], limits.v[k], limits.a[k], limits.j[k]));
  }
  return time;
}

}  // namespace

double time_bound(const Trajectory& trajectory, const std::vector<Move>& moves,
                  const JointLimits& limits, const PathOptions& options) {
  double time = 0.0;
  for (std::size_t n = 0; n < trajectory.chains(); ++n) {
    const auto held = trajectory.chain(n);
    const Trajectory::Chain& chain = *held;
    time += chain.plan == nullptr ? chain.duration
                                  : std::max(joint_bound(chain, limits),
                                             chain_bound(stations(chain, moves, limits, options,
                                                                  trajectory.rotary_radius()),
                                                         chain.plan->path.length(), limits));
  }
  return time;
}

}  // namespace servomill::controllers::test
