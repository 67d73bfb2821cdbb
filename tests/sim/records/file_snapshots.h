/// Copies of a file before each write to it, as a kill would leave it. To be included once in a
/// test program, because it takes the place of the system's pwrite.
#pragma once

#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace servomill::sim::records {

/// From its making to its end, keeps how the file looked before each write, and what `promised`
/// said then: how much had to be readable if the process were killed.
class FileSnapshots {
 public:
  struct Snapshot {
    std::string path;
    std::size_t promised;
  };

  FileSnapshots(std::string file, std::filesystem::path folder, std::atomic<std::size_t>& promised)
      : file_(std::move(file)), folder_(std::move(folder)), promised_(promised) {
    std::filesystem::create_directories(folder_);
    active() = this;
  }
  ~FileSnapshots() { active() = nullptr; }
  FileSnapshots(const FileSnapshots&) = delete;
  FileSnapshots& operator=(const FileSnapshots&) = delete;

  const std::vector<Snapshot>& all() const { return all_; }

  void take() {
    if (!std::filesystem::exists(file_)) return;
    const std::string copy = folder_ / std::to_string(all_.size());
    std::filesystem::copy_file(file_, copy, std::filesystem::copy_options::overwrite_existing);
    all_.push_back({copy, promised_.load()});
  }

  static std::atomic<FileSnapshots*>& active() {
    static std::atomic<FileSnapshots*> one = nullptr;
    return one;
  }

 private:
  std::string file_;
  std::filesystem::path folder_;
  std::atomic<std::size_t>& promised_;
  std::vector<Snapshot> all_;
};

}  // namespace servomill::sim::records

extern "C" ssize_t pwrite(int file, const void* data, size_t size, off_t offset) {
  if (auto* snapshots = servomill::sim::records::FileSnapshots::active().load()) snapshots->take();
  return syscall(SYS_pwrite64, file, data, size, offset);
}
