#include "controllers/path/time_law.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "plant/vocabulary/interrupt.h"

namespace servomill::controllers {
namespace {

constexpr double kOver = 1.0 + 1e-9;  // a limit counts as exceeded beyond this
constexpr double kRounding = 2e-15;   // m, of positions along the path
constexpr double kJoint = 1e-9;       // m, m/s, 1e3 m/s^2: rounding where phases meet
constexpr double kMin = 1e-12;        // m, waypoints closer than this are one

// S-curve from v0 up to v1 >= v0, acceleration zero at both ends. A fall is a rise read backwards.
struct Rise {
  double v0 = 0.0, v1 = 0.0;
  double j = 1.0;
  double t_jerk = 0.0, t_even = 0.0;  // s, phases: t_jerk, t_even, t_jerk
  double length = 0.0;                // m

  Rise() = default;
  Rise(double from, double to, double a, double j_in) : v0(from), v1(to), j(j_in) {
    const double dv = to - from;
    const bool even = dv * j > a * a;
    t_jerk = even ? a / j : std::sqrt(dv / j);
    t_even = even ? dv / a - t_jerk : 0.0;
    length = 0.5 * (from + to) * duration();
  }
  double duration() const { return 2.0 * t_jerk + t_even; }

  // Speed after x metres.
  double speed_at(double x) const {
    if (x <= 0.0) return v0;
    if (x >= length) return v1;
    const double T = t_jerk, dv = 0.5 * j * T * T, a = j * T;
    const double first = T * (v0 + dv / 3.0), third = T * (v1 - dv / 3.0);
    if (x < first) {  // v0 t + j t^3/6 = x, convex: Newton from above
      double t = T;
      for (int i = 0; i < 40; ++i) {
        const double step = (t * (v0 + j * t * t / 6.0) - x) / (v0 + j * t * t / 2.0);
        t -= step;
        if (step <= 1e-14 * T) break;
      }
      return v0 + j * t * t / 2.0;
    }
    if (length - x < third) {  // v1 t - j t^3/6 = rest, concave: Newton from below
      double t = 0.0;
      for (int i = 0; i < 40; ++i) {
        const double slope = v1 - j * t * t / 2.0;
        if (slope <= 0.0) break;
        const double step = (length - x - t * (v1 - j * t * t / 6.0)) / slope;
        t = std::min(t + step, T);
        if (step <= 1e-14 * T) break;
      }
      return v1 - j * t * t / 2.0;
    }
    const double v = v0 + dv;
    return std::sqrt(v * v + 2.0 * a * (x - first));
  }
};

struct Waypoint {
  double s = 0.0, v = 0.0;
  std::size_t stretch = 0;  // the one that begins at s or contains it
  std::size_t next = 0;
  std::size_t previous = 0;
  Rise up, down;  // towards the next waypoint
};

class SpeedPlanner {
 public:
  explicit SpeedPlanner(std::span<const SegmentLimits> stretches, const EndSpeeds& ends = {})
      : limits_(stretches), ends_(ends) {
    points_.push_back({0.0, ends.begin, 0, kLast, 0, {}, {}});
    points_.push_back({limits_.back().end, ends.end, limits_.size(), kLast, 0, {}, {}});
    dirty_ = {0};
  }

  // A place that is passed without acceleration. @return its waypoint
  std::size_t pass(double s) {
    put(0, s, std::numeric_limits<double>::infinity());
    return points_.size() - 1;
  }

  // Returns whether the speeds at both ends could be kept.
  bool run() {
    while (!dirty_.empty()) {
      throw_if_interrupted();
      const std::size_t l = dirty_.back();
      dirty_.pop_back();
      solve(l);
    }
    return points_[0].v == ends_.begin && points_[kLast].v == ends_.end;
  }

  double speed_at(std::size_t point) const { return points_[point].v; }

