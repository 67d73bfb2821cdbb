// CYCLE800: swivelled planes, as G68.2 and G53.1. [C] "Swivel plane / swivel tool"; parameters from
// memory.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "controllers/siemens/translator.h"
#include "controllers/translation/plane_angles.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::siemens {
namespace {

// Places of the parameters _FR, _TC, _ST, _MODE, _X0 ... _Z0, _A ... _C, _X1 ... _Z1, _DIR.
constexpr std::size_t kRetraction = 0, kState = 2, kMode = 3, kBefore = 4, kAngles = 7,
                      kBehind = 10, kDirection = 13;

}  // namespace

// About three axes, each as the ones before have left it; _MODE holds the axes, two bits each.
Eigen::Matrix3d Translator::swivel_of(const Call& call) const {
  const double mode = value_of(call, kMode, 0.0, "_MODE");
  constexpr double kMax = 255.0;
  if (mode != std::floor(mode) || mode < 0.0 || mode > kMax) {
    fail(call.place, fmt::format("CYCLE800: _MODE {:g} must be an integer from 0 to 255", mode));
  }
  const auto bits = static_cast<unsigned>(mode);
  constexpr unsigned kKind = 6;
  if (bits >> kKind != 0U) {
    fail(call.place,
         "CYCLE800: only axis-by-axis swivelling (_MODE up to 63) is supported; solid angles, "
         "projection angles and direct rotary axes are not");
  }
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  for (std::size_t i = 0; i < 3; ++i) {
    const double angle = value_of(call, kAngles + i, 0.0, "an angle");
    const unsigned axis = (bits >> (2U * i)) & 3U;
    if (angle != 0.0 && axis == 0U)
      fail(call.place, "CYCLE800: _MODE does not assign an axis to an angle");
    if (angle == 0.0) continue;
    R = R * Eigen::AngleAxisd(angle * deg, Eigen::Vector3d::Unit(static_cast<int>(axis) - 1))
                .toRotationMatrix();
  }
  return R;
}

bool Translator::are_rotary_axes_at_zero() const {
  return !has_swivelled_ && std::all_of(work_.begin() + 3, work_.end(),
                                        [](const auto& one) { return one.value_or(0.0) == 0.0; });
}

// CYCLE800() ends the swivelling; no axis moves.
void Translator::swivel(const Call& call) {
  require_no_compensation("CYCLE800");
  if (is_tcp_) fail(call.place, "CYCLE800 is not allowed with TRAORI; cancel it with TRAFOOF");
  if (!modes_.frame.is_plain()) {
    fail(call.place,
         "CYCLE800 is not supported with TRANS, ROT, SCALE or MIRROR active; cancel them with "
         "TRANS first");
  }
  path_.flush();
  end_swivel();
  if (call.arguments.empty()) return;
  const auto vector = [&](std::size_t first) -> Eigen::Vector3d {
    return Eigen::Vector3d(value_of(call, first, 0.0, "_X"), value_of(call, first + 1, 0.0, "_Y"),
                           value_of(call, first + 2, 0.0, "_Z")) *
           unit();
  };
  if (value_of(call, kState, 0.0, "_ST") != 0.0) {
    fail(call.place,
         "CYCLE800: only new planes without tool tip correction (_ST = 0) are supported");
  }
  const Eigen::Matrix3d R = swivel_of(call);
  const Eigen::Vector3d origin = vector(kBefore) + R * vector(kBehind);
  const bool is_level = R.isIdentity(1e-12);
  const bool turns =
      value_of(call, kDirection, 0.0, "_DIR") != 0.0 && !(is_level && are_rotary_axes_at_zero());
  if (value_of(call, kRetraction, 0.0, "_FR") != 0.0) {
    warn_once("_FR",
              "CYCLE800: the retraction before the rotary axes rotate (_FR) is omitted: its "
              "positions are in the swivel data record");
  }
  if (turns) {
    warn_once("_DIR",
              "CYCLE800: the nearest solution of the rotary axes is used; the control selects it "
              "by _DIR and the swivel data record");
  }
  plane_line_ = "G68.2";
  const std::array<double, 3> euler = translation::euler_angles(R);
  for (int i = 0; i < 3; ++i) plane_line_ += " " + word("XYZ"[i], origin[i]);
  for (std::size_t i = 0; i < 3; ++i) plane_line_ += " " + word("IJK"[i], euler[i]);
  lines_.put(plane_line_, place_);
  if (turns) {
    lines_.put("G53.1", place_);
    has_swivelled_ = has_swivelled_ || !is_level;
    for (std::size_t i = 3; i < work_.size(); ++i) work_[i].reset();
  }
  forget_linear_positions();
}

void Translator::end_swivel() {
  if (plane_line_.empty()) return;
  plane_line_.clear();
  lines_.put("G69", place_);
  forget_linear_positions();
}

// Machine coordinates in a swivelled plane.
void Translator::put_beside_plane(Motion motion) {
  const bool is_swivelled = !plane_line_.empty();
  if (is_swivelled) note("G69");
  path_.add(std::move(motion));
  if (!is_swivelled) return;
  path_.flush();
  note(plane_line_);
  forget_linear_positions();
}

}  // namespace servomill::controllers::siemens
