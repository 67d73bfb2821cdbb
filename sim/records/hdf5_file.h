/// HDF5 files: written under a temporary name, renamed when complete, read back by path.
///
/// Every dataset has what h5py, xarray, netCDF and Octave need to open it: attributes
/// `units` and `long_name`, and a dimension scale for each of its dimensions. Texts are attributes.
/// Several threads may use this, but wait for each other: the library takes one at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/records/chunk_encoder.h"
#include "sim/system/system_error.h"

namespace servomill::sim {

class TemporaryFile;

/// Owner of one identifier of the library; identifiers below 0 are none.
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

/// Common part of groups and datasets. An attribute set twice has the later value.
/// All members throw SystemError if the file cannot be written.
class Hdf5Object {
 public:
  void attribute(const std::string& name, std::string_view text);  // UTF-8 without NUL
  void attribute(const std::string& name, double value);
  void attribute(const std::string& name, std::int64_t value);
  void attribute(const std::string& name, int value) { attribute(name, std::int64_t{value}); }
  void attribute(const std::string& name, std::span<const double> values);

  /// Hands everything written so far to the system, so that it outlives a kill of the process.
  void flush_file();

  /// Claims room on the disk for `bytes` more, where the file system can: a full disk is then found
  /// before the library writes half of something.
  void reserve(std::size_t bytes);

 protected:
  explicit Hdf5Object(Hdf5Handle id) : id_(std::move(id)) {}
  Hdf5Handle id_;
};

/// Description of a dataset.
struct Meaning {
  std::string units;      // as CF has them: "mm", "s", "1"
  std::string long_name;  // a phrase for the label of a plot
};

class Hdf5Dataset : public Hdf5Object {
 public:
  /// Makes this dataset the scale of a dimension called `name`.
  void make_scale(const std::string& name);
  /// Gives the dimension (0 rows, 1 columns) its scale.
  void attach_scale(Hdf5Dataset& scale, unsigned dimension);

  /// Replaces numbers of a dataset of fixed size, from row `first` on.
  void write(std::size_t first, std::span<const double> values);
  /// Replaces one row of texts. What is longer than the room ends with "...".
  void write_text(std::size_t row, std::string_view text);

  /// Adds rows at the end of an extendible dataset: of each column one chunk, encoded as the
  /// dataset says. Only the last chunks may hold fewer rows than the chunks are long.
  void append(std::size_t rows, std::span<const std::vector<std::uint8_t>> chunks);

 private:
  friend class Hdf5Group;
  Hdf5Dataset(Hdf5Handle id, std::size_t columns, bool has_columns);

  std::size_t rows_ = 0;
  std::size_t columns_;
  bool has_columns_;
};

class Hdf5Group : public Hdf5Object {
 public:
  /// Opens or makes the group at a path below this one: "cases/table/servo". Groups are listed in
  /// the order in which they were made.
  Hdf5Group group(const std::string& path);

  /// Makes a group for about `children` whose names are no longer than `longest_name`: so many take
  /// their places by the change of one block of the file, which a kill does not cut in two.
  Hdf5Group group_with_room(const std::string& name, std::size_t children,
                            std::size_t longest_name);

  /// Moves what is at a path to another path, both below this group; the groups above are there.
  void move(const std::string& from, const std::string& to);

  /// Takes an empty group away.
  void remove(const std::string& name);

  /// An empty dataset (time) or, with `has_columns`, (time, columns), that grows by whole chunks of
  /// `chunk_rows` x 1, encoded with that compression (ChunkEncoder).
  Hdf5Dataset extendible(const std::string& name, std::size_t columns, bool has_columns,
                         std::size_t chunk_rows, Storage storage, int compression,
                         const Meaning& meaning);

  /// A dataset of `rows` numbers, all `fill` at first, that are replaced in any order. Its room is
  /// claimed at once and it never moves: once the file was flushed, rows that are written outlive a
  /// kill whenever it comes.
  Hdf5Dataset fixed(const std::string& name, std::size_t rows, Storage storage, double fill,
                    const Meaning& meaning);
  /// The same for texts of at most `width` bytes, empty at first: (rows, width) characters, as
  /// netCDF has them. Rows that stay empty take no room on the disk.
  Hdf5Dataset fixed_texts(const std::string& name, std::size_t rows, std::size_t width,
                          const std::string& long_name);
  /// A dataset that is there.
  Hdf5Dataset dataset(const std::string& name);

  /// One letter a column, as the scale of the dimension `name`.
  Hdf5Dataset labels(const std::string& name, std::string_view letters,
                     const std::string& long_name);

  /// One value.
  void scalar(const std::string& name, double value, const Meaning& meaning);

  /// Rows of `columns` values each. The names of two lists in this group are its dimensions; or of
  /// labels.
  void table(const std::string& name, std::size_t columns, std::span<const double> values,
             const Meaning& meaning, const std::string& row_scale, const std::string& column_scale);

  /// A list of values. With `scale`, the name of a list in this group of the same length, that one
  /// is its dimension; without, it is a dimension itself.
  void list(const std::string& name, std::span<const double> values, const Meaning& meaning,
            const std::string& scale = "");

 private:
  friend class OutputFile;
  explicit Hdf5Group(Hdf5Handle id) : Hdf5Object(std::move(id)) {}
};

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
  OutputFile(std::string path, bool force, Hdf5Handle file);

  std::string path_;
  std::string partial_path_;
  bool force_;
  std::unique_ptr<TemporaryFile> temporary_;  // where nothing stays without a commit
  Hdf5Handle file_;                           // closed before that one is removed
};

/// A file to read. Paths are absolute: "/cases/table/servo/time".
/// All members throw InputError that names the file and what it lacks.
class InputFile {
 public:
  /// @throws SystemError if another process writes it
  explicit InputFile(std::string path);

  const std::string& path() const { return path_; }
  bool has(const std::string& object) const;
  std::vector<std::string> groups(const std::string& group) const;    // in the order of making
  std::vector<std::string> datasets(const std::string& group) const;  // in the order of making

  /// Lengths of the dimensions; none for one value.
  std::vector<std::size_t> shape(const std::string& dataset) const;
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
  std::string text(const std::string& object, const std::string& name) const;
  double number(const std::string& object, const std::string& name) const;
  std::vector<double> numbers(const std::string& object, const std::string& name) const;

 private:
  [[noreturn]] void fail(const std::string& message) const;
  std::vector<std::string> children(const std::string& group, bool groups) const;
  Hdf5Handle open(const std::string& object) const;
  Hdf5Handle open_attribute(const std::string& object, const std::string& name) const;

  std::string path_;
  Hdf5Handle file_;
};

}  // namespace servomill::sim
