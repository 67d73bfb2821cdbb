/// Readings of a whole machine in tests: lines, angles, squares, as a shop takes them.
#pragma once

#include <string>
#include <vector>

#include "plant/kinematics/structure.h"
#include "sim/readings/readings.h"

namespace servomill::sim::calibration {

/// Three axes of 1 m, the table stands.
inline plant::MachineChain gantry() {
  return plant::make_chain(plant::parse_structure("[w b X Y Z (C1) t]"));
}

/// A line of targets over 0 to 1 m of an axis, once.
inline readings::Group line(readings::Kind kind, Axis axis, const Joints& at,
                            const Eigen::Vector3d& p_ST, double uncertainty, int targets = 11) {
  readings::Group group;
  group.kind = kind;
  group.axis = axis;
  group.at = at;
  group.p_ST = p_ST;
  group.uncertainty = uncertainty;
  for (int k = 0; k < targets; ++k) {
    readings::Reading reading;
    reading.Q = at;
    reading.Q[index_of(axis)] = double(k) / (targets - 1);
    reading.line = k + 2;
    group.rows.push_back(reading);
  }
  return group;
}

/// Positioning, two straightnesses and the three angles on three lines an axis, and three
/// squarenesses: what tells all 21 errors, but for the roll of the vertical axis where levels take
/// it, which see no turn about the vertical.
inline readings::Readings shop_readings(bool roll_of_Z = true) {
  using readings::Kind;
  readings::Readings out;
  out.instruments.push_back({.name = "laser", .scale_uncertainty = 0.25e-6});
  const Eigen::Vector3d tools[] = {{0.0, 0.0, -0.1}, {0.1, 0.0, -0.1}, {0.0, 0.15, -0.3}};
  const double places[] = {0.2, 0.5, 0.9};
  for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
    const auto next = [axis](int by) { return static_cast<Axis>((index_of(axis) + by) % 3); };
    for (std::size_t k = 0; k < 3; ++k) {
      Joints at = Joints::Zero();
      at[index_of(next(1))] = places[k];
      at[index_of(next(2))] = places[2 - k];
      const auto add = [&](readings::Group group, const std::string& what) {
        group.name = std::string(1, letter(axis)) + " " + what + " " + std::to_string(k + 1);
        out.groups.push_back(std::move(group));
      };
      readings::Group positioning = line(Kind::positioning, axis, at, tools[k], 0.3e-6);
      positioning.instrument = 0;
      add(positioning, "positioning");
      for (const int by : {1, 2}) {
        readings::Group straight = line(Kind::straightness, axis, at, tools[k], 0.5e-6);
        straight.direction = next(by);
        add(straight, std::string("straightness ") + letter(next(by)));
      }
      for (const Axis about : {Axis::A, Axis::B, Axis::C}) {
        if (axis == Axis::Z && about == Axis::C && !roll_of_Z) continue;
        readings::Group angle = line(Kind::angle, axis, at, tools[k], 1e-6);
        angle.direction = about;
        add(angle, std::string("angle ") + letter(about));
      }
    }
  }
  for (const std::array<Axis, 2> plane :
       {std::array{Axis::X, Axis::Y}, std::array{Axis::Y, Axis::Z}, std::array{Axis::X, Axis::Z}}) {
    readings::Group square;
    square.kind = Kind::squareness;
    square.name = std::string("square ") + letter(plane[0]) + letter(plane[1]);
    square.plane = plane;
    square.legs = {1.0, 1.0};
    square.targets = 11;
    square.p_ST = tools[0];
    square.uncertainty = 1e-6;
    square.rows.emplace_back();
    out.groups.push_back(square);
  }
  return out;
}

/// An AC table below a spindle that moves along X, Y, Z; A turns 50 mm above C.
inline plant::MachineChain trunnion() {
  plant::MachineChain chain = plant::make_chain(plant::parse_structure("[w C' A' b X Y Z (C1) t]"));
  chain.at(Axis::A).centre.z() = 0.05;
  return chain;
}

/// Three spheres on the table of a trunnion, touched by an adjusted stylus at 56 poses each.
inline void add_spheres(readings::Readings& all, const plant::MachineChain& chain) {
  // the lines of the shop say where A and C stood: at 0
  readings::Group group;
  group.kind = readings::Kind::sphere;
  group.name = "spheres";
  group.p_ST = {0.0, 0.0, -0.15};
  group.uncertainty = 0.5e-6;
  group.tool_is_known = true;
  group.spheres = {"outer", "upper", "middle"};
  const Eigen::Vector3d places[] = {{0.2, 0.0, 0.05}, {-0.1, 0.15, 0.25}, {0.02, -0.03, 0.15}};
  for (std::size_t sphere = 0; sphere < 3; ++sphere) {
    for (int a = -3; a <= 3; ++a) {
      for (int c = 0; c < 8; ++c) {
        Joints rotary = Joints::Zero();
        rotary[3] = 0.35 * a;
        rotary[4] = 0.7853981633974483 * c + 0.1 * a;
        readings::Reading reading;
        reading.Q = *plant::inverse_fixed_rotary(chain, places[sphere], rotary, group.p_ST);
        reading.sphere = sphere;
        reading.line = static_cast<int>(group.rows.size()) + 2;
        group.rows.push_back(reading);
      }
    }
  }
  all.groups.push_back(std::move(group));
}

}  // namespace servomill::sim::calibration
