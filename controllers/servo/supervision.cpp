#include "controllers/servo/supervision.h"

#include <cmath>

namespace servomill::controllers {
namespace {

// Written so that no number is beyond every limit, too.
bool beyond(double value, double limit) { return limit < kNoLimit && !(std::abs(value) <= limit); }

}  // namespace

std::optional<AxisFault> supervise(const SupervisionParams& p, SupervisionState& s,
                                   const AxisReading& now) {
  const double error = now.q_cmd - now.y;
  const double difference = now.y_scale - now.y_motor - s.difference_at_start;
  s.standing = std::abs(now.dq_cmd) <= p.standstill_speed ? s.standing + 1 : 0;
  const bool settled =
      s.standing > 0 && static_cast<double>(s.standing - 1) * p.Tp >= p.standstill_delay;

  if (beyond(error, p.following_error)) {
    return AxisFault{AxisFaultKind::following_error, error, p.following_error};
  }
  if (settled && beyond(error, p.standstill)) {
    return AxisFault{AxisFaultKind::standstill, error, p.standstill};
  }
  if (beyond(difference, p.encoder_difference)) {
    return AxisFault{AxisFaultKind::encoder_difference, difference, p.encoder_difference};
  }
  return std::nullopt;
}

}  // namespace servomill::controllers
