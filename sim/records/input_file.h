/// HDF5 files that are read: by path, with every fault named.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "plant/vocabulary/stored_text.h"
#include "sim/records/meaning.h"

namespace servomill::sim::records {

class Hdf5Handle;  // sim/records/hdf5_library.h

/// A file to read. Paths are absolute: "/cases/table/servo/time".
/// All members throw InputError that names the file and what it lacks.
class InputFile {
 public:
  /// @throws SystemError if another process writes it
  explicit InputFile(std::string path);
  ~InputFile();
  InputFile(InputFile&&) noexcept;

  const std::string& path() const { return path_; }
  bool has(const std::string& object) const;
  std::vector<std::string> groups(const std::string& group) const;    // in the order of making
  std::vector<std::string> datasets(const std::string& group) const;  // in the order of making

  /// Lengths of the dimensions; none for one value.
  std::vector<std::size_t> shape(const std::string& dataset) const;
  bool holds_numbers(const std::string& dataset) const;
  /// All values, row by row.
  std::vector<double> values(const std::string& dataset) const;

  /// The same of some rows of a list.
  std::vector<double> values(const std::string& dataset, std::size_t first,
                             std::size_t count) const;
  /// Some rows of one column of a table, or of a list (column 0).
  std::vector<double> column(const std::string& dataset, std::size_t column, std::size_t first,
                             std::size_t count) const;
  /// Some rows of a list of texts.
  std::vector<std::string> texts(const std::string& dataset, std::size_t first,
                                 std::size_t count) const;

  bool has_attribute(const std::string& object, const std::string& name) const;
  /// A text that is an attribute.
  std::string text(const std::string& object, const std::string& name) const;
  /// A text as Hdf5Group::write_text() writes it; a long one is read in pieces.
  StoredText stored_text(const std::string& object, const std::string& name) const;
  /// Unit of a dataset and its long name without it.
  Meaning meaning(const std::string& dataset) const;
  double number(const std::string& object, const std::string& name) const;
  std::vector<double> numbers(const std::string& object, const std::string& name) const;

 private:
  [[noreturn]] void fail(const std::string& message) const;
  std::vector<std::string> children(const std::string& group, bool groups) const;
  Hdf5Handle open(const std::string& object) const;
  StoredText long_text(const std::string& dataset) const;
  Hdf5Handle open_attribute(const std::string& object, const std::string& name) const;

  std::string path_;
  std::unique_ptr<Hdf5Handle> file_;
};

}  // namespace servomill::sim::records
