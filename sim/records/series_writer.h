/// Datasets of one group with the same rows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/records/hdf5_group.h"
#include "sim/records/nexus.h"
#include "sim/records/series.h"

namespace servomill::sim::records {

/// Names of the columns: `{"axis_linear", "XYZ", "linear axis"}`; one letter a column.
struct ColumnLabels {
  std::string name;
  std::string letters;
  std::string long_name;
  std::string same_as = {};  // path of the dataset that has them already; empty: none
};

/// One dataset: a number a row, or as many as its labels have letters.
struct Channel {
  std::string name;
  Meaning meaning;
  std::string labels;  // name of its ColumnLabels; empty: one number a row
  Storage storage = Storage::float64;
  std::string same_as = {};  // path of the dataset that has its numbers already; empty: none
};

/// An index whose row i is i * ticks * tick, to the bit.
struct EvenSteps {
  std::int64_t ticks;
  double tick;
};

/// Layout of a series. The index is the dimension that all share and the first number of a
/// row; a list of probed points would have {"point", {"1", "number of the point"}}.
struct SeriesLayout {
  std::string index = "time";
  Meaning index_meaning = {"s", "time"};
  std::optional<EvenSteps> index_steps = {};  // said to readers, who need not read the index then
  std::string index_same_as = {};             // as that of a channel
  std::vector<ColumnLabels> labels;
  std::vector<Channel> channels;
  Plot plot = {};  // what viewers draw; without a signal, nothing
  std::size_t chunk_rows = 16384;
  int compression = 1;  // kNoCompression to kMaxCompression
};

/// Writes a series: a flat list of numbers a row, the index, then the channels in the order of the
/// layout. Those that are `same_as` a dataset of the file are further names of that, whose numbers
/// are left alone. Some hundred kilobytes or more of a column lie next to each other in the file,
/// so that one signal is read without the others.
/// @param pages  encoded, with the rows and compression of a chunk as the layout says
/// @pre  every name is there once, every `labels` of a channel exists
/// @throws SystemError
void write_pages(Hdf5Group group, const SeriesLayout& layout, const ColumnPages& pages);

}  // namespace servomill::sim::records
