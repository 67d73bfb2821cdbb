// A written table that is changed in any way that matters is refused.
#include <gtest/gtest.h>

#include <functional>
#include <sstream>

#include "sim/model/machine.h"
#include "tests/sim/tables/rich_tables.h"
#include "tests/text.h"

namespace servomill::sim::tables::table_mutations_test {
namespace {

// Numbers of a line by their place in it.
struct Number {
  std::size_t at, size;
  double value;
};

std::vector<Number> values_in(const std::string& line) {
  std::vector<Number> out;
  const std::size_t equals = line.find('=');  // SINUMERIK: indices are none
  std::size_t i = equals == std::string::npos ? 0 : equals + 1;
  while (i < line.size()) {
    const std::size_t end = line.find_first_of(" ,", i);
    const std::string word = line.substr(i, end - i);
    char* rest = nullptr;
    const double value = std::strtod(word.c_str(), &rest);
    if (!word.empty() && *rest == '\0') out.push_back({i, word.size(), value});
    if (end == std::string::npos) break;
    i = end + 1;
  }
  return out;
}

// True for lines that hold a point: of *.comp, *.COM, *.csv, *.exc and $AA_ENC_COMP[0,1,X1]=,
// $AN_CEC[0,1]=.
bool holds_point(const std::string& line) {
  if (line.starts_with("$")) {
    return line.starts_with("$AA_ENC_COMP[") || line.starts_with("$AN_CEC[");
  }
  return !line.empty() && values_in(line).size() >= 2 &&
         line.find_first_of("#;=") == std::string::npos;
}

using Edit = std::function<void(std::vector<std::string>& lines, std::size_t at)>;

std::string replaced(const std::string& line, const Number& number, double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.8f", value);
  return line.substr(0, number.at) + text + line.substr(number.at + number.size);
}

Edit change_value(double factor, double offset) {
  return [=](std::vector<std::string>& lines, std::size_t at) {
    const Number last = values_in(lines[at]).back();
    lines[at] = replaced(lines[at], last, last.value * factor + offset);
  };
}

struct Mutation {
  std::string name;
  Edit edit;
};

std::vector<Mutation> mutations() {
  return {{"value off by 1 um", change_value(1.0, 1e-3)},
          {"value in another unit", change_value(25.4, 0.0)},
          {"row dropped",
           [](auto& lines, std::size_t at) { lines.erase(lines.begin() + static_cast<long>(at)); }},
          {"row doubled",
           [](auto& lines, std::size_t at) {
             lines.insert(lines.begin() + static_cast<long>(at), lines[at]);
           }},
          {"values of two rows swapped",
           [](auto& lines, std::size_t at) {
             const Number a = values_in(lines[at]).back(), b = values_in(lines[at + 1]).back();
             const std::string first = replaced(lines[at], a, b.value);
             lines[at + 1] = replaced(lines[at + 1], b, a.value);
             lines[at] = first;
           }},
          {"sign lost",
           [](auto& lines, std::size_t at) {
             const Number last = values_in(lines[at]).back();
             lines[at] = replaced(lines[at], last, -last.value);
           }},
          {"text instead of a number", [](auto& lines, std::size_t at) {
             const Number last = values_in(lines[at]).back();
             lines[at] = lines[at].substr(0, last.at) + "-";
           }}};
}

// At 20 rows of every file: a mutation either leaves the very text (a zero has no sign) or is
// found.
TEST(TableMutations, MutationsOfAnyRowAreFound) {
  std::size_t found = 0;
  for (const TableFormat format :
       {TableFormat::linuxcnc, TableFormat::heidenhain, TableFormat::siemens, TableFormat::csv,
        TableFormat::isg, TableFormat::etalon}) {
    const TableExport tables = rich_tables(format);
    const auto files = table_files(tables);
    for (std::size_t f = 0; f < files.size(); ++f) {
      const auto lines = lines_of(files[f].text);
      std::vector<std::size_t> points;
      for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
        if (holds_point(lines[i]) && holds_point(lines[i + 1])) points.push_back(i);
      }
      constexpr std::size_t kRows = 20;
      for (std::size_t n = 0; n < std::min(kRows, points.size()); ++n) {
        const std::size_t at = points[n * points.size() / std::min(kRows, points.size())];
        for (const Mutation& mutation : mutations()) {
          const bool siemens_row = format == TableFormat::siemens;
          if (siemens_row && mutation.name == "row doubled") continue;  // assigned twice the same
          auto changed = lines;
          mutation.edit(changed, at);
          const auto before = values_in(lines[at]), after = values_in(changed[at]);
          const bool is_same = mutation.name != "row dropped" && mutation.name != "row doubled" &&
                               !after.empty() && after.size() == before.size() &&
                               std::abs(after.back().value - before.back().value) < 2e-4;
          if (is_same) continue;  // within two digits
          auto mutant = files;
          mutant[f].text = joined(changed);
          EXPECT_NE(fault_of(tables, mutant), "verified")
              << name_of(format) << ", " << mutation.name << ": " << files[f].name << ":" << at + 1
              << ": " << lines[at];
          ++found;
        }
      }
    }
  }
  EXPECT_GT(found, 1000U);
}

// A text of one file replaced everywhere.
std::vector<TextFile> with(std::vector<TextFile> files, const std::string& name,
                           const std::string& from, const std::string& to) {
  for (TextFile& file : files) {
    if (file.name != name) continue;
    const std::size_t at = file.text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    file.text.replace(at, from.size(), to);
  }
  return files;
}

TEST(TableMutations, MutationsOfHeadsAreFound) {
  struct Head {
    TableFormat format;
    std::string file, from, to;
  };
  const std::vector<Head> heads = {
      {TableFormat::linuxcnc, "compensation.ini", "COMP_FILE_TYPE = 0", "COMP_FILE_TYPE = 1"},
      {TableFormat::linuxcnc, "compensation.ini", "[JOINT_1]", "[JOINT_2]"},
      {TableFormat::linuxcnc, "compensation.ini", "COMP_FILE = joint_1_y.comp", "HOME = 0"},
      {TableFormat::heidenhain, "CONFIG.CMA.txt", "X        Y", "Y        X"},
      {TableFormat::heidenhain, "CONFIG.CMA.txt", "*", "-"},
      {TableFormat::heidenhain, "X.COM.txt", "  Y          Z", "  Z          Y"},
      {TableFormat::heidenhain, "X.COM.txt", "BACKLASH          X", "X          BACKLASH"},
      {TableFormat::siemens, "NC_CEC.INI", "OUTPUT_AXIS[2]=(Y1)", "OUTPUT_AXIS[2]=(Z1)"},
      {TableFormat::siemens, "NC_CEC.INI", "INPUT_AXIS[2]=(X1)", "INPUT_AXIS[2]=(Y1)"},
      {TableFormat::siemens, "NC_CEC.INI", "DIRECTION[0]=1", "DIRECTION[0]=-1"},
      {TableFormat::siemens, "NC_CEC.INI", "DIRECTION[0]=1", "DIRECTION[0]=0"},
      {TableFormat::siemens, "NC_CEC.INI", "STEP[0]=10", "STEP[0]=5"},
      {TableFormat::siemens, "NC_CEC.INI", "MIN[0]=-100", "MIN[0]=-90"},
      {TableFormat::siemens, "NC_CEC.INI", "MULT_BY_TABLE[0]=0", "MULT_BY_TABLE[0]=1"},
      {TableFormat::siemens, "NC_CEC.INI", "M17", ""},
      {TableFormat::siemens, "AX_EEC.INI", "$AA_ENC_COMP_MAX[0,Y1]=150",
       "$AA_ENC_COMP_MAX[0,Y1]=140"},
      {TableFormat::siemens, "AX_EEC.INI", "IS_MODULO[0,Y1]=0", "IS_MODULO[0,Y1]=1"},
      {TableFormat::csv, "x.csv", "EYX_up_um", "EYX_down_um"},
      {TableFormat::csv, "x.csv", "EZX_um", "EZX_urad"},
      {TableFormat::csv, "z.csv", "Z_mm", "Y_mm"},
      {TableFormat::csv, "locations.csv", "EC0Y", "EC0X"},
      {TableFormat::csv, "locations.csv", "200.0", "20.0"},
      {TableFormat::isg, "volcomp.csv", "C0Y", "C0X"},
      {TableFormat::isg, "volcomp.csv", "0.000200000", "0.000100000"},
      {TableFormat::isg, "volcomp.csv", "EXX EYX", "EYX EXX"},
      {TableFormat::isg, "volcomp.csv", "Y EYY", "X EYX"},
      {TableFormat::isg, "volcomp.csv", "#\n", ""},
      {TableFormat::etalon, "volcomp.exc", "[C0Y]", "[B0Y]"},
      {TableFormat::etalon, "volcomp.exc", "VALUE = 0.0002", "VALUE = 0.0003"},
      {TableFormat::etalon, "volcomp.exc", "[EXX]", "[EXY]"},
      {TableFormat::etalon, "volcomp.exc", "}", ""}};
  for (const Head& head : heads) {
    const TableExport tables = rich_tables(head.format);
    const auto files = table_files(tables);
    EXPECT_NE(fault_of(tables, with(files, head.file, head.from, head.to)), "verified")
        << head.file << ": " << head.from << " -> " << head.to;
  }
}

// File, line, position and both values.
TEST(TableMutations, TellsWhereAndByHowMuch) {
  plant::ErrorModel errors;
  errors.component("EXX"_err) = plant::polynomial({0.0, 1e-4});
  TableRequest request = request_of(TableFormat::linuxcnc);
  request.spacing = 100.0 * mm;
  const TableExport tables = export_tables(machine_of("[w X b Y Z t]"), errors, request);
  const auto files = table_files(tables);
  EXPECT_EQ(fault_of(tables, with(files, "joint_0_x.comp", "100.009999 100.009999",
                                  "100.009999 99.990001")),
            "joint_0_x.comp:2: error: verification failed: X over X at X0.1001 mm, travelling "
            "down: the file gives 0.0100 um, the error model -0.0100 um");
  EXPECT_EQ(fault_of(tables, with(files, "joint_0_x.comp", "0.000000 0.000000 0.000000\n", "")),
            "joint_0_x.comp: error: verification failed: 2 points; 3 are needed");
  EXPECT_EQ(to_string(verify_tables(tables, files)),
            "verified: 6000 positions, largest difference to the error model 0.0000 um");
}

}  // namespace
}  // namespace servomill::sim::tables::table_mutations_test
