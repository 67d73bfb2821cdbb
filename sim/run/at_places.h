/// Signals of different runs at the same places along the path.
#pragma once

#include <cmath>
#include <utility>

#include "sim/evaluation/path_signal.h"
#include "sim/records/stored_signal.h"
#include "sim/run/budget.h"

namespace servomill::sim::run {

/// Reads a signal at the places of a budget, one after the other; constant beyond its ends.
class AtPlaces {
 public:
  /// @pre the signal has samples
  AtPlaces(evaluation::PathSignal signal, const Budget& places)
      : signal_(std::move(signal)), s_(places.s), turned_(places.turned) {
    signal_.next(now_);
    has_ahead_ = signal_.next(ahead_);
  }

  double next() {
    const double s = s_.next(), turned = turned_.next();
    while (has_ahead_ && !is_behind(ahead_, s, turned)) {
      now_ = ahead_;
      has_ahead_ = signal_.next(ahead_);
    }
    if (!has_ahead_ || is_behind(now_, s, turned)) return now_.value;
    const bool moves = key(ahead_.s) > key(now_.s);
    const double share = moves ? (s - now_.s) / (ahead_.s - now_.s)
                               : (turned - now_.turned) / (ahead_.turned - now_.turned);
    return now_.value + share * (ahead_.value - now_.value);
  }

 private:
  static double key(double s) { return std::round(s * 1e6); }  // nm: cases differ by rounding
  static bool is_behind(const evaluation::PathSample& sample, double s, double turned) {
    return std::pair(key(sample.s), sample.turned) > std::pair(key(s), turned);
  }

  evaluation::PathSignal signal_;
  records::StoredSignal::Reader s_, turned_;
  evaluation::PathSample now_, ahead_;
  bool has_ahead_ = false;
};

}  // namespace servomill::sim::run
