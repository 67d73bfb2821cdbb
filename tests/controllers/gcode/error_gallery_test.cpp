// Every message of the interpreter, as the user sees it.
#include "tests/controllers/gcode/program.h"

namespace servomill::controllers::error_gallery_test {
namespace {

struct Wrong {
  const char* text;
  const char* message;  // behind "p.nc:"
};

void expect_gallery(std::initializer_list<Wrong> gallery) {
  for (const Wrong& wrong : gallery) {
    EXPECT_EQ(fault_of(wrong.text), std::string("p.nc:") + wrong.message) << wrong.text;
  }
}

TEST(ErrorGallery, Characters) {
  expect_gallery({
      {"G0 X1 (open", "1:7: error: comment is not closed; ')' is missing"},
      {"(a (b) c)", "1:4: error: comment within a comment"},
      {"G0 X1 )", "1:7: error: ')' without '('"},
      {"G0 X1 \xc3\xa4", "1:7: error: byte 0xC3 is not allowed outside comments"},
      {"G0 X1 ?", "1:7: error: unexpected '?'; a word starts with one of ABCDFGHIJKLMPQRSTXYZ@^"},
      {"G0 X1 U2", "1:7: error: unexpected 'U'; a word starts with one of ABCDFGHIJKLMPQRSTXYZ@^"},
  });
  EXPECT_EQ(fault_of("G0 X1" + std::string(248, ' ')),
            "p.nc:1:253: error: line of 253 characters; at most 252 are allowed");
  EXPECT_EQ(fault_of("G0 X1" + std::string(247, ' ')), "");
}

TEST(ErrorGallery, Encodings) {
  EXPECT_EQ(fault_of("\xFF\xFEG"),
            "p.nc:1:1: error: byte 0xFF is not allowed outside comments; the file looks like "
            "UTF-16: save it as UTF-8");
  EXPECT_EQ(fault_of("G0\n\xFF"), "p.nc:2:1: error: byte 0xFF is not allowed outside comments");
  EXPECT_EQ(fault_of("\xEF\xBB\xBFG0 Q"),
            "p.nc:1:5: error: expected a value after Q, found the end of the line");
}

TEST(ErrorGallery, Values) {
  expect_gallery({
      {"G0 X", "1:5: error: expected a value after X, found the end of the line"},
      {"G0 XY1", "1:5: error: expected a value after X, found the word Y"},
      {"Y F100", "1:3: error: expected a value after Y, found the word F"},
      {"#1=F3", "1:4: error: expected a value after =, found the word F"},
      {"X[1+Y2]", "1:5: error: expected a value after '[' or an operator, found the word Y"},
      {"G0 X.", "1:5: error: expected a value after X, found the end of the line"},
      {"G0 X1.2.3", "1:8: error: a second decimal point in one number"},
      {"G0 X[1+2", "1:5: error: '[' is not closed; ']' is missing"},
      {"G0 X[1 FOO 2]", "1:8: error: expected an operator or ']', found 'F'"},
      {"#1=SINE[3]", "1:4: error: unknown function 'SINE'; did you mean 'SIN'?"},
      {"#1=SIN 5", "1:8: error: expected '[' after SIN"},
      {"#1=ATAN[1]", "1:11: error: expected '/': ATAN requires two arguments, ATAN[y]/[x]"},
      {"#1=EXISTS[5]", "1:11: error: EXISTS requires a parameter, as in EXISTS[#<name>]"},
      {"#1=[1 / 0]", "1:7: error: 1 / 0: division by zero"},
      {"#1=[7 MOD 0]", "1:7: error: 7 MOD 0: division by zero"},
      {"#1=ACOS[1.5]", "1:4: error: ACOS[1.5]: argument must be in -1 ... 1"},
      {"#1=SQRT[-1]", "1:4: error: SQRT[-1]: argument must be >= 0"},
      {"#1=LN[0]", "1:4: error: LN[0]: argument must be > 0"},
      {"#1=[[-8] ** 0.5]", "1:10: error: -8 ** 0.5: a negative base requires an integer exponent"},
      {"#1=EXP[1000]", "1:4: error: the result is not a finite number"},
  });
}

TEST(ErrorGallery, Parameters) {
  expect_gallery({
      {"#0=1", "1:1: error: parameter number 0; must be in 1 ... 5601"},
      {"#1.5=1", "1:1: error: parameter number 1.5 is not an integer"},
      {"#5420=1", "1:1: error: parameter #5420 is read-only"},
      {"#<_x>=1", "1:1: error: parameter #<_x> is read-only"},
      {"#1", "1:3: error: expected '=' after a parameter, found the end of the line"},
      {"G0 X#<nope>", "1:5: error: parameter #<nope> is not defined"},
      {"G0 X#<nope", "1:6: error: parameter name is not closed; '>' is missing"},
  });
}

TEST(ErrorGallery, WordsAndCodes) {
  expect_gallery({
      {"\nG2 G3 X1", "2:4: error: G2 and G3 in one block (same modal group)"},
      {"M3 M4", "1:4: error: M3 and M4 in one block (same modal group)"},
      {"G0 X1 X2", "1:7: error: second X word in one block; the first is in column 4"},
      {"G1.5 X1", "1:1: error: unknown G code G1.5"},
      {"M100", "1:1: error: unknown M code M100"},
      {"G0 o100 if [1]", "1:4: error: an O-word must be the first word of its block"},
      {"N5.", "1:4: error: expected a digit after the decimal point of N"},
      {"G0 N5", "1:4: error: N is only allowed at the start of a block"},
      {"N-5 G0", "1:1: error: N must be followed by an unsigned number"},
      {"G0 X1 H3", "1:7: error: H word without a code that uses it (G43, G43.2, G43.4, G43.5)"},
      {"G0 X1 P3",
       "1:7: error: P word without a code that uses it (G2, G3, G4, G5, G5.2, G10, G64, G74, "
       "G82, G84, G86, G88, G89, M50, M51, M52, M53, M62, M63, M64, M65)"},
      {"G40 D3", "1:5: error: D word without a code that uses it (G41, G41.1, G42, G42.1)"},
      {"M0 M3 M7 M48 M6", "1:14: error: more than 4 M codes in one block"},
  });
}

TEST(ErrorGallery, Motion) {
  expect_gallery({
      {"X1", "1:1: error: axis words, but no active G code uses them"},
      {"G80 X1", "1:5: error: axis words are not allowed with G80"},
      {"G28 G1 X1", "1:5: error: G28 and G1 are not allowed in one block: both use the axis words"},
      {"G1 X1", "1:1: error: G1 with zero feed rate; no F is active"},
      {"F9\nG94\nG1 X1", "3:1: error: G1 with zero feed rate; no F is active"},
      {"G93 F1\nG1 X1", "2:1: error: G1 without F; G93 requires F in every block"},
      {"F-1", "1:1: error: F-1; must be >= 0"},
      {"S-1", "1:1: error: S-1; must be >= 0"},
      {"G4", "1:1: error: G4 requires a P word (seconds)"},
      {"G4 P-1", "1:4: error: G4 P-1; must be >= 0"},
      {"G53 X1", "1:5: error: axis words, but no active G code uses them"},
      {"G53 G2 X1 I1 F1", "1:1: error: G53 requires G0 or G1"},
      {"G91 G53 G0 X1", "1:5: error: G53 with G91; machine coordinates are absolute"},
  });
}

TEST(ErrorGallery, Arcs) {
  expect_gallery({
      {"F1 G2 X2 I1 R1", "1:10: error: I and R in one G2 block"},
      {"F1 G2 X2 I1 K1", "1:13: error: K in an arc of the XY plane"},
      {"F1 G2 X2", "1:4: error: G2 requires R, I or J"},
      {"F1 G2 Z5 R3", "1:4: error: G2 with R requires X or Y"},
      {"F1 G90.1 G2 X2 I1", "1:10: error: G2 requires J: with G90.1 the centre is absolute"},
      {"F1 G2 X2 I0",
       "1:4: error: G2: radius is zero: 0.0000 mm at the start, 2.0000 mm at the end"},
      {"F1 G2 X0 R1", "1:4: error: G2: an arc with R cannot end where it starts; use I, J, K"},
      {"F1 G2 X2 R0.9", "1:4: error: G2: R 0.9000 mm is too small; half the chord is 1.0000 mm"},
      {"F1 G2 X2 I1 P2.5", "1:13: error: P2.5; must be an integer"},
      {"F1 G2 X2 I1 P0", "1:13: error: P0; an arc has at least 1 turn"},
  });
}

TEST(ErrorGallery, ToolsAndOffsets) {
  expect_gallery({
      {"T98", "1:1: error: T98 is not in the tool table"},
      {"T1.5", "1:1: error: T1.5; must be an integer"},
      {"T-1", "1:1: error: T-1; must be >= 0"},
      {"G43 H98", "1:5: error: H98 is not in the tool table"},
      {"G10 P1 X1", "1:1: error: G10 requires an L word (L0 L1 L2 L10 L11 L20)"},
      {"G10 L3 P1 X1", "1:5: error: G10 L3; must be L0, L1, L2, L10, L11 or L20"},
      {"G10 L2 X1", "1:1: error: G10 L2 requires a P word (0 ... 9)"},
      {"G10 L2 P10 X1", "1:8: error: G10 L2 P10; must be in 0 ... 9"},
      {"G10 L20 P1 X1 R5",
       "1:15: error: R word is not allowed with G10 L20; only G10 L2 sets a rotation"},
      {"G92", "1:1: error: G92 requires an axis word"},
  });
}

std::string fault_of_whole(const std::string& text) {
  try {
    interpret(text, "p.nc", {});
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(ErrorGallery, EndOfProgram) {
  EXPECT_EQ(fault_of_whole("G0 X1\n"),
            "p.nc:1: error: the program ends without M2, M30 or a closing '%'");
  EXPECT_EQ(fault_of_whole("%\nG0 X1"),
            "p.nc:2: error: the program ends without M2, M30 or a closing '%'");
  EXPECT_EQ(fault_of_whole("G0 X1\n%\n"),
            "p.nc:2:1: error: '%' ends a program only if its first line is also '%'");
  EXPECT_EQ(fault_of_whole("G0 X1\nG1 X[2"), "p.nc:2:5: error: '[' is not closed; ']' is missing");
}

TEST(ErrorGallery, SetupParameters) {
  const auto fault = [](const std::string& name, double value) {
    ProgramSetup setup;
    setup.parameters = {{name, value}};
    return fault_of("", setup);
  };
  EXPECT_EQ(fault("101", 1), "p.nc: error: parameter '101': must be written #123 or #<name>");
  EXPECT_EQ(fault("#0", 1), "p.nc: error: parameter number 0; must be in 1 ... 5601");
  EXPECT_EQ(fault("#5420", 1), "p.nc: error: parameter '#5420': is set by the machine");
  EXPECT_EQ(fault("#<_x>", 1), "p.nc: error: parameter '#<_x>': is set by the machine");
  EXPECT_EQ(fault("#1", 1.0 / 0.0), "p.nc: error: parameter '#1': value must be finite");
}

TEST(ErrorGallery, ToolTable) {
  const auto fault = [](const std::string& text) -> std::string {
    try {
      ToolTable::parse(text, "t.tbl");
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(fault("T1 Z5 ; comment\n\n;\nT1 Z6"), "t.tbl:4:1: error: tool T1 appears twice");
  EXPECT_EQ(fault("P1 Z5"), "t.tbl:1:1: error: the tool number (T word) is missing");
  EXPECT_EQ(fault("T1 Zx\nT2 W5"),
            "t.tbl:1:4: error: Z must be followed by a number\nt.tbl:2:4: error: W5; must be 0: "
            "axis W is not supported");
  EXPECT_EQ(fault("T1.5"), "t.tbl:1:1: error: T1.5; must be an integer in 0 ... 1000000");
}

TEST(CheckProgram, GivesEverySyntaxFaultAndTheFirstOther) {
  const std::vector<Fault> faults = check_program(
      "G0 X1\nG1 Y2\nG0 X(\nG2 G3\nG1 X2\nG99.5\nG0 X[3\nM2\nG0 X(\n", "p.nc", usual_setup());
  std::string text;
  for (const Fault& fault : faults) text += to_string(fault) + "\n";
  EXPECT_EQ(text,
            "p.nc:2:1: error: G1 with zero feed rate; no F is active\np.nc:3:5: error: comment is "
            "not closed; ')' is missing\np.nc:4:4: error: G2 and G3 in one block (same modal "
            "group)\np.nc:6:1: error: unknown G code G99.5\np.nc:7:5: error: '[' is not closed; "
            "']' is missing\n");
  EXPECT_TRUE(check_program("G0 X1\nM2\n", "p.nc", {}).empty());
}

TEST(CheckProgram, NamesEveryFunctionOfTheMachinesBuilderAtOnce) {
  ProgramSetup setup = usual_setup();
  setup.reader = Reader::any;
  const std::vector<Fault> faults = check_program(
      "G21\nM201\nG0 X1.\nM202\nM201\nG1 Y2. F100.\nG2 X9. Y9. R0.5\nM84\nM2\n", "p.nc", setup);
  std::vector<int> lines;
  for (const Fault& fault : faults) lines.push_back(fault.place.line);
  ASSERT_EQ(lines, (std::vector{2, 4, 7})) << "each code once, then the next fault of another kind";
  EXPECT_TRUE(faults[1].message.starts_with("unknown M code M202: ")) << faults[1].message;
  EXPECT_TRUE(faults[2].message.starts_with("G2: R")) << faults[2].message;
}

}  // namespace
}  // namespace servomill::controllers::error_gallery_test
