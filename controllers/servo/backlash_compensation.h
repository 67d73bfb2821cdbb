/// Backlash compensation of the NC: crosses the gap of the drive train at a reversal.
#pragma once

namespace servomill::controllers {

/// Constant description for one axis.
struct BacklashCompensationParams {
  double width = 0.0;         // m or rad, the backlash that the NC assumes; < 0 has the other sign
  double time = 0.0;          // s, over which it is crossed, rounded to whole periods, at least one
  double hysteresis = 20e-9;  // m or rad, way back that counts as a reversal: above the noise of
                              // the command, by default one step of the position (19.5 nm)
  double Tp = 0.0;            // s, position period
};

struct BacklashCompensationState {
  double farthest = 0.0;  // m or rad, setpoint farthest in the direction of motion
  int direction = 1;      // flank that carries
  double offset = 0.0;    // m or rad, 0 ... -width
};

/// Output of the ramp over the gap in one position period.
struct BacklashRamp {
  double offset = 0.0;  // m or rad, 0 while the positive flank carries, -width for the other
  double rate = 0.0;    // m/s or rad/s, change of the offset
};

/// State of an axis that stands at q_cmd (m or rad) with its positive flank carrying.
inline BacklashCompensationState standing_at(const BacklashCompensationParams&, double q_cmd) {
  return {q_cmd, 1, 0.0};
}

/// Advances the ramp by one position period; call it before position_loop.
///
/// The setpoint reverses when it has come back by more than the hysteresis from its farthest
/// point. From that period on the offset moves by width / n per period, n = time / Tp, to the other
/// end; a reversal on the way turns it round.
///
/// Scale feedback: the loop sees the slide, so only the time is to be gained: add `rate` to the
/// speed command (position_loop's v_add). Heidenhain's MP750 = 0.03 mm with MP752 = 15 ms gives
/// 120 mm/min for 15 ms. Motor feedback: the loop cannot see the gap: add `offset` to the set
/// point, which the axis reaches with Kv.
/// @param q_cmd  m or rad, without the offset
/// Source: Heidenhain, Technical Manual iTNC 530 HSCI (2013) p. 650; MANUALplus 620 (2012) p. 708.
BacklashRamp backlash_compensation(const BacklashCompensationParams& p,
                                   BacklashCompensationState& s, double q_cmd);

}  // namespace servomill::controllers
