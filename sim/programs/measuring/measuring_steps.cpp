#include "sim/programs/measuring/measuring_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"

namespace servomill::sim::programs {
namespace {

using Eigen::Vector3d;
using readings::Group;
using readings::Kind;
using readings::Reading;

constexpr double kSameAngle = 1e-9;  // rad
constexpr double kFacing = 0.05;     // of the table's normal along a side: it turns towards it
constexpr double kSteepest = 0.5;    // cosine: the table turned by 60 degrees

// A sphere at one pair of angles, with the tip at its centre.
struct Target {
  const Group* group;
  const Reading* reading;
};

void require_turning_table(const model::MachineSettings& machine) {
  const JointLayout& layout = machine.chain.layout;
  bool turns = false;
  for (const Axis axis : {Axis::A, Axis::B, Axis::C}) {
    const auto joint = layout.joint_of(axis);
    if (!joint) continue;
    turns = true;
    Joints turned = Joints::Zero();
    turned[*joint] = 0.1;
    const Vector3d tool = plant::forward(machine.chain, turned, Vector3d::Zero()).k_W;
    const Vector3d spindle = plant::R_WM(machine.chain, turned) * Vector3d::UnitZ();
    if ((tool - spindle).norm() > 1e-9) {
      throw InputError(
          {"plan-calibration"},
          fmt::format("writes measuring programs only for machines whose rotary axes carry the "
                      "table; {} carries the spindle, whose rotation swings the stylus about the "
                      "sphere and changes its pre-travel direction, which is not supported; use "
                      "--instruments without probe for the other measurements",
                      letter(axis)));
    }
  }
  if (!turns) {
    throw InputError({"plan-calibration"},
                     "writes measuring programs for machines with rotary axes; this one has none");
  }
}

class Moves {
 public:
  Moves(const model::MachineSettings& machine, const ProbingSettings& settings, double length)
      : machine_(machine), settings_(settings), length_(length) {
    top_ = machine.nc.upper[2] - length;
  }

  MeasuringMoves make(const readings::Readings& plan) {
    std::vector<Target> targets;
    for (const Group& group : plan.groups) {
      if (group.kind != Kind::sphere || std::abs(group.p_ST.z() + length_) > 1e-9) continue;
      for (const Reading& reading : group.rows) targets.push_back({&group, &reading});
    }
    const auto angles = [](const Target& one) {
      return std::pair(one.reading->Q[3], one.reading->Q[4]);
    };
    std::stable_sort(targets.begin(), targets.end(),
                     [&](const Target& a, const Target& b) { return angles(a) < angles(b); });
    turn_back_and_forth(targets);
    if (!targets.empty()) rapid({{2, top_}});
    for (const Target& target : targets) measure(target);
    for (const auto& [why, count] : left_out_) {
      out_.notes.push_back(fmt::format("{}, at {} poses that are omitted", why, count));
    }
    return std::move(out_);
  }

 private:
  // Every other angle of the first rotary axis in the other order of the second: no way back over
  // half a turn.
  static void turn_back_and_forth(std::vector<Target>& targets) {
    bool back = false;
    for (auto first = targets.begin(); first != targets.end();) {
      const auto last = std::find_if(first, targets.end(), [&](const Target& one) {
        return std::abs(one.reading->Q[3] - first->reading->Q[3]) > kSameAngle;
      });
      if (back) std::reverse(first, last);
      back = !back;
      first = last;
    }
  }

  using Words = std::vector<std::pair<int, double>>;  // axis and value

  void rapid(const Words& words) {
    MeasuringStep step;
    for (const auto& [axis, value] : words) step.to[std::size_t(axis)] = value;
    out_.steps.push_back(std::move(step));
  }

  int axis_of_joint(int joint) const {
    return index_of(*machine_.chain.layout.axis[std::size_t(joint)]);
  }

  void measure(const Target& target) {
    const Joints& Q = target.reading->Q;
    const Vector3d up = plant::R_WM(machine_.chain, Q).transpose() * Vector3d::UnitZ();
    const Vector3d centre = Q.head<3>() + target.group->p_ST;
    const std::string& name = target.group->spheres[target.reading->sphere];
    if (const auto why = why_not(centre, up)) {
      ++left_out_[fmt::format("{}: {}", name, *why)];
      return;
    }
    rapid({{2, top_}});
    for (int joint = kLinearJoints; joint < kJoints; ++joint) {
      if (!machine_.chain.layout.has(joint)) continue;
      if (angles_ && std::abs((*angles_)[joint] - Q[joint]) < kSameAngle) continue;
      rapid({{axis_of_joint(joint), Q[joint]}});
    }
    angles_ = Q;
    rapid({{0, centre.x()}});
    rapid({{1, centre.y()}});
    rapid({{2, centre.z() + reach()}});
    touch(target, centre, 2, 1);
    for (const int axis : {0, 1}) {
      for (const int side : {1, -1}) {
        if (side * up[axis] < -kFacing) continue;  // the table is there
        rapid({{axis, centre[axis] + side * reach()}});
        rapid({{2, centre.z()}});
        touch(target, centre, axis, side);
        rapid({{2, centre.z() + reach()}});
      }
      rapid({{axis, centre[axis]}});
    }
    rapid({{2, top_}});
  }

  double radius() const { return 0.5 * (settings_.sphere + settings_.stylus); }
  double reach() const { return radius() + settings_.clearance; }

  // Armed from the clearance to behind the surface, then back.
  void touch(const Target& target, const Vector3d& centre, int axis, int side) {
    MeasuringStep step;
    step.is_probe = true;
    step.to[std::size_t(axis)] = centre[axis] + side * (radius() - settings_.beyond);
    step.sphere = target.group->spheres[target.reading->sphere];
    step.joints = target.reading->Q;
    step.joints[axis] += side * radius();
    out_.steps.push_back(step);
    ++out_.touches;
    rapid({{axis, centre[axis] + side * reach()}});
  }

  std::optional<std::string> why_not(const Vector3d& centre, const Vector3d& up) const {
    if (up.z() < kSteepest) return "the table is rotated by more than 60 deg from the spindle";
    if (centre.z() + reach() > top_) return "Z does not rise above the sphere";
    for (int axis = 0; axis < 3; ++axis) {
      const double room = axis == 2 ? 0.0 : reach();
      const double offset = axis == 2 ? length_ : 0.0;
      if (centre[axis] - room + offset < machine_.nc.lower[axis] ||
          centre[axis] + room + offset > machine_.nc.upper[axis]) {
        return fmt::format("the sides of the sphere are outside the travel of {}", "XYZ"[axis]);
      }
    }
    return std::nullopt;
  }

  const model::MachineSettings& machine_;
  const ProbingSettings& settings_;
  double length_, top_ = 0.0;
  std::optional<Joints> angles_;
  std::map<std::string, int> left_out_;  // poses, by reason
  MeasuringMoves out_;
};

}  // namespace

MeasuringMoves measuring_moves(const readings::Readings& plan,
                               const model::MachineSettings& machine,
                               const ProbingSettings& settings, double length) {
  require_turning_table(machine);
  if (!std::isfinite(machine.nc.upper[2])) {
    throw InputError({"plan-calibration"}, "needs the end of travel of Z: axis.Z.travel_mm");
  }
  return Moves(machine, settings, length).make(plan);
}

}  // namespace servomill::sim::programs
