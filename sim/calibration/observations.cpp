#include "sim/calibration/observations.h"

#include <fmt/format.h>

#include <cmath>
#include <tuple>

#include "plant/vocabulary/units.h"
#include "sim/calibration/observation_builder.h"
#include "sim/calibration/point_observations.h"

namespace servomill::sim::calibration {
namespace {

using Eigen::Vector3d;
using readings::Kind;
using readings::Reading;

constexpr double kReference = 20.0;  // degC, ISO 1

// Lines, squares and circles: single numbers along a motion of axes.
class LineObservations {
 public:
  explicit LineObservations(ObservationBuilder& builder) : b_(builder) {}

  void add() {
    switch (group().kind) {
      case Kind::positioning:
        return add_positioning();
      case Kind::straightness:
        return add_straightness();
      case Kind::angle:
        return add_angle();
      case Kind::squareness:
        return add_squareness();
      case Kind::circle:
        return add_circle();
      default:
        return add_point_observations(b_);
    }
  }

 private:
  const readings::Group& group() const { return b_.group(); }
  int joint(Axis axis) const { return b_.joint(axis); }

  // Direction of a diagonal: from its first to its last row.
  Vector3d path_direction() const {
    const Vector3d whole = b_.tip(group().rows.back().Q) - b_.tip(group().rows.front().Q);
    if (whole.norm() > 0.0) return whole.normalized();
    throw InputError({group().file},
                     "the start and end of a diagonal must differ (its first and last rows)");
  }

  void add_positioning() {
    const bool is_path = !group().axis;
    const bool is_turn = group().axis && !is_linear(*group().axis);
    const std::size_t zero = is_turn ? b_.add_own("zero", urad, "urad") : b_.add_own("zero");
    const Vector3d start = b_.tip(group().rows.front().Q);
    std::optional<std::size_t> expansion, warmth;
    if (!is_turn) std::tie(expansion, warmth) = add_expansion();
    const auto wavelength = add_wavelength();
    for (std::size_t row = 0; row < group().rows.size(); ++row) {
      const Joints& Q = group().rows[row].Q;
      Pose pose;
      pose.is_turn = is_turn;
      pose.n_W = is_path   ? path_direction()
                 : is_turn ? b_.turn_of(*group().axis, Q)
                           : b_.direction_of(*group().axis, Q);
      Observation& one = b_.add(row, 0, pose);
      one.set_up.push_back({zero, 1.0});
      if (is_turn) continue;
      // lengths from the first row on; rotary axes stand still, so W is turned the same way
      const double length = (b_.tip(Q) - start).dot(pose.n_W);
      add_scale(one, length);
      add_temperature(one, length, expansion, warmth);
      if (wavelength) {
        const double path = group().dead_path->length + length;
        one.set_up.push_back({*wavelength, b_.share_of_time(row) * path});
      }
    }
  }

  // A reading is short by the share by which the instrument's scale is long.
  void add_scale(Observation& one, double length) {
    if (const auto scale = b_.scale()) one.set_up.push_back({*scale, length});
  }

  using TwoUnknowns = std::pair<std::optional<std::size_t>, std::optional<std::size_t>>;
  TwoUnknowns add_expansion() {
    const auto& expansion = group().expansion;
    TwoUnknowns out;
    if (!expansion) return out;
    if (expansion->coefficient_uncertainty > 0.0) {
      out.first =
          b_.add_own("expansion coefficient", 1e-6, "um/m/K", expansion->coefficient_uncertainty);
    }
    if (expansion->temperature_uncertainty > 0.0) {
      out.second = b_.add_own("temperature", 1.0, "K", expansion->temperature_uncertainty);
    }
    return out;
  }

  // Taken back to 20 degC: a length is shown long by alpha (T - 20 degC).
  void add_temperature(Observation& one, double length, std::optional<std::size_t> expansion,
                       std::optional<std::size_t> warmth) {
    const double T = group().rows[one.row].temperature;
    if (!group().expansion || std::isnan(T)) return;
    const double alpha = group().expansion->coefficient;
    b_.correct(one, -alpha * (T - kReference) * length);
    if (expansion) one.set_up.push_back({*expansion, (T - kReference) * length});
    if (warmth) one.set_up.push_back({*warmth, alpha * length});
  }

