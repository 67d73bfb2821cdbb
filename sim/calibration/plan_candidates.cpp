#include "sim/calibration/plan_candidates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"

namespace servomill::sim::calibration {
namespace {

using readings::Group;
using readings::Kind;
using readings::Reading;

constexpr double kPlaces[] = {0.1, 0.5, 0.9};  // of the travel of the other axes
constexpr double kEnds = 0.02;                 // of the travel left free by lines
constexpr int kTargets = 11, kRuns = 3;
constexpr double kLineTime = 1500.0, kLevelTime = 1200.0,
                 kSquareTime = 1200.0;  // s, set-up and all
constexpr double kCircleTime = 900.0, kSphereTime = 1200.0;
constexpr double kPositioning = 0.3e-6, kStraightness = 0.5e-6, kCircle = 0.7e-6, kSphere = 0.8e-6;
constexpr double kAngle = 1e-6, kLevel = 2e-6, kSquare = 2e-6, kIndexing = 2e-6;  // rad
constexpr double kRadii[] = {0.15, 0.1, 0.05};                                    // m, of ball bars
constexpr int kAnglesOfCircle = 72;

class Candidates {
 public:
  Candidates(const model::MachineSettings& machine, const PlanSettings& settings)
      : machine_(machine), settings_(settings), layout_(machine.chain.layout) {}

  std::vector<PlannedSetUp> all() {
    for (const PlanInstrument instrument : settings_.instruments) {
      for (const double length : settings_.tool_lengths) {
        p_ST_ = {0.0, 0.0, -length};
        add(instrument);
      }
    }
    return std::move(out_);
  }

 private:
  double lower(int j) const { return machine_.nc.lower[j]; }
  double travel(int j) const { return machine_.nc.upper[j] - machine_.nc.lower[j]; }
  double place(int j, double share) const { return lower(j) + share * travel(j); }

  void add(PlanInstrument instrument) {
    switch (instrument) {
      case PlanInstrument::laser:
      case PlanInstrument::level:
        for (int j = 0; j < kLinearJoints; ++j) {
          if (layout_.has(j)) add_lines(j, instrument == PlanInstrument::level);
        }
        if (instrument == PlanInstrument::laser) add_rotary_positioning();
        return;
      case PlanInstrument::square:
      case PlanInstrument::ballbar:
        for (int a = 0; a < kLinearJoints; ++a) {
          for (int b = a + 1; b < kLinearJoints; ++b) {
            if (!layout_.has(a) || !layout_.has(b)) continue;
            if (instrument == PlanInstrument::square) {
              add_square(a, b);
            } else {
              add_circles(a, b);
            }
          }
        }
        return;
      case PlanInstrument::probe:
        add_spheres();
        return;
    }
  }

  // Joints at one of three places of each of two axes; rotary axes at 0, or where they begin.
  Joints at(int a, double share_a, int b, double share_b) const {
    Joints Q = Joints::Zero();
    if (layout_.has(a)) Q[a] = place(a, share_a);
    if (layout_.has(b)) Q[b] = place(b, share_b);
    return Q;
  }

  void add_lines(int j, bool is_level) {
    const int a = (j + 1) % 3, b = (j + 2) % 3;
    for (const double share_a : kPlaces) {
      if (!layout_.has(a) && share_a != 0.5) continue;
      for (const double share_b : kPlaces) {
        if (!layout_.has(b) && share_b != 0.5) continue;
        const Joints Q = at(a, share_a, b, share_b);
        const bool middle = share_a == 0.5 && share_b == 0.5;
        if (is_level) {
          add_levels(j, Q, middle);
        } else {
          add_laser(j, Q, middle);
        }
      }
    }
  }

  void add_laser(int j, const Joints& Q, bool middle) {
    const Axis axis = *layout_.axis[std::size_t(j)];
    add_line(Kind::positioning, axis, std::nullopt, Q, kPositioning, kLineTime, middle);
    for (int k = 0; k < 3; ++k) {
      if (k == j) continue;
      add_line(Kind::straightness, axis, static_cast<Axis>(k), Q, kStraightness, kLineTime, middle);
      const auto about = static_cast<Axis>(index_of(Axis::A) + k);
      add_line(Kind::angle, axis, about, Q, kAngle, kLineTime, middle);
    }
  }

  // Levels show turns about horizontal axes: where Z is vertical, A and B.
  void add_levels(int j, const Joints& Q, bool middle) {
    for (const Axis about : {Axis::A, Axis::B}) {
      add_line(Kind::angle, *layout_.axis[std::size_t(j)], about, Q, kLevel, kLevelTime, middle);
    }
  }

