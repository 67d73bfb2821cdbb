#include "sim/tables/table_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>

#include "plant/vocabulary/units.h"
#include "sim/tables/exchange_files.h"
#include "sim/tables/mesh_settings.h"
#include "sim/tables/skew_settings.h"

namespace servomill::sim::tables {
namespace {

double unit_of(int joint) { return joint < kLinearJoints ? mm : deg; }
int decimals_of(int joint) { return joint < kLinearJoints ? 6 : 8; }

std::string fixed(double value, int decimals) {
  const std::string text = fmt::format("{:.{}f}", value, decimals);
  const bool is_zero = text.find_first_not_of("-0.") == std::string::npos;
  return is_zero && text.front() == '-' ? text.substr(1) : text;
}

// A position without trailing zeros.
std::string shortest(double value) {
  std::string text = fixed(value, 9);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string lower_case(char letter) {
  return {static_cast<char>(std::tolower(static_cast<unsigned char>(letter)))};
}

std::string joined(const std::vector<std::string>& lines, std::string_view prefix) {
  std::string text;
  for (const std::string& line : lines) text += fmt::format("{}{}\n", prefix, line);
  return text;
}

const std::vector<double>& values(const CompensationTable& table, int direction) {
  return direction < 0 && table.depends_on_direction() ? table.error_down : table.error;
}

bool any_by_direction(const TableExport& e) {
  return std::any_of(e.tables.begin(), e.tables.end(),
                     [](const CompensationTable& table) { return table.depends_on_direction(); });
}

// --- LinuxCNC -----------------------------------------------------------------------------------

// Reading ends at the first line that is not three numbers: no comments, no header.
std::string comp_file(const CompensationTable& table, int type) {
  const double unit = unit_of(table.output);
  const int decimals = decimals_of(table.output);
  std::string text;
  for (std::size_t i = 0; i < table.error.size(); ++i) {
    const double nominal = table.line.entry(i) / unit;
    const auto value = [&](int direction) {
      const double error = values(table, direction)[i] / unit;
      return fixed(type == 0 ? nominal + error : -error, decimals);
    };
    text += fmt::format("{} {} {}\n", fixed(nominal, decimals), value(1), value(-1));
  }
  return text;
}

std::vector<TextFile> linuxcnc_files(const TableExport& e) {
  const int type = e.request.comp_file_type;
  std::vector<TextFile> files;
  std::string ini = joined(report(e), "# ");
  ini += joined(
      {type == 0 ? "each line of a file: nominal position, position reached moving up, moving down"
                 : "each line of a file: nominal position, trim moving up, trim moving down, added "
                   "to the motor command",
       any_by_direction(e)
           ? "units: mm and deg, as LINEAR_UNITS = mm and ANGULAR_UNITS = degree"
           : "units: mm and deg, as LINEAR_UNITS = mm and ANGULAR_UNITS = degree; up and down are "
             "equal: no positioning depends on the direction of travel",
       "joints: X, Y, Z and the rotary axes in alphabetical order; COMP_FILE excludes BACKLASH"},
      "# ");
  int number = 0;
  for (const TableLine& line : e.lines) {
    for (const CompensationTable& table : e.tables) {
      if (table.output != line.joint) continue;
      const std::string name =
          fmt::format("joint_{}_{}.comp", number, lower_case(e.letter(line.joint)));
      files.push_back({name, comp_file(table, type)});
      ini += fmt::format("\n[JOINT_{}]\nCOMP_FILE = {}\nCOMP_FILE_TYPE = {}\n", number, name, type);
    }
    ++number;
  }
  files.push_back({"compensation.ini", ini});
  return files;
}

// --- Heidenhain ---------------------------------------------------------------------------------

std::string com_listing(const TableExport& e, const std::vector<const CompensationTable*>& tables) {
  const TableLine& line = tables.front()->line;
  const CompensationTable* down = nullptr;  // BACKLASH
  for (const CompensationTable* table : tables) {
    if (table->depends_on_direction()) down = table;
  }
  std::string text = fmt::format("{:>12}", "AXISPOS");
  if (down != nullptr) text += fmt::format(" {:>10}", "BACKLASH");
  for (const CompensationTable* table : tables) {
    text += fmt::format(" {:>10}", std::string(1, e.letter(table->output)));
  }
  text += "\n";
  for (std::size_t i = 0; i < line.points; ++i) {
    text += fmt::format("{:>12}", fixed(line.entry(i) / unit_of(line.joint), 4));
    const auto add = [&](const CompensationTable& table, int direction) {
      const double error = values(table, direction)[i] / unit_of(table.output);
      text += fmt::format(" {:>10}", fixed(error, table.is_angle() ? 5 : 4));
    };
    if (down != nullptr) add(*down, -1);
    for (const CompensationTable* table : tables) add(*table, 1);
    text += "\n";
  }
  return text;
}

// All tables over the positions of one axis.
std::vector<const CompensationTable*> tables_over(const TableExport& e, int joint) {
  std::vector<const CompensationTable*> tables;
  for (const CompensationTable& table : e.tables) {
    if (table.line.joint == joint) tables.push_back(&table);
  }
  return tables;
}

std::vector<TextFile> heidenhain_files(const TableExport& e) {
  std::vector<TextFile> files;
  std::string head = fmt::format("{:>6}", "ACTIVE"), names = fmt::format("{:>6}", "*");
  for (const TableLine& line : e.lines) {
    const std::vector<const CompensationTable*> tables = tables_over(e, line.joint);
    if (tables.empty()) continue;
    const std::string name = fmt::format("{}.COM", e.letter(line.joint));
    files.push_back({name + ".txt", com_listing(e, tables)});
    head += fmt::format(" {:>8}", std::string(1, e.letter(line.joint)));
    names += fmt::format(" {:>8}", name);
  }
  files.push_back({"CONFIG.CMA.txt", head + "\n" + names + "\n"});
  std::vector<std::string> notes = report(e);
  notes.insert(
      notes.end(),
      {"values: error in mm or deg, positive where the axis travels too far, entered with its sign",
       any_by_direction(e)
           ? "columns: [axis of the column of *.COM] = F([axis of the column of *.CMA]); AXISPOS "
             "from the machine datum; BACKLASH: values of the axis itself in the negative "
             "direction "
             "of traverse, where it differs"
           : "columns: [axis of the column of *.COM] = F([axis of the column of *.CMA]); AXISPOS "
             "from the machine datum; BACKLASH is empty: no positioning depends on the direction",
       "these are listings for the table editor of the control: the documents give the columns, "
       "not "
       "the text of the files",
       "check the sign at one point before relying on it"});
  files.push_back({"notes.txt", joined(notes, "")});
  return files;
}

// --- Siemens ------------------------------------------------------------------------------------

std::string machine_axis(const TableExport& e, int joint) {
  return fmt::format("{}1", e.letter(joint));
}

std::string encoder_table(const TableExport& e, const CompensationTable& table) {
  const std::string axis = machine_axis(e, table.output);
  const TableLine& line = table.line;
  const double unit = unit_of(line.joint);
  std::string text = fmt::format("; {}: MD38000 $MA_MM_ENC_COMP_MAX_POINTS[0,{}] >= {}\n", axis,
                                 axis, line.points);
  for (std::size_t i = 0; i < table.error.size(); ++i) {
    text += fmt::format("$AA_ENC_COMP[0,{},{}]={}\n", i, axis,
                        fixed(table.error[i] / unit, decimals_of(table.output)));
  }
  text += fmt::format("$AA_ENC_COMP_STEP[0,{}]={}\n", axis, shortest(line.spacing / unit));
  text += fmt::format("$AA_ENC_COMP_MIN[0,{}]={}\n", axis, shortest(line.first / unit));
  text += fmt::format("$AA_ENC_COMP_MAX[0,{}]={}\n", axis,
                      shortest(line.entry(line.points - 1) / unit));
  text += fmt::format("$AA_ENC_COMP_IS_MODULO[0,{}]={}\n", axis, line.wraps ? 1 : 0);
  return text;
}

// @param direction  of travel for which the table acts: 1, -1, 0 for both
std::string cross_table(const TableExport& e, const CompensationTable& table, int index,
                        int direction) {
  const TableLine& line = table.line;
  const double place = unit_of(line.joint), unit = unit_of(table.output);
  std::string text =
      fmt::format("; {} over {}{}: MD18342 $MN_MM_CEC_MAX_POINTS[{}] >= {}\n",
                  machine_axis(e, table.output), machine_axis(e, line.joint),
                  direction == 0 ? "" : (direction > 0 ? ", travelling up" : ", travelling down"),
                  index, line.points);
  for (std::size_t i = 0; i < table.error.size(); ++i) {
    text += fmt::format("$AN_CEC[{},{}]={}\n", index, i,
                        fixed(-values(table, direction)[i] / unit, decimals_of(table.output)));
  }
  text += fmt::format("$AN_CEC_INPUT_AXIS[{}]=({})\n", index, machine_axis(e, line.joint));
  text += fmt::format("$AN_CEC_OUTPUT_AXIS[{}]=({})\n", index, machine_axis(e, table.output));
  text += fmt::format("$AN_CEC_STEP[{}]={}\n", index, shortest(line.spacing / place));
  text += fmt::format("$AN_CEC_MIN[{}]={}\n", index, shortest(line.first / place));
  text += fmt::format("$AN_CEC_MAX[{}]={}\n", index, shortest(line.entry(line.points - 1) / place));
  text += fmt::format("$AN_CEC_DIRECTION[{}]={}\n", index, direction);
  text += fmt::format("$AN_CEC_MULT_BY_TABLE[{}]=0\n", index);
  text += fmt::format("$AN_CEC_IS_MODULO[{}]={}\n", index, line.wraps ? 1 : 0);
  return text;
}

std::vector<TextFile> siemens_files(const TableExport& e) {
  std::vector<std::string> notes = report(e);
  notes.push_back("axes: machine axes are taken to be called X1, Y1, ...; first measuring system");
  const std::string head = joined(notes, "; ");
  std::string encoder, cross;
  int index = 0;
  for (const CompensationTable& table : e.tables) {
    if (table.depends_on_direction()) {  // page 249: two tables, of the same axis, too
      cross += cross_table(e, table, index, 1) + cross_table(e, table, index + 1, -1);
      index += 2;
    } else if (table.output == table.line.joint) {
      encoder += encoder_table(e, table);
    } else {
      cross += cross_table(e, table, index++, 0);
    }
  }
  std::vector<TextFile> files;
  if (!encoder.empty()) {
    files.push_back(
        {"AX_EEC.INI",
         "%_N_AX_EEC_INI\nCHANDATA(1)\n" + head +
             "; sign: error, actual minus nominal; a positive value moves the axis in the negative "
             "direction (SINUMERIK 808D Function Manual, 01/2017, page 106)\n; load with MD32700 "
             "$MA_ENC_COMP_ENABLE = 0\n" +
             encoder + "M17\n"});
  }
  if (!cross.empty()) {
    files.push_back(
        {"NC_CEC.INI",
         "%_N_NC_CEC_INI\nCHANDATA(1)\n" + head +
             "; sign: correction, added to the setpoint of the compensation axis; check "
             "it with one table before you enable all\n; load with MD32710 "
             "$MA_CEC_ENABLE = 0, then enable SD41300 $SN_CEC_TABLE_ENABLE\n" +
             cross + "M17\n"});
  }
  return files;
}

// --- CSV ----------------------------------------------------------------------------------------

std::string component_csv(const TableExport& e,
                          const std::vector<const CompensationTable*>& tables) {
  const TableLine& line = tables.front()->line;
  std::string text =
      fmt::format("{}_{}", e.letter(line.joint), line.joint < kLinearJoints ? "mm" : "deg");
  for (const CompensationTable* table : tables) {
    const char* unit = table->is_angle() ? "urad" : "um";
    const std::string name = to_string(*table->component);
    text += table->depends_on_direction() ? fmt::format(",{0}_up_{1},{0}_down_{1}", name, unit)
                                          : fmt::format(",{}_{}", name, unit);
  }
  text += "\n";
  for (std::size_t i = 0; i < line.points; ++i) {
    text += shortest(line.entry(i) / unit_of(line.joint));
    for (const CompensationTable* table : tables) {
      for (const int direction : {1, -1}) {
        if (direction < 0 && !table->depends_on_direction()) continue;
        text += ',';
        text += fixed(values(*table, direction)[i] / (table->is_angle() ? urad : um), 4);
      }
    }
    text += "\n";
  }
  return text;
}

std::string location_csv(const TableExport& e) {
  std::string text;
  for (const TableLine& line : e.lines) {
    const Axis axis = *e.source.chain.layout.axis[static_cast<std::size_t>(line.joint)];
    for (const Axis direction : kAllAxes) {
      const plant::ErrorName name{direction, axis, true};
      const double value = e.source.errors.location(name);
      if (value == 0.0) continue;
      const bool length = is_linear(direction);
      text += fmt::format("{},{},{}\n", to_string(name), fixed(value / (length ? um : urad), 4),
                          length ? "um" : "urad");
    }
  }
  return text;
}

std::vector<TextFile> csv_files(const TableExport& e) {
  std::vector<TextFile> files;
  for (const TableLine& line : e.lines) {
    const std::vector<const CompensationTable*> tables = tables_over(e, line.joint);
    if (tables.empty()) continue;
    files.push_back({lower_case(e.letter(line.joint)) + ".csv", component_csv(e, tables)});
  }
  if (const std::string locations = location_csv(e); !locations.empty()) {
    files.push_back({"locations.csv", "error,value,unit\n" + locations});
  }
  std::vector<std::string> notes = report(e);
  notes.push_back(
      "sign: deviation of the tool side relative to the workpiece side, along X, Y, Z and about "
      "A, "
      "B, C right-handed; the columns are functions of the first one");
  files.push_back({"notes.txt", joined(notes, "")});
  return files;
}

std::vector<TextFile> firmware_files(const TableExport& e) {
  std::vector<TextFile> out;
  if (e.skew) out = skew_files(e);
  if (e.mesh) out.push_back(mesh_file(e));
  return out;
}

}  // namespace

std::vector<TextFile> table_files(const TableExport& e) {
  switch (e.request.format) {
    case TableFormat::linuxcnc:
      return linuxcnc_files(e);
    case TableFormat::heidenhain:
      return heidenhain_files(e);
    case TableFormat::siemens:
      return siemens_files(e);
    case TableFormat::isg:
      return isg_files(e);
    case TableFormat::etalon:
      return etalon_files(e);
    case TableFormat::marlin:
    case TableFormat::klipper:
    case TableFormat::reprapfirmware:
      return firmware_files(e);
    case TableFormat::csv:
      break;
  }
  return csv_files(e);
}

}  // namespace servomill::sim::tables
