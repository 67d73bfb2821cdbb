/// A case with what several quantities look at, each found once.
#pragma once

#include "sim/evaluation/case_samples.h"
#include "sim/evaluation/circular_quantities.h"
#include "sim/evaluation/r_test_quantities.h"

namespace servomill::sim::evaluation {

struct CaseEvaluation {
  /// @param of  must outlive this
  explicit CaseEvaluation(const CaseData& of)
      : data(of), samples(of), circles(samples), ball(samples) {}
  CaseEvaluation(const CaseEvaluation&) = delete;
  CaseEvaluation& operator=(const CaseEvaluation&) = delete;

  const CaseData& data;
  CaseSamples samples;
  CircularQuantities circles;
  BallQuantities ball;
};

}  // namespace servomill::sim::evaluation
