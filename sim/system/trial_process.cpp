#include "sim/system/trial_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

#include "plant/vocabulary/progress.h"

namespace servomill::sim::system {
namespace {

[[noreturn]] void run_limited(const std::function<void()>& work, int seconds) {
  ProgressWatch::forget();
  const auto limit = static_cast<rlim_t>(seconds);
  const rlimit time{limit, limit + 1}, none{0, 0};
  setrlimit(RLIMIT_CPU, &time);
  setrlimit(RLIMIT_CORE, &none);
  for (const int crash : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU}) {
    signal(crash, SIG_DFL);
  }
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }
  try {
    work();
  } catch (...) {
    // whoever does the work again meets it
  }
  _exit(0);
}

}  // namespace

std::string try_in_process(const std::function<void()>& work, int seconds) {
  const pid_t child = fork();
  if (child < 0) return {};  // no process to be had: the work is done without a trial
  if (child == 0) run_limited(work, seconds);
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return {};
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal == SIGXCPU || signal == SIGKILL) {
    return fmt::format("does not come to an end within {} s", seconds);
  }
  return signal != 0 ? fmt::format("crashes (signal {})", signal) : "fails";
}

}  // namespace servomill::sim::system
