/// Source of the position loop's feedback: scale, motor encoder, or both.
#pragma once

#include <cstdint>

namespace servomill::controllers {

enum class PositionFeedback : std::uint8_t {
  scale,      // y = y_scale
  motor,      // y = y_motor, counted from where the scale stood at the start
  crossover,  // y = y_motor + LP(y_scale - y_motor): the motor for fast, the scale for slow motion
};

/// Constant description of the position feedback of one axis.
struct PositionFeedbackParams {
  PositionFeedback kind = PositionFeedback::scale;
  double gain = 0.0;  // -, share of the difference that is taken over in one position period:
                      // crossover_gain for `crossover`, 0 for `motor`
};

struct PositionFeedbackState {
  double difference = 0.0;  // m or rad, y_scale - y_motor as it is assumed
};

/// 1 - exp(-2 pi f Tp): a first-order low-pass at the crossover frequency f (Hz), exact at the
/// position period Tp (s) for a step. It delays a slow signal by 1 / (2 pi f) - Tp / 2.
double crossover_gain(double f, double Tp);

PositionFeedbackParams scale_feedback();
PositionFeedbackParams motor_feedback();
/// @param f   Hz, > 0, below half the position rate (can_filter in filters.h); 20 to 80 is usual
/// @param Tp  s, position period
PositionFeedbackParams crossover_feedback(double f, double Tp);

/// State of an axis that has been standing: y = y_scale for each kind.
inline PositionFeedbackState standing_at(const PositionFeedbackParams&, double y_motor,
                                         double y_scale) {
  return {y_scale - y_motor};
}

/// d_k and y of position_feedback, for one axis or for lanes.
template <class Number>
Number combined_reading(const Number& gain, Number& difference, const Number& y_motor,
                        const Number& y_scale) {
  difference = difference + gain * (y_scale - y_motor - difference);
  return y_motor + difference;
}

/// Position that the NC reads, once per position period:
///
///   d_k = d_(k-1) + gain (y_scale - y_motor - d_(k-1)),  y = y_motor + d_k
///
/// An offset injected into the scale signal passes the low-pass, one added to the setpoint does
/// not: with lag mode gain Kv an injected sine A sin(w t) lags by about
/// A w (1/Kv + 1/(2 pi f) - Tp/2), the same sine from a table by A w / Kv.
/// @param y_motor  r phi (m or rad)
/// @param y_scale  as read, offsets of a virtual encoder included (m or rad)
/// Source: Heidenhain, Technical Manual iTNC 530 HSCI (2013), crossover position filter (MP2609).
inline double position_feedback(const PositionFeedbackParams& p, PositionFeedbackState& s,
                                double y_motor, double y_scale) {
  if (p.kind == PositionFeedback::scale) return y_scale;
  return combined_reading(p.gain, s.difference, y_motor, y_scale);
}

}  // namespace servomill::controllers