  // The law between two waypoints, of phases: rise (jerk, constant acceleration, jerk), cruise, and
  // the fall as a mirrored rise. Each jerk phase of duration T changes the velocity by
  // dv = j T^2 / 2 over the distance v T + j T^3 / 6 = T (v + dv / 3).
  TimeLaw write(std::size_t from = 0, std::size_t to = kLast) const {
    TimeLaw law;
    double t = 0.0;
    const double origin = points_[from].s;
    const auto phase = [&](double s, double v, double a, double j, double duration) {
      if (duration <= 0.0) return;
      law.phases.push_back({t, s - origin, v, a, j, 0.0});
      t += duration;
    };
    for (std::size_t l = from; l != to; l = points_[l].next) {
      const Waypoint& p = points_[l];
      const double s_r = points_[p.next].s;
      const Rise &up = p.up, &down = p.down;
      const double T = up.t_jerk, dv = 0.5 * up.j * T * T, a = up.j * T;
      const double x1 = p.s + T * (up.v0 + dv / 3.0), x3 = p.s + up.length;
      phase(p.s, up.v0, 0.0, up.j, T);
      phase(x1, up.v0 + dv, a, 0.0, up.t_even);
      phase(x3 - T * (up.v1 - dv / 3.0), up.v1 - dv, a, -up.j, T);
      const double cruise = s_r - down.length - x3;
      if (cruise > kRounding) phase(x3, up.v1, 0.0, 0.0, cruise / up.v1);
      const double U = down.t_jerk, dw = 0.5 * down.j * U * U, b = down.j * U;
      const double y1 = s_r - down.length;
      phase(y1, down.v1, 0.0, -down.j, U);
      phase(y1 + U * (down.v1 - dw / 3.0), down.v1 - dw, -b, 0.0, down.t_even);
      phase(s_r - U * (down.v0 + dw / 3.0), down.v0 + dw, -b, down.j, U);
    }
    law.duration = t;
    assert(is_continuous(law, {t, points_[to].s - origin, points_[to].v, 0.0, 0.0, 0.0}));
    return law;
  }

 private:
  struct Profile {
    Rise up, down;
    double x_up = 0.0, x_down = 0.0;  // m, where the cruise begins and ends
  };

  double begin_of(std::size_t k) const { return k == 0 ? 0.0 : limits_[k - 1].end; }
  std::size_t first_stretch(std::size_t l) const { return points_[l].stretch; }
  std::size_t last_stretch(std::size_t r) const {
    const Waypoint& p = points_[r];
    return begin_of(p.stretch) >= p.s ? p.stretch - 1 : p.stretch;
  }

  // Shortest rise from waypoint l to speed v that ends before waypoint r.
  std::optional<Rise> rise(std::size_t l, std::size_t r, double v) const {
    const Waypoint &from = points_[l], &to = points_[r];
    if (v <= from.v) return Rise(from.v, from.v, 1.0, 1.0);
    double a = std::numeric_limits<double>::infinity(), j = a;
    for (std::size_t k = first_stretch(l), last = last_stretch(r); k <= last; ++k) {
      a = std::min(a, limits_[k].a);
      j = std::min(j, limits_[k].j);
      const Rise out(from.v, v, a, j);
      if (out.length <= std::min(limits_[k].end, to.s) - from.s) return out;
    }
    return std::nullopt;
  }

  // The same, backwards from waypoint r.
  std::optional<Rise> fall(std::size_t l, std::size_t r, double v) const {
    const Waypoint &from = points_[l], &to = points_[r];
    if (v <= to.v) return Rise(to.v, to.v, 1.0, 1.0);
    double a = std::numeric_limits<double>::infinity(), j = a;
    for (std::size_t k = last_stretch(r) + 1, first = first_stretch(l); k-- > first;) {
      a = std::min(a, limits_[k].a);
      j = std::min(j, limits_[k].j);
      const Rise out(to.v, v, a, j);
      if (out.length <= to.s - std::max(begin_of(k), from.s)) return out;
    }
    return std::nullopt;
  }

  std::optional<Profile> profile(std::size_t l, double peak) const {
    const std::size_t r = points_[l].next;
    const auto up = rise(l, r, peak);
    if (!up) return std::nullopt;
    const auto down = fall(l, r, peak);
    if (!down) return std::nullopt;
    Profile p{*up, *down, points_[l].s + up->length, points_[r].s - down->length};
    if (p.x_up > p.x_down + kRounding) return std::nullopt;
    return p;
  }

  // Largest v in [low, high] that `good` accepts, low being accepted.
  template <class F>
  static double largest(double low, double high, F&& good) {
    for (int i = 0; i < 60 && high - low > 1e-6 * high; ++i) {
      const double v = 0.5 * (low + high);
      (good(v) ? low : high) = v;
    }
    return low;
  }

