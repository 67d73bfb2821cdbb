#include "plant/vocabulary/scratch_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cassert>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "plant/vocabulary/system_error.h"

namespace servomill {
namespace {

std::atomic<std::uint64_t> temporary = 0;

std::string folder_of_temporary_files(const std::string& contents) {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  if (!error) return folder.string();
  const char* named = std::getenv("TMPDIR");
  throw SystemError(named != nullptr ? named : "/tmp", contents + " cannot be stored there",
                    error.message());
}

int open_without_name(const std::string& folder) {
  const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor >= 0) return descriptor;
  std::string name = folder + "/servomill-XXXXXX";  // where the file system knows no such files
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

}  // namespace

ScratchFile::ScratchFile(std::string folder, std::string contents)
    : is_temporary_(folder.empty()),
      folder_(folder.empty() ? folder_of_temporary_files(contents) : std::move(folder)),
      contents_(std::move(contents)),
      descriptor_(open_without_name(folder_)) {
  if (descriptor_ < 0) {
    throw SystemError(folder_, contents_ + " cannot be stored there", std::strerror(errno));
  }
}

ScratchFile::~ScratchFile() {
  if (mapped_ != nullptr) ::munmap(mapped_, size_);
  ::close(descriptor_);
  if (is_temporary_) temporary -= size_;
}

std::uint64_t ScratchFile::temporary_bytes() { return temporary; }

void ScratchFile::fail_to_write(const std::string& reason) const {
  const char* const remedy = is_temporary_ ? "; TMPDIR chooses another folder" : "";
  throw SystemError(folder_, contents_ + " cannot be written", reason + remedy);
}

std::uint64_t ScratchFile::size() const {
  const std::scoped_lock lock(mutex_);
  return size_;
}

std::uint64_t ScratchFile::append(std::span<const std::uint8_t> bytes) {
  const std::scoped_lock lock(mutex_);
  const std::uint64_t place = size_;
  while (!bytes.empty()) {
    const ssize_t done =
        ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(size_));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) fail_to_write(std::strerror(errno));
    size_ += static_cast<std::uint64_t>(done);
    if (is_temporary_) temporary += static_cast<std::uint64_t>(done);
    bytes = bytes.subspan(static_cast<std::size_t>(done));
  }
  return place;
}

void ScratchFile::read(std::uint64_t place, std::span<std::uint8_t> bytes) const {
  while (!bytes.empty()) {
    const ssize_t done =
        ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(place));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) {
      throw SystemError(folder_, contents_ + " cannot be read", std::strerror(errno));
    }
    place += static_cast<std::uint64_t>(done);
    bytes = bytes.subspan(static_cast<std::size_t>(done));
  }
}

std::span<const std::uint8_t> ScratchFile::map() {
  const std::scoped_lock lock(mutex_);
  assert(size_ > 0 && mapped_ == nullptr);
  void* const at = ::mmap(nullptr, size_, PROT_READ, MAP_SHARED, descriptor_, 0);
  if (at == MAP_FAILED) {
    throw SystemError(folder_, contents_ + " cannot be read", std::strerror(errno));
  }
  mapped_ = at;
  return {static_cast<const std::uint8_t*>(at), size_};
}

void ScratchFile::release() const {
  const std::scoped_lock lock(mutex_);
  // pages of a shared mapping that are dropped are those of the file again
  if (mapped_ != nullptr) ::madvise(mapped_, size_, MADV_DONTNEED);
}

}  // namespace servomill
