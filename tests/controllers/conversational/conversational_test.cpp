// Conversational programs against moves worked out by hand.
#include <gtest/gtest.h>

#include <limits>

#include "controllers/gcode/interpreter.h"
#include "controllers/path/tool_centre_point.h"
#include "moves_text.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::conversational::conversational_test {
namespace {

void expect_all(const std::vector<Example>& examples) {
  for (const Example& example : examples) {
    SCOPED_TRACE(example.name);
    try {
      EXPECT_EQ(framed_moves(example.program), example.moves);
    } catch (const InputError& error) {
      ADD_FAILURE() << error.what();
    }
  }
}

// A portal machine whose Z ends at `upper` (m).
std::shared_ptr<const ToolCentrePoint> machine_with_z_travel(double upper) {
  const auto chain = plant::make_chain(plant::parse_structure("[w b X Y Z (C1) t]"));
  Joints lower = Joints::Constant(-1.0), ends = Joints::Constant(1.0);
  ends[2] = upper;
  return std::make_shared<const ToolCentrePoint>(chain, lower, ends, 1e-6);
}

TEST(Conversational, Lines) { expect_all(line_examples()); }
TEST(Conversational, LabelsAndParameters) { expect_all(flow_examples()); }
TEST(Conversational, Circles) { expect_all(circle_examples()); }
TEST(Conversational, Contours) { expect_all(contour_examples()); }
TEST(Conversational, Cycles) { expect_all(cycle_examples()); }
TEST(Conversational, Transformations) { expect_all(transformation_examples()); }

TEST(Conversational, AtLeastSixtyProgramsAreWorkedOut) {
  EXPECT_GE(line_examples().size() + flow_examples().size() + circle_examples().size() +
                contour_examples().size() + cycle_examples().size() +
                transformation_examples().size(),
            60u);
}

// In tenths of an inch per minute; TNC 7 user's manual, Cutting data
TEST(Conversational, InchesAndTheirFeeds) {
  EXPECT_EQ(
      all_moves(
          "0 BEGIN PGM I INCH\n1 TOOL CALL 1 Z S100\n2 L X+1 Y+0 R0 F100\n3 END PGM I INCH\n"),
      "2 tool 1\n2 spindle 0 S100\n3 feed 25.4 0 -100 F254\n4 end\n");
}

// Programming systems write set-up sheets before the program.
TEST(Conversational, LinesInBracketsBeforeTheProgramAreLeftOut) {
  ProgramSetup setup = example_setup();
  Interpreter interpreter(
      "( Set-up sheet\n(   X0 \"vice\"\n\nBEGIN PGM T MM\n1 TOOL CALL 1 Z "
      "S100\n2 L X+1 Y+2 Z+3 R0 FMAX\n3 END PGM T MM\n",
      "t.h", setup);
  EXPECT_EQ(interpreter.rest().size(), 4u);
  ASSERT_EQ(interpreter.warnings().size(), 1u);
  EXPECT_EQ(interpreter.warnings()[0].message, "2 lines before BEGIN PGM are ignored");
  EXPECT_EQ(interpreter.warnings()[0].place, (Place{"t.h", 4, 1}));
}

std::vector<std::string> warnings_of(const std::string& program, const ProgramSetup& setup) {
  Interpreter interpreter(program, "t.h", setup);
  interpreter.rest();
  std::vector<std::string> out;
  for (const Fault& warning : interpreter.warnings()) out.push_back(warning.message);
  return out;
}

// Simulators of the control number the blocks with N.
TEST(Conversational, BlockNumbersWithN) {
  const std::string program =
      "BEGIN PGM T MM\nN1 TOOL CALL 1 Z S100\nN2 L X+1 Y+2 Z+3 R0 FMAX\nN3 END PGM T MM\n";
  EXPECT_EQ(all_moves(program), "2 tool 1\n2 spindle 0 S100\n3 rapid 1 2 3\n4 end\n");
  EXPECT_EQ(warnings_of(program, example_setup()),
            std::vector<std::string>{
                "block numbers with N are accepted, although controls write them without N"});
}

// Neither line of the comment is a block, with or without a number.
TEST(Conversational, CommentsThatGoOn) {
  for (const std::string number : {"", "3 "}) {
    const std::string lines = number + ";Free software: see~\n L X+99 F1\n4 L X+1 FMAX\n";
    EXPECT_EQ(framed_moves(lines), "3 rapid 1 0 0\n");
    EXPECT_EQ(warnings_of(with_frame(lines), example_setup()),
              std::vector<std::string>{
                  "a comment that ends with '~': the next line is treated as part of it"});
  }
}

TEST(Conversational, Cycle392MovesNothing) {
  const std::string lines = "CYCL DEF 392 ATC~\n Q240=0 ;MODE~\n Q241=1\nL X+1 FMAX\n";
  EXPECT_EQ(framed_moves(lines), "4 rapid 1 0 0\n");
  EXPECT_EQ(warnings_of(with_frame(lines), example_setup()),
            std::vector<std::string>{"CYCL DEF 392 is ignored: it adapts the drives to the load"});
}

// A table that tilts about A and turns about C: tilted by 30 degrees about X, the tool stands along
// the plane at A30 C0 and at A-30 C180.
TEST(Conversational, SeqChoosesTheSignOfThePrincipalAxis) {
  ProgramSetup setup = example_setup();
  setup.machine = std::make_shared<const ToolCentrePoint>(
      plant::make_chain(plant::parse_structure("[w C A b X Y Z t]")), Joints::Constant(-10.0),
      Joints::Constant(10.0), 1e-6);
  const auto A_of = [&](const std::string& lines) {
    Interpreter interpreter(with_frame(lines), "t.h", setup);
    double A = 0.0;
    for (const Move& move : interpreter.rest()) A = move.end_machine[3] / deg;
    return A;
  };
  const std::string plane = "PLANE SPATIAL SPA+30 SPB+0 SPC+0 ";
  const double positive = A_of(plane + "TURN FMAX SEQ+\n"),
               negative = A_of(plane + "TURN FMAX SEQ-\n");
  EXPECT_NEAR(std::abs(positive), 30.0, 1e-9);
  EXPECT_NEAR(negative, -positive, 1e-9);
  EXPECT_GT(positive, 0.0);
  EXPECT_NEAR(A_of(plane + "STAY SEQ-\nL A+Q120 C+Q122 FMAX\n"), negative, 1e-9);
}

// The values of FN 18 are the control's; --parameter gives them.
TEST(Conversational, ValuesReadFromTheControlMayBeGiven) {
  ProgramSetup setup = example_setup();
  setup.parameters["Q1"] = 7.0;
  EXPECT_EQ(framed_moves("FN18: SYSREAD Q1 = ID270 NR1 IDX1\nFN 16: F-PRINT A.A / B.TXT\n"
                         "L X+Q1 F100\n",
                         setup),
            "3 feed 7 0 0 F100\n");
  EXPECT_EQ(framed_moves("FN 18: SYSREAD Q2 = ID270 NR1 IDX1\nQ2 = 4\nL X+Q2 F100\n"),
            "3 feed 4 0 0 F100\n");
}

// A survey goes on: the place is that of G30, which has none unless it is given, and Z is unknown.
TEST(Conversational, TheBuildersReferencePointIsUnknown) {
  ProgramSetup setup = example_setup();
  setup.accepts_unknown_positions = true;
  setup.stored = {{5183, 250.0}};
  EXPECT_EQ(framed_moves("L X+3 FMAX\nL Z+0 R0 FMAX M92\nL Z+5 FMAX\n", setup),
            "1 rapid 3 0 0\n2 rapid 3 0 0\n2 rapid 3 0 150\n3 rapid 3 0 5\n");
  EXPECT_EQ(
      warnings_of(with_frame("L Z+0 FMAX M92\n"), setup),
      std::vector<std::string>{"M92: the machine builder's reference point is unknown; use M91"});
  EXPECT_EQ(fault_of("L Z+0 FMAX M92\nL IZ+1 F100 X+1\n", setup),
            "t.h:5:3: error: IZ: the position of Z is unknown here; program an absolute position");
}

// The path of a pocket is internal to the control: a survey continues, with unknown positions.
TEST(Conversational, ASurveyLeavesOutCyclesOfUnknownPath) {
  ProgramSetup setup = example_setup();
  setup.accepts_unknown_positions = true;
  setup.stored = {{5181, 100.0}, {5182, 200.0}, {5183, 250.0}};
  const std::string pocket =
      "CYCL DEF 251 RECTANGULAR POCKET ~\n  Q218=+60 ~\n  Q219=+20\nL X+3 Y+4 FMAX M99\n";
  EXPECT_EQ(framed_moves(pocket + "L Z+5 FMAX\nL X+1 Y+2 FMAX\n", setup),
            "4 rapid 3 4 0\n4 rapid 3 4 0\n4 rapid 100 200 150\n5 rapid 100 200 5\n"
            "6 rapid 1 2 5\n");
  EXPECT_EQ(warnings_of(with_frame(pocket), setup),
            std::vector<std::string>{
                "CYCL DEF 251: pockets, slots, studs and threads are not supported; have the CAM "
                "system output the moves; extent and cycle time exclude its moves"});
  EXPECT_EQ(fault_of(pocket + "L IX+1 Y+2 F100\n", setup),
            "t.h:8:3: error: IX: the position of X is unknown here; program an absolute position");
  // contours name labels, and old pockets have steps
  EXPECT_EQ(framed_moves("CYCL DEF 14.0 KONTUR\nCYCL DEF 14.1 KONTURLABEL 1/2\nCYCL DEF 4.0 "
                         "TASCHENFRAESEN\nCYCL DEF 4.1 ABST 2\nL X+1 FMAX\n",
                         setup),
            "5 rapid 1 0 0\n");
}

// Measured values are unknown, and so are the positions after the cycle; Q115 to Q119 and Q150 to
// Q166 are its results.
TEST(Conversational, ASurveyGoesOnAfterTouchProbeCycles) {
  ProgramSetup setup = example_setup();
  setup.accepts_unknown_positions = true;
  setup.stored = {{5181, 100.0}, {5182, 200.0}, {5183, 250.0}};
  const std::string probe = "TCH PROBE 412 DATUM INSIDE CIRCLE ~\n  Q321=+0 ~\n  Q262=+40\n";
  EXPECT_EQ(framed_moves(probe + "L Z+5 FMAX\nL X+Q262 Y+2 FMAX\n", setup),
            "1 rapid 0 0 0\n1 rapid 100 200 150\n4 rapid 100 200 5\n5 rapid 40 2 5\n");
  EXPECT_NE(fault_of(probe + "L X+Q151 F100\n", setup).find("Q151 was measured by TCH PROBE"),
            std::string::npos);
  for (const char* result : {"Q5", "Q8"}) {
    EXPECT_NE(fault_of(std::string("Q5 = 3\nQ8 = 3\nTCH PROBE 0.0 REF. PLANE Q5 X-\nTCH PROBE 0.1 "
                                   "X+5 Y+0 Z-5\nL X+") +
                           result + " F100\n",
                       setup)
                  .find(std::string(result) + " was measured by TCH PROBE"),
              std::string::npos);
  }
  EXPECT_EQ(framed_moves("CYCL DEF 202 Q200=2 Q201=-9 Q206=50 Q211=0 Q208=0 Q203=0 Q204=0 Q214=1\n"
                         "CYCL CALL M3\n",
                         setup),
            "2 spindle 1 S1000\n2 rapid 0 0 2\n2 feed 0 0 -9 F50\n2 feed 0 0 2 F50\n");
}

// Before the rotary axes turn, the tool retracts along its axis by MB.
TEST(Conversational, PlaneRetractsBeforeItTurns) {
  ProgramSetup setup = example_setup();
  setup.accepts_unknown_positions = true;
  EXPECT_EQ(framed_moves("L Z+5 FMAX\nPLANE SPATIAL SPA+0 SPB+0 SPC+0 TURN MB+20 F500\n"
                         "L X+1 Y+2 Z+3 FMAX\nPLANE RESET STAY MB+9\n",
                         setup),
            "1 rapid 0 0 5\n2 feed 0 0 25 F500\n3 rapid 1 2 3\n");
  EXPECT_EQ(fault_of("L Z+5 FMAX\nPLANE SPATIAL SPA+0 SPB+0 SPC+0 TURN MB FMAX\n"),
            "t.h:5:38: error: 'MB' requires a number or MAX");
}

// Without a machine, surveys leave out what depends on the tilt, and name the option that gives it.
TEST(Conversational, ASurveyGoesOnInPlanesOfUnknownTilt) {
  ProgramSetup setup = example_setup();
  setup.accepts_unknown_positions = true;
  const std::string ends = "L X+1 Y+2 Z+3 FMAX\n";
  const std::vector<std::string> planes = {"PLANE AXIAL B+45 TURN FMAX\n",
                                           "PLANE SPATIAL SPA+0 SPB+45 SPC+0 MOVE MB MAX FMAX\n",
                                           "CYCL DEF 19.0 WORKING PLANE\nCYCL DEF 19.1 A+0 B+45\n"};
  for (const std::string& plane : planes) {
    EXPECT_EQ(fault_of(plane + ends + "PLANE RESET TURN FMAX\n" + ends, setup), "") << plane;
    EXPECT_NE(fault_of(plane), "") << plane;
  }
  EXPECT_EQ(fault_of("M116\nL B+10 F500\n", setup), "");
  EXPECT_EQ(
      fault_of("FUNCTION TCPM F CONT AXIS POS PATHCTRL VECTOR\n" + ends + "FUNCTION RESET TCPM\n",
               setup),
      "");
  EXPECT_NE(fault_of("FUNCTION TCPM F TCP AXIS SPAT PATHCTRL AXIS\n", setup), "");
}

// The tool is normal to a plane that it was turned to, although the survey knows no angle.
TEST(Conversational, ASurveyKnowsNoAngleOfAToolInAPlane) {
  ProgramSetup setup = example_setup();
  setup.accepts_unknown_positions = setup.accepts_unknown_feeds = true;
  for (const char* plane : {"PLANE SPATIAL SPA+0 SPB+45 SPC+0 TURN FMAX\n",
                            "CYCL DEF 19.0 WORKING PLANE\nCYCL DEF 19.1 A+0 B+45\n"}) {
    for (const std::string& warning :
         warnings_of(with_frame(std::string(plane) + "L X+1 Y+2 Z+3 FMAX\nL X+5 F100\n"), setup)) {
      EXPECT_EQ(warning.find("off Z of the tilted"), std::string::npos) << warning;
    }
  }
}

// DR of a tool whose radius no table has is no radius; R0 in a block with one axis then leaves the
// contour at its end.
TEST(Conversational, ASurveyWithoutARadiusFollowsTheContour) {
  ProgramSetup setup = example_setup();
  const std::string program =
      "TOOL CALL 77 Z S1000 DR-0.04\nL X+0 Y-12 R0 FMAX\nL X+12 RL F100\nL Y+5\nL X+0 R0\n"
      "L Z+9 FMAX\n";
  EXPECT_NE(fault_of(program, setup), "");
  setup.accepts_unknown_positions = true;
  setup.tools.take_any_number();
  EXPECT_EQ(framed_moves(program, setup),
            "1 tool 77\n1 spindle 0 S1000\n2 rapid 0 -12 100\n3 feed 12 -12 100 F100\n"
            "4 feed 12 5 100 F100\n5 feed 0 5 100 F100\n6 rapid 0 5 9\n");
  EXPECT_EQ(warnings_of(with_frame(program), setup).back(),
            "RL and RR: the radius of tool 77 is unknown; the path is the programmed contour; pass "
            "a tool table with --tools");
}

// The end of a move does not depend on its feed.
TEST(Conversational, ASurveyGoesOnWithoutAFeed) {
  ProgramSetup setup = example_setup();
  setup.accepts_unknown_feeds = true;
  EXPECT_EQ(
      warnings_of(with_frame("L X+1\nL X+2\n"), setup),
      std::vector<std::string>{"no feed rate is active; program F; the cycle time is unknown"});
  EXPECT_EQ(framed_moves("L X+1 F100\nFUNCTION DWELL TIME2.5\nFUNCTION DWELL TIME 3\n", setup),
            "1 feed 1 0 0 F100\n2 dwell 2.5\n3 dwell 3\n");
}

// Z travels to 400 mm in machine coordinates, at rapid and at F2000; the tip is then 300 mm high.
TEST(Conversational, RetractToTheEndOfTravel) {
  ProgramSetup setup = example_setup();
  setup.machine = machine_with_z_travel(0.4);
  EXPECT_EQ(framed_moves("L X+5 FMAX\nL M140 MB MAX\nL Z+2 FMAX\nL M140 MB MAX F2000\n", setup),
            "1 rapid 5 0 0\n2 rapid 5 0 300\n3 rapid 5 0 2\n4 feed 5 0 300 F2000\n");
  EXPECT_EQ(fault_of("L M140 MB MAX\nL IZ-1 F100\nL X+1 Z+0\nL M140 MB MAX\nL IZ-1 X+1\n", setup),
            "t.h:8:3: error: IZ: the position of Z is unknown here; program an absolute position");
  setup.machine = machine_with_z_travel(std::numeric_limits<double>::infinity());
  EXPECT_EQ(fault_of("L M140 MB MAX\n", setup),
            "t.h:4:1: error: M140 MB MAX: the upper travel limit of Z is unknown; pass a machine "
            "with --machine, or use MB with a number or M91");
}

TEST(Conversational, NamesOfToolsWithoutATable) {
  ProgramSetup setup;
  setup.reader = Reader::any;
  const std::string program =
      "BEGIN PGM T MM\nTOOL CALL \"END MILL\" Z S1\nTOOL CALL \"B\" Z S2\nTOOL CALL \"END MILL\" "
      "Z S3\nEND PGM T MM\n";
  EXPECT_EQ(all_moves(program, setup),
            "2 tool 30001\n2 spindle 0 S1\n3 tool 30002\n3 spindle 0 S2\n4 tool 30001\n"
            "4 spindle 0 S3\n5 end\n");
  const auto warnings = warnings_of(program, setup);
  ASSERT_GE(warnings.size(), 1u);
  EXPECT_EQ(warnings.front(),
            "TOOL CALL \"END MILL\": treated as tool 30001 of unknown length; pass a tool table "
            "with --tools");
}

// The tip counts: machine Z is 100 mm above it
TEST(Conversational, ToolLengthAndPreset) {
  ProgramSetup setup = example_setup();
  setup.work_offset[0] << 10 * mm, 20 * mm, 30 * mm, 0, 0, 0;
  setup.work_offset[2] << 1 * mm, 2 * mm, 3 * mm, 0, 0, 0;
  const auto moves =
      interpret(with_frame("L Z+5 FMAX\nCYCL DEF 247 DATUM SETTING ~\nQ339=+3 ;DATUM NUMBER\n"
                           "L X+0 Y+0 Z+5 FMAX\nL Z-7 FMAX M91\n"),
                "t.h", setup);
  ASSERT_EQ(moves.size(), 7u);
  EXPECT_NEAR(moves[3].end_machine[2], 135 * mm, 1e-12);
  EXPECT_NEAR(moves[4].end_machine[0], 1 * mm, 1e-12);
  EXPECT_NEAR(moves[4].end_machine[2], 108 * mm, 1e-12);
  EXPECT_EQ(moves[4].work_offset, 3);
  EXPECT_NEAR(moves[5].end_machine[2], -7 * mm, 1e-12);
}

TEST(Conversational, PresetThatWasSetByHand) {
  const std::string program = with_frame("CYCL DEF 247 Q339=0\nL X+1 F9\n");
  EXPECT_EQ(interpret(program, "t.h", example_setup()).back().work_offset, 1);
  EXPECT_EQ(warnings_of(program, example_setup()).front(),
            "preset 0, the manually set datum: treated as preset 1, which is active at the start");
}

TEST(Conversational, ToolsDefinedInTheProgram) {
  ProgramSetup setup;
  setup.reader = Reader::any;
  EXPECT_EQ(all_moves("BEGIN PGM T MM\nTOOL DEF 5 L+20 R+3\nTOOL CALL 5 Z S1\nL X-9 Y+0 Z+0 FMAX\n"
                      "L X+0 Y+0 RL F100\nL Y+9\nL X-9 Y+9 R0 M2\nEND PGM T MM\n",
                      setup),
            "3 tool 5\n3 spindle 0 S1\n4 rapid -9 0 0\n5 feed -3 0 0 F100\n6 feed -3 9 0 F100\n"
            "7 feed -9 9 0 F100\n7 end\n");
}

// The length counts from the definition; the radius is needed by RL and RR alone.
TEST(Conversational, ToolsDefinedByTheirLengthAlone) {
  const std::string head = "BEGIN PGM T MM\nTOOL DEF1 L+20,5 F300\nTOOL CALL 1 Z S1\n";
  ProgramSetup setup;
  setup.reader = Reader::any;
  EXPECT_EQ(all_moves(head + "L X-9 Y+0 Z+0 FMAX\nEND PGM T MM\n", setup),
            "3 tool 1\n3 spindle 0 S1\n4 rapid -9 0 0\n5 end\n");
  try {
    all_moves(head + "L X+0 Y+0 RL F100\nL Y+9\nEND PGM T MM\n", setup);
    FAIL() << "read";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "t.h:4:1: error: RL and RR: TOOL DEF 1 has no R, so the radius is unknown; add R");
  }
}

