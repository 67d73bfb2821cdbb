#include "sim/engine/drive_steps.h"

#include <algorithm>

#include "sim/model/machine.h"

namespace servomill::sim::engine {

std::vector<model::Rate> loop_rates(const model::LoopPeriods& p, Tick reading_delay) {
  const Tick phase = (p.position - reading_delay % p.position) % p.position;
  return {{model::kFeedbackSample, p.position, phase},
          {model::kPositionLoop, p.position, 0},
          {model::kVelocityLoop, p.velocity, 0},
          {model::kCurrentLoop, p.current, 0}};
}

namespace {

// Matrices are prepared for each stop of each: beyond that, steps are taken as they come.
constexpr std::size_t kMaxStretches = 32;

// Number of a stretch with stops among those of the way, which it joins if it is new; -1 if there
// are too many.
int number_of(const plant::Stretch& stretch, DriveSteps& way) {
  const auto known = std::find(way.stretches.begin(), way.stretches.end(), stretch);
  const auto number = static_cast<int>(known - way.stretches.begin());
  if (known != way.stretches.end()) return number;
  if (way.stretches.size() == kMaxStretches) return -1;
  way.most_stops = std::max(way.most_stops, stretch.stops.size());
  way.stretches.push_back(stretch);
  return number;
}

}  // namespace

// A stretch takes up to `most_stops` stops and the end of a step at once; equal stretches share
// their matrices. Where there are more than kMaxStretches of them, single steps go from stop to
// stop.
DriveSteps drive_steps(const std::vector<model::Instant>& schedule, std::size_t most_stops) {
  DriveSteps way;
  const auto add_step = [&](Tick step) {
    way.legs.push_back({step});
    way.steps.push_back(step);
  };
  for (const model::Instant& instant : schedule) {
    std::vector<Tick> places = instant.stops;
    places.push_back(instant.step);
    Tick begin = 0;
    for (std::size_t first = 0; first < places.size();) {
      const std::size_t last = std::min(first + most_stops, places.size() - 1);
      plant::Stretch stretch{.step = places[last] - begin};
      for (std::size_t n = first; n < last; ++n) stretch.stops.push_back(places[n] - begin);
      const int number = stretch.stops.empty() ? -1 : number_of(stretch, way);
      if (number >= 0) {
        way.legs.push_back({stretch.step, number});
      } else {
        for (std::size_t n = first; n <= last; ++n) {
          add_step(places[n] - (n == first ? begin : places[n - 1]));
        }
      }
      begin = places[last];
      first = last + 1;
    }
  }
  return way;
}

}  // namespace servomill::sim::engine
