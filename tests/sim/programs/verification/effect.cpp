#include "tests/sim/programs/verification/effect.h"

#include <fmt/format.h>

#include <algorithm>

#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/programs/verification/linuxcnc_replay.h"
#include "sim/programs/verification/readings.h"

namespace servomill::sim::programs {
namespace {

using controllers::ActionKind;
using controllers::MachineAction;
using Eigen::Vector3d;

class Observer {
 public:
  void see(const MachineAction& one) {
    switch (one.kind) {
      case ActionKind::spindle:
        spindle_ = fmt::format("spindle {} {:.3f}", one.direction, one.value);
        return;
      case ActionKind::coolant:
        coolant_ = fmt::format("coolant {}", one.number);
        return;
      case ActionKind::rapid:
      case ActionKind::feed:
      case ActionKind::arc:
        return see_motion(one);
      default:
        put_switches();
        if (one.kind == ActionKind::tool) forget_switches();
        put(fmt::format("{} {} {:.4f}", static_cast<int>(one.kind), one.number, one.value));
        if (one.kind != ActionKind::dwell) at_ = one.end;
    }
  }
  Effect take() { return std::move(effect_); }

 private:
  void put(const std::string& text) {
    effect_.order.push_back(text);
    feed_.clear();
  }
  // State of spindle and coolant when something else happens: their order between is no matter.
  void put_switches() {
    if (spindle_ != seen_spindle_) put(spindle_);
    if (coolant_ != seen_coolant_) put(coolant_);
    seen_spindle_ = spindle_;
    seen_coolant_ = coolant_;
  }
  void forget_switches() {
    for (std::string* one : {&spindle_, &coolant_, &seen_spindle_, &seen_coolant_}) one->clear();
  }
  Vector3d place() const {
    return {at_[0].value_or(0.0), at_[1].value_or(0.0), at_[2].value_or(0.0)};
  }
  void see_motion(const MachineAction& one) {
    bool moves = one.kind == ActionKind::arc;
    std::string end;
    for (std::size_t i = 0; i < at_.size(); ++i) {
      moves |= one.is_commanded[i] && (!at_[i] || !one.end[i] || *at_[i] != *one.end[i]);
      end += one.end[i] ? fmt::format(" {:.7f}", *one.end[i]) : " ?";
    }
    const Vector3d begin = place();
    // frames switch off before or behind their retracts
    if (moves && !one.is_machine_position) put_switches();
    at_ = one.end;
    if (!moves) return;
    if (one.kind == ActionKind::rapid) {
      return put(fmt::format("rapid{} {} {}", end, one.is_straight, one.is_machine_position));
    }
    const std::string feed =
        fmt::format("feed {} {:.9f}", static_cast<int>(one.feed_mode), one.feed);
    if (feed != feed_) {
      put(feed);
      effect_.paths.push_back({begin});
    }
    feed_ = feed;
    effect_.blocks.push_back(fmt::format("{}{} {} {:.7f} {:.7f}", static_cast<int>(one.kind), end,
                                         one.turns, one.centre.x(), one.centre.y()));
    constexpr int kPoints = 200;
    if (one.kind == ActionKind::arc) {
      const ArcSweep arc(begin, place(), one.centre, one.normal_axis, one.turns);
      for (int i = 1; i < kPoints; ++i) {
        effect_.paths.back().push_back(arc.point(static_cast<double>(i) / kPoints));
      }
    }
    effect_.paths.back().push_back(place());
  }

  Effect effect_;
  controllers::KnownPosition at_;
  std::string spindle_, coolant_, seen_spindle_, seen_coolant_, feed_;
};

double distance(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d e = b - a;
  const double n = e.squaredNorm();
  const double t = n > 0.0 ? std::clamp((p - a).dot(e) / n, 0.0, 1.0) : 0.0;
  return (p - a - t * e).norm();
}

bool is_near(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b, double tolerance) {
  std::size_t found =
      1;  // end of the line that the point before is near to: the search begins there
  return std::all_of(a.begin(), a.end(), [&](const Vector3d& p) {
    for (std::size_t k = 1; k < b.size(); ++k, found = found + 1 < b.size() ? found + 1 : 1) {
      if (distance(p, b[found - 1], b[found]) <= tolerance) return true;
    }
    return false;
  });
}

}  // namespace

std::vector<Effect> effects_of(const std::string& text, Dialect dialect,
                               const controllers::ControlSetup& setup) {
  std::vector<Effect> out;
  try {
    for (const Reading& reading : readings_of(text, dialect, setup, {})) {
      Observer observer;
      for (const MachineAction& one : reading.read()) observer.see(one);
      out.push_back(observer.take());
    }
  } catch (const InputError&) {
    return {};
  }
  return out;
}

std::vector<Effect> linuxcnc_effects_of(const std::string& text, controllers::ProgramSetup setup,
                                        const JointLayout& layout) {
  setup.reader = controllers::Reader::linuxcnc;
  OriginalOptions options;
  options.layout = layout;
  std::vector<Effect> out;
  try {
    for (const double start : {0.0, 17.0 * mm}) {
      setup.start.head<3>().setConstant(start);
      Observer observer;
      for (const MachineAction& one : replay_linuxcnc(text, "mutant", setup, options)) {
        observer.see(one);
      }
      out.push_back(observer.take());
    }
  } catch (const InputError&) {
    return {};
  }
  return out;
}

bool is_within(const std::vector<Effect>& a, const std::vector<Effect>& b, double tolerance) {
  if (a.size() != b.size() || a.empty()) return false;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (a[k].order != b[k].order || a[k].paths.size() != b[k].paths.size()) return false;
    for (std::size_t i = 0; i < a[k].paths.size(); ++i) {
      if (!is_near(a[k].paths[i], b[k].paths[i], tolerance)) return false;
      if (!is_near(b[k].paths[i], a[k].paths[i], tolerance)) return false;
      if ((a[k].paths[i].back() - b[k].paths[i].back()).norm() > tolerance) return false;
    }
  }
  return true;
}

}  // namespace servomill::sim::programs
