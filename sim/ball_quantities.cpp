#include "sim/ball_quantities.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "plant/vocabulary/units.h"
#include "sim/scenario.h"

namespace servomill::sim {
namespace {

using Eigen::Vector3d;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kStands = 1.0 * um;        // how far a nominal tip may move, or a bar lengthen
constexpr double kTurns = 1e-6;             // rad, by which an axis turns that turns
constexpr double kLeastRadius = 1.0 * mm;   // of a ball about an axis
constexpr std::size_t kMostSamples = 2000;  // for one identification

// A rotary axis in the workpiece.
struct Line {
  Vector3d point, direction;
};

Line axis_in_workpiece(const plant::MachineChain& chain, std::size_t which, const Joints& Q) {
  const plant::ChainAxis& axis = chain.axes[which];
  ToolPose P{axis.centre, plant::direction_of(axis)};
  for (std::size_t i = which; i-- > 0;) {
    const plant::ChainAxis& nearer = chain.axes[i];
    plant::apply(nearer, plant::motion_at(nearer, Q[nearer.joint]), P);
  }
  return {P.p_WT, axis.sense == plant::Sense::tool ? P.k_W : Vector3d(-P.k_W)};
}

double range(const std::vector<Joints>& Q, int joint) {
  double low = kNone, high = kNone;
  for (const Joints& q : Q) {
    low = std::fmin(low, q[joint]);
    high = std::fmax(high, q[joint]);
  }
  return high - low;
}

// The rotary axis that turns, by its place in the chain, if it is one alone.
std::optional<std::size_t> turning_axis(const plant::MachineChain& chain,
                                        const std::vector<Joints>& Q) {
  std::optional<std::size_t> out;
  for (std::size_t i = 0; i < chain.axes.size(); ++i) {
    const plant::ChainAxis& axis = chain.axes[i];
    if (is_linear(axis.axis) || range(Q, axis.joint) < kTurns) continue;
    if (out) return std::nullopt;
    out = i;
  }
  return out;
}

// Tip in the spindle nose of the ideal machine.
Vector3d tip_of(const plant::MachineChain& chain, const Joints& Q, const Vector3d& p_WT) {
  const Vector3d p_WS = plant::forward(chain, Q, Vector3d::Zero()).p_WT;
  Eigen::Matrix3d R_WS;
  for (int i = 0; i < 3; ++i) {
    R_WS.col(i) = plant::forward(chain, Q, Vector3d::Unit(i)).p_WT - p_WS;
  }
  return R_WS.transpose() * (p_WT - p_WS);
}

// Spread of the distances to a point, m.
double spread_about(const std::vector<Vector3d>& points, const Vector3d& centre) {
  double low = kNone, high = kNone;
  for (const Vector3d& p : points) {
    low = std::fmin(low, (p - centre).norm());
    high = std::fmax(high, (p - centre).norm());
  }
  return high - low;
}

}  // namespace

BallQuantities::Path BallQuantities::path_of(const std::vector<std::string>& sections,
                                             const BallSpec& ball) {
  const std::vector<std::size_t>& rows = samples_.rows(sections);
  Path out;
  out.nominal = samples_.positions("tool_position_nominal", rows);
  out.actual = samples_.positions("tool_position_true", rows);
  const Series& servo = *samples_.data().servo;
  out.Q.assign(rows.size(), Joints::Zero());
  for (const plant::ChainAxis& axis : ball.chain.axes) {
    const bool linear = is_linear(axis.axis);
    const auto column = servo.column(linear ? "ref_linear" : "ref_rotary", letter(axis.axis));
    if (!column) return {};
    for (std::size_t n = 0; n < rows.size(); ++n) {
      out.Q[n][axis.joint] = servo.at(rows[n], *column) * (linear ? mm : deg);
    }
  }
  if (out.nominal.size() != rows.size() || out.actual.size() != rows.size()) return {};
  return out;
}

std::vector<double> BallQuantities::deviations(const QuantitySpec& spec, std::string& note) {
  const BallSpec& ball = *spec.ball;
  const Path path = path_of(spec.sections, ball);
  std::vector<double> out;
  if (spec.name == "ball_bar_deviation") {
    if (!(spread_about(path.nominal, *ball.bar_centre) < kStands)) {
      note = "the program does not keep its distance to bar_centre_mm";
      return {};
    }
    for (std::size_t n = 0; n < path.nominal.size(); ++n) {
      const double length = (path.nominal[n] - *ball.bar_centre).norm();
      out.push_back(((path.actual[n] - *ball.bar_centre).norm() - length) / um);
    }
    return out;
  }
  const auto which = turning_axis(ball.chain, path.Q);
  if (!which) {
    note = "must be sections in which one rotary axis turns alone";
    return {};
  }
  for (std::size_t n = 0; n < path.nominal.size(); ++n) {
    const Line line = axis_in_workpiece(ball.chain, *which, path.Q[n]);
    const Vector3d arm = path.nominal[n] - line.point;
    const Vector3d radial = arm - arm.dot(line.direction) * line.direction;
    const Vector3d d = path.actual[n] - path.nominal[n];
    if (spec.name == "axial_ball_deviation") {
      out.push_back(d.dot(line.direction) / um);
      continue;
    }
    if (radial.norm() < kLeastRadius) {
      note = "the ball lies on the rotary axis";
      return {};
    }
    const Vector3d along = spec.name == "radial_ball_deviation"
                               ? Vector3d(radial.normalized())
                               : line.direction.cross(radial).normalized();
    out.push_back(d.dot(along) / um);
  }
  return out;
}

BallQuantities::Identified BallQuantities::identify(const QuantitySpec& spec) {
  const BallSpec& ball = *spec.ball;
  const Path path = path_of(spec.sections, ball);
  const std::size_t count = path.nominal.size();
  if (count == 0) return {{}, "no samples"};
  const std::size_t step = (count + kMostSamples - 1) / kMostSamples;
  std::vector<SensorReading> readings;
  std::vector<Vector3d> balls;  // places of the nest
  for (std::size_t n = 0; n < count; n += step) {
    SensorReading reading;
    reading.Q = path.Q[n];
    reading.p_ST = tip_of(ball.chain, reading.Q, path.nominal[n]);
    const Vector3d d = path.actual[n] - path.nominal[n];
    if (ball.bar_centre) {
      reading.n_W = (path.nominal[n] - *ball.bar_centre).normalized();
      reading.d = d.dot(reading.n_W);
      readings.push_back(reading);
      continue;
    }
    const auto at = std::find_if(balls.begin(), balls.end(), [&](const Vector3d& p) {
      return (p - path.nominal[n]).norm() < kStands;
    });
    reading.set_up = static_cast<int>(at - balls.begin());
    if (at == balls.end()) balls.push_back(path.nominal[n]);
    if (balls.size() > spec.sections.size()) {
      return {{}, "the program does not keep the tip in one place in each section"};
    }
    for (int i = 0; i < 3; ++i) {
      reading.n_W = Vector3d::Unit(i);
      reading.d = d[i];
      readings.push_back(reading);
    }
  }
  if (ball.bar_centre && !(spread_about(path.nominal, *ball.bar_centre) < kStands)) {
    return {{}, "the program does not keep its distance to bar_centre_mm"};
  }
  const BallSetUp set_up{.tip_is_unknown = !ball.tip_is_known,
                         .length_is_unknown = ball.bar_centre.has_value()};
  return {identify_locations(ball.chain, readings, set_up), ""};
}

double BallQuantities::location(const QuantitySpec& spec, std::string& note) {
  const BallSpec& ball = *spec.ball;
  assert(ball.error);
  std::string key = fmt::format("{}\n{}", fmt::join(spec.sections, "\n"), ball.tip_is_known);
  if (ball.bar_centre) {
    for (const double x : *ball.bar_centre) key += fmt::format("\n{}", x);
  }
  const auto known = identified_.find(key);
  const Identified& found = known != identified_.end()
                                ? known->second
                                : identified_.emplace(key, identify(spec)).first->second;
  note = found.why_not;
  const LocationEstimate* estimate = found.fit.find(*ball.error);
  if (estimate == nullptr) return kNone;
  note = estimate->why_not();
  return estimate->value ? *estimate->value / (is_linear(ball.error->direction) ? um : urad)
                         : kNone;
}

std::string_view unit_of_location(const plant::ErrorName& name) {
  return is_linear(name.direction) ? "um" : "urad";
}

}  // namespace servomill::sim
