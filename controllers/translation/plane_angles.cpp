#include "controllers/translation/plane_angles.h"

#include <cmath>

#include "plant/vocabulary/units.h"

namespace servomill::controllers::translation {

std::array<double, 3> euler_angles(const Eigen::Matrix3d& R) {
  const double second = std::atan2(std::hypot(R(0, 2), R(1, 2)), R(2, 2));
  constexpr double kSingular = 1e-12;
  if (std::abs(std::sin(second)) < kSingular) {
    return {std::atan2(R(1, 0), R(0, 0)) / deg, R(2, 2) > 0.0 ? 0.0 : 180.0, 0.0};
  }
  return {std::atan2(R(0, 2), -R(1, 2)) / deg, second / deg, std::atan2(R(2, 0), R(2, 1)) / deg};
}

}  // namespace servomill::controllers::translation
