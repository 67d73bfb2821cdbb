// The law of compensated programs: what a control makes of the written program is what the original
// asks for. Random programs of every class, for every dialect.
#include <cstdlib>
#include <map>

#include "tests/sim/programs/compensate/trial.h"
#include "tests/sim/programs/verification/random_program.h"

namespace servomill::sim {
namespace {

constexpr const char* kNoErrors = "[errors.none]\nEXX = { constant_um = 0.0 }\n";
constexpr const char* kCompensated = "compensated";

constexpr int kShown = 3;  // programs that differ, in full

int number_of(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::atoi(text);
}

// How many programs a dialect, and the seed of the first.
int program_count() { return number_of("SERVOMILL_REPLAY_PROGRAMS", 200); }
int first_seed() { return number_of("SERVOMILL_REPLAY_SEED", 0); }

CompensateRequest request_for(const std::string& program, Dialect dialect, bool has_rotary_axes,
                              bool has_errors) {
  Trial trial(program, "random.ngc");
  CompensateRequest request = trial.request;
  request.dialect = dialect;
  request.program_name = "RANDOM";
  request.program_number = 7;
  request.retract_Z = 0.0;
  request.inputs.parameter_file.clear();
  request.work_offsets = {"X=200,Y=250,Z=-90", "G55:X=300,Y=200,Z=-95", "G56:X=120,Y=140,Z=-80"};
  if (has_rotary_axes) {
    request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/generic_trunnion_ac.toml";
    request.work_offsets = {"X=0,Y=0,Z=-90,A=0,C=0", "G55:X=30,Y=-20,Z=-95,A=0,C=0",
                            "G56:X=-20,Y=40,Z=-80,A=0,C=0"};
  }
  if (!has_errors || has_rotary_axes) request.error_file = written("none.toml", kNoErrors);
  return request;
}

// What became of a program: nothing but "compensated", or the refusal without places and numbers.
std::string outcome(const CompensateRequest& request) {
  try {
    compensate(request);
    return kCompensated;
  } catch (const InputError& error) {
    return error.faults().front().message;
  }
}

bool is_of_verification(const std::string& message) {
  return message.find("would do something else") != std::string::npos ||
         message.find("cannot be verified") != std::string::npos;
}

// Numbers and names out of a message, so that reasons can be counted.
std::string reason_of(const std::string& message) {
  std::string out;
  for (const char c : message) {
    const bool is_number = (c >= '0' && c <= '9') || c == '.' || c == '-';
    if (!is_number) out += c;
    if (is_number && (out.empty() || out.back() != '#')) out += '#';
  }
  return out.substr(0, 100);
}

struct Count {
  int compensated = 0, refused = 0, differing = 0;
  std::map<std::string, int> reasons;
};

void run(Count& count, std::uint32_t seed, Dialect dialect) {
  const bool has_rotary_axes = seed % 5 == 4, has_errors = seed % 2 == 1;
  const RandomProgram program(seed, {.has_rotary_axes = has_rotary_axes});
  const std::string message =
      outcome(request_for(program.text(), dialect, has_rotary_axes, has_errors));
  if (message == kCompensated) {
    ++count.compensated;
  } else if (is_of_verification(message)) {
    ++count.differing;
    const bool is_shown = count.differing <= kShown;
    ADD_FAILURE() << "seed " << seed << " for " << kDialects[static_cast<std::size_t>(dialect)]
                  << ": " << message << "\n"
                  << (is_shown ? program.text() : "");
  } else {
    ++count.refused;
    ++count.reasons[reason_of(message)];
  }
}

class ReplayLaw : public testing::TestWithParam<Dialect> {};

TEST_P(ReplayLaw, HoldsForRandomPrograms) {
  Count count;
  const int programs = program_count();
  const int first = first_seed();
  for (int i = 0; i < programs; ++i) run(count, static_cast<std::uint32_t>(first + i), GetParam());
  fmt::print("{}: {} compensated and verified, {} refused, {} differ\n",
             kDialects[static_cast<std::size_t>(GetParam())], count.compensated, count.refused,
             count.differing);
  for (const auto& [reason, n] : count.reasons) fmt::print("  {:5} {}\n", n, reason);
  EXPECT_EQ(count.differing, 0);
  EXPECT_GT(count.compensated, programs / 2);
}

INSTANTIATE_TEST_SUITE_P(Dialects, ReplayLaw,
                         testing::Values(Dialect::linuxcnc, Dialect::heidenhain, Dialect::fanuc,
                                         Dialect::siemens),
                         [](const auto& one) {
                           return std::string(kDialects[static_cast<std::size_t>(one.param)]);
                         });

}  // namespace
}  // namespace servomill::sim
