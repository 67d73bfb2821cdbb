// Refusals of written programs: both lines and the setting of the control are shown.
#include "sim/programs/verification/verification.h"

#include "tests/sim/programs/compensate/trial.h"

namespace servomill::sim::programs::verification_test {
namespace {

const std::string kProgram =
    "G21 G90 G17 G54\n"
    "T1 M6\n"
    "G43 H1\n"
    "S1000 M3\n"
    "G0 X10 Y10\n"
    "G0 Z5\n"
    "M8\n"
    "G1 Z-1 F200\n"
    "G1 X50\n"
    "M30\n";

// The same moves with a frame, a variable, a loop and a cycle.
const std::string kSiemens =
    "DEF INT HOLE\n"
    "G17 G710 G90 G94 G54\n"
    "T1 M6\n"
    "D1 S1000 M3\n"
    "G0 X10 Y10\n"
    "G0 Z5\n"
    "TRANS X10\n"
    "G1 Z-1 F200\n"
    "G1 X40 RND=2\n"
    "Y20\n"
    "G0 Z5\n"
    "FOR HOLE=1 TO 3\n"
    "G0 X=HOLE*10\n"
    "CYCLE81(5,0,2,-3)\n"
    "ENDFOR\n"
    "M30\n";

CompensateRequest request_for(Dialect dialect, const std::string& program = kProgram,
                              const std::string& file = "plate.ngc") {
  Trial trial(program, file);
  CompensateRequest request = trial.request;
  request.error_file = written("none.toml", "[errors.none]\nEXX = { constant_um = 0.0 }\n");
  request.inputs.parameter_file.clear();
  request.work_offsets = {"X=200,Y=250,Z=-90"};
  request.dialect = dialect;
  request.program_name = "PLATE";
  request.program_number = 7;
  request.retract_Z = 0.0;
  return request;
}

// The refusal of the written program with one text in place of another.
std::string refusal(Dialect dialect, const std::string& from, const std::string& to) {
  const CompensateRequest request = request_for(dialect);
  std::string text = compensate(request).program;
  const std::size_t at = text.find(from);
  if (at == std::string::npos) return "no such text in:\n" + text;
  text.replace(at, from.size(), to);
  try {
    verify_compensated(request, text);
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find("plate.ngc"));
  }
  return "taken";
}

TEST(Verification, TakesWhatIsWrittenFromAProgramOfSiemens) {
  for (const Dialect dialect :
       {Dialect::linuxcnc, Dialect::heidenhain, Dialect::fanuc, Dialect::siemens}) {
    const CompensateRequest request = request_for(dialect, kSiemens, "plate.mpf");
    const VerificationReport report = verify_compensated(request, compensate(request).program);
    EXPECT_GT(report.blocks, 15U);
    EXPECT_LT(report.largest, 1e-6);  // m; arcs end on the grid of the control
  }
}

TEST(Verification, TakesWhatIsWritten) {
  for (const Dialect dialect :
       {Dialect::linuxcnc, Dialect::heidenhain, Dialect::fanuc, Dialect::siemens}) {
    const CompensateRequest request = request_for(dialect);
    const VerificationReport report = verify_compensated(request, compensate(request).program);
    EXPECT_GT(report.blocks, 4U);
    EXPECT_LT(report.largest, 1e-9);
  }
  const Compensated done = compensate(request_for(Dialect::fanuc));
  EXPECT_NE(std::find(done.report.begin(), done.report.end(),
                      "verified: 8 blocks, largest difference 0.00 um, for 17 control settings"),
            done.report.end());
}

TEST(Verification, ShowsBothLines) {
  EXPECT_EQ(refusal(Dialect::fanuc, "X50.", "X51."),
            "plate.ngc:9: error: the program written for fanuc differs in effect from \"G1 X50\": "
            "moves beyond X250 Y260 Z-51, where the original ends (its line 27, \"N18 X51.\"; "
            "EVO=0 TOS=0 LRP=0 TLB=0 IS-B)");
  EXPECT_EQ(refusal(Dialect::fanuc, "G43 H1 Z5.", "Z5."),
            "plate.ngc: error: the program written for fanuc cannot be verified (EVO=0 TOS=0 LRP=0 "
            "TLB=0 IS-B): its line 24, \"N15 Z5.\": Z requires an active G43, G44 or G49");
  EXPECT_EQ(refusal(Dialect::siemens, "M8", "M9"),
            "plate.ngc:8: error: the program written for siemens differs in effect from \"G1 Z-1 "
            "F200\": coolant must be on, but is off (its line 20, \"N120 G1 Z-1 F200\"; MD20270=1 "
            "MD10760=1 MD22550=1 SD42940=0 M6 a macro)");
}

// X and Y of a rapid before Z is known are not corrected: the next feed begins beside its path, and
// here by more than its length (Y from 1 to 0.9 mm under a correction of 0.2 mm), or has none.
TEST(Verification, TakesShortFeedsThatBeginBesideTheirPath) {
  const std::string errors =
      written("shifted.toml", "[errors.shifted]\nEYX = { constant_um = 200.0 }\n");
  for (const std::string feed : {"G1 Y0.9 F100\n", "G1 Y1.1 F100\n", "G1 Y1 F100\n"}) {
    for (const Dialect dialect :
         {Dialect::linuxcnc, Dialect::heidenhain, Dialect::fanuc, Dialect::siemens}) {
      CompensateRequest request = request_for(dialect);
      request.error_file = errors;
      request.program_file =
          written("plate.ngc", "G21 G90 G17 G54\nT1 M6\nS1000 M3\nG0 X1 Y1\nG43 H1 Z5\n" + feed +
                                   "G1 X9\nM30\n");
      EXPECT_NO_THROW(compensate(request)) << feed;
    }
  }
}

TEST(Verification, ReplaysLinuxCncFromTwoStarts) {
  EXPECT_EQ(
      refusal(Dialect::linuxcnc, "G0 X10 Y10", "G0 X10"),
      "plate.ngc:5: error: the program written for linuxcnc differs in effect from \"G0 X10 Y10\": "
      "moves Z, which is at rest in the original (its line 10, \"G0 Z5\"; the start at zero)");
}

}  // namespace
}  // namespace servomill::sim::programs::verification_test
