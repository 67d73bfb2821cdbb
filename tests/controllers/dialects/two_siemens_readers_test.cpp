// Programs in the form that `compensate --dialect siemens` writes: the interpreter, which
// translates them, and the verification reader share no line, and must make the same motions of
// them.
#include <gtest/gtest.h>

#include "controllers/gcode/interpreter.h"
#include "same_motions.h"
#include "tests/controllers/dialects/siemens_examples.h"

namespace servomill::controllers::two_siemens_readers_test {
namespace {

// The settings that the translation takes.
SiemensSettings settings() {
  SiemensSettings out;
  out.SUPA_drops_length = false;
  out.M6_is_macro = false;
  out.length_follows_plane = false;
  return out;
}

// @return the number of motions; 0 where one of the two refuses the program
std::size_t motions(const SiemensExample& example) {
  const std::string program = kSiemensHead + example.program + "\nM30\n";
  const ControlSetup control = siemens_example_setup();
  std::vector<Move> moves;
  std::vector<MachineAction> actions;
  try {
    actions = read_siemens(program, "t.mpf", control, settings());
    ProgramSetup setup = setup_of(control, Reader::siemens);
    setup.start = AxisWords::Constant(0.0123);  // where no example goes
    moves = interpret(program, "t.mpf", setup);
  } catch (const InputError&) {
    return 0;
  }
  return expect_same_motions(std::move(moves), std::move(actions));
}

TEST(TwoSiemensReaders, AgreeOnTheExamplesOfTheVerificationReader) {
  int programs = 0, refused = 0;
  for (const SiemensExample& example : siemens_examples()) {
    SCOPED_TRACE(example.name + "\n" + example.program);
    if (!example.applies(settings())) continue;
    motions(example) > 0 ? ++programs : ++refused;
  }
  EXPECT_GE(programs, 40);
  EXPECT_LE(refused, 40);
}

}  // namespace
}  // namespace servomill::controllers::two_siemens_readers_test
