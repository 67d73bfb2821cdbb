// The texts themselves, to the letter.
#include <gtest/gtest.h>

#include <numeric>

#include "plant/geometry/error_model.h"
#include "sim/model/machine.h"
#include "sim/tables/table_export.h"
#include "tests/sim/tables/small_machine.h"

namespace servomill::sim::tables::table_files_test {
namespace {

using plant::operator""_err;

// X 0..20 mm with three points, Y and Z 0..20 mm at their middle, 10 mm.
std::vector<TextFile> small_files(TableFormat format, int comp_file_type = 0) {
  plant::ErrorModel errors;
  errors.component("EXX"_err) = plant::polynomial({0.0, 1e-4});       // 1 um in 10 mm
  errors.component("EYX"_err) = plant::polynomial({0.0, 0.0, 0.02});  // 2 um at 10 mm
  errors.component("EAX"_err) = plant::polynomial({0.0, 1e-3});       // 20 urad at 20 mm
  errors.location("EC0Y"_err) = 50.0 * urad;
  TableRequest request = request_of(format);
  request.comp_file_type = comp_file_type;
  request.spacing = 10.0 * mm;
  request.tool_length = 100.0 * mm;
  for (int j = 0; j < kLinearJoints; ++j) {
    TableRequest::AxisRequest& axis = request.axes[static_cast<std::size_t>(j)];
    axis.from = 0.0;
    axis.to = 20.0 * mm;
    axis.wanted = j < 2;
  }
  return table_files(export_tables(machine_of("[w X b Y Z t]"), errors, request));
}

// All files of a format in one text, each below its name.
std::string all(const std::vector<TextFile>& files) {
  return std::accumulate(files.begin(), files.end(), std::string(),
                         [](const std::string& text, const TextFile& file) {
                           return text + "--- " + file.name + "\n" + file.text;
                         });
}

TEST(TableFiles, Linuxcnc) {
  EXPECT_EQ(all(small_files(TableFormat::linuxcnc)),
            R"(--- joint_0_x.comp
0.000000 -0.001000 -0.001000
10.000000 10.000000 10.000000
20.000000 20.001000 20.001000
--- compensation.ini
# compensation tables of error model 'test' on small machine
# document: LinuxCNC, INI Configuration, [JOINT_N]: COMP_FILE, COMP_FILE_TYPE, as read by usrmotLoadComp (src/emc/motion/usrmotintf.cc) and EMCMOT_SET_JOINT_COMP (src/emc/motion/command.c)
# reference: each table contains the errors along its axis through X = 10 mm, Y = 10 mm, Z = 10 mm, tool 100 mm
# zero: the tables are 0 at the reference; the error there is left to the work offset: X 0.500 um, Y 2.900 um, Z 0.100 um
# tables:
#   X over X: 3 points, 10 mm apart from 0 mm, up to 1.000 um; linear interpolation and rounding leave up to 0.000 um
# not in these tables, or only on their lines (largest value; its residual within the travel, relative to the reference):
#   EYX   8.000 um; tip 6.000 um
#   EAX   20.000 urad; tip 1.140 um, tool axis 20.000 urad
#   EC0Y  50.000 urad; tip 0.500 um
# TCP at poses all over the travel, relative to the reference: off by up to 7.257 um without these tables, 7.123 um with
# each line of a file: nominal position, position reached moving up, moving down
# units: mm and deg, as LINEAR_UNITS = mm and ANGULAR_UNITS = degree; up and down are equal: no positioning depends on the direction of travel
# joints: X, Y, Z and the rotary axes in alphabetical order; COMP_FILE excludes BACKLASH

[JOINT_0]
COMP_FILE = joint_0_x.comp
COMP_FILE_TYPE = 0
)");
}

// The correction is added to the command of the motor: the error with the opposite sign.
TEST(TableFiles, LinuxcncTrims) {
  EXPECT_EQ(file_named(small_files(TableFormat::linuxcnc, 1), "joint_0_x.comp").text,
            R"(0.000000 0.001000 0.001000
10.000000 0.000000 0.000000
20.000000 -0.001000 -0.001000
)");
}

TEST(TableFiles, Heidenhain) {
  EXPECT_EQ(all(small_files(TableFormat::heidenhain)),
            R"(--- X.COM.txt
     AXISPOS          X          Y          Z
      0.0000    -0.0010    -0.0029    -0.0001
     10.0000     0.0000     0.0000     0.0000
     20.0000     0.0010     0.0069     0.0001
--- Y.COM.txt
     AXISPOS          X          Z
      0.0000     0.0005    -0.0001
     10.0000     0.0000     0.0000
     20.0000    -0.0005     0.0001
--- CONFIG.CMA.txt
ACTIVE        X        Y
     *    X.COM    Y.COM
--- notes.txt
compensation tables of error model 'test' on small machine
document: HEIDENHAIN, Technical Manual MANUALplus 620 (2012), pages 716 to 718 (columns of *.COM and *.CMA); Technical Manual TNC 407/415/425 (1998), pages 151 to 156 and 622 (sign, limits)
reference: each table contains the errors along its axis through X = 10 mm, Y = 10 mm, Z = 10 mm, tool 100 mm
zero: the tables are 0 at the reference; the error there is left to the work offset: X 0.500 um, Y 2.900 um, Z 0.100 um
tables:
  X over X: 3 points, 10 mm apart from 0 mm, up to 1.000 um; linear interpolation and rounding leave up to 0.000 um
  Y over X: 3 points, 10 mm apart from 0 mm, up to 6.900 um; linear interpolation and rounding leave up to 0.500 um
  Z over X: 3 points, 10 mm apart from 0 mm, up to 0.100 um; linear interpolation and rounding leave up to 0.000 um
  X over Y: 3 points, 10 mm apart from 0 mm, up to 0.500 um; linear interpolation and rounding leave up to 0.000 um
  Z over Y: 3 points, 10 mm apart from 0 mm, up to 0.100 um; linear interpolation and rounding leave up to 0.000 um
note: X: controls without the column AXISPOS need a spacing of 2^n x 0.0001 mm
note: Y: controls without the column AXISPOS need a spacing of 2^n x 0.0001 mm
not in these tables, or only on their lines (largest value; its residual within the travel, relative to the reference):
  EAX   20.000 urad; tip 0.224 um, tool axis 20.000 urad
TCP at poses all over the travel, relative to the reference: off by up to 7.257 um without these tables, 0.651 um with
values: error in mm or deg, positive where the axis travels too far, entered with its sign
columns: [axis of the column of *.COM] = F([axis of the column of *.CMA]); AXISPOS from the machine datum; BACKLASH is empty: no positioning depends on the direction
these are listings for the table editor of the control: the documents give the columns, not the text of the files
check the sign at one point before relying on it
)");
}

TEST(TableFiles, Siemens) {
  EXPECT_EQ(all(small_files(TableFormat::siemens)),
            R"(--- AX_EEC.INI
%_N_AX_EEC_INI
CHANDATA(1)
; compensation tables of error model 'test' on small machine
; document: Siemens, SINUMERIK 840D sl/828D Function Manual Extended Functions (03/2013), 6FC5397-1BP40-3BA1, K3 Compensations, pages 237 to 268
; reference: each table contains the errors along its axis through X = 10 mm, Y = 10 mm, Z = 10 mm, tool 100 mm
; zero: the tables are 0 at the reference; the error there is left to the work offset: X 0.500 um, Y 2.900 um, Z 0.100 um
; tables:
;   X over X: 3 points, 10 mm apart from 0 mm, up to 1.000 um; linear interpolation and rounding leave up to 0.000 um
;   Y over X: 3 points, 10 mm apart from 0 mm, up to 6.899 um; linear interpolation and rounding leave up to 0.500 um
;   Z over X: 3 points, 10 mm apart from 0 mm, up to 0.100 um; linear interpolation and rounding leave up to 0.000 um
;   X over Y: 3 points, 10 mm apart from 0 mm, up to 0.500 um; linear interpolation and rounding leave up to 0.000 um
;   Z over Y: 3 points, 10 mm apart from 0 mm, up to 0.100 um; linear interpolation and rounding leave up to 0.000 um
; not in these tables, or only on their lines (largest value; its residual within the travel, relative to the reference):
;   EAX   20.000 urad; tip 0.224 um, tool axis 20.000 urad
; TCP at poses all over the travel, relative to the reference: off by up to 7.257 um without these tables, 0.650 um with
; axes: machine axes are taken to be called X1, Y1, ...; first measuring system
; sign: error, actual minus nominal; a positive value moves the axis in the negative direction (SINUMERIK 808D Function Manual, 01/2017, page 106)
; load with MD32700 $MA_ENC_COMP_ENABLE = 0
; X1: MD38000 $MA_MM_ENC_COMP_MAX_POINTS[0,X1] >= 3
$AA_ENC_COMP[0,0,X1]=-0.001000
$AA_ENC_COMP[0,1,X1]=0.000000
$AA_ENC_COMP[0,2,X1]=0.001000
$AA_ENC_COMP_STEP[0,X1]=10
$AA_ENC_COMP_MIN[0,X1]=0
$AA_ENC_COMP_MAX[0,X1]=20
$AA_ENC_COMP_IS_MODULO[0,X1]=0
M17
--- NC_CEC.INI
%_N_NC_CEC_INI
CHANDATA(1)
; compensation tables of error model 'test' on small machine
; document: Siemens, SINUMERIK 840D sl/828D Function Manual Extended Functions (03/2013), 6FC5397-1BP40-3BA1, K3 Compensations, pages 237 to 268
; reference: each table contains the errors along its axis through X = 10 mm, Y = 10 mm, Z = 10 mm, tool 100 mm
; zero: the tables are 0 at the reference; the error there is left to the work offset: X 0.500 um, Y 2.900 um, Z 0.100 um
; tables:
;   X over X: 3 points, 10 mm apart from 0 mm, up to 1.000 um; linear interpolation and rounding leave up to 0.000 um
;   Y over X: 3 points, 10 mm apart from 0 mm, up to 6.899 um; linear interpolation and rounding leave up to 0.500 um
;   Z over X: 3 points, 10 mm apart from 0 mm, up to 0.100 um; linear interpolation and rounding leave up to 0.000 um
;   X over Y: 3 points, 10 mm apart from 0 mm, up to 0.500 um; linear interpolation and rounding leave up to 0.000 um
;   Z over Y: 3 points, 10 mm apart from 0 mm, up to 0.100 um; linear interpolation and rounding leave up to 0.000 um
; not in these tables, or only on their lines (largest value; its residual within the travel, relative to the reference):
;   EAX   20.000 urad; tip 0.224 um, tool axis 20.000 urad
; TCP at poses all over the travel, relative to the reference: off by up to 7.257 um without these tables, 0.650 um with
; axes: machine axes are taken to be called X1, Y1, ...; first measuring system
; sign: correction, added to the setpoint of the compensation axis; check it with one table before you enable all
; load with MD32710 $MA_CEC_ENABLE = 0, then enable SD41300 $SN_CEC_TABLE_ENABLE
; Y1 over X1: MD18342 $MN_MM_CEC_MAX_POINTS[0] >= 3
$AN_CEC[0,0]=0.002900
$AN_CEC[0,1]=0.000000
$AN_CEC[0,2]=-0.006899
$AN_CEC_INPUT_AXIS[0]=(X1)
$AN_CEC_OUTPUT_AXIS[0]=(Y1)
$AN_CEC_STEP[0]=10
$AN_CEC_MIN[0]=0
$AN_CEC_MAX[0]=20
$AN_CEC_DIRECTION[0]=0
$AN_CEC_MULT_BY_TABLE[0]=0
$AN_CEC_IS_MODULO[0]=0
; Z1 over X1: MD18342 $MN_MM_CEC_MAX_POINTS[1] >= 3
$AN_CEC[1,0]=0.000100
$AN_CEC[1,1]=0.000000
$AN_CEC[1,2]=-0.000100
$AN_CEC_INPUT_AXIS[1]=(X1)
$AN_CEC_OUTPUT_AXIS[1]=(Z1)
$AN_CEC_STEP[1]=10
$AN_CEC_MIN[1]=0
$AN_CEC_MAX[1]=20
$AN_CEC_DIRECTION[1]=0
$AN_CEC_MULT_BY_TABLE[1]=0
$AN_CEC_IS_MODULO[1]=0
; X1 over Y1: MD18342 $MN_MM_CEC_MAX_POINTS[2] >= 3
$AN_CEC[2,0]=-0.000500
$AN_CEC[2,1]=0.000000
$AN_CEC[2,2]=0.000500
$AN_CEC_INPUT_AXIS[2]=(Y1)
$AN_CEC_OUTPUT_AXIS[2]=(X1)
$AN_CEC_STEP[2]=10
$AN_CEC_MIN[2]=0
$AN_CEC_MAX[2]=20
$AN_CEC_DIRECTION[2]=0
$AN_CEC_MULT_BY_TABLE[2]=0
$AN_CEC_IS_MODULO[2]=0
; Z1 over Y1: MD18342 $MN_MM_CEC_MAX_POINTS[3] >= 3
$AN_CEC[3,0]=0.000100
$AN_CEC[3,1]=0.000000
$AN_CEC[3,2]=-0.000100
$AN_CEC_INPUT_AXIS[3]=(Y1)
$AN_CEC_OUTPUT_AXIS[3]=(Z1)
$AN_CEC_STEP[3]=10
$AN_CEC_MIN[3]=0
$AN_CEC_MAX[3]=20
$AN_CEC_DIRECTION[3]=0
$AN_CEC_MULT_BY_TABLE[3]=0
$AN_CEC_IS_MODULO[3]=0
M17
)");
}

TEST(TableFiles, Csv) {
  EXPECT_EQ(all(small_files(TableFormat::csv)),
            R"(--- x.csv
X_mm,EXX_um,EYX_um,EAX_urad
0,0.0000,0.0000,0.0000
10,1.0000,2.0000,10.0000
20,2.0000,8.0000,20.0000
--- locations.csv
error,value,unit
EC0Y,50.0000,urad
--- notes.txt
compensation tables of error model 'test' on small machine
document: RFC 4180; names of ISO 230-1 and ISO 230-7
tables:
  EXX over X: 3 points, 10 mm apart from 0 mm, up to 2.000 um; linear interpolation and rounding leave up to 0.000 um
  EYX over X: 3 points, 10 mm apart from 0 mm, up to 8.000 um; linear interpolation and rounding leave up to 0.500 um
  EAX over X: 3 points, 10 mm apart from 0 mm, up to 20.000 urad; linear interpolation and rounding leave up to 0.000 urad
not in these tables: none except the residual of linear interpolation
sign: deviation of the tool side relative to the workpiece side, along X, Y, Z and about A, B, C right-handed; the columns are functions of the first one
)");
}

// An endless axis: one turn, which a SINUMERIK repeats.
TEST(TableFiles, SiemensRepeatsTheTurnOfAnEndlessAxis) {
  plant::ErrorModel errors;
  errors.component("ECC"_err) = plant::harmonic(100.0 * urad, 360.0 * deg);
  TableRequest request = request_of(TableFormat::siemens);
  request.rotary_spacing = 90.0 * deg;
  const auto files = table_files(export_tables(machine_of("[w C' X b Y Z t]"), errors, request));
  ASSERT_EQ(files.size(), 1U);
  const std::string& text = files.front().text;
  EXPECT_EQ(text.substr(text.find("; C1")),
            R"(; C1: MD38000 $MA_MM_ENC_COMP_MAX_POINTS[0,C1] >= 5
$AA_ENC_COMP[0,0,C1]=0.00000000
$AA_ENC_COMP[0,1,C1]=0.00572958
$AA_ENC_COMP[0,2,C1]=0.00000000
$AA_ENC_COMP[0,3,C1]=-0.00572958
$AA_ENC_COMP[0,4,C1]=0.00000000
$AA_ENC_COMP_STEP[0,C1]=90
$AA_ENC_COMP_MIN[0,C1]=0
$AA_ENC_COMP_MAX[0,C1]=360
$AA_ENC_COMP_IS_MODULO[0,C1]=1
M17
)");
}

}  // namespace
}  // namespace servomill::sim::tables::table_files_test
