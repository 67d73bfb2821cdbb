/// Deviations that a model of the machine predicts for a program before and after.
#pragma once

#include <string>
#include <vector>

namespace servomill::sim::programs {

struct ServoFigures {
  double contour = 0.0;             // m, largest contour error in feed motion
  double tip = 0.0, tip_rms = 0.0;  // m, deviation of the tip from the interpolated path there
  double duration = 0.0;            // s, of the planned motion
};

struct ServoPrediction {
  std::string model;    // its file
  double cutoff = 0.0;  // Hz
  int runs = 0;         // of the model
  ServoFigures before, after;

  std::vector<std::string> report() const;
  std::string json() const;
};

}  // namespace servomill::sim::programs
