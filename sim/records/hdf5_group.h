/// Groups of an HDF5 file that is being written, and the datasets that they make.
///
/// h5py, xarray, netCDF and Octave open what is written: every dataset has the attributes `units`
/// and `long_name`, and a dimension scale for each of its dimensions. Texts are attributes.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "plant/vocabulary/stored_text.h"
#include "sim/records/chunk_encoder.h"
#include "sim/records/hdf5_dataset.h"

namespace servomill::sim::records {

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

  /// Gives a dataset of this file one name more, in this group; nothing is copied.
  /// @param from  its path below this group or, with "/" at its begin, below the root
  void link(const std::string& from, const std::string& name);

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

  /// One letter a column, as the scale of the dimension `name`. xarray selects by it:
  /// `sel(axis_linear="Y")`.
  Hdf5Dataset labels(const std::string& name, std::string_view letters,
                     const std::string& long_name);

  /// A text: an attribute or, of more than a megabyte, a list of characters of that name, which is
  /// compressed and written in pieces.
  void write_text(const std::string& name, const StoredText& text);

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
  /// The same of whole numbers, stored as int32.
  void counts(const std::string& name, std::span<const double> values, const Meaning& meaning,
              const std::string& scale = "");

 private:
  friend class OutputFile;
  void list(Storage storage, const std::string& name, std::span<const double> values,
            const Meaning& meaning, const std::string& scale);
  struct Layout;
  explicit Hdf5Group(Hdf5Handle id) : Hdf5Object(std::move(id)) {}
  Hdf5Dataset create(const std::string& name, const Layout& layout, const Meaning& meaning);
};

}  // namespace servomill::sim::records