TEST(Conversational, RecognisedByContentExtensionAndReader) {
  const std::string text = "0  BEGIN PGM T MM\n1 L X+1 R0 FMAX\n2 END PGM T MM\n";
  ProgramSetup setup = example_setup();
  EXPECT_EQ(text_of(interpret(text, "part.txt", setup)), "2 rapid 1 0 0\n3 end\n");
  EXPECT_EQ(text_of(interpret("; remark\n" + text, "part.H", setup)), "3 rapid 1 0 0\n4 end\n");
  setup.reader = Reader::heidenhain;
  EXPECT_EQ(text_of(interpret("* - part\n" + text, "part", setup)), "3 rapid 1 0 0\n4 end\n");
  setup.reader = Reader::linuxcnc;
  EXPECT_THROW(interpret(text, "part.h", setup), InputError);
}

TEST(Conversational, CalledPrograms) {
  ProgramSetup setup = example_setup();
  setup.subroutine_file = [](const std::string& name) -> std::optional<ProgramText> {
    if (name != "HOLE") return std::nullopt;
    return ProgramText::of_text("BEGIN PGM HOLE MM\nL IZ-Q1 F100\nL IZ+Q1\nEND PGM HOLE MM\n",
                                "HOLE.H");
  };
  EXPECT_EQ(framed_moves("Q1 = 3\nL X+1 FMAX\nCALL PGM TNC:\\LIB\\HOLE.H\nCALL PGM HOLE\n", setup),
            "2 rapid 1 0 0\n");
  const auto moves = interpret(with_frame("Q1 = 3\nCALL PGM HOLE\n"), "t.h", setup);
  ASSERT_EQ(moves.size(), 6u);
  EXPECT_NEAR(moves[3].end[2], -3 * mm, 1e-15);
  EXPECT_NEAR(moves[4].end[2], 0.0, 1e-15);
}

TEST(Conversational, ParametersFromOutside) {
  ProgramSetup setup = example_setup();
  setup.parameters["Q7"] = 12.5;
  EXPECT_EQ(framed_moves("L X+Q7 FMAX\n", setup), "1 rapid 12.5 0 0\n");
}

// Moves before a fault are handed out, none after it.
TEST(Conversational, MovesBeforeAFaultComeFirst) {
  Interpreter interpreter(with_frame("L X+1 F100\nL X+2\nC X+3 Y+3\nL X+9\n"), "t.h",
                          example_setup());
  int moves = 0;
  EXPECT_THROW(while (interpreter.next() != nullptr)++ moves, InputError);
  EXPECT_EQ(moves, 5);
}

}  // namespace
}  // namespace servomill::controllers::conversational::conversational_test
