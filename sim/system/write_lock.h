/// The right to write a file, for one process at a time.
#pragma once

#include <cstdint>
#include <string>

namespace servomill::sim::system {

/// Locks a partial file until it has its final name, for as long as this lives. HDF5 gives up its
/// own lock when it closes the file: until that is on the disk and renamed, which takes seconds,
/// another process would take it for left behind.
class WriteLock {
 public:
  /// The file must not be there, may be there, or is.
  enum class File : std::uint8_t { created, replaced, resumed };

  WriteLock() = default;
  /// Creates the file if it is not there; one that is there keeps its contents. A file to be
  /// resumed that cannot be opened is not locked, nor is one on a file system without locks.
  /// @throws SystemError if it cannot be created, or while another process writes it
  WriteLock(const std::string& path, File file);
  WriteLock(WriteLock&& other) noexcept;
  WriteLock& operator=(WriteLock&& other) noexcept;
  ~WriteLock() { release(); }

 private:
  void release();

  int descriptor_ = -1;
};

/// True if a lock keeps this process itself from writing the file, but through the descriptor that
/// has the lock (SMB; flock(2), "CIFS details").
bool locks_bind_writers(const std::string& path);

/// Process that writes a partial file now, as its lock tells.
enum class Writer : std::uint8_t { none, alive, unknown };
Writer writer_of(const std::string& partial);

}  // namespace servomill::sim::system
