/// Calls of the HDF5 library: one thread at a time, each result checked, each identifier owned.
/// Only sources that call the library itself include this.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>

namespace servomill::sim::records {

/// Debian's library is not made for threads: every function that calls it holds this.
class Hdf5Lock {
 public:
  Hdf5Lock();

 private:
  std::lock_guard<std::recursive_mutex> lock_;
};

/// Owner of one identifier of the library (hid_t); identifiers below 0 are none.
class Hdf5Handle {
 public:
  explicit Hdf5Handle(std::int64_t id = -1) : id_(id) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept;
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept;
  ~Hdf5Handle() { reset(); }

  std::int64_t get() const { return id_; }
  void reset();

 private:
  std::int64_t id_;
};

/// Silences the library and keeps it from closing files when the process ends. To be called before
/// a file is opened.
void prepare_hdf5();

/// Reason for which the last call failed: that of the system if the system refused.
std::string hdf5_reason();

/// Name of the file that an object is in.
std::string hdf5_file_name(std::int64_t object);

/// Checks the result of a call that writes into the file of `object`.
/// @throws SystemError if it failed
std::int64_t written(std::int64_t result, std::int64_t object);

/// Identifier returned by a call that touches no file and therefore cannot fail.
Hdf5Handle hdf5_handle(std::int64_t id);

/// Creation of a group, or of the root of a file: members are listed in the order of their making.
/// @param kind  H5P_GROUP_CREATE or H5P_FILE_CREATE
Hdf5Handle group_creation(std::int64_t kind);

/// Refuses to open a file that another process writes; to be called after an attempt failed.
/// @throws SystemError
void refuse_if_locked(const std::string& path);

}  // namespace servomill::sim::records
