// Tables worked out by hand from the documents that the readers name: each example lists what the
// control adds to the command at positions between, on and beyond the points. Wrong rules of a
// reader are found by at least one of the examples.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "controllers/tables/csv_table.h"
#include "controllers/tables/heidenhain_table.h"
#include "controllers/tables/siemens_table.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "tests/controllers/tables/linuxcnc_files.h"

namespace servomill::controllers::control_table_test {
namespace {

// Displacement that the control adds: mm and um, deg and millidegrees for rotary axes.
struct Expected {
  Axis base, compensated;
  double position;
  int direction;
  double displacement;
};

struct Example {
  std::string name;
  std::function<std::vector<ControlTable>()> read;
  std::vector<Expected> expected;
};

double displacement(const std::vector<ControlTable>& tables, const Expected& e) {
  double sum = 0.0;
  for (const ControlTable& table : tables) {
    if (table.base_axis != e.base || table.compensated_axis != e.compensated) continue;
    sum += table.at(e.position * (is_linear(e.base) ? mm : deg), e.direction);
  }
  return sum / (is_linear(e.compensated) ? um : 1e-3 * deg);
}

std::vector<std::string> differences(const std::vector<ControlTable>& tables,
                                     const Example& example) {
  std::vector<std::string> out;
  for (const Expected& e : example.expected) {
    const double read = displacement(tables, e);
    if (std::abs(read - e.displacement) <= 1e-6) continue;
    out.push_back(example.name + " at " + std::to_string(e.position) + ": " + std::to_string(read) +
                  ", expected " + std::to_string(e.displacement));
  }
  return out;
}

// The axis is found at 10.003 mm when it was sent to 10 mm moving up, at 10.001 mm moving down: the
// motor must go 3 um and 1 um less.
Example linuxcnc_positions() {
  return {"LinuxCNC, type 0",
          [] {
            return linuxcnc(
                "[EMCMOT]\nCOMM_TIMEOUT = 1\n# comment\n[JOINT_0]\nHOME = 0\n"
                "COMP_FILE = joint_0_x.comp\nCOMP_FILE_TYPE = 0\n",
                "0 0 0\n10 10.003 10.001\n30 29.999 29.998\n");
          },
          {{Axis::X, Axis::X, -5.0, 1, 0.0},
           {Axis::X, Axis::X, 0.0, 1, 0.0},
           {Axis::X, Axis::X, 5.0, 1, -1.5},
           {Axis::X, Axis::X, 5.0, -1, -0.5},
           {Axis::X, Axis::X, 10.0, 1, -3.0},
           {Axis::X, Axis::X, 10.0, -1, -1.0},
           {Axis::X, Axis::X, 15.0, 1, -2.0},
           {Axis::X, Axis::X, 15.0, -1, -0.25},
           {Axis::X, Axis::X, 30.0, 1, 1.0},
           {Axis::X, Axis::X, 30.0, -1, 2.0},
           {Axis::X, Axis::X, 40.0, 1, 1.0},
           {Axis::X, Axis::X, 40.0, -1, 2.0}}};
}

// Type 1: the values are added as they are; joint 3 is C, in degrees.
Example linuxcnc_trims() {
  return {"LinuxCNC, type 1",
          [] {
            return linuxcnc("[JOINT_3]\nCOMP_FILE = c.comp\nCOMP_FILE_TYPE = 1\n",
                            "0 0.002 0.004\n90 -0.002 0.001\n");
          },
          {{Axis::C, Axis::C, 0.0, 1, 2.0},
           {Axis::C, Axis::C, 45.0, 1, 0.0},
           {Axis::C, Axis::C, 45.0, -1, 2.5},
           {Axis::C, Axis::C, 90.0, -1, 1.0},
           {Axis::C, Axis::C, 400.0, 1, -2.0}}};
}

// MANUALplus 620, pages 716 to 718: a pitch error Y = F(Y), a sag Z = F(Y); Y travels 20 um too far
// at 0 upwards and 14 um downwards.
Example heidenhain() {
  return {"HEIDENHAIN",
          [] {
            return read_heidenhain_tables(std::vector<TableText>{
                {"CONFIG.CMA.txt",
                 "ACTIVE        X        Y\n   OLD.COM   O.COM\n*    X.COM    Y.COM\n"},
                {"X.COM.txt", "AXISPOS X\n-10.0000 0.0030\n10.0000 -0.0010\n"},
                {"Y.COM.txt",
                 "AXISPOS BACKLASH Y Z\n-90.0000 0.0000 0.0000 0.0100\n"
                 "0.0000 0.0140 0.0200 0.0300\n5.0000 0.0160 0.0240 0.0500\n"}});
          },
          {{Axis::X, Axis::X, -10.0, 1, -3.0},
           {Axis::X, Axis::X, 5.0, -1, 0.0},
           {Axis::X, Axis::X, 10.0, 1, 1.0},
           {Axis::Y, Axis::Y, -45.0, 1, -10.0},
           {Axis::Y, Axis::Y, -45.0, -1, -7.0},
           {Axis::Y, Axis::Y, 0.0, 1, -20.0},
           {Axis::Y, Axis::Y, 0.0, -1, -14.0},
           {Axis::Y, Axis::Z, -45.0, 1, -20.0},
           {Axis::Y, Axis::Z, -45.0, -1, -20.0},
           {Axis::Y, Axis::Z, 2.5, 1, -40.0},
           {Axis::Y, Axis::Z, 9.0, 1, -50.0}}};
}

// TNC 407, page 156: the control knows entries from 0 to 360 deg only.
Example heidenhain_rotary() {
  return {"HEIDENHAIN, rotary axis",
          [] {
            return read_heidenhain_tables(std::vector<TableText>{
                {"CONFIG.CMA.txt", "ACTIVE C\n* C.COM\n"},
                {"C.COM.txt",
                 "AXISPOS C\n0.0000 0.00000\n90.0000 0.00400\n180.0000 0.00000\n"
                 "270.0000 -0.00200\n360.0000 0.00000\n"}});
          },
          {{Axis::C, Axis::C, 45.0, 1, -2.0},
           {Axis::C, Axis::C, 270.0, 1, 2.0},
           {Axis::C, Axis::C, 315.0, 1, 1.0},
           {Axis::C, Axis::C, -90.0, 1, 2.0},
           {Axis::C, Axis::C, 450.0, -1, -4.0}}};
}

// 6FC5397-1BP40-3BA1, K3: an encoder table of X1, a sag of Z1 over Y1, and pitch tables of Z1 over
// itself for each direction of travel (page 249).
Example siemens() {
  return {"SINUMERIK",
          [] {
            return read_siemens_tables(
                std::vector<TableText>{
                    {"AX_EEC.INI",
                     "%_N_AX_EEC_INI\nCHANDATA(1)\n; comment\n$AA_ENC_COMP[0,0,X1]=0.0\n"
                     "$AA_ENC_COMP[0,1,X1]=0.0200 ; first value\n$AA_ENC_COMP[0,2,X1]=0.0500\n"
                     "$AA_ENC_COMP_STEP[0,X1]=2\n$AA_ENC_COMP_MIN[0,X1]=-200.0\n"
                     "$AA_ENC_COMP_MAX[0,X1]=-196.0\n$AA_ENC_COMP_IS_MODULO[0,X1]=0\nM17\n"},
                    {"NC_CEC.INI",
                     "%_N_NC_CEC_INI\nCHANDATA(1)\n"
                     "$AN_CEC[0,0]=0\n$AN_CEC[0,1]=0.01\n$AN_CEC_INPUT_AXIS[0]=(Y1)\n"
                     "$AN_CEC_OUTPUT_AXIS[0]=(Z1)\n$AN_CEC_STEP[0]=8\n$AN_CEC_MIN[0]=-400.0\n"
                     "$AN_CEC_MAX[0]=-392.0\n$AN_CEC_DIRECTION[0]=0\n$AN_CEC_MULT_BY_TABLE[0]=0\n"
                     "$AN_CEC_IS_MODULO[0]=0\n"
                     "$AN_CEC[1,0]=0.001\n$AN_CEC[1,1]=0.003\n$AN_CEC_INPUT_AXIS[1]=(Z1)\n"
                     "$AN_CEC_OUTPUT_AXIS[1]=(Z1)\n$AN_CEC_STEP[1]=10\n$AN_CEC_MIN[1]=0\n"
                     "$AN_CEC_MAX[1]=10\n$AN_CEC_DIRECTION[1]=1\n$AN_CEC_MULT_BY_TABLE[1]=0\n"
                     "$AN_CEC_IS_MODULO[1]=0\n"
                     "$AN_CEC[2,0]=-0.001\n$AN_CEC[2,1]=-0.002\n$AN_CEC_INPUT_AXIS[2]=(Z1)\n"
                     "$AN_CEC_OUTPUT_AXIS[2]=(Z1)\n$AN_CEC_STEP[2]=10\n$AN_CEC_MIN[2]=0\n"
                     "$AN_CEC_MAX[2]=10\n$AN_CEC_DIRECTION[2]=-1\n$AN_CEC_MULT_BY_TABLE[2]=0\n"
                     "$AN_CEC_IS_MODULO[2]=0\nM17\n"}},
                200);
          },
          {{Axis::X, Axis::X, -300.0, 1, 0.0},
           {Axis::X, Axis::X, -199.0, 1, -10.0},
           {Axis::X, Axis::X, -198.0, -1, -20.0},
           {Axis::X, Axis::X, -197.0, 1, -35.0},
           {Axis::X, Axis::X, 0.0, 1, -50.0},
           {Axis::Y, Axis::Z, -396.0, 1, 5.0},
           {Axis::Y, Axis::Z, -396.0, -1, 5.0},
           {Axis::Y, Axis::Z, 0.0, 1, 10.0},
           {Axis::Z, Axis::Z, 5.0, 1, 2.0},
           {Axis::Z, Axis::Z, 5.0, -1, -1.5},
           {Axis::Z, Axis::Z, 99.0, 1, 3.0},
           {Axis::Z, Axis::Z, -99.0, -1, -1.0}}};
}

// An encoder table of a rotary axis that repeats every 360 deg.
Example siemens_modulo() {
  return {"SINUMERIK, modulo",
          [] {
            return read_siemens_tables(
                std::vector<TableText>{
                    {"AX_EEC.INI",
                     "$AA_ENC_COMP[0,0,C1]=0\n$AA_ENC_COMP[0,1,C1]=0.004\n$AA_ENC_COMP[0,2,C1]=0\n"
                     "$AA_ENC_COMP[0,3,C1]=-0.002\n$AA_ENC_COMP[0,4,C1]=0\n"
                     "$AA_ENC_COMP_STEP[0,C1]=90\n$AA_ENC_COMP_MIN[0,C1]=0\n"
                     "$AA_ENC_COMP_MAX[0,C1]=360\n$AA_ENC_COMP_IS_MODULO[0,C1]=1\nM17\n"}},
                200);
          },
          {{Axis::C, Axis::C, 45.0, 1, -2.0},
           {Axis::C, Axis::C, -90.0, 1, 2.0},
           {Axis::C, Axis::C, 765.0, -1, -2.0}}};
}

// The first points of the examples of the manuals: compensation values of X1 (6FC5397-1BP40-3BA1,
// page 242), and of X1 over Y1 (SINUMERIK 802D sl, 6FC5397-1CP10-5BA0, page 222).
Example siemens_manuals() {
  return {"SINUMERIK, manuals",
          [] {
            return read_siemens_tables(
                std::vector<TableText>{
                    {"AX_EEC.INI",
                     "%_N_AX_EEC_INI\nCHANDATA(1)\n"
                     "$AA_ENC_COMP[0,0,X1]=0.003 ; 1st value: +3 um\n$AA_ENC_COMP[0,1,X1]=0.01\n"
                     "$AA_ENC_COMP[0,2,X1]=0.012\n$AA_ENC_COMP_STEP[0,X1]=1.0\n"
                     "$AA_ENC_COMP_MIN[0,X1]=-200.0\n$AA_ENC_COMP_MAX[0,X1]=-198.0\n"
                     "$AA_ENC_COMP_IS_MODULO[0,X1]=0\nM17\n"},
                    {"NC_CEC.INI",
                     "%_N_NC_CEC_INI\nCHANDATA(1)\n$AN_CEC[0,0]=0\n$AN_CEC[0,1]=0.01\n"
                     "$AN_CEC[0,2]=0.012\n$AN_CEC_INPUT_AXIS[0]=(Y1)\n"
                     "$AN_CEC_OUTPUT_AXIS[0]=(X1)\n$AN_CEC_STEP[0]=6.73\n$AN_CEC_MIN[0]=-400.0\n"
                     "$AN_CEC_MAX[0]=-386.54\n$AN_CEC_DIRECTION[0]=0\n"
                     "$AN_CEC_MULT_BY_TABLE[0]=0\n$AN_CEC_IS_MODULO[0]=0\nM17\n"}},
                200);
          },
          {{Axis::X, Axis::X, -250.0, 1, -3.0},
           {Axis::X, Axis::X, -199.5, 1, -6.5},
           {Axis::X, Axis::X, -199.0, -1, -10.0},
           {Axis::X, Axis::X, -198.5, 1, -11.0},
           {Axis::Y, Axis::X, -450.0, 1, 0.0},
           {Axis::Y, Axis::X, -396.635, 1, 5.0},
           {Axis::Y, Axis::X, -393.27, -1, 10.0},
           {Axis::Y, Axis::X, -389.905, 1, 11.0},
           {Axis::Y, Axis::X, 0.0, 1, 12.0}}};
}

std::vector<Example> examples() {
  return {linuxcnc_positions(), linuxcnc_trims(), heidenhain(), heidenhain_rotary(), siemens(),
          siemens_modulo(),     siemens_manuals()};
}

TEST(ControlTable, ReadersAgreeWithTheExamplesWorkedOutByHand) {
  std::size_t positions = 0;
  for (const Example& example : examples()) {
    EXPECT_EQ(differences(example.read(), example), std::vector<std::string>{});
    positions += example.expected.size();
  }
  EXPECT_EQ(positions, 57U);
}

// Each wrong rule changes what was read; the examples of a control must notice.
TEST(ControlTable, WrongRulesAreFoundByTheExamples) {
  using Rule = std::function<void(ControlTable&)>;
  const auto each_point = [](const std::function<void(TablePoint&)>& change) {
    return Rule([change](ControlTable& table) {
      for (TablePoint& p : table.points) change(p);
    });
  };
  const std::vector<std::pair<std::string, Rule>> everywhere = {
      {"value with the wrong sign",
       each_point([](TablePoint& p) { p.up = -p.up, p.down = -p.down; })},
      {"value in another unit", each_point([](TablePoint& p) { p.up *= 25.4, p.down *= 25.4; })},
      {"position in another unit", each_point([](TablePoint& p) { p.position *= 25.4; })},
      {"table shifted by a point",
       [](ControlTable& t) {
         for (std::size_t i = t.points.size(); --i > 0;) {
           t.points[i].up = t.points[i - 1].up, t.points[i].down = t.points[i - 1].down;
         }
       }},
      {"last point dropped",
       [](ControlTable& t) {
         t.points.pop_back(), t.points.push_back(t.points.back());
         t.points.back().position += 1.0;
       }},
      {"compensated axis swapped",
       [](ControlTable& t) {
         t.compensated_axis = t.compensated_axis == Axis::X ? Axis::Y : Axis::X;
       }},
      {"values held from the point below, not linear", [](ControlTable& t) {
         std::vector<TablePoint> stairs;
         for (std::size_t i = 0; i < t.points.size(); ++i) {
           stairs.push_back(t.points[i]);
           if (i + 1 == t.points.size()) break;
           stairs.push_back(t.points[i]);
           stairs.back().position = t.points[i + 1].position - 1e-9;
         }
         t.points = stairs;
       }}};
  for (const auto& [name, rule] : everywhere) {
    for (const Example& example : examples()) {
      auto tables = example.read();
      std::for_each(tables.begin(), tables.end(), rule);
      EXPECT_FALSE(differences(tables, example).empty()) << name << ": " << example.name;
    }
  }
  const auto swap = each_point([](TablePoint& p) { std::swap(p.up, p.down); });
  const auto mean = each_point([](TablePoint& p) { p.up = p.down = 0.5 * (p.up + p.down); });
  for (const Rule& rule : {swap, mean}) {  // direction of travel
    for (const Example& example :
         {linuxcnc_positions(), linuxcnc_trims(), heidenhain(), siemens()}) {
      auto tables = example.read();
      std::for_each(tables.begin(), tables.end(), rule);
      EXPECT_FALSE(differences(tables, example).empty()) << example.name;
    }
  }
  const Rule never_repeats = [](ControlTable& t) { t.repeats = t.is_one_turn = false; };
  for (const Example& example : {heidenhain_rotary(), siemens_modulo()}) {
    auto tables = example.read();
    std::for_each(tables.begin(), tables.end(), never_repeats);
    EXPECT_FALSE(differences(tables, example).empty()) << example.name;
  }
}

TEST(ControlTable, CsvIsReadByItsHeader) {
  const ErrorColumns read = read_csv_tables(std::vector<TableText>{
      {"x.csv", "X_mm,EXX_up_um,EXX_down_um,EAX_urad\n0,1,-1,10\n10,3,1,20\n"},
      {"locations.csv", "error,value,unit\nEC0Y,50,urad\nEX0C,2,um\n"}});
  ASSERT_EQ(read.components.size(), 3U);
  const ErrorColumn& down = read.components[1];
  EXPECT_EQ(down.name, "EXX");
  EXPECT_EQ(down.direction, -1);
  EXPECT_EQ(down.base_axis, Axis::X);
  EXPECT_DOUBLE_EQ(down.points[1].position, 10.0 * mm);
  EXPECT_DOUBLE_EQ(down.points[1].up, 1.0 * um);
  EXPECT_EQ(read.components[2].name, "EAX");
  EXPECT_DOUBLE_EQ(read.components[2].points[0].up, 10.0 * urad);
  EXPECT_DOUBLE_EQ(read.locations.at("EC0Y").value, 50.0 * urad);
  EXPECT_DOUBLE_EQ(read.locations.at("EX0C").value, 2.0 * um);
}

}  // namespace
}  // namespace servomill::controllers::control_table_test
