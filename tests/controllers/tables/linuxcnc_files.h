/// Compensation files of LinuxCNC as the tests of tables read them.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "controllers/tables/linuxcnc_table.h"

namespace servomill::controllers {

constexpr std::array kJointAxes = {Axis::X, Axis::Y, Axis::Z, Axis::C};

/// Tables of an INI file that names joint_0_x.comp or c.comp, both with the same text.
inline std::vector<ControlTable> linuxcnc(const std::string& ini, const std::string& text) {
  return read_linuxcnc_tables(
      std::vector<TableText>{{"mill.ini", ini}, {"joint_0_x.comp", text}, {"c.comp", text}},
      kJointAxes);
}

}  // namespace servomill::controllers
