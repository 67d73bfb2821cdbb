#include "controllers/gcode/post_approach.h"

#include <algorithm>

#include "controllers/gcode/printer.h"
#include "tests/controllers/gcode/cutter_locations.h"

namespace servomill::controllers::post_approach_test {
namespace {

// A fork head tilted by 30 deg to +X; the tool is 100 mm long, the retract height 400 mm. Spindle
// and coolant wait for the rotary axes; the rapid at the same tool axis stays one; a rapid to
// another tool axis, a tool change and the end retract.
TEST(PostApproach, SafeApproachAndRetractAsPrinted) {
  PostOptions options;
  options.tools = usual_setup().tools;
  options.safe = {10.0 * mm, 0.4};
  const ClData data =
      cl("LOADTL/1\nSPINDL/600,CLW\nCOOLNT/ON\nFEDRAT/600\nGOTO/0,0,10,0.5,0,0.8660254037844386\n"
         "GOTO/0,0,0\nRAPID\nGOTO/20,0,0\nRAPID\nGOTO/40,0,0,0,0,1\nFEDRAT/600\nGOTO/50,0,0\n"
         "SPINDL/OFF\nFINI\n");
  PrintOptions print;
  print.axes = "XYZAB";
  const auto inverse = machine("[w X b Y Z B t]");
  EXPECT_EQ(print_program(post(data, "p.cls", inverse, options).moves, print, "").text,
            R"(G21 G90 G91.1 G94 G17 G40 G80 G92.1
G49 G53 G0 Z400
T1 M6
G49 G53 G0 Z400
G54 G0 B30
S600
M3
M8
G54 G0 X55 Y0
G54
G43 H1
G64 P0.0005
G0 X55 Y0 Z5.2627944 A0 B30
G93
G1 X50 Z-3.3974596 F60
G1 Z-13.3974596 F60
G94
G0 X70
G0 X75 Z-4.7372056
G49 G53 G0 Z400
G54 G0 B0
G54 G0 X40 Y0
G54
G43 H1
G64 P0.0005
G0 X40 Y0 Z10 A0 B0
G0 Z0
G93
G1 X50 F60
G94
G0 Z10
G49 G53 G0 Z400
M5
M9
M30
)");
}

// Under G49 a dwell as a move would bring the tool length before X and Y are there.
TEST(PostApproach, DwellsAtTheRetractHeightAreLinesOfTheProgram) {
  PostOptions options;
  options.tools = usual_setup().tools;
  options.safe = {10.0 * mm, 0.4};
  const ClData data = cl("LOADTL/1\nDELAY/2\nFEDRAT/600\nGOTO/0,0,10,0,0,1\nGOTO/0,0,0\nFINI\n");
  const PostProcessed made = post(data, "p.cls", machine("[w X b Y Z B t]"), options);
  const auto text = print_program(made.moves, {}, "").text;
  EXPECT_LT(text.find("G4 P2"), text.find("G43")) << text;
  EXPECT_TRUE(std::none_of(made.moves.begin(), made.moves.end(),
                           [](const Move& move) { return move.kind == MoveKind::dwell; }));
}

}  // namespace
}  // namespace servomill::controllers::post_approach_test
