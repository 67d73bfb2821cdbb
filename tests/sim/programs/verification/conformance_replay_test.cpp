// The conformance programs, compensated without errors for every dialect: each is verified, or
// refused with a reason.
#include <map>

#include "tests/sim/programs/compensate/trial.h"

namespace servomill::sim {
namespace {

namespace fs = std::filesystem;

// Ends behind a '/': what follows is not written, so that the switch would end it too early.
constexpr const char* kEndBehindSlash = "end_block_delete_on";

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

bool is_of_verification(const std::string& message) {
  return message.find("would do something else") != std::string::npos ||
         message.find("cannot be verified") != std::string::npos;
}

// Numbers out of a message, so that reasons can be counted.
std::string reason_of(const std::string& message) {
  std::string out;
  for (const char c : message) {
    const bool is_number = (c >= '0' && c <= '9') || c == '.' || c == '-';
    if (!is_number) out += c;
    if (is_number && (out.empty() || out.back() != '#')) out += '#';
  }
  return out.substr(0, 70);
}

class ConformanceReplay : public testing::TestWithParam<Dialect> {};

TEST_P(ConformanceReplay, ProgramsAreVerifiedOrRefused) {
  int verified = 0, refused = 0, differing = 0;
  std::map<std::string, int> reasons;
  for (const auto& entry :
       fs::directory_iterator(SERVOMILL_SOURCE_DIR "/tests/conformance/programs")) {
    if (entry.path().extension() != ".ngc") continue;
    try {
      compensate(request_for(entry.path().string(), GetParam()));
      ++verified;
    } catch (const InputError& error) {
      const std::string message = error.faults().front().message;
      const bool differs = is_of_verification(message) && entry.path().stem() != kEndBehindSlash;
      ++(differs ? differing : refused);
      ++reasons[reason_of(message)];
      if (differs) ADD_FAILURE() << error.what();
    }
  }
  const auto name = kDialects[static_cast<std::size_t>(GetParam())];
  fmt::print("{}: {} verified, {} refused, {} differ\n", name, verified, refused, differing);
  for (const auto& [reason, n] : reasons) {
    if (n >= 5) fmt::print("  {:4} {}\n", n, reason);
  }
  EXPECT_GT(verified, 50);
}

INSTANTIATE_TEST_SUITE_P(Dialects, ConformanceReplay,
                         testing::Values(Dialect::linuxcnc, Dialect::heidenhain, Dialect::fanuc,
                                         Dialect::siemens),
                         [](const auto& one) {
                           return std::string(kDialects[static_cast<std::size_t>(one.param)]);
                         });

}  // namespace
}  // namespace servomill::sim
