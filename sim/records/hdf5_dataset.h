/// Datasets of an HDF5 file that is being written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plant/vocabulary/stored_text.h"
#include "sim/records/hdf5_object.h"
#include "sim/records/meaning.h"

namespace servomill::sim::records {

class Hdf5Dataset : public Hdf5Object {
 public:
  /// Numbers of a row.
  std::size_t columns() const { return columns_; }

  /// Makes this dataset the scale of a dimension called `name`.
  void make_scale(const std::string& name);
  /// Gives the dimension (0 rows, 1 columns) its scale.
  void attach_scale(Hdf5Dataset& scale, unsigned dimension);
  /// Gives all dimensions their scales, which are not changed: they have no list of their datasets
  /// then, which no reader needs, but a kill cannot spoil them.
  /// @pre no dimension has one
  void refer_to_scales(std::span<Hdf5Dataset* const> scales);

  /// Replaces numbers of a dataset of fixed size, from row `first` on.
  void write(std::size_t first, std::span<const double> values);
  /// Fills a list of characters.
  /// @pre it is as long as the text
  void write(const StoredText& text);
  /// Replaces one row of texts. A text longer than the room ends with "...".
  void write_text(std::size_t row, std::string_view text);

  /// Adds rows at the end of an extendible dataset: of each column one chunk, encoded as the
  /// dataset says. Only the last chunks may hold fewer rows than the chunks are long.
  void append(std::size_t rows, std::span<const std::vector<std::uint8_t>> chunks);
  /// The chunk of a column that begins with this row, as it was appended.
  void read_chunk(std::size_t row, std::size_t column, std::vector<std::uint8_t>& chunk);

 private:
  friend class Hdf5Group;
  Hdf5Dataset(Hdf5Handle id, std::size_t columns);
  void write(std::size_t first, std::size_t count, std::int64_t type, const void* values);

  std::size_t rows_ = 0;
  std::size_t columns_;
};

}  // namespace servomill::sim::records
