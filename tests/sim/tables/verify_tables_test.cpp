// Written tables are read back as the control documents them and compared with the error model; a
// file that is changed in any way that matters is refused.
#include "sim/tables/verify_tables.h"

#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <functional>
#include <sstream>

#include "plant/vocabulary/input_error.h"
#include "tests/sim/tables/small_machine.h"
#include "tests/text.h"

namespace servomill::sim::verify_tables_test {
namespace {

using plant::operator""_err;

// Errors of all kinds, two of them dependent on the direction of travel.
plant::ErrorModel rich_model() {
  plant::ErrorModel errors;
  errors.component("EXX"_err) = plant::polynomial({5.0 * um, 2e-4, 1e-3}) +
                                plant::harmonic(10.0 * um, 60.0 * mm, 0.3) +
                                plant::reversal({6.0 * um, 2e-5}, 0.1 * mm);
  errors.component("EYX"_err) =
      plant::harmonic(8.0 * um, 150.0 * mm) + plant::reversal({4.0 * um}, 0.1 * mm);
  errors.component("EZX"_err) = plant::polynomial({0.0, 1e-4, 2e-3});
  errors.component("EYY"_err) = plant::harmonic(20.0 * um, 150.0 * mm, 1.0);
  errors.component("EXZ"_err) = plant::polynomial({0.0, 5e-5, -1e-4});
  errors.component("EAZ"_err) = plant::polynomial({0.0, 2e-4});
  errors.location("EC0Y"_err) = 200.0 * urad;
  errors.component("ECC"_err) = plant::harmonic(100.0 * urad, 360.0 * deg, 0.4) +
                                plant::harmonic(20.0 * urad, 90.0 * deg) +
                                plant::reversal({8.0 * urad}, 0.01);
  return errors;
}

TableRequest rich_request(TableFormat format, int comp_file_type = 0) {
  TableRequest request = request_of(format);
  request.comp_file_type = comp_file_type;
  request.tool_length = 120.0 * mm;
  request.spacing = 10.0 * mm;
  request.rotary_spacing = 15.0 * deg;
  if (format == TableFormat::csv) request.tool_length = 0.0;
  return request;
}

TableExport rich_tables(TableFormat format, int comp_file_type = 0) {
  return export_tables(machine_of("[w C' X b Y Z t]"), rich_model(),
                       rich_request(format, comp_file_type));
}

std::string fault_of(const TableExport& tables, const std::vector<TextFile>& files) {
  try {
    verify_tables(tables, files);
  } catch (const InputError& error) {
    return error.what();
  }
  return "verified";
}

TEST(VerifyTables, EveryFormatHoldsTheErrorModel) {
  for (const TableFormat format :
       {TableFormat::linuxcnc, TableFormat::heidenhain, TableFormat::siemens, TableFormat::csv}) {
    for (const int type : {0, 1}) {
      if (type == 1 && format != TableFormat::linuxcnc) continue;
      const TableExport tables = rich_tables(format, type);
      const auto files = table_files(tables);
      ASSERT_EQ(fault_of(tables, files), "verified") << name_of(format);
      const TableVerification verified = verify_tables(tables, files);
      EXPECT_GE(verified.positions, 8000U) << name_of(format);
      // interpolation over 10 mm of a wave of 60 mm and 10 um: (2 pi 10/60)^2 / 8 of it
      EXPECT_GT(verified.length, 1.0 * um) << name_of(format);
      EXPECT_LT(verified.length, 2.0 * um) << name_of(format);
      EXPECT_GT(verified.angle, 0.1 * urad) << name_of(format);
      EXPECT_LT(verified.angle, 4.0 * urad) << name_of(format);
    }
  }
}

TEST(VerifyTables, OnChainsOfAnyOrderAndSense) {
  for (const char* structure : {"[w X Y b Z t]", "[w C' A' Y b X Z t]", "[w Y b X Z B t]"}) {
    for (const plant::Sense sense : {plant::Sense::tool, plant::Sense::table}) {
      MachineSettings machine = machine_of(structure);
      for (auto& axis : machine.chain.axes) axis.sense = sense;
      plant::ErrorModel errors = rich_model();
      if (!machine.chain.layout.joint_of(Axis::C)) errors.component("ECC"_err) = {};
      if (machine.chain.layout.joint_of(Axis::B)) {
        errors.component("EBB"_err) = plant::harmonic(100.0 * urad, 360.0 * deg, 0.4);
      }
      for (const TableFormat format : {TableFormat::linuxcnc, TableFormat::heidenhain,
                                       TableFormat::siemens, TableFormat::csv}) {
        const TableExport tables = export_tables(machine, errors, rich_request(format));
        EXPECT_EQ(fault_of(tables, table_files(tables)), "verified")
            << structure << " " << name_of(format);
      }
    }
  }
}

// Errors of any size, kind and place on machines of any order.
plant::ErrorModel random_model(boost::random::mt19937& engine, const JointLayout& layout) {
  boost::random::uniform_real_distribution<double> part(-1.0, 1.0);
  plant::ErrorModel errors;
  for (const auto& axis : layout.axis) {
    if (!axis) continue;
    const double travel = is_linear(*axis) ? 0.2 : 6.0;  // m, rad
    for (const Axis direction : kAllAxes) {
      const double size = 20e-6 * part(engine);  // m, rad
      plant::ErrorFunction error;
      const bool repeats = !is_linear(*axis);  // after one turn
      if (part(engine) > 0.0) error = plant::polynomial({size, repeats ? 0.0 : size / travel});
      const double period = repeats ? 120.0 * deg : 0.4 * travel;
      if (part(engine) > 0.0) error = error + plant::harmonic(size, period, part(engine));
      if (part(engine) > 0.6) error = error + plant::reversal({0.3 * size}, 1e-3 * travel);
      errors.component({direction, *axis, false}) = error;
      const plant::ErrorName location{direction, *axis, true};
      if (!plant::why_meaningless(location, layout)) errors.location(location) = size;
    }
  }
  return errors;
}

TEST(VerifyTables, RandomModelsAreVerified) {
  boost::random::mt19937 engine(3);
  constexpr int kModels = 5;
  for (int n = 0; n < kModels; ++n) {
    for (const char* structure : {"[w X b Y Z t]", "[w C' A' Y b X Z t]", "[w Y b X Z B t]"}) {
      const MachineSettings machine = machine_of(structure);
      const plant::ErrorModel errors = random_model(engine, machine.chain.layout);
      for (const TableFormat format : {TableFormat::linuxcnc, TableFormat::heidenhain,
                                       TableFormat::siemens, TableFormat::csv}) {
        const TableExport tables = export_tables(machine, errors, rich_request(format));
        ASSERT_EQ(fault_of(tables, table_files(tables)), "verified")
            << structure << " " << name_of(format) << " " << n;
      }
    }
  }
}

TEST(VerifyTables, AnErrorThatDoesNotRepeatIsRefusedForATableThatDoes) {
  plant::ErrorModel errors;
  errors.component("ECC"_err) = plant::polynomial({0.0, 1e-5});  // 62.8 urad a turn
  for (const TableFormat format : {TableFormat::siemens, TableFormat::heidenhain}) {
    try {
      export_tables(machine_of("[w C' X b Y Z t]"), errors, request_of(format));
      FAIL() << name_of(format);
    } catch (const InputError& error) {
      EXPECT_EQ(error.faults()[0].message,
                "the error of C after one turn differs by 62.83 urad from that at the start, and "
                "the table repeats; give --travel C=FROM:TO, or an error that repeats, too");
    }
    TableRequest limited = request_of(format);
    limited.axes[4].from = 0.0;
    limited.axes[4].to = 270.0 * deg;
    limited.axes[3] = limited.axes[4];
    const TableExport tables = export_tables(machine_of("[w C' X b Y Z t]"), errors, limited);
    EXPECT_EQ(fault_of(tables, table_files(tables)), "verified");
  }
}

// --- mutations of written files

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

// True for lines that hold a point: of *.comp, *.COM, *.csv and $AA_ENC_COMP[0,1,X1]=,
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
TEST(VerifyTables, MutationsOfAnyRowAreFound) {
  std::size_t found = 0;
  for (const TableFormat format :
       {TableFormat::linuxcnc, TableFormat::heidenhain, TableFormat::siemens, TableFormat::csv}) {
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

TEST(VerifyTables, MutationsOfHeadsAreFound) {
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
      {TableFormat::csv, "locations.csv", "200.0", "20.0"}};
  for (const Head& head : heads) {
    const TableExport tables = rich_tables(head.format);
    const auto files = table_files(tables);
    EXPECT_NE(fault_of(tables, with(files, head.file, head.from, head.to)), "verified")
        << head.file << ": " << head.from << " -> " << head.to;
  }
}

// File, line, position and both values.
TEST(VerifyTables, TellsWhereAndByHowMuch) {
  plant::ErrorModel errors;
  errors.component("EXX"_err) = plant::polynomial({0.0, 1e-4});
  TableRequest request = request_of(TableFormat::linuxcnc);
  request.spacing = 100.0 * mm;
  const TableExport tables = export_tables(machine_of("[w X b Y Z t]"), errors, request);
  const auto files = table_files(tables);
  EXPECT_EQ(
      fault_of(tables,
               with(files, "joint_0_x.comp", "100.009999 100.009999", "100.009999 99.990001")),
      "joint_0_x.comp:2: error: not as verified: X over X at X0.1001 mm, travelling down: the "
      "file gives 0.0100 um, the error model -0.0100 um");
  EXPECT_EQ(fault_of(tables, with(files, "joint_0_x.comp", "0.000000 0.000000 0.000000\n", "")),
            "joint_0_x.comp: error: not as verified: 2 points; 3 are needed");
  EXPECT_EQ(to_string(verify_tables(tables, files)),
            "verified: 6000 positions, largest difference to the error model 0.0000 um");
}

// --- direction of travel

plant::ErrorModel reversal_of_x() {
  plant::ErrorModel errors;
  errors.component("EXX"_err) =
      plant::polynomial({0.0, 1e-4}) + plant::reversal({4.0 * um}, 0.1 * mm);
  return errors;
}

TableRequest three_points(TableFormat format) {
  TableRequest request = request_of(format);
  request.spacing = 100.0 * mm;
  return request;
}

// 10 um in 100 mm, at the corrected position 0.01 % less; 2 um more upwards, 2 um less downwards.
TEST(VerifyTables, BothDirectionsOfTravelGoIntoTables) {
  const auto text = [](TableFormat format, const std::string& name) {
    return file_named(table_files(export_tables(machine_of("[w X b Y Z t]"), reversal_of_x(),
                                                three_points(format))),
                      name)
        .text;
  };
  EXPECT_EQ(text(TableFormat::linuxcnc, "joint_0_x.comp"),
            "-100.000000 -100.007999 -100.011999\n"
            "0.000000 0.002000 -0.002000\n"
            "100.000000 100.011999 100.007999\n");
  EXPECT_EQ(text(TableFormat::heidenhain, "X.COM.txt"),
            "     AXISPOS   BACKLASH          X\n"
            "   -100.0000    -0.0120    -0.0080\n"
            "      0.0000    -0.0020     0.0020\n"
            "    100.0000     0.0080     0.0120\n");
  EXPECT_EQ(text(TableFormat::csv, "x.csv"),
            "X_mm,EXX_up_um,EXX_down_um\n-100,-8.0000,-12.0000\n0,2.0000,-2.0000\n"
            "100,12.0000,8.0000\n");
  const std::string cec = text(TableFormat::siemens, "NC_CEC.INI");
  EXPECT_EQ(cec.substr(cec.find("; X1 over X1")),
            R"(; X1 over X1, travelling up: MD18342 $MN_MM_CEC_MAX_POINTS[0] >= 3
$AN_CEC[0,0]=0.007999
$AN_CEC[0,1]=-0.002000
$AN_CEC[0,2]=-0.011999
$AN_CEC_INPUT_AXIS[0]=(X1)
$AN_CEC_OUTPUT_AXIS[0]=(X1)
$AN_CEC_STEP[0]=100
$AN_CEC_MIN[0]=-100
$AN_CEC_MAX[0]=100
$AN_CEC_DIRECTION[0]=1
$AN_CEC_MULT_BY_TABLE[0]=0
$AN_CEC_IS_MODULO[0]=0
; X1 over X1, travelling down: MD18342 $MN_MM_CEC_MAX_POINTS[1] >= 3
$AN_CEC[1,0]=0.011999
$AN_CEC[1,1]=0.002000
$AN_CEC[1,2]=-0.007999
$AN_CEC_INPUT_AXIS[1]=(X1)
$AN_CEC_OUTPUT_AXIS[1]=(X1)
$AN_CEC_STEP[1]=100
$AN_CEC_MIN[1]=-100
$AN_CEC_MAX[1]=100
$AN_CEC_DIRECTION[1]=-1
$AN_CEC_MULT_BY_TABLE[1]=0
$AN_CEC_IS_MODULO[1]=0
M17
)");
}

std::vector<std::string> notes(TableFormat format, const plant::ErrorModel& errors) {
  std::vector<std::string> out;
  for (const std::string& line :
       report(export_tables(machine_of("[w X b Y Z t]"), errors, three_points(format)))) {
    if (line.starts_with("note: E") || line.starts_with("note: no")) out.push_back(line);
  }
  return out;
}

// The control's BACKLASH belongs to the axis itself: of a straightness it takes the mean.
TEST(VerifyTables, WhatAControlCannotHoldIsReported) {
  plant::ErrorModel errors = reversal_of_x();
  errors.component("EYX"_err) =
      plant::polynomial({0.0, 1e-4}) + plant::reversal({2.0 * um}, 0.1 * mm);
  EXPECT_EQ(
      notes(TableFormat::heidenhain, errors),
      (std::vector<std::string>{"note: EXX depends on the direction of travel, by 4.000 um at "
                                "the ends of the travel; both directions are held by X over "
                                "X; the mean by Y over X",
                                "note: EYX depends on the direction of travel, by 2.000 um at "
                                "the ends of the travel; both directions are held by X over "
                                "X; the mean by Y over X"}));
  EXPECT_EQ(notes(TableFormat::siemens, errors)[1],
            "note: EYX depends on the direction of travel, by 2.000 um at the ends of the travel; "
            "both directions are held by X over X, Y over X");
}

// An error of 5 mm period between points 7 mm apart.
TEST(VerifyTables, TablesThatMakeTheMachineWorseAreRefused) {
  plant::ErrorModel errors;
  errors.component("EYY"_err) = plant::harmonic(12.0 * um, 5.0 * mm);
  TableRequest request = request_of(TableFormat::heidenhain);
  request.spacing = 7.0 * mm;
  try {
    export_tables(machine_of("[w X b Y Z t]"), errors, request);
    FAIL();
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("these tables would make the machine worse: tip off by up to "),
              std::string::npos)
        << what;
    EXPECT_NE(what.find("; Y over Y: points 7 mm apart leave "), std::string::npos) << what;
    EXPECT_NE(what.find(" of an error of +-12.000 um; it needs 0."), std::string::npos) << what;
  }
}

// Points one period apart see an error that does not change.
TEST(VerifyTables, PointsThatSeeNothingOfAnErrorAreReported) {
  plant::ErrorModel errors;
  errors.component("EYY"_err) = plant::harmonic(12.0 * um, 5.0 * mm);
  errors.component("EXX"_err) = plant::polynomial({0.0, 1e-4});
  TableRequest request = request_of(TableFormat::heidenhain);
  request.spacing = 5.0 * mm;
  std::string all;
  for (const std::string& line :
       report(export_tables(machine_of("[w X b Y Z t]"), errors, request))) {
    all += line + "\n";
  }
  EXPECT_NE(all.find("note: Y over Y: points 5 mm apart leave 12.000 um of an error of +-12.000 "
                     "um; it needs 0."),
            std::string::npos)
      << all;

  errors.component("EXX"_err) = {};
  try {
    export_tables(machine_of("[w X b Y Z t]"), errors, request);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("can hold nothing of the error model"),
              std::string::npos);
    EXPECT_NE(std::string(error.what()).find("; Y over Y: points 5 mm apart leave 12.000 um"),
              std::string::npos)
        << error.what();
  }
}

// A straightness of which only the direction of travel matters has no mean to hold.
TEST(VerifyTables, ReversalWithoutATableIsReportedAsLost) {
  plant::ErrorModel errors = reversal_of_x();
  errors.component("EYX"_err) = plant::reversal({2.0 * um}, 0.1 * mm);
  for (const TableFormat format : {TableFormat::linuxcnc, TableFormat::heidenhain}) {
    EXPECT_EQ(notes(format, errors),
              (std::vector<std::string>{
                  "note: EXX depends on the direction of travel, by 4.000 um at the ends of the "
                  "travel; both directions are held by X over X",
                  "note: EYX depends on the direction of travel, by 2.000 um at the ends of the "
                  "travel; there is no table Y over X: half of it, 1.000 um, stays in each "
                  "direction"}));
  }
}

TEST(VerifyTables, MoreTablesThanASmallSinumerikHasAreReported) {
  plant::ErrorModel errors = reversal_of_x();
  for (const char* name : {"EXX", "EYX", "EZX", "EXY", "EYZ"}) {
    errors.component(*plant::error_name_of(name)) =
        plant::polynomial({0.0, 1e-4}) + plant::reversal({2.0 * um}, 0.1 * mm);
  }
  const auto lines = report(
      export_tables(machine_of("[w X b Y Z t]"), errors, three_points(TableFormat::siemens)));
  const std::string note =
      "note: 10 tables of $AN_CEC; a SINUMERIK 828D has 8: choose axes with --axis";
  EXPECT_EQ(std::count(lines.begin(), lines.end(), note), 1);
}

// --- axes without an error of their own

// Squareness alone: Y inclined by 200 urad is shorter by 200e-6^2 / 2 of 0.6 m, 12 nm. Neither X
// nor Y has an error of positioning.
TEST(VerifyTables, NoTableForAnAxisWithoutError) {
  plant::ErrorModel errors;
  errors.component("EXX"_err) = plant::polynomial({0.0, 1e-4});
  errors.location("EC0Y"_err) = 200.0 * urad;
  TableRequest request = request_of(TableFormat::linuxcnc);
  request.axes[1].from = 0.0;
  request.axes[1].to = 1200.0 * mm;
  const TableExport tables = export_tables(machine_of("[w X b Y Z t]"), errors, request);
  std::vector<std::string> names;
  for (const TextFile& file : table_files(tables)) names.push_back(file.name);
  EXPECT_EQ(names, (std::vector<std::string>{"joint_0_x.comp", "compensation.ini"}));
  EXPECT_EQ(fault_of(tables, table_files(tables)), "verified");
  const auto lines = report(tables);
  const std::string note =
      "note: no table Y over Y: 0.012 um at most, of second order in errors of other directions";
  EXPECT_EQ(std::count(lines.begin(), lines.end(), note), 1);
}

}  // namespace
}  // namespace servomill::sim::verify_tables_test
