#include "controllers/servo/position_feedback.h"

#include <cassert>
#include <cmath>
#include <numbers>

#include "controllers/servo/filters.h"

namespace servomill::controllers {

double crossover_gain(double f, double Tp) { return -std::expm1(-2.0 * std::numbers::pi * f * Tp); }

PositionFeedbackParams scale_feedback() { return {}; }

PositionFeedbackParams motor_feedback() { return {PositionFeedback::motor, 0.0}; }

PositionFeedbackParams crossover_feedback(double f, double Tp) {
  assert(can_filter(f, Tp));
  return {PositionFeedback::crossover, crossover_gain(f, Tp)};
}

}  // namespace servomill::controllers
