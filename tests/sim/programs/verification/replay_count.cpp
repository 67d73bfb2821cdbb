#include "tests/sim/programs/verification/replay_count.h"

#include <fmt/format.h>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim::programs {
namespace {

constexpr std::size_t kLongestReason = 100;

// The user can act on it: blocks behind '/' leave something else than they find.
bool is_of_the_switch(const std::string& message) {
  return message.find("with the blocks with '/' left out") != std::string::npos;
}

bool is_of_verification(const std::string& message) {
  if (is_of_the_switch(message)) return false;
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
  return out.substr(0, kLongestReason);
}

}  // namespace

std::string ReplayCount::add(const CompensateRequest& request) {
  try {
    compensate(request);
    ++verified;
    return {};
  } catch (const InputError& error) {
    const std::string& message = error.faults().front().message;
    if (is_of_verification(message)) {
      ++differing;
      return error.what();
    }
    ++refused;
    ++reasons[reason_of(message)];
    return {};
  }
}

void ReplayCount::print(Dialect dialect, int often) const {
  fmt::print("{}: {} verified, {} refused, {} differ\n",
             kDialects[static_cast<std::size_t>(dialect)], verified, refused, differing);
  for (const auto& [reason, n] : reasons) {
    if (n >= often) fmt::print("  {:5} {}\n", n, reason);
  }
}

}  // namespace servomill::sim::programs