  Group group(Kind kind, const Joints& Q, double uncertainty) const {
    Group out;
    out.kind = kind;
    out.at = Q;
    out.p_ST = p_ST_;
    out.uncertainty = uncertainty;
    for (int j = 0; j < kJoints; ++j) out.stands[std::size_t(j)] = layout_.has(j);
    return out;
  }

  void push(Group group, double time, bool middle) {
    for (std::size_t k = 0; k < group.rows.size(); ++k) group.rows[k].line = int(k) + 2;
    out_.push_back({.group = std::move(group), .time = time, .through_the_middle = middle});
  }

  std::string place_text(const Joints& Q, int without, int and_without = -1) const {
    std::string out;
    for (int j = 0; j < kLinearJoints; ++j) {
      if (j == without || j == and_without || !layout_.has(j)) continue;
      out += fmt::format(", {} {:g}", layout_.letter_of(j), Q[j] / mm);
    }
    return out + fmt::format(", tool {:g} mm", -p_ST_.z() / mm);
  }

  void add_line(Kind kind, Axis axis, std::optional<Axis> direction, const Joints& Q,
                double uncertainty, double time, bool middle) {
    Group line = group(kind, Q, uncertainty);
    const int j = *layout_.joint_of(axis);
    line.axis = axis;
    line.direction = direction;
    line.name = fmt::format("{}{} of {}{}", readings::kKinds[std::size_t(kind)],
                            direction ? fmt::format(" {}", letter(*direction)) : "", letter(axis),
                            place_text(Q, j));
    for (int run = 0; run < kRuns; ++run) {
      for (const int way : {1, -1}) {
        for (int k = 0; k < kTargets; ++k) {
          const int target = way > 0 ? k : kTargets - 1 - k;
          Reading row;
          row.Q = Q;
          row.Q[j] = place(j, kEnds + (1.0 - 2.0 * kEnds) * target / (kTargets - 1));
          row.direction[std::size_t(j)] = way;
          row.run = run;
          line.rows.push_back(row);
        }
      }
    }
    push(std::move(line), time, middle);
  }

  // Angles of rotary axes, by an indexing table on them, as long as the tool does not matter.
  void add_rotary_positioning() {
    if (p_ST_.z() != -settings_.tool_lengths.front()) return;
    for (int j = kLinearJoints; j < kJoints; ++j) {
      if (!layout_.has(j)) continue;
      Group turns = group(Kind::positioning, at(0, 0.5, 1, 0.5), kIndexing);
      turns.axis = *layout_.axis[std::size_t(j)];
      turns.name = fmt::format("positioning of {}", letter(*turns.axis));
      if (layout_.has(2)) turns.at[2] = place(2, 0.5);
      const std::vector<double> angles = angles_of(j);
      for (int run = 0; run < kRuns; ++run) {
        for (std::size_t k = 0; k < 2 * angles.size(); ++k) {
          const bool up = k < angles.size();
          Reading row;
          row.Q = turns.at;
          row.Q[j] = angles[up ? k : 2 * angles.size() - 1 - k];
          row.direction[std::size_t(j)] = up ? 1 : -1;
          row.run = run;
          turns.rows.push_back(row);
        }
      }
      push(std::move(turns), kLineTime, true);
    }
  }

  void add_square(int a, int b) {
    const int c = 3 - a - b;
    Joints Q = at(a, 0.1, b, 0.1);
    if (layout_.has(c)) Q[c] = place(c, 0.5);
    Group square = group(Kind::squareness, Q, kSquare);
    square.plane = {*layout_.axis[std::size_t(a)], *layout_.axis[std::size_t(b)]};
    square.legs = {0.8 * travel(a), 0.8 * travel(b)};
    square.targets = kTargets;
    square.name = fmt::format("squareness {}{}{}", layout_.letter_of(a), layout_.letter_of(b),
                              place_text(Q, a, b));
    Reading row;
    row.Q = Q;
    square.rows.push_back(row);
    push(std::move(square), kSquareTime, true);
  }

  void add_circles(int a, int b) {
    const int c = 3 - a - b;
    const double room = 0.5 * std::min(travel(a), travel(b));
    const auto fits = std::find_if(std::begin(kRadii), std::end(kRadii),
                                   [&](double radius) { return radius <= 0.98 * room; });
    if (fits == std::end(kRadii)) return;
    for (const double share_a : {0.0, 0.5, 1.0}) {
      for (const double share_b : {0.0, 0.5, 1.0}) {
        Joints centre = Joints::Zero();
        centre[a] = lower(a) + *fits + share_a * (travel(a) - 2.0 * *fits);
        centre[b] = lower(b) + *fits + share_b * (travel(b) - 2.0 * *fits);
        if (layout_.has(c)) centre[c] = place(c, 0.5);
        add_circle(a, b, centre, *fits, share_a == 0.5 && share_b == 0.5);
      }
    }
  }

