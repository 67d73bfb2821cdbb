/// Five-axis machines of the common kinds, and less common ones.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "plant/vocabulary/units.h"
#include "tests/plant/kinematics/all_structures.h"

namespace servomill::plant {

/// A machine of a common kind: structure, and where a rotary axis points if it is inclined.
struct Kind {
  const char* name;
  const char* structure;
  std::vector<std::pair<Axis, Eigen::Vector3d>> directions;
};
inline const std::vector<Kind> kKinds = {
    {"table-table BC", "[w C' B' X b Y Z t]", {}},
    {"table-table AC, trunnion", "[w C' A' b X Y Z t]", {}},
    {"table-table AC on Y", "[w C' A' Y b X Z t]", {}},
    {"table-table AB", "[w B' A' b X Y Z t]", {}},
    {"head-table BC", "[w C' X b Y Z B t]", {}},
    {"head-table AC", "[w C' Y b X Z A t]", {}},
    {"head-table AB", "[w A' b X Y Z B t]", {}},
    {"head-head CA", "[w b X Y Z C A t]", {}},
    {"head-head CB on a moving table", "[w X b Y Z C B t]", {}},
    {"head-head AB", "[w b X Y Z A B t]", {}},
    {"head-head BA", "[w X Y b Z B A t]", {}},
    {"rotary between the linear axes", "[w C' X b A Y Z t]", {}},
    {"45 deg nutating head CB", "[w b X Y Z C B t]", {{Axis::B, {0, 1, 1}}}},
    {"45 deg nutating table CB", "[w C' B' X b Y Z t]", {{Axis::B, {0, 1, 1}}}},
    {"45 deg nutating head, C table", "[w C' Y b X Z B t]", {{Axis::B, {0, -1, 1}}}},
    {"50 deg nutating head CA",
     "[w b X Y Z C A t]",
     {{Axis::A, {0, std::sin(50 * deg), std::cos(50 * deg)}}}},
    {"both inclined, anywhere",
     "[w X A' b Y Z C t]",
     {{Axis::A, {1, 0.3, -0.2}}, {Axis::C, {0.7, 0.5, 0.6}}}},
};

inline MachineChain chain_of(const Kind& kind) {
  MachineChain chain = make_chain(parse_structure(kind.structure));
  for (const auto& [axis, direction] : kind.directions) incline(chain.at(axis), direction);
  return chain;
}

/// With centres and senses at random.
inline MachineChain random_chain_of(const Kind& kind, Uniform& random) {
  MachineChain chain = random_chain(parse_structure(kind.structure), random);
  for (const auto& [axis, direction] : kind.directions) incline(chain.at(axis), direction);
  return chain;
}

}  // namespace servomill::plant