  // The wavelength of a laser changes with the air, over the dead path, too: linearly in time.
  std::optional<std::size_t> add_wavelength() {
    if (!group().dead_path) return std::nullopt;
    return b_.add_own("change of the wavelength", 1e-6, "um/m", group().dead_path->change);
  }

  void add_straightness() {
    const std::size_t zero = b_.add_own("zero"), slope = b_.add_own("slope", 1e-6, "um/m");
    const int moving = joint(*group().axis);
    const double middle = mean_position(moving);
    for (std::size_t row = 0; row < group().rows.size(); ++row) {
      const Joints& Q = group().rows[row].Q;
      Pose pose;
      pose.n_W = b_.direction_of(*group().direction, Q);
      Observation& one = b_.add(row, 0, pose);
      one.set_up.push_back({zero, 1.0});
      one.set_up.push_back({slope, Q[moving] - middle});
    }
  }

  double mean_position(int moving) const {
    double sum = 0.0;
    for (const Reading& reading : group().rows) sum += reading.Q[moving];
    return sum / static_cast<double>(group().rows.size());
  }

  void add_angle() {
    const std::size_t zero = b_.add_own("zero", urad, "urad");
    for (std::size_t row = 0; row < group().rows.size(); ++row) {
      Pose pose;
      pose.is_turn = true;
      pose.n_W = b_.direction_of(*group().direction, group().rows[row].Q);
      b_.add(row, 0, pose).set_up.push_back({zero, 1.0});
    }
  }

  // The angle between the mean lines grows where the first bends away from the second axis and
  // the second from the first: minus the slope of either along the other.
  void add_squareness() {
    Observation one{.poses = {},
                    .set_up = {},
                    .d = group().rows[0].deviation[0],
                    .group = b_.index(),
                    .row = 0};
    for (int i : {0, 1}) {
      const Axis moving = group().plane[static_cast<std::size_t>(i)];
      const Axis across = group().plane[static_cast<std::size_t>(1 - i)];
      const double length = group().legs[static_cast<std::size_t>(i)];
      const int n = group().targets;
      double squares = 0.0;
      const auto place = [&](int k) { return length * (double(k) / (n - 1) - 0.5); };
      for (int k = 0; k < n; ++k) squares += place(k) * place(k);
      for (int k = 0; k < n; ++k) {
        Pose pose;
        pose.Q = group().at;
        pose.Q[joint(moving)] += length * k / (n - 1);
        pose.p_ST = group().p_ST;
        pose.n_W = b_.direction_of(across, pose.Q);
        pose.weight = -place(k) / squares;
        one.poses.push_back(pose);
      }
    }
    b_.observations().push_back(std::move(one));
  }

  void add_circle() {
    const std::size_t a = b_.add_own(fmt::format("centre {}", letter(group().plane[0]))),
                      b = b_.add_own(fmt::format("centre {}", letter(group().plane[1]))),
                      radius = b_.add_size("radius");
    const int i = joint(group().plane[0]), j = joint(group().plane[1]);
    for (std::size_t row = 0; row < group().rows.size(); ++row) {
      const Joints Q = group().rows[row].Q;
      const double u = (Q[i] - group().at[i]) / group().radius;
      const double v = (Q[j] - group().at[j]) / group().radius;
      Pose pose;
      pose.n_W =
          (u * b_.direction_of(group().plane[0], Q) + v * b_.direction_of(group().plane[1], Q))
              .normalized();
      Observation& one = b_.add(row, 0, pose);
      one.set_up.push_back({a, u});
      one.set_up.push_back({b, v});
      one.set_up.push_back({radius, 1.0});
    }
  }

  ObservationBuilder& b_;
};

}  // namespace

Observations observations_of(const readings::Readings& readings, const plant::MachineChain& chain) {
  ObservationBuilder builder(readings, chain);
  for (std::size_t group = 0; group < readings.groups.size(); ++group) {
    builder.begin(group);
    LineObservations(builder).add();
    if (builder.group().drifts) builder.add_drift();
    builder.add_turning_points();
  }
  return builder.take();
}

}  // namespace servomill::sim::calibration
