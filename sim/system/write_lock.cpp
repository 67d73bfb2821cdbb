#include "sim/system/write_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
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
  return ::open(path.c_str(), O_RDONLY | kAlways);
}

// False if the file was renamed since it was opened: whoever held the lock has given it its name.
bool is_still_called(int descriptor, const std::string& path) {
  struct stat own = {}, there = {};
  return ::fstat(descriptor, &own) == 0 && ::stat(path.c_str(), &there) == 0 &&
         own.st_dev == there.st_dev && own.st_ino == there.st_ino;
}

}  // namespace

WriteLock::WriteLock(const std::string& path, File file) {
  const char* const failed = file == File::resumed ? "cannot be opened" : "cannot be created";
  while (true) {
    descriptor_ = opened(path, file);
    if (descriptor_ < 0) {
      if (file == File::resumed) return;
      throw SystemError(path, failed, std::strerror(errno));
    }
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      ::close(descriptor_);
      throw SystemError(path, failed, "another process writes it");
    }
    if (is_still_called(descriptor_, path)) return;
    release();
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
