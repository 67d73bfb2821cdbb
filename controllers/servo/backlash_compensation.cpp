#include "controllers/servo/backlash_compensation.h"

#include <algorithm>
#include <cmath>

namespace servomill::controllers {

BacklashRamp backlash_compensation(const BacklashCompensationParams& p,
                                   BacklashCompensationState& s, double q_cmd) {
  const double ahead = s.direction * (q_cmd - s.farthest);
  if (ahead < -p.hysteresis) s.direction = -s.direction;
  if (ahead > 0.0 || ahead < -p.hysteresis) s.farthest = q_cmd;

  const double periods = std::max(1.0, std::round(p.time / p.Tp));
  const double step = std::abs(p.width) / periods;
  const double before = s.offset, target = s.direction > 0 ? 0.0 : -p.width;
  const double rest = target - before;
  // the last step also takes what rounding has left
  s.offset = std::abs(rest) < 1.5 * step ? target : before + std::copysign(step, rest);
  return {s.offset, s.offset == before ? 0.0 : (s.offset - before) / p.Tp};
}

}  // namespace servomill::controllers
