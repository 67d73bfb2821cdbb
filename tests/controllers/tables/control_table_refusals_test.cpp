// Tables that a control would not load, or would take otherwise, are refused at their line.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "controllers/tables/csv_table.h"
#include "controllers/tables/heidenhain_table.h"
#include "controllers/tables/siemens_table.h"
#include "plant/vocabulary/input_error.h"
#include "tests/controllers/tables/linuxcnc_files.h"

namespace servomill::controllers::control_table_refusals_test {
namespace {

std::string fault_of(const std::function<void()>& read) {
  try {
    read();
  } catch (const InputError& error) {
    return error.what();
  }
  return "read";
}

std::string linuxcnc_fault(const std::string& text) {
  return fault_of([&] { linuxcnc("[JOINT_0]\nCOMP_FILE = joint_0_x.comp\n", text); });
}

TEST(ControlTableRefusals, LinuxcncRefusesWhatItDoesNotLoad) {
  EXPECT_EQ(linuxcnc_fault("0 0 0\n1 1 x\n2 2 2\n"),
            "joint_0_x.comp:2: error: is not three numbers; LinuxCNC stops reading here");
  EXPECT_EQ(linuxcnc_fault("0 0 0\n0 0 0\n"),
            "joint_0_x.comp:2: error: the positions must increase");
  EXPECT_EQ(linuxcnc_fault("0 0 0\n"), "joint_0_x.comp: error: 1 points; must be >= 2");
  std::string many;
  for (int i = 0; i < 257; ++i) many += std::to_string(i) + " 0 0\n";
  EXPECT_EQ(linuxcnc_fault(many), "joint_0_x.comp:257: error: 257 points; the control accepts 256");
  EXPECT_EQ(fault_of([] { linuxcnc("[JOINT_0]\nCOMP_FILE = y.comp\n", "0 0 0\n1 0 0\n"); }),
            "mill.ini:1: error: file y.comp does not exist");
  EXPECT_EQ(fault_of([] { linuxcnc("[JOINT_7]\nCOMP_FILE = c.comp\n", "0 0 0\n1 0 0\n"); }),
            "mill.ini:1: error: the machine has no joint 7");
}

std::string siemens_fault(const std::string& text) {
  return fault_of([&] { read_siemens_tables(std::vector<TableText>{{"A.INI", text}}, 200); });
}

TEST(ControlTableRefusals, SiemensRefusesWhatItWouldTakeOtherwise) {
  const std::string step = "$AA_ENC_COMP_STEP[0,X1]=1\n$AA_ENC_COMP_MIN[0,X1]=0\n";
  const std::string max = "$AA_ENC_COMP_MAX[0,X1]=2\n$AA_ENC_COMP_IS_MODULO[0,X1]=0\n";
  const std::string points =
      "$AA_ENC_COMP[0,0,X1]=1\n$AA_ENC_COMP[0,1,X1]=0\n$AA_ENC_COMP[0,2,X1]=0\n";
  EXPECT_EQ(siemens_fault(points + step + max + "M17\n"), "read");
  EXPECT_EQ(siemens_fault(points + step + max), "A.INI:7: error: the file ends without M17");
  EXPECT_EQ(siemens_fault(points + max + "M17\n"), "A.INI:1: error: the table does not assign MIN");
  EXPECT_EQ(
      siemens_fault("$AA_ENC_COMP[0,0,X1]=1\n$AA_ENC_COMP[0,2,X1]=1\n" + step + max + "M17\n"),
      "A.INI:1: error: the table has no point 1 of 0 to 2");
  EXPECT_EQ(siemens_fault(points + "$AA_ENC_COMP[0,3,X1]=1\n" + step + max + "M17\n"),
            "A.INI:4: error: the last point of the table is 2");
  EXPECT_EQ(siemens_fault(points + step +
                          "$AA_ENC_COMP_MAX[0,X1]=2\n$AA_ENC_COMP_IS_MODULO[0,X1]=1\nM17\n"),
            "A.INI:3: error: a periodic table must end with its first value");
  EXPECT_EQ(siemens_fault("$MN_X[0]=1\nM17\n"), "A.INI:1: error: unknown variable $MN_X");
}

// Texts with bytes changed, dropped and doubled are read or refused; nothing else happens.
TEST(ControlTableRefusals, DamagedFilesAreReadOrRefused) {
  const std::string pieces = "0123456789.-+eE[](),=;$%#*\n XYZC_AMN";
  const std::vector<std::pair<std::string, std::string>> files = {
      {"mill.ini", "[JOINT_0]\nCOMP_FILE = x.comp\nCOMP_FILE_TYPE = 0\n"},
      {"x.comp", "0 0 0\n10 10.003 10.001\n30 29.999 29.998\n"},
      {"CONFIG.CMA.txt", "ACTIVE X C\n* X.COM C.COM\n"},
      {"X.COM.txt", "AXISPOS BACKLASH X\n0 0.1 0\n1 0.2 0.1\n"},
      {"C.COM.txt", "AXISPOS C\n0 0\n360 0\n"},
      {"A.INI",
       "%_N_NC_CEC_INI\n$AN_CEC[0,0]=0\n$AN_CEC[0,1]=0.01\n$AN_CEC_INPUT_AXIS[0]=(Y1)\n"
       "$AN_CEC_OUTPUT_AXIS[0]=(Z1)\n$AN_CEC_STEP[0]=8\n$AN_CEC_MIN[0]=-400\n"
       "$AN_CEC_MAX[0]=-392\n$AN_CEC_DIRECTION[0]=0\n$AN_CEC_MULT_BY_TABLE[0]=0\n"
       "$AN_CEC_IS_MODULO[0]=0\nM17\n"},
      {"x.csv", "X_mm,EXX_up_um,EXX_down_um\n0,1,2\n5,1,2\n"},
      {"locations.csv", "error,value,unit\nEC0Y,1,urad\n"}};
  std::size_t refused = 0, seed = 1;
  const auto random = [&seed](std::size_t n) {
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return (seed >> 33) % n;
  };
  constexpr int kTexts = 4000;
  for (int n = 0; n < kTexts; ++n) {
    std::vector<TableText> texts;
    for (const auto& [name, text] : files) texts.push_back({name, text});
    std::string& text = texts[random(texts.size())].text;
    for (std::size_t edits = 1 + random(3); edits > 0 && !text.empty(); --edits) {
      const std::size_t at = random(text.size());
      const std::size_t kind = random(4);
      if (kind == 0) text.erase(at, 1 + random(4));
      if (kind == 1) text.insert(at, text.substr(at, 1 + random(20)));
      if (kind >= 2) text[at] = pieces[random(pieces.size())];
    }
    const auto reads = [&](auto&& read) {
      try {
        read();
      } catch (const InputError&) {
        ++refused;
      }
    };
    reads([&] { read_linuxcnc_tables(texts, kJointAxes); });
    reads([&] { read_heidenhain_tables(texts); });
    reads([&] { read_siemens_tables(texts, 200); });
    reads([&] { read_csv_tables(texts); });
  }
  EXPECT_GT(refused, 1000U);
}

TEST(ControlTableRefusals, HeidenhainRefusesRowsAndColumnsThatDoNotFit) {
  const auto fault = [](const std::string& text) {
    return fault_of([&] {
      read_heidenhain_tables(
          std::vector<TableText>{{"CONFIG.CMA.txt", "ACTIVE X\n* X.COM\n"}, {"X.COM.txt", text}});
    });
  };
  EXPECT_EQ(fault("AXISPOS X\n0 0\n1 0 0\n"), "X.COM.txt:3: error: 3 values for 2 columns");
  EXPECT_EQ(fault("AXISPOS Q\n0 0\n1 0\n"), "X.COM.txt:1: error: 'Q' is not an axis");
  EXPECT_EQ(fault("AXISPOS BACKLASH Z\n0 0 0\n1 0 0\n"),
            "X.COM.txt:1: error: BACKLASH without a column X");
  EXPECT_EQ(fault("AXISPOS X\n1 0\n0 0\n"), "X.COM.txt:3: error: the positions must increase");
}

}  // namespace
}  // namespace servomill::controllers::control_table_refusals_test
