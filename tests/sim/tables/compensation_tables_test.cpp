#include "sim/tables/compensation_tables.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "sim/model/machine.h"
#include "tests/sim/tables/rich_tables.h"

namespace servomill::sim::tables::compensation_tables_test {
namespace {

// 10 um in 100 mm, at the corrected position 0.01 % less; 2 um more upwards, 2 um less downwards.
TEST(CompensationTables, BothDirectionsOfTravelGoIntoTables) {
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

// Squareness alone: Y inclined by 200 urad is shorter by 200e-6^2 / 2 of 0.6 m, 12 nm. Neither X
// nor Y has an error of positioning.
TEST(CompensationTables, NoTableForAnAxisWithoutError) {
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
}  // namespace servomill::sim::tables::compensation_tables_test
