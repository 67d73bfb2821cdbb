#include "controllers/path/law_ends.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace servomill::controllers {
namespace {

constexpr double kSlower = 0.5;     // of the speed, at which a place has to be reached
constexpr double kShortest = 1e-6;  // m, a ramp
constexpr int kHalvings = 12;       // of the phase in which a place is sought

// Beyond rounding a ramp from rest cannot be made quicker.
constexpr double kRounding = 1e-12;

Phase slowed(Phase p, double t0, double f) {
  p.t = (p.t - t0) / f;
  p.v *= f;
  p.a *= f * f;
  p.j *= f * f * f;
  return p;
}

}  // namespace

double LawEnds::end_of(std::size_t phase) const {
  return phase + 1 < law_.phases.size() ? law_.phases[phase + 1].s : stretches_.back().end;
}

bool LawEnds::is_even(std::size_t phase) const {
  return law_.phases[phase].a == 0.0 && law_.phases[phase].v > 0.0;
}

LawEnds::Place LawEnds::place_on(std::size_t phase, double s) const {
  const Phase& p = law_.phases[phase];
  return {phase, s, p.t + (s - p.s) / p.v, p.v};
}

// Between the near and the far end of a phase the place nearest to `near` that is reached. A phase
// with jerk has zero acceleration at its begin alone.
template <class Reaches>
std::optional<LawEnds::Place> LawEnds::place_reached(std::size_t phase, double near, double far,
                                                     Reaches reaches) const {
  if (law_.phases[phase].j != 0.0) near = far = law_.phases[phase].s;
  if (reaches(near)) return place_on(phase, near);
  if (near == far || !reaches(far)) return std::nullopt;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (near + far);
    (reaches(middle) ? far : near) = middle;
  }
  return place_on(phase, far);
}

std::optional<LawEnds::Place> LawEnds::begin() const {
  const bool moves = speeds_.begin > 0.0;
  for (std::size_t i = moves ? 0 : 1; i < law_.phases.size(); ++i) {
    if (!is_even(i)) continue;
    const Phase& p = law_.phases[i];
    if (!moves) return place_on(i, p.s);
    const auto place = place_reached(i, p.s, end_of(i), [&](double s) {
      return ramp(0.0, s, {speeds_.begin, kSlower * p.v}).has_value();
    });
    if (place) return place;
  }
  return std::nullopt;
}

std::optional<LawEnds::Place> LawEnds::end() const {
  const bool moves = speeds_.end > 0.0;
  for (std::size_t i = law_.phases.size(); i-- > 0;) {
    if (!is_even(i)) continue;
    const Phase& p = law_.phases[i];
    if (!moves) return place_on(i, p.s);
    const auto place = place_reached(i, end_of(i), p.s, [&](double s) {
      return ramp(s, stretches_.back().end, {kSlower * p.v, speeds_.end}).has_value();
    });
    if (place) return place;
  }
  return std::nullopt;
}

std::optional<TimeLaw> LawEnds::before(const Place& place, double v) const {
  if (speeds_.begin > 0.0) return ramp(0.0, place.s, {speeds_.begin, v});
  if (v > place.v * (1.0 + kRounding)) return std::nullopt;
  const double f = std::min(v / place.v, 1.0);
  TimeLaw out;
  for (std::size_t i = 0; i < place.phase; ++i) {
    out.phases.push_back(slowed(law_.phases[i], 0.0, f));
  }
  out.duration = place.t / f;
  return out;
}

std::optional<TimeLaw> LawEnds::behind(const Place& place, double v) const {
  if (speeds_.end > 0.0) return ramp(place.s, stretches_.back().end, {v, speeds_.end});
  if (v > place.v * (1.0 + kRounding)) return std::nullopt;
  const double f = std::min(v / place.v, 1.0);
  TimeLaw out;
  for (std::size_t i = place.phase; i < law_.phases.size(); ++i) {
    out.phases.push_back(slowed(law_.phases[i], place.t, f));
  }
  out.duration = (law_.duration - place.t) / f;
  return out;
}

// Under the limits of the law between two places.
std::optional<TimeLaw> LawEnds::ramp(double from, double to, const EndSpeeds& speeds) const {
  if (to - from < kShortest) return std::nullopt;
  const auto holds = [](const SegmentLimits& stretch, double s) { return stretch.end <= s; };
  const auto first = std::lower_bound(stretches_.begin(), stretches_.end(), from, holds);
  std::vector<SegmentLimits> passed;
  for (auto stretch = first; passed.empty() || passed.back().end < to - from; ++stretch) {
    passed.push_back(*stretch);
    passed.back().end = std::min(stretch->end, to) - from;
  }
  auto law = plan_speed(passed, speeds);
  if (!law) return std::nullopt;
  for (Phase& phase : law->phases) phase.s += from;
  return law;
}

}  // namespace servomill::controllers
