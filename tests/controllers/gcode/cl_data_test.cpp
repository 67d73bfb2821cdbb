#include "controllers/gcode/cl_data.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>

#include "controllers/gcode/modal_state.h"
#include "plant/vocabulary/tool_axis.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::cl_data_test {
namespace {

constexpr double kPrinted = 1e-15;       // m; 17 digits are printed and read, then scaled by mm
constexpr double kUnitRounding = 4e-16;  // of a normalised component

ClData apt(std::string_view text) { return read_cl_data(text, "p.cls"); }
ClData csv(std::string_view text) { return read_cl_data(text, "p.csv"); }

std::string fault_of(std::string_view text, const std::string& file) {
  try {
    read_cl_data(text, file);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}
std::string apt_fault(std::string_view text) { return fault_of(text, "p.cls"); }
std::string csv_fault(std::string_view text) { return fault_of(text, "p.csv"); }

std::vector<std::string> warnings_of(const ClData& data) {
  std::vector<std::string> out;
  for (const Warning& warning : data.warnings) out.push_back(to_string(warning));
  return out;
}

void expect_pose(const ClRecord& record, const Eigen::Vector3d& p_mm, const Eigen::Vector3d& k) {
  EXPECT_LT((record.P.p_WT - p_mm * mm).norm(), kPrinted);
  EXPECT_LT((record.P.k_W - k).norm(), kUnitRounding);
}

TEST(ClData, EveryStatementThatIsKnown) {
  const ClData data =
      apt("PARTNO impeller, $ 1\n"
          "$$ a comment\n"
          "UNITS/MM\n"
          "LOADTL/3\n"
          "SPINDL/4775,RPM,CLW\n"
          "COOLNT/ON\n"
          "RAPID\n"
          "GOTO/1,2,3,0,0,1\n"
          "FEDRAT/MMPM,1394.0\n"
          "goto / 1.5 , -2. , +3e1 $$ behind\n"
          "GOTO/1,2,3,$\n"
          "  0.6,0,$ what stands here is not read\n"
          "  0.8\n"
          "DELAY/0.5\n"
          "PPRINT blade 1\n"
          "OPSTOP\nSTOP\n"
          "SPINDL/OFF\nCOOLNT/OFF\n"
          "FINI\n");
  ASSERT_EQ(data.records.size(), 12u);
  EXPECT_EQ(data.part, "impeller,");
  EXPECT_EQ(data.locations(), 3u);
  EXPECT_TRUE(data.warnings.empty());
  const auto& r = data.records;
  EXPECT_EQ(r[0].kind, MoveKind::tool);
  EXPECT_EQ(r[0].number, 3);
  EXPECT_EQ(r[1].kind, MoveKind::spindle);
  EXPECT_EQ(r[1].direction, 1);
  EXPECT_DOUBLE_EQ(r[1].value, 4775.0 * rpm);
  EXPECT_EQ(r[2].number, kFlood);
  EXPECT_EQ(r[3].kind, MoveKind::rapid);
  EXPECT_EQ(r[3].line, 8);
  expect_pose(r[3], {1, 2, 3}, {0, 0, 1});
  EXPECT_EQ(r[4].kind, MoveKind::feed);
  EXPECT_DOUBLE_EQ(r[4].feed, 1394.0 * mm_per_min);
  expect_pose(r[4], {1.5, -2, 30}, {0, 0, 1});
  EXPECT_EQ(r[5].line, 11);
  expect_pose(r[5], {1, 2, 3}, {0.6, 0, 0.8});
  EXPECT_DOUBLE_EQ(r[6].value, 0.5);
  EXPECT_EQ(r[7].text, "blade 1");
  EXPECT_EQ(r[8].number, 1);
  EXPECT_EQ(r[9].number, 0);
  EXPECT_EQ(r[10].direction, 0);
  EXPECT_EQ(r[11].number, 0);
}

TEST(ClData, RapidHoldsForOneLocation) {
  const ClData data = apt("FEDRAT/100\nRAPID\nGOTO/0,0,1\nGOTO/0,0,0\n");
  EXPECT_EQ(data.records[0].kind, MoveKind::rapid);
  EXPECT_EQ(data.records[1].kind, MoveKind::feed);
}

TEST(ClData, ToolAxisStaysUntilAnotherIsGiven) {
  const ClData data = apt("GOTO/0,0,0\nGOTO/1,0,0,0,1,0\nGOTO/2,0,0\n");
  expect_pose(data.records[0], {0, 0, 0}, {0, 0, 1});
  expect_pose(data.records[2], {2, 0, 0}, {0, 1, 0});
}

TEST(ClData, FeedsInAllUnits) {
  const auto feed = [](const std::string& fedrat) {
    return apt("SPINDL/600,CLW\n" + fedrat + "\nGOTO/0,0,0\n").records.back().feed;
  };
  EXPECT_DOUBLE_EQ(feed("FEDRAT/100"), 100 * mm_per_min);
  EXPECT_DOUBLE_EQ(feed("FEDRAT/100,MMPM"), 100 * mm_per_min);
  EXPECT_DOUBLE_EQ(feed("FEDRAT/IPM,10"), 254 * mm_per_min);
  EXPECT_DOUBLE_EQ(feed("FEDRAT/0.1,MMPR"), 1 * mm);
  EXPECT_DOUBLE_EQ(feed("FEDRAT/0.1,IPR"), 25.4 * mm);
  EXPECT_DOUBLE_EQ(feed("UNITS/INCH\nFEDRAT/10"), 254 * mm_per_min);
  EXPECT_DOUBLE_EQ(feed("UNITS/INCH\nFEDRAT/10,PERREV"), 2.54);
  EXPECT_DOUBLE_EQ(feed("UNITS/INCH\nFEDRAT/10,MMPM"), 10 * mm_per_min);
  EXPECT_EQ(apt("GOTO/0,0,0\n").records.back().feed, 0.0);  // none given
}

TEST(ClData, InchesScaleLengthsAndNotTheAxis) {
  const ClData data = apt("UNITS/INCH\nGOTO/1,2,3,0,0.6,0.8\nUNITS/MM\nGOTO/1,2,3\n");
  expect_pose(data.records[0], {25.4, 50.8, 76.2}, {0, 0.6, 0.8});
  expect_pose(data.records[1], {1, 2, 3}, {0, 0.6, 0.8});
}

TEST(ClData, CsvWithColumnsInAnyOrder) {
  const ClData data =
      csv("# from a CAM "
          "system\r\n\r\nk,j,i,x_in,y,z_mm,feed\r\n1,0,0,1,2,3,600\r\n0.8,0.6,0,-1,0,1e-3,60\r\n");
  ASSERT_EQ(data.records.size(), 2u);
  expect_pose(data.records[0], {25.4, 2, 3}, {0, 0, 1});
  expect_pose(data.records[1], {-25.4, 0, 1e-3}, {0, 0.6, 0.8});
  EXPECT_DOUBLE_EQ(data.records[0].feed, 10 * mm);
  EXPECT_EQ(data.records[1].line, 5);
  EXPECT_EQ(csv("x,y,z,i,j,k\n0,0,0,0,0,1\n").records[0].feed, 0.0);
}

TEST(ClData, LengthOfTheAxisOnBothSidesOfTheTolerance) {
  const std::string inside = fmt::format("GOTO/0,0,0,0,0,{}\n", 1.0 + 0.99 * kAxisLengthTolerance);
  const std::string outside = fmt::format("GOTO/0,0,0,0,0,{}\n", 1.0 + 1.01 * kAxisLengthTolerance);
  EXPECT_TRUE(apt(inside).warnings.empty());
  const ClData data = apt("\n" + outside);
  EXPECT_EQ(warnings_of(data),
            std::vector<std::string>(
                {"p.cls:2:12: warning: tool axis has length 1.0001; normalised to a unit vector"}));
  expect_pose(data.records[0], {0, 0, 0}, {0, 0, 1});
}

TEST(ClData, FourDecimalsOfAnAxisNeedNoWarning) {
  boost::random::mt19937 random(1);
  boost::random::uniform_real_distribution<double> part(-1.0, 1.0);
  std::string text;
  for (int n = 0; n < 1000; ++n) {
    Eigen::Vector3d k(part(random), part(random), part(random));
    k.normalize();
    text += fmt::format("GOTO/0,0,0,{:.4f},{:.4f},{:.4f}\n", k[0], k[1], k[2]);
  }
  EXPECT_TRUE(apt(text).warnings.empty());
}

TEST(ClData, WhatIsWrittenIsReadInBothForms) {
  boost::random::mt19937 random(2);
  boost::random::uniform_real_distribution<double> part(-1.0, 1.0);
  std::string in_apt, in_csv = "x,y,z,i,j,k,feed\n";
  std::vector<ClRecord> wanted(1000);
  for (ClRecord& record : wanted) {
    record.P.p_WT << part(random), part(random), part(random);
    record.P.k_W << part(random), part(random), part(random);
    record.P.k_W.normalize();
    record.feed = 0.01 * (1.1 + part(random));
    const auto& [p, k] = record.P;
    const std::string values = fmt::format("{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}",
                                           p[0] / mm, p[1] / mm, p[2] / mm, k[0], k[1], k[2]);
    in_apt += fmt::format("FEDRAT/{:.17g},MMPM\nGOTO/{}\n", record.feed / mm_per_min, values);
    in_csv += fmt::format("{},{:.17g}\n", values, record.feed / mm_per_min);
  }
  for (const ClData& data : {apt(in_apt), csv(in_csv)}) {
    ASSERT_EQ(data.records.size(), wanted.size());
    for (std::size_t n = 0; n < wanted.size(); ++n) {
      expect_pose(data.records[n], wanted[n].P.p_WT / mm, wanted[n].P.k_W);
      EXPECT_NEAR(data.records[n].feed, wanted[n].feed, kPrinted);
    }
  }
}

TEST(ClData, WhatIsSkippedIsSaid) {
  EXPECT_EQ(
      warnings_of(apt("MACHIN/FANUC\nPAINT/PATH\nPAINT/SPEED,10\nPAINT/COLOR,3\n"
                      "COOLNT/ON,THRU\nLOADTL/1,ADJUST,1\nGOTO/0,0,0\nFINI\nGOTO/1,1,1\n")),
      std::vector<std::string>({"p.cls:1:1: warning: MACHIN is ignored",
                                "p.cls:2:1: warning: PAINT is ignored, here and in 2 other lines",
                                "p.cls:5:11: warning: 'THRU' of COOLNT is ignored",
                                "p.cls:6:10: warning: 'ADJUST' of LOADTL is ignored",
                                "p.cls:6:17: warning: '1' of LOADTL is ignored",
                                "p.cls:9:1: warning: text after FINI is ignored"}));
}

TEST(ClData, FaultsOfApt) {
  EXPECT_EQ(apt_fault("GOTO/1,2,3,0,0,0\n"),
            "p.cls:1:12: error: tool axis (0, 0, 0) has zero length");
  EXPECT_EQ(apt_fault("GOTO/1,2\n"), "p.cls:1:1: error: GOTO requires x,y,z or x,y,z,i,j,k");
  EXPECT_EQ(apt_fault("GOTO/1,two,3\n"), "p.cls:1:8: error: 'two' is not a number");
  EXPECT_EQ(apt_fault("GOTO/1,,3\n"), "p.cls:1:8: error: a number is missing");
  EXPECT_EQ(apt_fault("GOTO/1,2,3,$\n0,nan,1\n"), "p.cls:2:3: error: 'nan' is not a number");
  EXPECT_EQ(apt_fault("GOTO/1,2,1e999\n"), "p.cls:1:10: error: '1e999' is not a number");
  EXPECT_EQ(apt_fault("GTO/1,2,3\n"), "p.cls:1:1: error: unknown word 'GTO'; did you mean 'GOTO'?");
  EXPECT_EQ(apt_fault("GOTO 1,2,3\n"),
            "p.cls:1:1: error: GOTO must be followed by '/' or the end of the line");
  EXPECT_EQ(apt_fault("  CIRCLE/0,0,0,0,0,1,5\n"),
            "p.cls:1:3: error: CIRCLE changes the tool path and is not supported; output GOTO "
            "locations instead");
  for (const std::string word : {"MOVARC/0,0,0,0,0,1,5,ANGLE,90", "GOHOME", "GOFWD/L1"}) {
    const std::string name = word.substr(0, word.find('/'));
    EXPECT_EQ(apt_fault(word + "\n"),
              "p.cls:1:1: error: " + name +
                  " changes the tool path and is not supported; output GOTO locations instead");
  }
  EXPECT_EQ(apt_fault("FEDRAT/0,MMPM\n"), "p.cls:1:8: error: the feed rate must be > 0");
  EXPECT_EQ(apt_fault("FEDRAT/MMPM\n"), "p.cls:1:1: error: FEDRAT requires a number");
  EXPECT_EQ(apt_fault("FEDRAT/10,MPM\n"),
            "p.cls:1:11: error: unknown unit 'MPM' of FEDRAT; must be one of MMPM, IPM, MMPR, IPR, "
            "PERMIN, PERREV");
  EXPECT_EQ(apt_fault("FEDRAT/0.1,MMPR\nGOTO/0,0,0\n"),
            "p.cls:2:1: error: a feed per revolution requires a spindle speed (SPINDL)");
  EXPECT_EQ(apt_fault("UNITS/CM\n"), "p.cls:1:1: error: UNITS requires MM or INCH");
  EXPECT_EQ(apt_fault("SPINDL/ON\n"), "p.cls:1:1: error: SPINDL requires a speed");
  EXPECT_EQ(apt_fault("SPINDL/-5,CLW\n"), "p.cls:1:8: error: the spindle speed must be > 0");
  EXPECT_EQ(apt_fault("SPINDL/100,SMM\n"),
            "p.cls:1:12: error: a cutting speed (SFM, SMM) is not supported; program the spindle "
            "speed in RPM");
  EXPECT_EQ(apt_fault("LOADTL/1.5\n"),
            "p.cls:1:8: error: the tool number must be an integer >= 1 and <= 99999");
  EXPECT_EQ(apt_fault("DELAY/-1\n"), "p.cls:1:7: error: DELAY must be >= 0");
  EXPECT_EQ(apt_fault("RAPID/1\n"), "p.cls:1:1: error: RAPID does not accept parameters");
  EXPECT_EQ(apt_fault("/1\n"), "p.cls:1:1: error: a word is missing before '/'");
  EXPECT_EQ(apt_fault("GOTO/0,0,0,$"),
            "p.cls:1: error: the last line ends with the continuation '$', but no line "
            "follows\np.cls:1:1: error: GOTO requires x,y,z or x,y,z,i,j,k");
  EXPECT_EQ(apt_fault(std::string_view("GOTO/0,\0,0", 10)),
            "p.cls:1:8: error: byte 0x00 is not allowed");
  EXPECT_EQ(apt_fault("UNITS/MM\n"), "p.cls: error: contains no cutter location");
  EXPECT_EQ(apt_fault(""), "p.cls: error: contains no cutter location");
}

TEST(ClData, FaultsOfCsv) {
  EXPECT_EQ(csv_fault("x,y,z,i,j\n"), "p.csv:1:1: error: the header lacks column k");
  EXPECT_EQ(
      csv_fault("x,y,z,i,j,k,f\n"),
      "p.csv:1:13: error: unknown column 'f'; must be one of x, y, z (also x_mm, x_in), i, j, k, "
      "feed");
  EXPECT_EQ(csv_fault("x,y,z,x_mm,i,j,k\n"), "p.csv:1:7: error: column x appears twice");
  EXPECT_EQ(csv_fault("x,y,z,i,j,k\n1,2,3,0,0\n"), "p.csv:2:1: error: 5 values; the header has 6");
  EXPECT_EQ(csv_fault("x,y,z,i,j,k\n1,2,3,0,0,0\n"),
            "p.csv:2:7: error: tool axis (0, 0, 0) has zero length");
  EXPECT_EQ(csv_fault("x,y,z,i,j,k\n1,2;5,3,0,0,1\n"), "p.csv:2:3: error: '2;5' is not a number");
  EXPECT_EQ(csv_fault("x,y,z,i,j,k,feed\n1,2,3,0,0,1,0\n"),
            "p.csv:2:13: error: the feed rate must be > 0");
  EXPECT_EQ(csv_fault("x,y,z,i,j,k\n"), "p.csv: error: contains no cutter location");
}

TEST(ClData, WhateverIsReadIsALocationOrAFaultWithItsLine) {
  boost::random::mt19937 random(4);
  const std::string right =
      "UNITS/MM\nSPINDL/4775,RPM,CLW\nFEDRAT/MMPM,13.5\nRAPID\nGOTO/1,2,3,0.6,0,$\n0.8\nGOTO/"
      "-1,.5,+2\n";
  const std::string letters = "0159.,/$-+ \nGOTOFEDRATMMPMxi\t\r\x01\xff";
  int read = 0, refused = 0;
  for (int n = 0; n < 5000; ++n) {
    std::string text = right;
    for (unsigned changes = random() % 4 + 1; changes > 0; --changes) {
      text[random() % text.size()] = letters[random() % letters.size()];
    }
    try {
      for (const ClRecord& record : apt(text).records) {
        EXPECT_TRUE(record.P.p_WT.allFinite());
        EXPECT_NEAR(record.P.k_W.norm(), 1.0, kUnitRounding);
        EXPECT_GE(record.feed, 0.0);
        EXPECT_GT(record.line, 0);
      }
      ++read;
    } catch (const InputError& error) {
      for (const Fault& fault : error.faults()) {
        const bool of_file = fault.message == "contains no cutter location";
        EXPECT_EQ(fault.place.line > 0, !of_file) << text;
      }
      ++refused;
    }
  }
  EXPECT_GT(read, 300);
  EXPECT_GT(refused, 500);
}

TEST(ClData, AllFaultsAreToldAtOnce) {
  EXPECT_EQ(apt_fault("GOTO/1\nUNITS/CM\nGOTO/0,0,0,0,0,0\n"),
            "p.cls:1:1: error: GOTO requires x,y,z or x,y,z,i,j,k\np.cls:2:1: error: UNITS "
            "requires MM or INCH\np.cls:3:12: error: tool axis (0, 0, 0) has zero length");
}

TEST(ClApt, EndOfACycleThatNeverWasIsNothing) {
  const ClData data = apt("CYCLE/OFF\nGOTO/1,2,3\ncycle / off\n");
  EXPECT_EQ(data.records.size(), 1u);
  EXPECT_TRUE(data.warnings.empty());
  const std::string refused =
      "p.cls:1:1: error: CYCLE changes the tool path and is not supported; output GOTO locations "
      "instead";
  EXPECT_EQ(apt_fault("CYCLE/DRILL,10,MMPM,100\nGOTO/1,2,3\n"), refused);
  EXPECT_EQ(apt_fault("CYCLE/ON\nGOTO/1,2,3\n"), refused);
  EXPECT_EQ(apt_fault("CYCLE\nGOTO/1,2,3\n"), refused);
}

TEST(ClData, WarningsOfWhatIsRefusedAreKept) {
  for (const auto& [file, text] : {std::pair("p.cls", "GOTO/0,0,0,0,0,2\nGOTO/1\n"),
                                   {"p.csv", "x,y,z,i,j,k\n0,0,0,0,0,2\n0,0,0,0,0,0\n"}}) {
    std::vector<Warning> warnings;
    EXPECT_THROW(read_cl_data(text, file, &warnings), InputError);
    ASSERT_EQ(warnings.size(), 1u) << file;
    EXPECT_EQ(warnings[0].message, "tool axis has length 2; normalised to a unit vector");
  }
}

}  // namespace
}  // namespace servomill::controllers::cl_data_test