  // Stretch with the lowest limit among those that the profile exceeds.
  std::optional<std::size_t> lowest_exceeded(std::size_t l, const Profile& p) const {
    const std::size_t r = points_[l].next;
    const double s_l = points_[l].s, s_r = points_[r].s, peak = p.up.v1;
    std::optional<std::size_t> worst;
    for (std::size_t k = first_stretch(l), last = last_stretch(r); k <= last; ++k) {
      const double limit = limits_[k].v;
      if (peak <= limit * kOver || (worst && limit >= limits_[*worst].v)) continue;
      const double from = std::max(begin_of(k), s_l), to = std::min(limits_[k].end, s_r);
      double v = peak;
      if (to < p.x_up) v = p.up.speed_at(to - s_l);
      if (from > p.x_down) v = p.down.speed_at(s_r - from);
      if (v > limit * kOver) worst = k;
    }
    return worst;
  }

  // Lowers or inserts a waypoint between l and its successor.
  void put(std::size_t l, double s, double v) {
    std::size_t at = l;
    while (points_[at].next != at && points_[points_[at].next].s <= s + kMin && at != 1) {
      at = points_[at].next;
    }
    if (std::abs(points_[at].s - s) <= kMin) {
      if (v < points_[at].v) {
        points_[at].v = v;
        if (at != 0) dirty_.push_back(points_[at].previous);
      }
      return;
    }
    const std::size_t next = points_[at].next;
    std::size_t k = points_[at].stretch;
    if (limits_[k].end <= s) {  // the stretch that holds s
      const auto found =
          std::upper_bound(limits_.begin() + static_cast<std::ptrdiff_t>(k), limits_.end(), s,
                           [](double x, const SegmentLimits& limit) { return x < limit.end; });
      k = static_cast<std::size_t>(found - limits_.begin());
    }
    v = std::min(v, limits_[k].v);
    points_.push_back({s, v, k, next, at, {}, {}});
    points_[at].next = points_[next].previous = points_.size() - 1;
    dirty_.push_back(points_.size() - 1);
  }

  // A waypoint that cannot be reached from the other one is lowered.
  void bring_within_reach(std::size_t l) {
    const std::size_t r = points_[l].next;
    if (points_[r].v > points_[l].v && !rise(l, r, points_[r].v)) {
      points_[r].v =
          largest(points_[l].v, points_[r].v, [&](double v) { return rise(l, r, v).has_value(); });
      if (r != 1) dirty_.push_back(r);
    }
    if (points_[l].v > points_[r].v && !fall(l, r, points_[l].v)) {
      points_[l].v =
          largest(points_[r].v, points_[l].v, [&](double v) { return fall(l, r, v).has_value(); });
      if (l != 0) dirty_.push_back(points_[l].previous);
    }
  }

  void solve(std::size_t l) {
    bring_within_reach(l);
    const std::size_t r = points_[l].next;
    const double base = std::max(points_[l].v, points_[r].v);
    double peak = base;
    for (std::size_t k = first_stretch(l), last = last_stretch(r); k <= last; ++k) {
      peak = std::max(peak, limits_[k].v);
    }
    auto best = profile(l, peak);
    if (!best) {
      peak = largest(base, peak, [&](double v) { return profile(l, v).has_value(); });
      best = profile(l, peak);
    }
    assert(best);
    auto worst = lowest_exceeded(l, *best);
    if (!worst) {
      points_[l].up = best->up;
      points_[l].down = best->down;
      return;
    }
    // lower the peak to the limit that is exceeded, until nothing is
    std::optional<Profile> low;
    for (auto k = worst; k; k = lowest_exceeded(l, *low)) {
      worst = k;
      if (limits_[*k].v < base) return lower_ends(l, *k);
      low = profile(l, limits_[*k].v);
      assert(low);
    }
    double v = limits_[*worst].v;
    const double from = begin_of(*worst), to = limits_[*worst].end;
    dirty_.push_back(l);
    if (from <= low->x_down && to >= low->x_up) {
      // the stretch is met at its limit
      const double x_up = low->x_up, x_down = low->x_down;
      put(l, std::clamp(from, x_up, std::max(x_up, x_down)), v);
      put(l, std::clamp(to, x_up, std::max(x_up, x_down)), v);
      return;
    }
    // the stretch is passed on the way up or down: the highest speed that still passes below it
    v = largest(v, peak, [&](double x) {
      const auto p = profile(l, x);
      return p && !lowest_exceeded(l, *p);
    });
    low = profile(l, v);
    put(l, low->x_up, v);
    put(l, low->x_down, v);
  }

