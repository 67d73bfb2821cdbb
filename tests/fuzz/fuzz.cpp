#include "tests/fuzz/fuzz.h"

#include <fmt/format.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>

namespace servomill::fuzz {
namespace {

// Characters of a line (counted from 1) without its end; -1 if there is no such line. A text that
// ends with a line end has an empty line behind it.
std::ptrdiff_t length_of_line(std::string_view text, int line) {
  for (; line > 1; --line) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return -1;
    text.remove_prefix(end + 1);
  }
  return static_cast<std::ptrdiff_t>(std::min(text.find('\n'), text.size()));
}

bool lies_inside(const Place& place, std::string_view text) {
  if (place.line < 0 || place.column < 0) return false;
  if (place.line == 0) return place.column == 0;
  return place.column <= length_of_line(text, place.line) + 1;
}

// A timer of the processor's time, not of the wall: others may use the machine as well.
void set_timer(int seconds) {
  itimerval timer{};
  timer.it_value.tv_sec = seconds;
  setitimer(ITIMER_PROF, &timer, nullptr);
}

void out_of_time(int) {
  constexpr std::string_view kLaw = "law broken: no input takes that long\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kLaw.data(), kLaw.size());
  std::abort();
}

#ifdef SERVOMILL_INSTRUMENTED
constexpr int kAllowed = kMaxSeconds * kInstrumentedFactor;
#else
constexpr int kAllowed = kMaxSeconds;
#endif

}  // namespace

void run_in_time(std::string_view input) {
  std::signal(SIGPROF, out_of_time);
  set_timer(kAllowed);
  run(input.substr(0, kMaxBytes));
  set_timer(0);
}

void require(bool holds, std::string_view law, std::string_view details) {
  if (holds) return;
  fmt::print(stderr, "law broken: {}\n{}\n", law, details);
  std::fflush(stderr);
  std::abort();
}

void require_places(std::span<const Fault> faults, std::string_view text, std::string_view file) {
  require(!faults.empty(), "an InputError has a fault");
  for (const Fault& fault : faults) {
    require(!fault.message.empty(), "a fault has a message", to_string(fault));
    require(fault.place.file == file, "a fault names the file", to_string(fault));
    require(lies_inside(fault.place, text), "a fault has a place inside the file",
            to_string(fault));
  }
}

}  // namespace servomill::fuzz
