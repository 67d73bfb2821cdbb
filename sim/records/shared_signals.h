/// Equal signals of a result file, stored once: the others are further names of the same dataset
/// (hard links of HDF5).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/records/hdf5_group.h"
#include "sim/records/series.h"
#include "sim/records/series_writer.h"

namespace servomill::sim::records {

/// Long name of a dataset with several names, which says what it is under each of them:
/// "ref_linear: interpolated position = cmd_linear: setpoint".
std::string long_name_of_all(std::span<const Channel* const> channels);
/// The part of a long name that belongs to one name; of a dataset with one name, all of it.
std::string own_long_name(std::string_view long_name, std::string_view name);

class EncodedColumns;

/// Series that a file has, and which of their signals equal those of another one, bit for bit.
///
/// Within a series, channels of equal unit, labels and storage share a dataset if all their numbers
/// are equal; whole numbers and signals without labels never do. Between series, a dataset is
/// shared by channels of the same name and meaning, if the index is shared, too. Numbers are
/// compared in the chunks in which the file holds them.
class SharedSignals {
 public:
  /// Sets `same_as` of what is in the series or in the file already.
  /// @param file  any group of it
  /// @param pages  of the series, encoded
  /// @param layout  with chunk_rows and compression as it will be written
  void find(Hdf5Group& file, const Series& series, const ColumnPages& pages,
            SeriesLayout& layout) const;
  /// Adds a series that is in the file from now on.
  /// @param group  path of it, from the root
  /// @param layout  as find() left it
  void add(const std::string& group, std::size_t rows, const SeriesLayout& layout);

 private:
  struct Stored {
    Channel channel;  // same_as: its path
    bool is_drawn;
  };
  // Series with the same index.
  struct Family {
    std::size_t rows, chunk_rows;
    Channel index;                     // same_as: its path
    std::vector<ColumnLabels> labels;  // same_as: their paths
    std::vector<Stored> signals;
  };
  static void share(Hdf5Group& file, const Family& family, const Series& series,
                    EncodedColumns& encoded, SeriesLayout& layout);

  std::vector<Family> families_;
};

}  // namespace servomill::sim::records