  void lower_ends(std::size_t l, std::size_t stretch) {
    const double v = limits_[stretch].v;
    const double s_l = points_[l].s, s_r = points_[points_[l].next].s;
    dirty_.push_back(l);
    put(l, std::max(begin_of(stretch), s_l), v);
    put(l, std::min(limits_[stretch].end, s_r), v);
  }

  // Does every phase end where the next begins, and the last at the end? The times are sums
  // from the begin of the law and are rounded with its duration: short phases of a high jerk behind
  // hours of a slow feed are met only so well.
  static bool is_continuous(const TimeLaw& law, const Phase& end) {
    const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * law.duration;  // s
    for (std::size_t i = 0; i < law.phases.size(); ++i) {
      const bool last = i + 1 == law.phases.size();
      const Phase& p = law.phases[i];
      const Phase& next = last ? end : law.phases[i + 1];
      const double x = next.t - p.t;
      const double s = p.s + x * (p.v + x * (p.a / 2.0 + x * p.j / 6.0));
      const double v = p.v + x * (p.a + x * p.j / 2.0), a = p.a + x * p.j;
      const bool meets = std::abs(s - next.s) <= kJoint + std::abs(v) * rounding &&
                         std::abs(v - next.v) <= kJoint + std::abs(a) * rounding &&
                         std::abs(a - next.a) <= 1e3 * kJoint + std::abs(p.j) * rounding;
      if (!meets) return false;
    }
    return true;
  }

  static constexpr std::size_t kLast = 1;

  std::span<const SegmentLimits> limits_;
  EndSpeeds ends_;
  std::vector<Waypoint> points_;  // 0 is the first, kLast the last
  std::vector<std::size_t> dirty_;
};

}  // namespace

Phase::State Phase::at(double time) const {
  const double x = time - t;
  if (beta == 0.0) {
    return {s + x * (v + x * (a / 2.0 + x * j / 6.0)), v + x * (a + x * j / 2.0), a + x * j, j};
  }
  // C'' = 1 + beta C, S = C', E = S'
  const double y = beta * x * x;
  double C = 0.0, S = 0.0;
  if (std::abs(y) < 0.1) {
    C = 0.5 * x * x * (1.0 + y / 12.0 * (1.0 + y / 30.0 * (1.0 + y / 56.0 * (1.0 + y / 90.0))));
    S = x * (1.0 + y / 6.0 * (1.0 + y / 20.0 * (1.0 + y / 42.0 * (1.0 + y / 72.0))));
  } else {
    const double root = std::sqrt(std::abs(beta)), phi = root * x;
    S = (beta > 0.0 ? std::sinh(phi) : std::sin(phi)) / root;
    const double half = beta > 0.0 ? std::sinh(0.5 * phi) : std::sin(0.5 * phi);
    C = 2.0 * half * half / std::abs(beta);
  }
  const double E = 1.0 + beta * C, speed = v * E + a * S;
  return {s + v * S + a * C, speed, a * E + beta * v * S, beta * speed};
}

TimeLaw plan_speed(std::span<const SegmentLimits> stretches) {
  assert(!stretches.empty());
  SpeedPlanner planner(stretches);
  planner.run();
  return planner.write();
}

std::optional<TimeLaw> plan_speed(std::span<const SegmentLimits> stretches,
                                  const EndSpeeds& speeds) {
  SpeedPlanner planner(stretches, speeds);
  if (!planner.run()) return std::nullopt;
  return planner.write();
}

std::optional<DividedLaw> plan_speed_through(std::span<const SegmentLimits> stretches,
                                             double v_begin, double place) {
  SpeedPlanner planner(stretches, {v_begin, 0.0});
  const std::size_t there = planner.pass(place);
  if (!planner.run()) return std::nullopt;
  return DividedLaw{planner.write(0, there), planner.write(there), planner.speed_at(there)};
}

}  // namespace servomill::controllers
