#include "tests/controllers/dialects/siemens_examples.h"

#include <fmt/format.h>

#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "tests/controllers/dialects/action_text.h"

namespace servomill::controllers {
namespace {

bool has_macro(const SiemensSettings& s) { return s.M6_is_macro; }
bool has_no_macro(const SiemensSettings& s) { return !s.M6_is_macro; }
template <int D>
bool has_default_D(const SiemensSettings& s) {
  return !s.M6_is_macro && s.default_D == D;
}
bool drops_length(const SiemensSettings& s) { return s.SUPA_drops_length; }
bool keeps_length(const SiemensSettings& s) { return !s.SUPA_drops_length; }
bool changes_at_T(const SiemensSettings& s) { return s.T_changes_tool; }
bool changes_at_M6(const SiemensSettings& s) { return !s.T_changes_tool; }
bool follows_plane(const SiemensSettings& s) { return s.length_follows_plane; }
bool stays_in_Z(const SiemensSettings& s) { return !s.length_follows_plane; }
bool counts_turns(const SiemensSettings& s) { return !s.is_modulo[2]; }
bool is_modulo(const SiemensSettings& s) { return s.is_modulo[2] && !s.G90_is_shortest; }
bool is_shortest(const SiemensSettings& s) { return s.is_modulo[2] && s.G90_is_shortest; }

// Words that are restated after a tool change.
#define TOOL_1 "T1 M6\nG17 G40 G90 G94 G710 G54\nTRANS\n"

std::vector<SiemensExample> offsets() {
  return {
      // A probe stops the axis of its block somewhere; numbers are put out without a motion. M
      {"AMeasurementLeavesItsAxisUnknown",
       "G0 X10 Y-5\nMEAS=1 G1 X20 F300\nSTOPRE\nWRITE(NERR,\"TOUCHES\",$AA_MW[X]<<\" \")\nG0 Y0",
       {"3 rapid X110 Y195 ~", "4 probe X120 (Y195) F300", "7 rapid Y200"}},
      // [K2] p. 1-7: the settable frame adds its offset.
      {"ARapidEndsAtTheWorkOffset",
       "G0 X10 Y-5\nG0 Z5 D0",
       {"3 rapid X110 Y195 ~", "4 rapid (X110) (Y195) Z305"}},
      {"AnotherWorkOffsetActsWithTheNextMotion",
       "G0 X10 Y0\nG55\nX10",
       {"3 rapid X110 Y200 ~", "5 rapid X20 (Y200)"}},
      {"WorkOffsetsGoOnAtG505", "G505 G0 X10\nG1 Y-2 F60", {"3 rapid X11", "4 feed (X11) Y0 F60"}},
      // R = 90 deg: X' = 50 - y, Y' = 60 + x.
      {"ARotatedOffsetMovesBothAxes",
       "G56 G0 X10 Y5\nX20",
       {"3 rapid X45 Y70 ~", "4 rapid X45 Y80 ~"}},
      // Seen from the part: from (10, 0) about (0, 0); machine centre 50, 60.
      {"ARotatedOffsetRotatesArcs",
       "G56 G0 X10 Y0\nG3 X0 Y10 I-10 F60",
       {"3 rapid X50 Y70 ~", "4 arc X40 Y60 F60 about Z at 50 60 turns 1"}},
      // [D] p. 8-138, with G0 and the offset of G54.
      {"AbsoluteAndIncrementalByAxis",
       "G0 X20 Y90\nX75 Y=IC(-32)\nX80 Y90\nG91 X40 Y20\nX-12 Y=AC(17)",
       {"3 rapid X120 Y290 ~", "4 rapid X175 Y258 ~", "5 rapid X180 Y290 ~", "6 rapid X220 Y310 ~",
        "7 rapid X208 Y217 ~"}},
      {"AnIncrementAfterANewOffsetDependsOnSD42440",
       "G0 X10\nG55 G91\nX5",
       {"p.mpf:5:1: error: an increment of X after a change of work offset or tool length: "
        "settings determine whether it includes the change"}},
      // [IS] p. 3-42: not modal, in the machine's coordinates.
      {"SUPAIsOneBlockInMachineCoordinates",
       "G0 X10 Y0\nSUPA X0\nX10",
       {"3 rapid X110 Y200 ~", "4 rapid X0 (Y200) machine", "5 rapid X110 (Y200)"}},
      {"SUPANeedsNoWorkOffset", "SUPA G0 Z=-5.5 D0", {"3 rapid Z-5.5 machine"}},
      {"RotaryAxesHaveOffsets",
       "TRAFOOF\nG0 A30\nG1 B10 F360",
       {"4 rapid A35", "5 feed (A35) B10 F360"}},
  };
}

// Positions in degrees and turns: from 350 to 10 deg by -340 or by +20.
std::vector<SiemensExample> rotary_axes() {
  const std::string turn = "TRAFOOF\nG0 C350\nC10\nC=AC(300)";
  const std::string negative = "TRAFOOF\nG0 C20\nC-40";
  return {
      {"RotaryAxesCountTurns", turn, {"4 rapid C350", "5 rapid C10", "6 rapid C300"}, counts_turns},
      // [R2] p. 225: to a larger angle in positive direction, to a smaller one in negative.
      {"AModuloAxisDoesNotPassZero",
       turn,
       {"4 rapid C350", "5 rapid C10", "6 rapid C300"},
       is_modulo},
      {"G90MayBeTheShortestWay",
       turn,
       {"4 rapid C350", "5 rapid C370", "6 rapid C660"},
       is_shortest},
      {"NegativeAnglesAreCounted", negative, {"4 rapid C20", "5 rapid C-40"}, counts_turns},
      {"AModuloAxisTakesNegativeAnglesAsTheirRest",
       negative,
       {"4 rapid C20", "5 rapid C320"},
       is_modulo},
      {"IncrementsDoNotDependOnIt",
       "TRAFOOF\nG0 C20\nC=IC(-60)\nC=IC(400)",
       {"4 rapid C20", "5 rapid C-40", "6 rapid C360"}},
      {"AngleOfAnAxisWithAnOffset", "TRAFOOF\nG0 A350\nA=AC(10)", {"4 rapid A355", "5 rapid A15"}},
  };
}

std::vector<SiemensExample> lengths() {
  return {
      // Z = 10 + 300 + 50, whatever the builder has set.
      {"TheToolLengthIsAdded", TOOL_1 "G0 Z10 D1", {"3 tool 1", "6 rapid Z360 H1"}},
      // [W1] p. 13: with the first motion of its axis.
      {"DMovesNothingByItself",
       TOOL_1 "G0 Z10 D0\nD1\nX5\nZ10",
       {"3 tool 1", "6 rapid Z310", "8 rapid X105 (Z310)", "9 rapid (X105) Z360 H1"}},
      {"DInTheBlockOfTheMotionActsThere",
       TOOL_1 "G0 Z10 D1\nZ10 D0",
       {"3 tool 1", "6 rapid Z360 H1", "7 rapid Z310"}},
      {"AnArcDoesNotTakeANewLength",
       TOOL_1 "G0 X0 Y0 D1\nG2 X10 Y0 Z-1 I5 F60",
       {"p.mpf:7:1: error: the tool length changes in Z; this requires G0 or G1"}},
      {"AnIncrementAfterANewLengthDependsOnSD42442",
       TOOL_1 "G0 Z10 D0\nD1\nZ=IC(1)",
       {"p.mpf:8:1: error: an increment of Z after a change of work offset or tool length: "
        "settings determine whether it includes the change"}},
      {"SUPAWithoutTheLength",
       TOOL_1 "G0 Z10 D1\nSUPA Z400\nZ10",
       {"3 tool 1", "6 rapid Z360 H1", "7 rapid Z400 machine", "8 rapid Z360 H1"},
       drops_length},
      {"SUPAWithTheLength",
       TOOL_1 "G0 Z10 D1\nSUPA Z400\nZ10",
       {"3 tool 1", "6 rapid Z360 H1", "7 rapid Z450 machine H1", "8 rapid Z360 H1"},
       keeps_length},
      {"SUPAWithD0MeansTheSameEverywhere",
       TOOL_1 "G0 Z10 D1\nSUPA Z400 D0\nZ10 D1",
       {"3 tool 1", "6 rapid Z360 H1", "7 rapid Z400 machine", "8 rapid Z360 H1"}},
      // [P] p. 750: length 1 along Y in G18, unless SD42940 keeps it in Z.
      {"TheLengthFollowsThePlane",
       TOOL_1 "G18 G0 Y10 Z10 D1",
       {"3 tool 1", "6 rapid Y260 Z310 ~ H1"},
       follows_plane},
      {"TheLengthStaysInZ",
       TOOL_1 "G18 G0 Y10 Z10 D1",
       {"3 tool 1", "6 rapid Y210 Z360 ~ H1"},
       stays_in_Z},
      // [W1] p. 13, MD20270.
      {"NoEdgeAfterM6", "T1 M6\nG0 Z10", {"3 tool 1", "4 rapid Z310"}, has_default_D<0>},
      {"EdgeOneAfterM6", "T1 M6\nG0 Z10", {"3 tool 1", "4 rapid Z360 H1"}, has_default_D<1>},
      {"TheOldEdgeAfterM6",
       "T1 M6 D1\nT2 M6\nG0 Z10",
       {"3 tool 1", "4 tool 2", "5 rapid Z390 H2"},
       has_default_D<-1>},
      {"TheOldEdgeIsUnknown",
       "T1 M6\nG0 Z10",
       {"p.mpf:4:1: error: Z requires a tool length, but D is unknown here"},
       has_default_D<-1>},
      {"AMacroForgetsD",
       TOOL_1 "G0 Z10",
       {"p.mpf:6:1: error: Z requires a tool length, but D is unknown here"},
       has_macro},
      {"AMacroForgetsPositions",
       "G0 X10 Y0\n" TOOL_1 "G0 X10",
       {"3 rapid X110 Y200 ~", "4 tool 1", "7 rapid X110"},
       has_macro},
      {"WithoutAMacroPositionsStay",
       "G0 X10 Y0\nT1 M6\nX10",
       {"3 rapid X110 Y200 ~", "4 tool 1 (X110) (Y200)", "5 rapid X110 (Y200)"},
       has_no_macro},
      {"AMacroMayLeaveAFrame",
       "T1 M6\nG17 G40 G90 G94 G710 G54\nG0 X0",
       {"p.mpf:5:1: error: a programmable frame may be active; clear it with TRANS in a separate "
        "block"},
       has_macro},
      {"AMacroMayLeaveATransformation",
       TOOL_1 "G0 A0",
       {"p.mpf:6:4: error: A: a transformation may be active; cancel it with TRAFOOF"},
       has_macro},
      {"AMacroMayLeaveInches",
       "T1 M6\nG17 G40 G90 G94 G54\nTRANS\nG0 X0",
       {"p.mpf:6:4: error: the unit system is unknown; program G710 or G700"},
       has_macro},
      // [W1] p. 33, MD22550.
      {"TPreparesAndM6Changes", "T1\nM8\nM6", {"4 coolant 2", "5 tool 1"}, changes_at_M6},
      {"TChangesTheTool",
       "T1\nG17 G40 G90 G94 G710 G54\nTRANS\nG0 X0\nM6",
       {"3 tool 1", "6 rapid X100"},
       changes_at_T},
  };
}

std::vector<SiemensExample> arcs() {
  return {
      // [D] p. 8-154: centre (30, 40) + (10, -7); end (50, 40).
      {"CentreCountsFromTheStart",
       "G0 X30 Y40\nG2 X50 Y40 I10 J-7 F500",
       {"3 rapid X130 Y240 ~", "4 arc X150 Y240 F500 about Z at 140 233 turns -1"}},
      {"CentreWithACCountsFromTheOrigin",
       "G0 X30 Y40\nG3 X50 Y40 I=AC(40) J=AC(33) F500",
       {"3 rapid X130 Y240 ~", "4 arc X150 Y240 F500 about Z at 140 233 turns 1"}},
      // [P] p. 205: two full circles, then the rest.
      {"AHelixWithFullCircles",
       "G0 X27.5 Y32.99\nG0 Z3 D0\nG1 Z-5 F50\nG3 X20 Y5 Z-20 I=AC(20) J=AC(20) TURN=2",
       {"3 rapid X127.5 Y232.99 ~", "4 rapid (X127.5) (Y232.99) Z303",
        "5 feed (X127.5) (Y232.99) Z295 F50",
        "6 arc X120 Y205 Z280 F50 about Z at 120 220 turns 3"}},
      {"AFullCircleNeedsNoEnd",
       "G0 X10 Y0\nG2 I-10 F60",
       {"3 rapid X110 Y200 ~", "4 arc X110 Y200 F60 about Z at 100 200 turns -1"}},
      {"AFullCircleWithItsEnd",
       "G0 X10.1 Y0.3\nG3 X10.1 Y0.3 I-10.1 J-0.3 F60",
       {"3 rapid X110.1 Y200.3 ~", "4 arc X110.1 Y200.3 F60 about Z at 100 200 turns 1"}},
      // [P] p. 192; chord 40, radius 25: the centre is 15 off the chord, left of it for a short G3.
      {"CRPositiveIsTheShortArc",
       "G0 X0 Y0\nG3 X40 Y0 CR=25 F60\nG2 X0 Y0 CR=25",
       {"3 rapid X100 Y200 ~", "4 arc X140 Y200 F60 about Z at 120 215 turns 1",
        "5 arc X100 Y200 F60 about Z at 120 215 turns -1"}},
      {"CRNegativeIsTheLongArc",
       "G0 X0 Y0\nG3 X40 Y0 CR=-25 F60\nG2 X0 Y0 CR=-25",
       {"3 rapid X100 Y200 ~", "4 arc X140 Y200 F60 about Z at 120 185 turns 1",
        "5 arc X100 Y200 F60 about Z at 120 185 turns -1"}},
      // In G18 Z is the first axis: towards +X, right of the path is +Z.
      {"G18IsThePlaneOfZAndX",
       "G0 X0 D0\nZ0\nG18 G2 X40 Z0 CR=25 F60\nG3 X0 I-20 K15",
       {"3 rapid X100", "4 rapid (X100) Z300", "5 arc X140 Z300 F60 about Y at 120 315 turns -1",
        "6 arc X100 Z300 F60 about Y at 120 315 turns 1"}},
      {"G19IsThePlaneOfYAndZ",
       "G0 Y0 D0\nZ0\nG19 G3 Y0 Z20 K10 F60",
       {"3 rapid Y200", "4 rapid (Y200) Z300", "5 arc Y200 Z320 F60 about X at 200 310 turns 1"}},
      // [P] p. 198, centre and point worked out: about (0, 0) with radius 5 through (-3, 4) and
      // through (3, 4), in the XY plane; about X 0, Z -10 with radius 13 through Z+3, as G18 has
      // it.
      {"CIPGoesThroughItsPoint",
       "G0 X5 Y0\nZ0 D0\nCIP X-5 Y0 Z0 I1=AC(-3) J1=4 K1=0 F60\nX5 I1=AC(-3) J1=AC(-4) K1=AC(0)",
       {"3 rapid X105 Y200 ~", "4 rapid (X105) (Y200) Z300",
        "5 arc X95 Y200 Z300 F60 about Z at 100 200 turns 1",
        "6 arc X105 Y200 (Z300) F60 about Z at 100 200 turns 1"}},
      {"CIPNeedsNoPlane",
       "G0 X-12 Y0\nZ-5 D0\nCIP X12 Y0 Z-5 I1=AC(0) J1=AC(0) K1=AC(3) F60",
       {"3 rapid X88 Y200 ~", "4 rapid (X88) (Y200) Z295",
        "5 arc X112 Y200 Z295 F60 about Y at 100 290 turns 1"}},
      {"CIPCountsIncrementsFromItsStart",
       "G0 Y10 X0\nZ0 D0\nG91 CIP Y0 Z20 X0 I1=0 J1=10 K1=IC(10) F60",
       {"3 rapid X100 Y210 ~", "4 rapid (X100) (Y210) Z300",
        "5 arc X100 Y210 Z320 F60 about X at 210 310 turns 1"}},
      {"CIPWithoutAllCoordinatesOfItsPoint",
       "G0 X5 Y0\nZ0 D0\nCIP X-5 I1=AC(0) J1=AC(5) F60",
       {"p.mpf:5:1: error: CIP requires K1"}},
      {"CIPThroughAPointOnTheLine",
       "G0 X5 Y0\nZ0 D0\nCIP X-5 I1=AC(0) J1=AC(0) K1=AC(0) F60",
       {"p.mpf:5:1: error: the three points of CIP are collinear"}},
      {"CIPIsNoFullCircle",
       "G0 X5 Y0\nZ0 D0\nCIP X5 I1=AC(0) J1=AC(5) K1=AC(0) F60",
       {"p.mpf:5:1: error: CIP: start and end coincide: the circle is undetermined"}},
      {"CIPInATiltedPlane",
       "G0 X5 Y0\nZ0 D0\nCIP X-5 Z1 I1=AC(0) J1=AC(5) K1=AC(0.5) F60",
       {"p.mpf:5:1: error: CIP in a plane not spanned by two axes is not supported"}},
      {"CIPDoesNotTakeANewLength",
       TOOL_1 "G0 X0 Y0 Z0 D0\nCIP X10 I1=AC(5) J1=AC(0) K1=AC(5) D1 F60",
       {"p.mpf:7:1: error: the tool length changes in Z; this requires G0 or G1"},
       stays_in_Z},
      {"PointsAreOfCIPOnly",
       "G0 X5 Y0\nG1 X0 I1=AC(0) F60",
       {"p.mpf:4:1: error: I1, J1 and K1 require CIP; G1 is active"}},
      {"NearlyAFullCircleIsRefused",
       "G0 X10 Y0\nG2 Y0.0001 I-10 F60",
       {"p.mpf:4:1: error: start and end of the arc nearly coincide: rounding decides between no "
        "motion and a full circle"}},
      {"AnArcNeedsAKnownStart",
       "G0 X10\nG2 X20 Y0 I5 F60",
       {"p.mpf:4:1: error: the start position of the arc in Y is unknown"}},
  };
}

std::vector<SiemensExample> feeds() {
  return {
      {"FeedIsModal",
       "G0 X0 Y0\nG1 X10 F200\nY20",
       {"3 rapid X100 Y200 ~", "4 feed X110 (Y200) F200", "5 feed (X110) Y220 F200"}},
      {"InchesOfPositionsAndFeed",
       "G700 G0 X1\nG1 X2 F10",
       {"3 rapid X125.4", "4 feed X150.8 F254"}},
      // [D] p. 8-139: G70 and G71 do not concern F.
      {"G71SaysNothingOfTheFeed",
       "G71 G0 X0\nG1 X1 F10",
       {"p.mpf:4:1: error: with G70 and G71, F is in the basic unit of the control; use G700 or "
        "G710"}},
      // [P] p. 108: 2 a minute is 0.5 min for the block.
      {"InverseTime", "G93 G1 X100 F2", {"3 feed X200 F21/min"}},
      {"InverseTimeForLinearAndRotaryAxes",
       "TRAFOOF\nG93 G1 X10 A10 F4",
       {"4 feed X110 A15 F41/min"}},
      {"PerRevolution", "G95 G1 X10 F0.1", {"3 feed X110 F0.1/rev"}},
      // [V1] p. 2-4.
      {"AnotherKindOfFeedDeletesF",
       "G1 X10 F100\nG95\nX20",
       {"p.mpf:5:1: error: no feed rate has been programmed since G93, G94 or G95"}},
      {"TheSameKindOfFeedKeepsF", "G1 X10 F100\nG94 X20", {"3 feed X110 F100", "4 feed X120 F100"}},
      {"DwellDoesNotChangeTheFeed",
       "G1 X10 F100\nG4 F2.5\nX20",
       {"3 feed X110 F100", "4 dwell 2.5", "5 feed X120 F100"}},
      {"DwellInRevolutions", "S600 M3\nG4 S30", {"3 spindle +600", "4 dwell 3"}},
  };
}

std::vector<SiemensExample> corners() {
  return {
      // [P] p. 181: all axes at their own rate only with exact stop and RTLIOF.
      {"ExactStopLetsARapidBend",
       "G60 G0 X0 Y0\nRTLION\nX1 Y1\nRTLIOF\nX2 Y2",
       {"3 rapid X100 Y200 ~ stops", "5 rapid X101 Y201 stops", "7 rapid X102 Y202 ~ stops"}},
      {"ContinuousPathKeepsARapidStraight",
       "G64 G0 X0 Y0\nRTLIOF\nX2 Y2",
       {"3 rapid X100 Y200", "5 rapid X102 Y202"}},
      // [P] p. 293.
      {"G9IsOneBlock",
       "G64\nG1 X0 F60\nG9 X1\nX2",
       {"4 feed X100 F60", "5 feed X101 F60 stops", "6 feed X102 F60"}},
      {"RoundingByDistanceAndByTolerance",
       "G641 ADIS=0.5 CTOL=0.02\nG1 X0 F60\nG642\nX1\nCTOL=-1\nX2\nG64 X3",
       {"4 feed X100 F60 P0.5", "6 feed X101 F60 P0.02", "8 feed X102 F60", "9 feed X103 F60"}},
      // [P] p. 1108.
      {"CYCLE832SetsTheTolerance",
       "CYCLE832(0.01,1,1)\nG1 X0 F60\nCYCLE832(0,0,1)\nX1",
       {"4 feed X100 F60 P0.01", "6 feed X101 F60"}},
  };
}

std::vector<SiemensExample> switches() {
  return {
      {"TheSpindle",
       "S1000 M3\nS1200\nM4\nM5\nS500",
       {"3 spindle +1000", "4 spindle +1200", "5 spindle -1200", "6 spindle off 0"}},
      {"TheCoolant", "M8\nM7\nM9", {"3 coolant 2", "4 coolant 3", "5 coolant 0"}},
      {"AStopActsAfterTheMotion", "G0 X10 M0", {"3 rapid X110", "3 stop 0"}},
      {"AfterAStopPositionsAreUnknown",
       "G0 X10 Y5\nM1\nX20",
       {"3 rapid X110 Y205 ~", "4 stop 1", "5 rapid X120"}},
      // [P] p. 52: no distinction of capitals; a blank is allowed behind F (p. 108).
      {"WaysToWriteABlock",
       "; a comment\n\nN10 g1x1.5y-.5 f 60 ; behind\nN20 MSG(\"Z100; (no motion)\") X+2.\n  N30",
       {"5 feed X101.5 Y199.5 F60", "6 feed X102 (Y199.5) F60"}},
      {"ASkippableBlockRunsWhenTheSwitchIsOff",
       "G0 X0\n/G0 X1\n/0 N5 X2",
       {"3 rapid X100", "4 rapid X101", "5 rapid X102"}},
      {"NothingIsReadAfterTheEnd", "G0 X0\nM30\n?", {"3 rapid X100"}},
  };
}

}  // namespace

ControlSetup siemens_example_setup() {
  const auto place = [](double x, double y, double z, double a) {
    AxisWords words = AxisWords::Zero();
    words << x * mm, y * mm, z * mm, a * deg, 0.0, 0.0;
    return words;
  };
  ControlSetup setup;
  setup.work_offset[0] = place(100, 200, 300, 5);
  setup.work_offset[1] = place(10, 20, 30, 0);
  setup.work_offset[2] = place(50, 60, 70, 0);
  setup.work_rotation[2] = std::numbers::pi / 2.0;
  setup.work_offset[4] = place(1, 2, 3, 0);
  setup.tool_length = {{1, 50 * mm}, {2, 80 * mm}};
  return setup;
}

std::vector<SiemensSettings> siemens_example_settings() {
  return all_siemens_settings({true, true, true});
}

const std::vector<SiemensExample>& siemens_examples() {
  static const std::vector<SiemensExample> all = [] {
    std::vector<SiemensExample> out;
    for (const auto& group :
         {offsets(), rotary_axes(), lengths(), arcs(), feeds(), corners(), switches()}) {
      out.insert(out.end(), group.begin(), group.end());
    }
    return out;
  }();
  return all;
}

std::vector<std::string> siemens_actions(const SiemensExample& example,
                                         const SiemensSettings& settings,
                                         const SiemensRules& rules) {
  try {
    std::vector<std::string> out;
    for (const MachineAction& action :
         read_siemens(kSiemensHead + example.program + "\nM30\n", "p.mpf", siemens_example_setup(),
                      settings, rules)) {
      out.push_back(text_of(action));
    }
    out.pop_back();
    return out;
  } catch (const InputError& error) {
    return {error.what()};
  }
}

}  // namespace servomill::controllers
