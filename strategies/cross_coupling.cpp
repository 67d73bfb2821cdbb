#include "strategies/cross_coupling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "strategies/traced_path.h"

namespace servomill::strategies {
namespace {

using Eigen::Vector3d;

constexpr std::array<std::string_view, 1> kAuto = {"auto"};
constexpr double kResetRatio = 8.0;  // Ti (Kv + C) of `auto`: costs at most 7 deg at the crossover
// Time constants of the position loop for which the path is remembered: the tip follows by one.
constexpr double kRemembered = 8.0;
constexpr double kLongest = 1e5;  // position periods

const std::array<ParameterSpec, 3>& specs() {
  static const std::array<ParameterSpec, 3> kSpecs = {{
      {.name = "gain_per_s",
       .help = "gain C, velocity per contour error; auto: the largest gain with a phase margin of "
               "45 deg and a gain margin of 6 dB for X, Y and Z",
       .unit = "1/s",
       .default_text = "auto",
       .min = 0.0,
       .max = 1e5,
       .words = kAuto},
      {.name = "reset_time_ms",
       .help =
           "reset time Ti of the integral of the contour error; 0: no integral; auto: 8 / (Kv + C)",
       .unit = "ms",
       .default_text = "0",
       .min = 0.0,
       .max = 1e6,
       .words = kAuto},
      {.name = "max_mm_per_s",
       .help = "limit of the added velocity",
       .unit = "mm/s",
       .default_text = "20",
       .min = 0.0,
       .shortcoming = Shortcoming::saturation,
       .ideal = "1e6"},
  }};
  return kSpecs;
}

// State of one run.
class ContourTerm final : public PositionLoopPart {
 public:
  ContourTerm(const IdentifiedMachine& identified, const AddedGain& gain, double most,
              double slowest, double period)
      : chain_(identified.model.chain()),
        p_ST_(identified.p_ST),
        gain_(gain),
        most_(most),
        period_(period),
        path_(static_cast<std::size_t>(std::min(kRemembered / (slowest * period), kLongest))) {}

  void settle(const Reading& now) override {
    path_.start(tip(now.Q_cmd));
    integral_.setZero();
    tangent_.setZero();
  }

  Joints velocity(const Reading& now) override {
    path_.add(tip(now.Q_cmd));
    if (!path_.has_moved()) return Joints::Zero();
    const Vector3d a = tip(now.Q_fb);
    const TracedPath::Place place = path_.nearest(a);
    const Vector3d e = place.point - a;
    turn_integral(place.tangent);
    Vector3d v = gain_.C * e + integral_;
    const double size = v.norm();
    if (size > most_) {
      v *= most_ / size;
    } else if (gain_.Ti > 0.0) {
      integral_ += gain_.C / gain_.Ti * period_ * e;
    }
    Joints out = Joints::Zero();
    out.head<kLinearJoints>() = plant::least_squares(plant::linear_jacobian(chain_, now.Q_fb), v).x;
    return out;
  }

 private:
  Vector3d tip(const Joints& Q) const { return plant::forward(chain_, Q, p_ST_).p_WT; }

  // From one tangent to the next by the smallest rotation; where the path turns back it stays.
  void turn_integral(const Vector3d& tangent) {
    constexpr double kBack = -0.5;  // cosine
    if (tangent_.dot(tangent) > kBack && !tangent_.isZero(0.0)) {
      const Vector3d w = tangent_.cross(tangent);
      const double c = tangent_.dot(tangent);
      integral_ = integral_ + w.cross(integral_) + w.cross(w.cross(integral_)) / (1.0 + c);
    }
    integral_ -= tangent.dot(integral_) * tangent;
    tangent_ = tangent;
  }

  const plant::MachineChain chain_;
  Vector3d p_ST_;
  AddedGain gain_;
  double most_;  // m/s
  double period_;
  TracedPath path_;
  Vector3d integral_ = Vector3d::Zero();  // m/s
  Vector3d tangent_ = Vector3d::Zero();   // of the last place; 0: none yet
};

class Contour final : public Strategy {
 public:
  Contour(const IdentifiedMachine& identified, const AddedGain& gain, double most, double slowest)
      : identified_(identified), gain_(gain), most_(most), slowest_(slowest) {}

  std::unique_ptr<PositionLoopPart> position_loop(double position_period) const override {
    return std::make_unique<ContourTerm>(identified_, gain_, most_, slowest_, position_period);
  }
  std::optional<AddedGain> added_gain() const override { return gain_; }

 private:
  IdentifiedMachine identified_;
  AddedGain gain_;
  double most_;     // m/s
  double slowest_;  // 1/s, least Kv
};

std::optional<WantedMargins> wanted_margins(const Parameters& p) {
  if (!p.is_word("gain_per_s")) return std::nullopt;
  if (p.is_word("reset_time_ms")) return WantedMargins{.reset_ratio = kResetRatio};
  return WantedMargins{.Ti = p.number("reset_time_ms")};
}

std::unique_ptr<Strategy> make(const Parameters& p, Action, const IdentifiedMachine& identified) {
  double slowest = 0.0, fastest = 0.0;
  for (int j = 0; j < kLinearJoints; ++j) {
    if (!identified.layout.has(j)) continue;
    slowest = slowest > 0.0 ? std::min(slowest, identified.Kv[j]) : identified.Kv[j];
    fastest = std::max(fastest, identified.Kv[j]);
  }
  AddedGain gain;
  gain.C = p.is_word("gain_per_s") ? identified.added_gain : p.number("gain_per_s");
  if (gain.C == 0.0 && p.is_word("gain_per_s")) {
    throw InputError(Place{},
                     "gain_per_s = \"auto\": the position loops as they are have less than "
                     "45 deg or 6 dB; lower Kv, or give a gain");
  }
  gain.Ti =
      p.is_word("reset_time_ms") ? kResetRatio / (fastest + gain.C) : p.number("reset_time_ms");
  return std::make_unique<Contour>(identified, gain, p.number("max_mm_per_s"), slowest);
}

}  // namespace

Entry contour_entry() {
  Entry entry = {"contour",
                 "adds the contour error to the velocity commands: cross-coupled control", specs(),
                 make};
  entry.once = true;
  entry.corrects_following = true;
  entry.reads_gains = true;
  entry.reads_errors = false;
  entry.wanted_margins = wanted_margins;
  return entry;
}

}  // namespace servomill::strategies
