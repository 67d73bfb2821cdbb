/// Known positions of a program against the travel of the machine.
#pragma once

#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/model/forward.h"
#include "sim/programs/known_positions.h"

namespace servomill::sim::programs {

/// Adds up the moves that leave the travel. Only positions that are known in the machine count;
/// arcs with their extreme points.
class TravelCheck {
 public:
  /// @param machine  must outlive this
  explicit TravelCheck(const model::MachineSettings& machine) : machine_(machine) {}

  /// @param file  that has the line of the move
  void add(const Move& move, const MoveKnowledge& known, const std::string& file);

  /// The first moves, and the number of the others.
  /// @param program  the place of that number
  std::vector<Fault> faults(const std::string& program) const;

 private:
  const model::MachineSettings& machine_;
  std::vector<Fault> first_;
  std::size_t others_ = 0;
};

}  // namespace servomill::sim::programs
