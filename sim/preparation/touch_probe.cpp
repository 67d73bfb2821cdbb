#include "sim/preparation/touch_probe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "controllers/gcode/modal_state.h"
#include "plant/sensing/noise.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/move_list.h"
#include "plant/vocabulary/units.h"
#include "sim/metrology/location_errors.h"

namespace servomill::sim::preparation {
namespace {

using Eigen::Vector3d;

constexpr double kContact = 1e-10;     // m: a gap that counts as none
constexpr int kMaxSteps = 20000;       // of a search along a surface that is all but parallel
constexpr int kSamples = 16;           // of the speed along a way
constexpr double kSpeedMargin = 1.25;  // over the greatest speed sampled
constexpr int kMaxRounds = 20;         // of (1), which contracts by the slope of the errors
constexpr double kSettled = 1e-13;     // m, rad

}  // namespace

std::vector<Touch> with_sections(std::vector<Touch> touches, const MoveList& moves) {
  std::size_t next = 0;
  std::string section;
  for (const Move& move : moves) {
    if (move.kind == MoveKind::message && move.number != controllers::kPrintMessage) {
      section = move.text;
    }
    const bool is_probing = move.kind == MoveKind::feed && move.number != 0;
    if (is_probing && next < touches.size()) touches[next++].section = section;
  }
  return touches;
}

// A move, and the noise of its switching.
struct TouchedBodies::Way {
  Joints begin, end;  // as the NC shows them
  Vector3d p_ST;      // to the centre of the ball
  Vector3d p_ST_tool;
  double feed = 0.0, length = 0.0;  // m/s or rad/s; m or rad
  double noise = 0.0;               // m
  double speed = 0.0;               // m, greatest of the ball for a whole share

  Joints at(double share) const { return begin + share * (end - begin); }
};

TouchedBodies::TouchedBodies(Setting setting)
    : setting_(std::move(setting)),
      memory_(setting_.machine->plays(), setting_.start),
      directions_(setting_.machine->plays().size()) {}

StrategyParts& TouchedBodies::parts(const Vector3d& p_ST) {
  const auto known = std::find_if(parts_.begin(), parts_.end(),
                                  [&](const auto& one) { return one.first == p_ST; });
  if (known != parts_.end()) return known->second;
  return parts_.emplace_back(p_ST, setting_.strategies(p_ST)).second;
}

Joints TouchedBodies::true_joints(const Joints& Q, const Vector3d& p_ST) {
  StrategyParts& strategies = parts(p_ST);
  Joints wanted = Q;
  for (const auto& setpoint : strategies.setpoints) wanted += setpoint->offset(Q);
  if (!strategies.feedback) return wanted;
  Joints Q_true = wanted;
  for (int round = 0; round < kMaxRounds; ++round) {
    const Joints next = wanted - strategies.feedback->settle(Q_true);
    const double change = (next - Q_true).cwiseAbs().maxCoeff();
    Q_true = next;
    if (change < kSettled) break;
  }
  return Q_true;
}

// Gap that is left until the probe switches; negative: it has.
double TouchedBodies::gap(const Way& way, double share) {
  const model::TouchProbe& probe = *setting_.probe;
  const plant::VolumetricModel& machine = *setting_.machine;
  const Joints Q = true_joints(way.at(share), way.p_ST_tool);
  memory_.directions(Q, directions_);
  const Vector3d centre = setting_.frame.point(machine.forward(Q, way.p_ST, directions_).p_WT);
  const double distance = metrology::signed_distance(probe.bodies, centre);
  const Vector3d n_W = setting_.frame.R_WG * metrology::outward_normal(probe.bodies, centre);
  const Vector3d n_S = metrology::R_WS(machine.chain(), Q).transpose() * n_W;
  const double across = std::hypot(n_S.x(), n_S.y());
  const double angle = std::atan2(n_S.y(), n_S.x());
  const double deflection =
      probe.pretravel + way.noise +
      probe.lobing * across * std::cos(probe.lobes * angle - probe.lobing_phase);
  return distance - probe.radius + deflection;
}

// Steps by no more than the gap lets the ball go: nothing thin is passed over.
std::optional<double> TouchedBodies::switching_share(const Way& way) {
  const double sign = gap(way, 0.0) > 0.0 ? 1.0 : -1.0;
  double share = 0.0;
  for (int step = 0; step < kMaxSteps; ++step) {
    const double left = sign * gap(way, share);
    if (left <= kContact) return share;
    if (share >= 1.0) return std::nullopt;
    share = std::min(share + left / way.speed, 1.0);
  }
  throw InputError({}, "the stylus slides along a surface for too long; probe normal to it");
}

double TouchedBodies::stopping_share(const Way& way) const {
  const Joints per_length = (way.end - way.begin) / way.length;
  double a = std::numeric_limits<double>::infinity();
  for (int j = 0; j < kJoints; ++j) {
    if (per_length[j] != 0.0) a = std::min(a, setting_.a_max[j] / std::abs(per_length[j]));
  }
  return way.feed * way.feed / (2.0 * a) / way.length;
}

std::optional<controllers::ProbeContact> TouchedBodies::contact(
    const controllers::ProbingMove& move) {
  const model::TouchProbe& probe = *setting_.probe;
  const JointLayout& layout = setting_.machine->chain().layout;
  Way way{layout.joints(move.begin_machine), layout.joints(move.end_machine),
          move.p_ST + probe.stylus, move.p_ST};
  way.feed = move.feed;
  const AxisWords change = move.end - move.begin;
  way.length = change.head<3>().norm() > 0.0 ? change.head<3>().norm() : change.norm();
  const plant::NoiseKey key{probe.seed, 0};
  way.noise =
      probe.repeatability * plant::white_noise(key, 0, static_cast<Tick>(touches_.size()))[0];
  memory_.travel(way.begin);
  Vector3d before = Vector3d::Zero();
  for (int k = 0; k <= kSamples; ++k) {
    const Vector3d p = plant::forward(setting_.machine->chain(),
                                      way.at(static_cast<double>(k) / kSamples), way.p_ST)
                           .p_WT;
    if (k > 0) way.speed = std::max(way.speed, kSpeedMargin * kSamples * (p - before).norm());
    before = p;
  }
  if (way.length == 0.0 || way.speed == 0.0) return std::nullopt;
  const bool touches_now = gap(way, 0.0) <= kContact;
  if (touches_now != move.mode.leaves()) {
    throw InputError({}, touches_now ? "the probe is in contact before the move starts"
                                     : "the probe is not in contact where the move starts");
  }
  const std::optional<double> share = switching_share(way);
  const auto at = [&](double s) { return AxisWords(move.begin + std::min(s, 1.0) * change); };
  if (!share) {
    memory_.travel(way.end);
    touches_.push_back({move.line, {}, way.end, false});
    return std::nullopt;
  }
  const double latched = *share + way.feed * probe.delay / way.length;
  const double rest = std::min(*share + stopping_share(way), 1.0);
  memory_.travel(way.at(rest));
  touches_.push_back({move.line, {}, way.at(std::min(latched, 1.0)), true});
  return controllers::ProbeContact{at(latched), at(rest)};
}

}  // namespace servomill::sim::preparation
