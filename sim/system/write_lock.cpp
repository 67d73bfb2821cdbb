#include "sim/system/write_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <thread>
#include <utility>

#include "sim/system/system_error.h"

namespace servomill::sim::system {
namespace {

constexpr mode_t kMode = 0666;

int opened(const std::string& path, WriteLock::File file) {
  constexpr int kAlways = O_NONBLOCK | O_CLOEXEC;
  switch (file) {
    case WriteLock::File::created:
      return ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | kAlways, kMode);
    case WriteLock::File::replaced:
      return ::open(path.c_str(), O_RDWR | O_CREAT | kAlways, kMode);
    case WriteLock::File::resumed:
      break;
  }
  return ::open(path.c_str(), O_RDWR | kAlways);
}

// Takes the lock. Whoever looks for a writer has it for a moment, too.
// @return 0, or the number of the error
int locked(int descriptor) {
  constexpr int kAttempts = 5;
  for (int attempt = 1; ::flock(descriptor, LOCK_EX | LOCK_NB) != 0; ++attempt) {
    const bool is_held = errno == EWOULDBLOCK;
    if (!is_held || attempt == kAttempts) return errno;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return 0;
}

bool has_no_locks(int error) { return error == ENOLCK || error == ENOSYS || error == EOPNOTSUPP; }

// False if the file was renamed since it was opened: whoever held the lock has given it its name.
bool is_still_called(int descriptor, const std::string& path) {
  struct stat own = {}, there = {};
  return ::fstat(descriptor, &own) == 0 && ::stat(path.c_str(), &there) == 0 &&
         own.st_dev == there.st_dev && own.st_ino == there.st_ino;
}

}  // namespace

WriteLock::WriteLock(const std::string& path, File file) {
  const char* const failed = file == File::resumed ? "cannot be opened" : "cannot be created";
  constexpr int kAttempts = 10;  // file systems on which a file has several numbers end here
  for (int attempt = 1; attempt <= kAttempts; ++attempt) {
    release();
    descriptor_ = opened(path, file);
    if (descriptor_ < 0) {
      if (file == File::resumed) return;
      throw SystemError(path, failed, std::strerror(errno));
    }
    const int error = locked(descriptor_);
    if (error != 0 && !has_no_locks(error)) {
      ::close(std::exchange(descriptor_, -1));
      throw SystemError(path, failed,
                        error == EWOULDBLOCK ? "another process writes it" : std::strerror(error));
    }
    if (is_still_called(descriptor_, path)) return;
  }
}

WriteLock::WriteLock(WriteLock&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)) {}

WriteLock& WriteLock::operator=(WriteLock&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

// Processes that were forked since have the lock, too, unless it is given up.
void WriteLock::release() {
  if (descriptor_ < 0) return;
  ::flock(descriptor_, LOCK_UN);
  ::close(std::exchange(descriptor_, -1));
}

bool locks_bind_writers(const std::string& path) {
  constexpr std::array<unsigned, 3> kSmb = {0x517b, 0xff534d42, 0xfe534d42};  // statfs(2)
  struct statfs found = {};
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  if (::statfs(folder.c_str(), &found) != 0) return false;
  return std::find(kSmb.begin(), kSmb.end(), static_cast<unsigned>(found.f_type)) != kSmb.end();
}

Writer writer_of(const std::string& partial) {
  const int descriptor = ::open(partial.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return Writer::unknown;
  Writer writer = Writer::none;
  if (::flock(descriptor, LOCK_SH | LOCK_NB) != 0) {
    writer = errno == EWOULDBLOCK ? Writer::alive : Writer::unknown;
  }
  ::close(descriptor);
  return writer;
}

}  // namespace servomill::sim::system
