#include "sim/calibration/observations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/metrology/location_errors.h"

namespace servomill::sim::calibration {
namespace {

using Eigen::Vector3d;
using readings::Group;
using readings::Kind;
using readings::Reading;

constexpr double kReference = 20.0;  // degC, ISO 1

class Builder {
 public:
  Builder(const readings::Readings& readings, const plant::MachineChain& chain)
      : readings_(readings), chain_(chain) {
    for (const readings::Instrument& instrument : readings.instruments) {
      const std::optional<double> prior = instrument.scale_uncertainty > 0.0
                                              ? std::optional(instrument.scale_uncertainty)
                                              : std::nullopt;
      scales_.push_back(prior ? std::optional(add_unknown({.name = "scale of " + instrument.name,
                                                           .group = std::nullopt,
                                                           .prior = prior,
                                                           .unit = 1e-6,
                                                           .unit_name = "um/m"}))
                              : std::nullopt);
    }
  }

  Observations build() {
    for (group_ = 0; group_ < readings_.groups.size(); ++group_) {
      switch (group().kind) {
        case Kind::positioning:
          add_positioning();
          break;
        case Kind::straightness:
          add_straightness();
          break;
        case Kind::angle:
          add_angle();
          break;
        case Kind::squareness:
          add_squareness();
          break;
        case Kind::circle:
          add_circle();
          break;
        case Kind::ball_bar:
          add_ball_bar();
          break;
        case Kind::r_test:
          add_r_test();
          break;
        case Kind::sphere:
          add_spheres();
          break;
      }
      if (group().drifts) add_drift();
    }
    return std::move(out_);
  }

 private:
  const Group& group() const { return readings_.groups[group_]; }
  int joint(Axis axis) const { return *chain_.layout.joint_of(axis); }

  std::size_t add_unknown(SetUpUnknown unknown) {
    out_.set_up.push_back(std::move(unknown));
    return out_.set_up.size() - 1;
  }
  std::size_t add_own(std::string name, double unit = um, std::string unit_name = "um",
                      std::optional<double> prior = std::nullopt) {
    return add_unknown({.name = std::move(name),
                        .group = group_,
                        .prior = prior,
                        .unit = unit,
                        .unit_name = std::move(unit_name)});
  }
  std::array<std::size_t, 3> add_point(const std::string& name) {
    return {add_own(name + " X"), add_own(name + " Y"), add_own(name + " Z")};
  }

  Observation& add(std::size_t row, int number, Pose pose) {
    const Reading& reading = group().rows[row];
    pose.Q = reading.Q;
    pose.p_ST = group().p_ST;
    pose.direction = reading.direction;
    out_.all.push_back({.poses = {pose},
                        .set_up = {},
                        .d = reading.deviation[number],
                        .correction = 0.0,
                        .group = group_,
                        .row = row});
    return out_.all.back();
  }

  static void correct(Observation& one, double by) {
    one.d += by;
    one.correction += by;
  }

  Vector3d tip(const Joints& Q) const { return plant::forward(chain_, Q, group().p_ST).p_WT; }

  // Direction in W of a deviation along or about an axis of the machine, at these joints.
  Vector3d direction_of(Axis axis, const Joints& Q) const {
    const Vector3d unit = Vector3d::Unit(index_of(axis) % 3);
    return plant::R_WM(chain_, Q) * unit;
  }
  // The axis about which a rotary axis turns, seen from W.
  Vector3d turn_of(Axis axis, const Joints& Q) const {
    Joints beyond = Q;
    const double step = 1e-4;
    beyond[joint(axis)] += step;
    const Eigen::Matrix3d R = metrology::R_WS(chain_, Q);
    const Eigen::Matrix3d dR = (metrology::R_WS(chain_, beyond) - R) * R.transpose() / step;
    return Vector3d(dR(2, 1) - dR(1, 2), dR(0, 2) - dR(2, 0), dR(1, 0) - dR(0, 1)).normalized();
  }

  // Direction of a diagonal: from its first to its last row.
  Vector3d path_direction() const {
    const Vector3d whole = tip(group().rows.back().Q) - tip(group().rows.front().Q);
    if (whole.norm() > 0.0) return whole.normalized();
    throw InputError({group().file},
                     "a diagonal must end elsewhere than it begins (its first and last rows)");
  }

  void add_positioning() {
    const bool is_path = !group().axis;
    const bool is_turn = group().axis && !is_linear(*group().axis);
    const std::size_t zero = is_turn ? add_own("zero", urad, "urad") : add_own("zero");
    const Vector3d start = tip(group().rows.front().Q);
    std::optional<std::size_t> expansion, warmth;
    if (!is_turn) std::tie(expansion, warmth) = add_expansion();
    for (std::size_t row = 0; row < group().rows.size(); ++row) {
      const Joints& Q = group().rows[row].Q;
      Pose pose;
      pose.is_turn = is_turn;
      pose.n_W = is_path   ? path_direction()
                 : is_turn ? turn_of(*group().axis, Q)
                           : direction_of(*group().axis, Q);
      Observation& one = add(row, 0, pose);
      one.set_up.push_back({zero, 1.0});
      if (is_turn) continue;
      // lengths from the first row on; rotary axes stand still, so W is turned the same way
      const double length = (tip(Q) - start).dot(pose.n_W);
      add_scale(one, length);
      add_temperature(one, length, expansion, warmth);
    }
  }

