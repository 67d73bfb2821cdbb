#include "sim/engine/last_ticks.h"

#include <algorithm>
#include <string>

namespace servomill::sim::engine {

void LastTicks::keep(double time, const Joints& Q_cmd, const Joints& Q_fb, const Joints& Q_true,
                     const Joints& current) {
  double* row = ring_.data() + (count_++ % kLastTicks) * kPerRow;
  *row++ = time;
  for (const Joints* Q : {&Q_cmd, &Q_fb, &Q_true, &current}) {
    for (int j = 0; j < kJoints; ++j) *row++ = (*Q)[j];
  }
}

records::Series LastTicks::series(const JointLayout& layout) const {
  std::string letters;
  for (const int j : present_) letters += layout.letter_of(j);
  records::Series out({{"time", "s", "time since the start of the program", "", ""},
                       {"cmd", "m or rad", "setpoint", letters, "axis"},
                       {"fb", "m or rad", "position feedback", letters, "axis"},
                       {"true", "m or rad", "position of the slide or table", letters, "axis"},
                       {"current", "A", "torque-forming current", letters, "axis"}});
  std::vector<double> row(out.width());
  const std::size_t rows = std::min(count_, kLastTicks);
  for (std::size_t n = count_ - rows; n < count_; ++n) {
    const double* from = ring_.data() + (n % kLastTicks) * kPerRow;
    double* to = row.data();
    *to++ = *from;
    for (std::size_t block = 0; block < 4; ++block) {
      for (const int j : present_) *to++ = from[1 + block * kJoints + static_cast<std::size_t>(j)];
    }
    out.append(row);
  }
  return out;
}

}  // namespace servomill::sim::engine
