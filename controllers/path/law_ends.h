/// Both ends of a time law, which the search for a quicker one leaves as they are.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "controllers/path/time_law.h"

namespace servomill::controllers {

/// Begin and end of a law between speeds that are given. Where it begins or ends at rest, a slower
/// law behind the ramp is met by going through the same ramp more slowly. A speed at the end is
/// kept: a new ramp leads from it.
class LawEnds {
 public:
  /// A place where the law neither speeds up nor slows down.
  struct Place {
    std::size_t phase = 0;
    double s = 0.0, t = 0.0, v = 0.0;  // m, s, m/s
  };

  /// Both spans and the law must outlive this.
  /// @param stretches  limits of the law, of which new ramps are made; empty if both ends are at
  ///                   rest
  LawEnds(const TimeLaw& law, std::span<const SegmentLimits> stretches, const EndSpeeds& speeds)
      : law_(law), stretches_(stretches), speeds_(speeds) {}

  /// The first place behind the begin that a ramp reaches at half the speed of the law.
  std::optional<Place> begin() const;
  /// The last such place before the end.
  std::optional<Place> end() const;

  /// From the begin to a place, which is passed at v (m/s), not above the speed of the law.
  /// @return nullopt if no ramp leads there
  std::optional<TimeLaw> before(const Place& place, double v) const;
  /// From there to the end; s counts from the begin of the law, time from the place.
  std::optional<TimeLaw> behind(const Place& place, double v) const;

 private:
  double end_of(std::size_t phase) const;
  bool is_even(std::size_t phase) const;
  Place place_on(std::size_t phase, double s) const;
  std::optional<TimeLaw> ramp(double from, double to, const EndSpeeds& speeds) const;
  template <class Reaches>
  std::optional<Place> place_reached(std::size_t phase, double near, double far,
                                     Reaches reaches) const;

  const TimeLaw& law_;
  std::span<const SegmentLimits> stretches_;
  EndSpeeds speeds_;
};

}  // namespace servomill::controllers