  // A reading is short by the share by which the instrument's scale is long.
  void add_scale(Observation& one, double length) {
    const auto instrument = group().instrument;
    if (instrument && scales_[*instrument]) one.set_up.push_back({*scales_[*instrument], length});
  }

  using TwoUnknowns = std::pair<std::optional<std::size_t>, std::optional<std::size_t>>;
  TwoUnknowns add_expansion() {
    const auto& expansion = group().expansion;
    TwoUnknowns out;
    if (!expansion) return out;
    if (expansion->coefficient_uncertainty > 0.0) {
      out.first =
          add_own("expansion coefficient", 1e-6, "um/m/K", expansion->coefficient_uncertainty);
    }
    if (expansion->temperature_uncertainty > 0.0) {
      out.second = add_own("temperature", 1.0, "K", expansion->temperature_uncertainty);
    }
    return out;
  }

  // Taken back to 20 degC: a length is shown long by alpha (T - 20 degC).
  void add_temperature(Observation& one, double length, std::optional<std::size_t> expansion,
                       std::optional<std::size_t> warmth) {
    const double T = group().rows[one.row].temperature;
    if (!group().expansion || std::isnan(T)) return;
    const double alpha = group().expansion->coefficient;
    correct(one, -alpha * (T - kReference) * length);
    if (expansion) one.set_up.push_back({*expansion, (T - kReference) * length});
    if (warmth) one.set_up.push_back({*warmth, alpha * length});
  }

  void add_straightness() {
    const std::size_t zero = add_own("zero"), slope = add_own("slope", 1e-6, "um/m");
    const int moving = joint(*group().axis);
    const double middle = mean_position(moving);
    for (std::size_t row = 0; row < group().rows.size(); ++row) {
      const Joints& Q = group().rows[row].Q;
      Pose pose;
      pose.n_W = direction_of(*group().direction, Q);
      Observation& one = add(row, 0, pose);
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
    const std::size_t zero = add_own("zero", urad, "urad");
    for (std::size_t row = 0; row < group().rows.size(); ++row) {
      Pose pose;
      pose.is_turn = true;
      pose.n_W = direction_of(*group().direction, group().rows[row].Q);
      add(row, 0, pose).set_up.push_back({zero, 1.0});
    }
  }

  // The angle between the mean lines grows where the first bends away from the second axis and
  // the second from the first: minus the slope of either along the other.
  void add_squareness() {
    Observation one{
        .poses = {}, .set_up = {}, .d = group().rows[0].deviation[0], .group = group_, .row = 0};
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
        pose.n_W = direction_of(across, pose.Q);
        pose.weight = -place(k) / squares;
        one.poses.push_back(pose);
      }
    }
    out_.all.push_back(std::move(one));
  }

  // Radius or length: unknown, or known to a stated uncertainty.
  std::size_t add_size(const std::string& name) {
    return add_own(name, um, "um", group().size_uncertainty);
  }

  void add_circle() {
    const std::size_t a = add_own(fmt::format("centre {}", letter(group().plane[0]))),
                      b = add_own(fmt::format("centre {}", letter(group().plane[1]))),
                      radius = add_size("radius");
    const int i = joint(group().plane[0]), j = joint(group().plane[1]);
    for (std::size_t row = 0; row < group().rows.size(); ++row) {
      const Joints Q = group().rows[row].Q;
      const double u = (Q[i] - group().at[i]) / group().radius;
      const double v = (Q[j] - group().at[j]) / group().radius;
      Pose pose;
      pose.n_W = (u * direction_of(group().plane[0], Q) + v * direction_of(group().plane[1], Q))
                     .normalized();
      Observation& one = add(row, 0, pose);
      one.set_up.push_back({a, u});
      one.set_up.push_back({b, v});
      one.set_up.push_back({radius, 1.0});
    }
  }

  // Ball or stylus in the spindle: its place adds R_WS delta to the tip.
  std::optional<std::array<std::size_t, 3>> add_tool(const std::string& name) {
    if (group().tool_is_known) return std::nullopt;
    return add_point(name);
  }
  void add_tool_parts(Observation& one, const std::optional<std::array<std::size_t, 3>>& tool,
                      const Vector3d& n_W, const Joints& Q) {
    if (!tool) return;
    const Vector3d n_S = metrology::R_WS(chain_, Q).transpose() * n_W;
    for (std::size_t k = 0; k < 3; ++k) one.set_up.push_back({(*tool)[k], n_S[int(k)]});
  }
  static void add_place_parts(Observation& one, const std::array<std::size_t, 3>& place,
                              const Vector3d& n_W) {
    for (std::size_t k = 0; k < 3; ++k) one.set_up.push_back({place[k], -n_W[int(k)]});
  }

