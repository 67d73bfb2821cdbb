/// Static schedule of one case: the instants at which anything is due, over one common multiple of
/// all periods. Nothing is visited that is not due; between instants the drives take one exact
/// step. Where nothing but the error model is due, the drives feel nothing and nothing but
/// positions is read: such an instant is but a stop on the way from one instant to the next.
#pragma once

#include <cstdint>
#include <vector>

#include "plant/vocabulary/ticks.h"

namespace servomill::sim::model {

enum Due : std::uint8_t {
  kErrorModel = 1,      // feedback hardware evaluates its model
  kFeedbackSample = 2,  // the reading that the next position period will use is taken
  kPositionLoop = 4,
  kVelocityLoop = 8,
  kCurrentLoop = 16,
  kRecord = 32,
  kToothStep = 64,  // mean force of the teeth until the next one
};

struct Instant {
  std::uint8_t due = 0;
  Tick step = 0;              // ticks to the next instant
  std::vector<Tick> stops{};  // ticks from here to those where only the error model is due, rising
};

struct Rate {
  std::uint8_t due = 0;
  Tick period = 1;
  Tick phase = 0;  // due at phase, phase + period, ...; 0 <= phase < period
};

/// Longest schedule that is laid out; a combination of periods beyond it is refused.
inline constexpr Tick kMaxHyperperiod = 1'000'000;

/// Least common multiple of the periods, or 0 beyond kMaxHyperperiod.
Tick hyperperiod(const std::vector<Rate>& rates);

/// The instants of one hyperperiod, from tick 0 on, which is no stop. @pre hyperperiod(rates) > 0,
/// one rate has phase 0
std::vector<Instant> make_schedule(const std::vector<Rate>& rates);

}  // namespace servomill::sim::model