  void add_circle(int a, int b, const Joints& centre, double radius, bool middle) {
    Group circle = group(Kind::circle, centre, kCircle);
    circle.plane = {*layout_.axis[std::size_t(a)], *layout_.axis[std::size_t(b)]};
    circle.radius = radius;
    circle.name = fmt::format("circle {}{} at {} {:g}, {} {:g}{}", layout_.letter_of(a),
                              layout_.letter_of(b), layout_.letter_of(a), centre[a] / mm,
                              layout_.letter_of(b), centre[b] / mm, place_text(centre, a, b));
    for (const int way : {1, -1}) {
      for (int k = 0; k < kAnglesOfCircle; ++k) {
        const double angle = way * 2.0 * std::numbers::pi * k / kAnglesOfCircle;
        const double u = std::cos(angle), v = std::sin(angle);
        Reading row;
        row.Q = centre;
        row.Q[a] += radius * u;
        row.Q[b] += radius * v;
        row.direction[std::size_t(a)] = v == 0.0 ? 0 : way * (v > 0.0 ? -1 : 1);
        row.direction[std::size_t(b)] = u == 0.0 ? 0 : way * (u > 0.0 ? 1 : -1);
        circle.rows.push_back(row);
      }
    }
    push(std::move(circle), kCircleTime, middle);
  }

  // Spheres on the table, touched at poses of the rotary axes that the linear axes reach.
  void add_spheres() {
    if (!layout_.has(3)) return;
    const double reach = 0.25 * std::min(travel(0), travel(1));
    const Eigen::Vector3d places[] = {
        {reach, 0.0, 0.05}, {-0.7 * reach, 0.7 * reach, 0.1}, {0.0, -reach, 0.2}, {0.05, 0.0, 0.3}};
    int number = 0;
    for (const Eigen::Vector3d& centre : places) {
      Group spheres = group(Kind::sphere, Joints::Zero(), kSphere);
      spheres.name =
          fmt::format("sphere {} at {:g}, {:g}, {:g} of the table, stylus {:g} mm", ++number,
                      centre.x() / mm, centre.y() / mm, centre.z() / mm, -p_ST_.z() / mm);
      spheres.spheres = {fmt::format("sphere {}", number)};
      for (const Joints& rotary : rotary_poses()) {
        const auto Q = plant::inverse_fixed_rotary(machine_.chain, centre, rotary, p_ST_);
        if (!Q || !is_within(*Q)) continue;
        Reading row;
        row.Q = *Q;
        spheres.rows.push_back(row);
      }
      if (spheres.rows.size() >= 8) push(std::move(spheres), kSphereTime, number <= 2);
    }
  }

  bool is_within(const Joints& Q) const {
    for (int j = 0; j < kLinearJoints; ++j) {
      if (Q[j] < lower(j) || Q[j] > machine_.nc.upper[j]) return false;
    }
    return true;
  }

  // Angles of a rotary axis at which something is measured; of one that is not there: 0.
  std::vector<double> angles_of(int j) const {
    if (!layout_.has(j)) return {0.0};
    const bool turns = !(travel(j) > 0.0 && travel(j) < 2.0 * std::numbers::pi);
    const int count = turns ? 8 : 7;
    const double first = turns ? 0.0 : place(j, 0.2);
    const double step = turns ? 2.0 * std::numbers::pi / count : 0.6 * travel(j) / (count - 1);
    std::vector<double> out;
    for (int k = 0; k < count; ++k) out.push_back(first + k * step);
    return out;
  }

  std::vector<Joints> rotary_poses() const {
    std::vector<Joints> out;
    for (const double first : angles_of(3)) {
      for (const double second : angles_of(4)) {
        Joints Q = Joints::Zero();
        Q[3] = first;
        Q[4] = second;
        out.push_back(Q);
      }
    }
    return out;
  }

  const model::MachineSettings& machine_;
  const PlanSettings& settings_;
  const JointLayout& layout_;
  Eigen::Vector3d p_ST_ = Eigen::Vector3d::Zero();
  std::vector<PlannedSetUp> out_;
};

}  // namespace

std::vector<PlannedSetUp> plan_candidates(const model::MachineSettings& machine,
                                          const PlanSettings& settings) {
  return Candidates(machine, settings).all();
}

}  // namespace servomill::sim::calibration