  void add_ball_bar() {
    const auto ball = add_point("ball on the table");
    const auto tool = add_tool("ball in the spindle");
    const std::size_t length = add_size("length");
    for (std::size_t row = 0; row < group().rows.size(); ++row) {
      const Joints& Q = group().rows[row].Q;
      const Vector3d bar = tip(Q) - group().ball_W;
      const double nominal = bar.norm();
      if (std::abs(nominal - group().length) > readings::kLargestDeviation) {
        throw InputError({group().file, group().rows[row].line},
                         fmt::format("the balls stand {:.3f} mm apart at these joints, the bar is "
                                     "{:.3f} mm long: check ball_mm, point_mm and length_mm",
                                     nominal / mm, group().length / mm));
      }
      Pose pose;
      pose.n_W = bar / nominal;
      Observation& one = add(row, 0, pose);
      correct(one, group().length - nominal);
      one.set_up.push_back({length, 1.0});
      add_place_parts(one, ball, pose.n_W);
      add_tool_parts(one, tool, pose.n_W, Q);
    }
  }

  void add_r_test() {
    const auto nest = add_point("nest");
    const auto tool = add_tool("ball");
    for (std::size_t row = 0; row < group().rows.size(); ++row) {
      add_three(row, nest, tool);
    }
  }

  // Three numbers along X, Y and Z of W.
  void add_three(std::size_t row, const std::array<std::size_t, 3>& place,
                 const std::optional<std::array<std::size_t, 3>>& tool) {
    for (int k = 0; k < 3; ++k) {
      Pose pose;
      pose.n_W = Vector3d::Unit(k);
      Observation& one = add(row, k, pose);
      add_place_parts(one, place, pose.n_W);
      add_tool_parts(one, tool, pose.n_W, group().rows[row].Q);
    }
  }

  // The stylus stands at the centre: nominal tip + deviation = centre. Centres are counted from
  // the mean of what the nominal machine shows.
  void add_spheres() {
    const auto tool = add_tool("stylus");
    std::vector<std::array<std::size_t, 3>> places;
    std::vector<Vector3d> mean(group().spheres.size(), Vector3d::Zero());
    std::vector<int> count(group().spheres.size(), 0);
    for (const std::string& name : group().spheres) places.push_back(add_point(name));
    for (const Reading& reading : group().rows) {
      mean[reading.sphere] += tip(reading.Q);
      ++count[reading.sphere];
    }
    for (std::size_t row = 0; row < group().rows.size(); ++row) {
      const Reading& reading = group().rows[row];
      const Vector3d from_mean = tip(reading.Q) - mean[reading.sphere] / count[reading.sphere];
      const std::size_t first = out_.all.size();
      add_three(row, places[reading.sphere], tool);
      for (int k = 0; k < 3; ++k) out_.all[first + static_cast<std::size_t>(k)].d = -from_mean[k];
      if (from_mean.norm() > readings::kLargestDeviation) {
        throw InputError({group().file, reading.line},
                         fmt::format("sphere {} lies {:.3g} mm from where the others of its name "
                                     "lie; check joints, signs and point_mm",
                                     group().spheres[reading.sphere], from_mean.norm() / mm));
      }
    }
  }

  // Linear in time from the first row on; without times from row to row.
  void add_drift() {
    const bool is_angle = readings::is_angular(group().kind, group().axis);
    const std::size_t rows = group().rows.size();
    const bool timed = !std::isnan(group().rows.front().time);
    std::vector<std::size_t> rates;
    for (int k = 0; k < readings::numbers_of(group().kind); ++k) {
      rates.push_back(is_angle ? add_own("drift", urad, "urad") : add_own("drift"));
    }
    const double first = group().rows.front().time, last = group().rows.back().time;
    std::size_t number = 0, row_before = rows;
    for (Observation& one : out_.all) {
      if (one.group != group_) continue;
      number = one.row == row_before ? number + 1 : 0;
      row_before = one.row;
      const double share = timed ? (group().rows[one.row].time - first) / (last - first)
                                 : static_cast<double>(one.row) /
                                       static_cast<double>(std::max<std::size_t>(rows - 1, 1));
      one.set_up.push_back({rates[number], share});
    }
  }

  const readings::Readings& readings_;
  const plant::MachineChain& chain_;
  std::size_t group_ = 0;
  std::vector<std::optional<std::size_t>> scales_;  // of instruments
  Observations out_;
};

}  // namespace

Observations observations_of(const readings::Readings& readings, const plant::MachineChain& chain) {
  return Builder(readings, chain).build();
}

}  // namespace servomill::sim::calibration
