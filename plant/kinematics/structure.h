/// The structure string of a machine: which body carries which.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::plant {

/// The side of the bed on which an axis stands.
enum class Side : std::uint8_t { workpiece, tool };

struct StructureAxis {
  Axis axis;
  Side side;
  bool operator==(const StructureAxis&) const = default;
};

/// Meaning of `[w C' B' X b Y Z (C1) t]`: the axes from the workpiece to the tool.
struct Structure {
  std::vector<StructureAxis> axes;  // reading order, without the spindle
  std::optional<Axis> spindle;      // the axis about which the spindle turns; carries no motion

  JointLayout layout() const;
  bool operator==(const Structure&) const = default;
};

/// Reads a structure string, `w` (workpiece), axes, `b` (bed), axes, `t` (tool) between brackets:
/// up to three linear axes X Y Z and two rotary axes of A B C in any order. The side of `b` decides
/// what carries an axis; a prime may repeat it on the workpiece side and is an error on the tool
/// side. A spindle `(C1)` may stand directly before `t`. Blanks mean nothing.
/// @param at  place of the first character of `text`
/// @throws InputError with every fault of the string, each at its column
Structure parse_structure(std::string_view text, const Place& at = {"structure", 1, 1});

/// The string with a prime on every axis of the workpiece side: parse_structure(to_string(s)) == s.
std::string to_string(const Structure& structure);

}  // namespace servomill::plant
