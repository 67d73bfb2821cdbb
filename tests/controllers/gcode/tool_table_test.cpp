#include "controllers/gcode/tool_table.h"

#include "tests/controllers/gcode/program.h"

namespace servomill::controllers::tool_table_test {
namespace {

std::string faults_of(const std::string& text) {
  try {
    ToolTable::parse(text, "t.tbl");
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(ToolTable, ReadsEveryWordOfLinuxCnc) {
  const ToolTable table = ToolTable::parse(
      "T7 P12 X1 Y-2 Z+3.5 A4 B5 C6 U0 V0 W0 D8.5 I95 J155 Q2 ;mill\n\n; remark\nz1e1 t8p3\r\n",
      "t.tbl");
  ASSERT_EQ(table.size(), 2u);
  const ToolEntry& tool = *table.find(7);
  EXPECT_EQ(tool.pocket, 12);
  expect_axes(tool.offset, axes(1, -2, 3.5, 4, 5, 6));
  EXPECT_NEAR(tool.diameter, 8.5e-3, kExact);
  EXPECT_NEAR(tool.front_angle, 95 * deg, kExact);
  EXPECT_NEAR(tool.back_angle, 155 * deg, kExact);
  EXPECT_EQ(tool.orientation, 2);
  EXPECT_NEAR(table.find(8)->offset[2], 10e-3, kExact);
}

TEST(ToolTable, NamesEveryFaultOfEveryLine) {
  EXPECT_EQ(faults_of("T1 P1 Z5\n"
                      "T1 Z6\n"
                      "P3 D1\n"
                      "T2 Zx K4 D2 D3\n"
                      "T2.5 P-1 Q10\n"
                      "T4 U3 Znan\n"
                      "hello T5\n"),
            "t.tbl:2:1: error: tool T1 appears twice\nt.tbl:3:1: error: the tool number (T word) "
            "is missing\nt.tbl:4:4: error: Z must be followed by a number\nt.tbl:4:7: error: "
            "unknown word 'K'; allowed are T P X Y Z A B C D I J Q\nt.tbl:4:13: error: the D word "
            "appears twice\nt.tbl:5:1: error: T2.5; must be an integer in 0 ... "
            "1000000\nt.tbl:5:6: error: P-1; must be an integer in 0 ... 1000000\nt.tbl:5:10: "
            "error: Q10; must be an integer in 0 ... 9\nt.tbl:6:4: error: U3; must be 0: axis U is "
            "not supported\nt.tbl:6:7: error: Z must be followed by a number\nt.tbl:7:1: error: "
            "unknown word 'h'; allowed are T P X Y Z A B C D I J Q");
}

TEST(ToolTable, ChangesWhileTheProgramRuns) {
  expect_axes(last_move("T1 M6\nG10 L1 P1 Z50\nG43 G0 Z0").end_machine, axes(0, 0, 50));
  expect_axes(last_move("G10 L1 P1 Z50\nG10 L0\nG43 H1 G0 Z0").end_machine, axes(0, 0, 100));
  // the tip stands on Z3 of the work system
  expect_axes(last_move("T3 M6\nG10 L2 P1 Z20\nG0 Z70\nG10 L10 P3 Z3\nG43\nG0 X0").end,
              axes(0, 0.25, 3));
}

TEST(ToolTable, FaultsOfG10NameTheWord) {
  EXPECT_EQ(fault_of("G10 X1"), "p.nc:1:1: error: G10 requires an L word (L0 L1 L2 L10 L11 L20)");
  EXPECT_EQ(fault_of("G10 L3 P1 X1"),
            "p.nc:1:5: error: G10 L3; must be L0, L1, L2, L10, L11 or L20");
  EXPECT_EQ(fault_of("G10 L1 X1"), "p.nc:1:1: error: G10 L1 requires a P word (tool number)");
  EXPECT_EQ(fault_of("G10 L1 P1.5 X1"), "p.nc:1:8: error: P1.5; must be an integer");
  EXPECT_EQ(fault_of("G10 L11 P0 X1"), "p.nc:1:9: error: G10 L11 P0; must be a tool number >= 1");
  EXPECT_EQ(fault_of("G10 L10 P5 X1"), "p.nc:1:9: error: P5 is not in the tool table");
  EXPECT_EQ(fault_of("G10 L1 P1"),
            "p.nc:1:1: error: G10 L1 requires a word to set (X Y Z A B C R I J Q)");
  EXPECT_EQ(fault_of("G10 L1 P1 Q-1"),
            "p.nc:1:11: error: Q-1; the tool orientation must be in 0 ... 9");
  EXPECT_EQ(fault_of("G10 L2 P1 X1 J2"), "p.nc:1:14: error: J word is not allowed with G10 L2");
  EXPECT_EQ(fault_of("T1 M6\nG10 L0"),
            "p.nc:2:5: error: G10 L0 with tool T1 in the spindle; unload it (T0 M6) first");
  EXPECT_EQ(fault_of("G10 L1 P1 Z50\nG43.4 H1"),
            "p.nc:2:1: error: G43.4: G10 has changed T1; TCP control and tilted planes require the "
            "offset of the tool table");
}

}  // namespace
}  // namespace servomill::controllers::tool_table_test
