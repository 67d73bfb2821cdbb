/// HDF5 files that are written: under a temporary name, renamed when complete.
#pragma once

#include <memory>
#include <string>

#include "sim/system/write_lock.h"

namespace servomill::sim::system {
class TemporaryFile;
}  // namespace servomill::sim::system

namespace servomill::sim::records {

class Hdf5Group;   // sim/records/hdf5_group.h
class Hdf5Handle;  // sim/records/hdf5_library.h

/// A file under construction: it is called `path` + ".partial" until `commit()`. Without a commit
/// that file stays, readable up to the last flush.
class OutputFile {
 public:
  /// @param force  may replace `path` and its partial file
  /// @throws InputError if either exists and `force` is not set
  /// @throws SystemError if the file cannot be made, as while another process writes it
  OutputFile(std::string path, bool force);
  /// Goes on with the partial file of `path`.
  /// @throws InputError if it cannot be opened
  /// @throws SystemError if another process writes it
  static OutputFile resumed(std::string path, bool force);
  /// Makes the complete file `path` the partial one again and goes on with it.
  /// @throws as resumed()
  static OutputFile reopened(std::string path);
  OutputFile(OutputFile&&) noexcept;
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  Hdf5Group root();
  const std::string& path() const { return path_; }
  const std::string& partial_path() const { return partial_path_; }

  /// From here on nothing stays without a commit.
  void remove_unless_committed();

  /// Writes all to the disk and gives the file its name. Groups and datasets taken from it are of
  /// no use afterwards.
  /// @throws SystemError, and then the partial file stays
  /// @throws InputError if somebody made `path` meanwhile and `force` is not set
  void commit();

 private:
  static OutputFile opened(std::string path, bool force, system::WriteLock own);
  OutputFile(std::string path, bool force, system::WriteLock lock,
             std::unique_ptr<Hdf5Handle> file);

  std::string path_;
  std::string partial_path_;
  bool force_;
  system::WriteLock lock_;
  std::unique_ptr<system::TemporaryFile> temporary_;  // where nothing stays without a commit
  std::unique_ptr<Hdf5Handle> file_;                  // closed before that one is removed
};

}  // namespace servomill::sim::records
