#include "strategies/plugin_child.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "plant/vocabulary/progress.h"
#include "strategies/plugin_watch.h"

namespace servomill::strategies {
namespace {

std::atomic<bool> is_isolated = false;

// First byte that a child writes: what follows it.
constexpr char kResult = 'r', kFailure = 'f', kException = 'e';

constexpr char kBegin = 'b';  // the only byte that it reads
constexpr std::size_t kMaxText = 4096;

void write_text(ProcessPipe& pipe, char what, const std::string& text) {
  pipe.write(&what, 1);
  pipe.write(text.data(), text.size());
}

}  // namespace

void isolate_plugins() { is_isolated = true; }
bool plugins_are_isolated() { return is_isolated; }

bool ProcessPipe::write(const void* from, std::size_t bytes) {
  const char* next = static_cast<const char*>(from);
  while (bytes > 0) {
    const ssize_t done = ::send(descriptor_, next, bytes, MSG_NOSIGNAL);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    next += done;
    bytes -= static_cast<std::size_t>(done);
  }
  return true;
}

bool ProcessPipe::read(void* to, std::size_t bytes) {
  char* next = static_cast<char*>(to);
  while (bytes > 0) {
    const ssize_t done = ::recv(descriptor_, next, bytes, 0);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    next += done;
    bytes -= static_cast<std::size_t>(done);
  }
  return true;
}

bool ProcessPipe::can_be_read(std::chrono::milliseconds patience) const {
  pollfd one = {descriptor_, POLLIN, 0};
  return ::poll(&one, 1, static_cast<int>(patience.count())) > 0;
}

PluginChild::PluginChild(std::string who, const Work& work) : who_(std::move(who)) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw std::runtime_error(fmt::format("{}: cannot be isolated: {}", who_, std::strerror(errno)));
  }
  process_ = ::fork();
  if (process_ == 0) {
    ProgressWatch::forget();
    ::close(ends[0]);
    run(ends[1], work);
  }
  const int why = errno;
  ::close(ends[1]);
  pipe_ = ProcessPipe(ends[0]);
  if (process_ > 0) return;
  ::close(ends[0]);
  throw std::runtime_error(fmt::format("{}: cannot be isolated: {}", who_, std::strerror(why)));
}

PluginChild::~PluginChild() {
  ::close(pipe_.descriptor());
  if (process_ < 0) return;
  ::kill(process_, SIGKILL);
  while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

// In the child: nothing of the parent is destroyed or flushed here.
void PluginChild::run(int descriptor, const Work& work) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_IGN);  // the parent decides
  ProcessPipe pipe(descriptor);
  watch_plugins_in_child([&pipe](const std::string& why) {
    write_text(pipe, kFailure, why);
    ::_exit(EXIT_FAILURE);
  });
  char begin = 0;
  if (!pipe.read(&begin, 1)) ::_exit(EXIT_SUCCESS);
  try {
    const Result result = work();
    pipe.write(&kResult, 1);
    result(pipe);
  } catch (const PluginFailed& failed) {
    write_text(pipe, kFailure, failed.what());
  } catch (const std::exception& error) {
    write_text(pipe, kException, error.what());
  } catch (...) {
    write_text(pipe, kException, "an exception of unknown type");
  }
  ::_exit(EXIT_SUCCESS);
}

void PluginChild::begin() { pipe_.write(&kBegin, 1); }

bool PluginChild::wait(std::chrono::milliseconds patience) {
  constexpr std::chrono::milliseconds kNow{0};
  if (!pipe_.can_be_read(patience)) {
    // a process that has ended writes no more, even if one that it has started holds its end
    siginfo_t ended = {};
    const int failed =
        ::waitid(P_PID, static_cast<id_t>(process_), &ended, WEXITED | WNOHANG | WNOWAIT);
    if (failed == 0 && ended.si_pid == process_ && !pipe_.can_be_read(kNow)) fail();
    return false;
  }
  char what = 0;
  read(&what, 1);
  if (what == kFailure) throw PluginFailed(rest_as_text());
  if (what == kException) throw std::runtime_error(rest_as_text());
  if (what != kResult)
    throw PluginFailed(who_ + ": the plug-in wrote to a file descriptor that it did not open");
  return true;
}

void PluginChild::read(void* to, std::size_t bytes) {
  if (!pipe_.read(to, bytes)) fail();
}

void PluginChild::fail() {
  ::kill(process_, SIGKILL);  // nothing, where it has ended
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  throw PluginFailed(
      WIFSIGNALED(status)
          ? fmt::format("{}: its process was ended by signal {}", who_, WTERMSIG(status))
          : fmt::format("{}: the plug-in ended its process with status {}", who_,
                        WEXITSTATUS(status)));
}

std::string PluginChild::rest_as_text() {
  std::string text;
  for (char c = 0; text.size() < kMaxText && pipe_.read(&c, 1);) text += c;
  return text;
}

}  // namespace servomill::strategies
