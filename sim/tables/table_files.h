/// Writes compensation tables in the formats of NCs, as text.
///
/// Values are errors, actual minus nominal, e; the sign that a format wants:
///
///     linuxcnc    COMP_FILE_TYPE 0: position reached, nominal + e; 1: what is added to the motor
///                 command, -e
///     heidenhain  e: positive where the axis travels too far
///     siemens     $AA_ENC_COMP: e, added to the actual value, so that a positive value moves the
///                 axis in the negative direction; $AN_CEC: -e, added to the setpoint
///     csv         e of each component error by its name
///     isg, etalon e of each component error by its name, every axis as if it carried the tool
///                 (sim/tables/tool_side_errors.h)
#pragma once

#include <string>
#include <vector>

namespace servomill::sim::tables {

struct TableExport;  // sim/tables/table_export.h

struct TextFile {
  std::string name;  // without folder
  std::string text;
};

/// The files of the format of the tables. The report stands in a comment where the format has
/// comments, otherwise in a file notes.txt of its own.
std::vector<TextFile> table_files(const TableExport& tables);

}  // namespace servomill::sim::tables
