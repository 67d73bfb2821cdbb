/// Objects of an HDF5 file that is being written: their attributes, and the file that they are in.
/// Several threads may write, but wait for each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "sim/records/hdf5_library.h"

namespace servomill::sim::records {

/// A group or a dataset. An attribute set twice has the later value.
/// All members throw SystemError if the file cannot be written.
class Hdf5Object {
 public:
  void attribute(const std::string& name, std::string_view text);  // UTF-8 without NUL
  void attribute(const std::string& name, double value);
  void attribute(const std::string& name, std::int64_t value);
  void attribute(const std::string& name, int value) { attribute(name, std::int64_t{value}); }
  void attribute(const std::string& name, std::span<const double> values);
  void attribute(const std::string& name, std::span<const std::int32_t> values);
  void attribute(const std::string& name, std::span<const std::string> texts);

  bool has_attribute(const std::string& name) const;
  /// Value of an attribute that holds a text.
  std::string text(const std::string& name) const;

  /// Hands everything written so far to the system, so that it outlives a kill of the process.
  void flush_file();

  /// Claims room on the disk for `bytes` more, where the file system can: a full disk is then found
  /// before the library writes half of something.
  void reserve(std::size_t bytes);

 protected:
  explicit Hdf5Object(Hdf5Handle id) : id_(std::move(id)) {}
  Hdf5Handle id_;
};

}  // namespace servomill::sim::records
