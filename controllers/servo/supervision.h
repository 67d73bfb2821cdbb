/// Supervision of one axis by the NC: what stops the machine.
#pragma once

#include <cstdint>
#include <optional>

#include "controllers/servo/cascade.h"

namespace servomill::controllers {

/// Limits of one axis; each is for itself, without one nothing is supervised.
struct SupervisionParams {
  double following_error = kNoLimit;     // m or rad, setpoint less reading
  double standstill = kNoLimit;          // m or rad, the same while the axis is to stand
  double standstill_delay = 0.0;         // s, granted for settling before that
  double standstill_speed = 1e-6;        // m/s or rad/s, commanded speed up to which it is to stand
  double encoder_difference = kNoLimit;  // m or rad, scale less motor encoder, since the start;
                                         // wind-up of the screw and backlash belong to it
  double Tp = 0.0;                       // s, position period
};

struct SupervisionState {
  double difference_at_start = 0.0;  // m or rad
  std::int64_t standing = 0;         // periods for which the axis has been commanded to stand
};

/// Reading of one axis by the NC in a position period (m or rad, m/s or rad/s).
struct AxisReading {
  double q_cmd = 0.0;    // setpoint of the position loop
  double dq_cmd = 0.0;   // its fed-forward speed
  double y = 0.0;        // position that the loop reads
  double y_motor = 0.0;  // r phi
  double y_scale = 0.0;
};

enum class AxisFaultKind : std::uint8_t { following_error, standstill, encoder_difference };

struct AxisFault {
  AxisFaultKind fault;
  double value;  // m or rad, with its sign; NaN if the reading is no number
  double limit;  // m or rad
  bool operator==(const AxisFault&) const = default;
};

/// State of an axis that is about to start.
inline SupervisionState standing_at(const SupervisionParams&, const AxisReading& now) {
  return {now.y_scale - now.y_motor, 0};
}

/// The first of following error, standstill and encoder difference that is beyond its limit, once
/// per position period. A limit that is just reached is kept; a reading that is no number is beyond
/// each finite limit. The standstill limit holds from `standstill_delay` after the command stopped
/// until it moves again.
std::optional<AxisFault> supervise(const SupervisionParams& p, SupervisionState& s,
                                   const AxisReading& now);

}  // namespace servomill::controllers
