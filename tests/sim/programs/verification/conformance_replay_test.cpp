// The conformance programs, compensated without errors for every dialect: each is verified, or
// refused with a reason.
#include <filesystem>

#include "tests/sim/programs/compensate/trial.h"
#include "tests/sim/programs/verification/each_dialect.h"
#include "tests/sim/programs/verification/replay_count.h"

namespace servomill::sim::programs::conformance_replay_test {
namespace {

namespace fs = std::filesystem;

CompensateRequest request_for(const std::string& program, Dialect dialect) {
  CompensateRequest request;
  request.program_file = program;
  request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/generic_trunnion_ac.toml";
  request.error_file = written("none.toml", "[errors.none]\nEXX = { constant_um = 0.0 }\n");
  std::string tools;
  for (int i = 1; i <= 20; ++i) tools += fmt::format("T{0} P{0} Z+{1} D+{2}\n", i, 30 + i, 2 + i);
  request.inputs.tool_table = written("conformance.tbl", tools);
  request.dialect = dialect;
  request.program_name = "CONFORMANCE";
  request.program_number = 7;
  request.retract_Z = 0.0;
  return request;
}

class ConformanceReplay : public testing::TestWithParam<Dialect> {};

TEST_P(ConformanceReplay, ProgramsAreVerifiedOrRefused) {
  constexpr int kOften = 5;
  ReplayCount count;
  for (const auto& entry :
       fs::directory_iterator(SERVOMILL_SOURCE_DIR "/tests/conformance/programs")) {
    if (entry.path().extension() != ".ngc") continue;
    const std::string message = count.add(request_for(entry.path().string(), GetParam()));
    if (!message.empty()) ADD_FAILURE() << message;
  }
  count.print(GetParam(), kOften);
  EXPECT_GT(count.verified, 50);
}

INSTANTIATE_TEST_SUITE_P(Dialects, ConformanceReplay, each_dialect(), name_of_dialect);

}  // namespace
}  // namespace servomill::sim::programs::conformance_replay_test
