/// A slot in a block of steel: the scenario of the tests of cutting.
#pragma once

#include <string>

namespace servomill::sim {

/// A slot of 2 mm in the middle of a block of 40 mm, along +X.
inline const std::string kSlot =
    "G17 G90 T1 M6\nG43 H1\nS4775 M3\nG0 X-30 Y0\nZ-2\nG1 X30 F1394\nM30\n";

inline const std::string kTool =
    "[[program.tool]]\nnumber = 1\nlength_mm = 110.0\ndiameter_mm = 8.0\nteeth = 4\n";
inline const std::string kBlock =
    "[[part.stock]]\nbox = { from_mm = [-20.0, -20.0, -20.0], to_mm = [20.0, 20.0, 0.0] }\n";
inline const std::string kSteel = "[cutting]\nmaterial = \"42CrMo4\"\n";

inline std::string one_case(const std::string& name, const std::string& keys = "") {
  return "[[case]]\nname = \"" + name + "\"\n" + keys;
}

}  // namespace servomill::sim
