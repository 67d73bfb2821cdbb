/// Filter of the nominal position: a finite moving average of the reference of each cycle.
#pragma once

#include <vector>

#include "plant/vocabulary/axes.h"

namespace servomill::controllers {

enum class FilterShape { mean, triangle };

/// Mean of the last n samples; the triangle is two means of n/2 in a row.
///
///   mean:      y_k = (x_k + ... + x_(k-n+1)) / n,   delay (n - 1)/2 cycles                     (1)
///   triangle:  (1) twice with n/2,                  delay n/2 - 1 cycles                       (2)
///
/// With T_f = n cycles a corner of 90 degrees is cut by (sqrt(2)/8) v T_f by the mean, a circle
/// shrinks by R (w T_f)^2 / 24 under the mean and / 48 under the triangle (w = v/R).            (3)
class NominalFilter {
 public:
  /// @param length  cycles, >= 1; even for the triangle
  /// @param start   where the joints have been standing
  NominalFilter(FilterShape shape, int length, const Joints& start);

  Joints operator()(const Joints& Q_ref);  ///< Next sample in, next sample out; never allocates.
  double delay() const;                    ///< cycles

 private:
  struct Mean {
    std::vector<Joints> last;
    std::size_t oldest = 0;
    Joints sum;
  };
  static Joints step(Mean& mean, const Joints& x);

  std::vector<Mean> stages_;
};

}  // namespace servomill::controllers
