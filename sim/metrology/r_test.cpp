#include "sim/metrology/r_test.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <optional>

#include "plant/vocabulary/units.h"

namespace servomill::sim::metrology {
namespace {

using Eigen::Vector3d;

constexpr double kStands = 1.0 * um;        // how far a nominal tip may move, or a bar lengthen
constexpr double kTurns = 1e3 * urad;       // corrections turn an axis by less
constexpr double kMinArm = 1.0 * mm;        // of a ball about an axis
constexpr std::size_t kMaxSamples = 20000;  // for one identification

AxisLine axis_in_workpiece(const plant::MachineChain& chain, std::size_t which, const Joints& Q) {
  const plant::ChainAxis& axis = chain.axes[which];
  ToolPose P{axis.centre, plant::direction_of(axis)};
  for (std::size_t i = which; i-- > 0;) {
    const plant::ChainAxis& nearer = chain.axes[i];
    plant::apply(nearer, plant::motion_at(nearer, Q[nearer.joint]), P);
  }
  return {P.p_WT, axis.sense == plant::Sense::tool ? P.k_W : Vector3d(-P.k_W)};
}

bool turns(const std::vector<Joints>& Q, int joint) {
  const auto [low, high] = std::minmax_element(
      Q.begin(), Q.end(), [&](const Joints& a, const Joints& b) { return a[joint] < b[joint]; });
  return low != Q.end() && (*high)[joint] - (*low)[joint] > kTurns;
}

// The rotary axis that turns, by its place in the chain, if it is one alone.
std::optional<std::size_t> turning_axis(const plant::MachineChain& chain,
                                        const std::vector<Joints>& Q) {
  std::optional<std::size_t> out;
  for (std::size_t i = 0; i < chain.axes.size(); ++i) {
    const plant::ChainAxis& axis = chain.axes[i];
    if (is_linear(axis.axis) || !turns(Q, axis.joint)) continue;
    if (out) return std::nullopt;
    out = i;
  }
  return out;
}

// Tip in the spindle nose of the ideal machine.
Vector3d tip_of(const plant::MachineChain& chain, const Joints& Q, const Vector3d& p_WT) {
  const Vector3d p_WS = plant::forward(chain, Q, Vector3d::Zero()).p_WT;
  return R_WS(chain, Q).transpose() * (p_WT - p_WS);
}

// Why the nominal tip does not stay on a sphere, or nothing.
std::string why_no_bar(const TipPath& path, const Vector3d& centre) {
  if (path.nominal.empty()) return "there are no samples";
  double low = (path.nominal.front() - centre).norm(), high = low;
  for (const Vector3d& p : path.nominal) {
    low = std::min(low, (p - centre).norm());
    high = std::max(high, (p - centre).norm());
  }
  if (low < kMinArm) return "the TCP passes through the centre of the bar";
  return high - low < kStands ? ""
                              : "the TCP does not keep its distance from the centre of the bar";
}

// As many samples of a path as are enough, evenly.
std::size_t stride(std::size_t count) { return count / kMaxSamples + 1; }

}  // namespace

AxisLine axis_in_workpiece(const plant::MachineChain& chain, Axis axis, const Joints& Q) {
  const auto found = std::find_if(chain.axes.begin(), chain.axes.end(),
                                  [&](const plant::ChainAxis& one) { return one.axis == axis; });
  assert(found != chain.axes.end());
  return axis_in_workpiece(chain, static_cast<std::size_t>(found - chain.axes.begin()), Q);
}

BallDeviation nest_deviation(const plant::MachineChain& chain, const TipPath& path,
                             NestDirection direction) {
  const auto which = turning_axis(chain, path.Q);
  if (!which) return {{}, "not exactly one rotary axis moves"};
  BallDeviation out;
  for (std::size_t n = 0; n < path.Q.size(); ++n) {
    const AxisLine line = axis_in_workpiece(chain, *which, path.Q[n]);
    const Vector3d tangent = line.direction.cross(path.nominal[n] - line.point);
    if (tangent.norm() < kMinArm) return {{}, "the ball is on the moving rotary axis"};
    const Vector3d along = direction == NestDirection::axial ? line.direction
                           : direction == NestDirection::tangential
                               ? Vector3d(tangent.normalized())
                               : Vector3d(tangent.cross(line.direction).normalized());
    out.d.push_back((path.actual[n] - path.nominal[n]).dot(along));
  }
  return out;
}

BallDeviation bar_deviation(const TipPath& path, const Vector3d& centre) {
  BallDeviation out{{}, why_no_bar(path, centre)};
  if (!out.why_not.empty()) return out;
  for (std::size_t n = 0; n < path.nominal.size(); ++n) {
    out.d.push_back((path.actual[n] - centre).norm() - (path.nominal[n] - centre).norm());
  }
  return out;
}

BallReadings nest_readings(const plant::MachineChain& chain, const TipPath& path,
                           std::size_t most_places) {
  if (path.nominal.empty()) return {{}, "there are no samples"};
  BallReadings out;
  std::vector<Vector3d> places;
  for (std::size_t n = 0; n < path.nominal.size(); n += stride(path.nominal.size())) {
    const Vector3d& p = path.nominal[n];
    const auto place = std::find_if(places.begin(), places.end(),
                                    [&](const Vector3d& q) { return (p - q).norm() < kStands; });
    const auto set_up = static_cast<int>(place - places.begin());
    if (place == places.end()) places.push_back(p);
    if (places.size() > most_places) return {{}, "the TCP does not stay at rest in its sections"};
    const Vector3d d = path.actual[n] - p, p_ST = tip_of(chain, path.Q[n], p);
    for (int i = 0; i < 3; ++i) {
      out.readings.push_back({path.Q[n], p_ST, Vector3d::Unit(i), d[i], set_up});
    }
  }
  return out;
}

BallReadings bar_readings(const plant::MachineChain& chain, const TipPath& path,
                          const Vector3d& centre, int set_up) {
  BallReadings out{{}, why_no_bar(path, centre)};
  if (!out.why_not.empty()) return out;
  const std::vector<double> d = bar_deviation(path, centre).d;
  for (std::size_t n = 0; n < d.size(); n += stride(d.size())) {
    const Vector3d& p = path.nominal[n];
    out.readings.push_back(
        {path.Q[n], tip_of(chain, path.Q[n], p), (p - centre).normalized(), d[n], set_up});
  }
  return out;
}

}  // namespace servomill::sim::metrology
