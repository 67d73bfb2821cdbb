#include "sim/records/series_writer.h"

#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <utility>

namespace servomill::sim::records {
namespace {

// Room for what the library notes about a new chunk; a node of its index is about half of it.
constexpr std::size_t kBytesPerChunk = 8192;

constexpr std::size_t kRun = 64;  // chunks of a column next to each other, if there are so many

std::size_t place_of(const std::vector<ColumnLabels>& labels, const std::string& name) {
  const auto at = std::find_if(labels.begin(), labels.end(),
                               [&name](const ColumnLabels& l) { return l.name == name; });
  assert(at != labels.end());
  return static_cast<std::size_t>(at - labels.begin());
}

// Makes the datasets of a series, then fills them.
class SeriesWriter {
 public:
  SeriesWriter(Hdf5Group group, const SeriesLayout& layout);
  void write(const ColumnPages& pages);

 private:
  struct Dataset {
    Hdf5Dataset dataset;
    std::size_t offset;  // in a row
    std::size_t columns;
    bool is_shared;  // its numbers are there already
  };

  Hdf5Dataset make(const Channel& channel, std::vector<Hdf5Dataset>& scales);
  void add_channel(const Channel& channel, std::vector<Hdf5Dataset>& scales);
  void write_run(Dataset& to, const ColumnPages& pages, std::size_t first, std::size_t last);

  Hdf5Group group_;
  const SeriesLayout& layout_;
  std::vector<Dataset> datasets_;  // the index first
  std::size_t width_ = 0;
};

SeriesWriter::SeriesWriter(Hdf5Group group, const SeriesLayout& layout)
    : group_(std::move(group)), layout_(layout) {
  // all datasets, with their scales
  std::vector<Hdf5Dataset> scales;
  for (const ColumnLabels& labels : layout_.labels) {
    if (!labels.same_as.empty()) group_.link(labels.same_as, labels.name);
    scales.push_back(labels.same_as.empty()
                         ? group_.labels(labels.name, labels.letters, labels.long_name)
                         : group_.dataset(labels.name));
  }
  add_channel({layout_.index, layout_.index_meaning, "", Storage::float64, layout_.index_same_as},
              scales);
  if (layout_.index_steps && layout_.index_same_as.empty()) {
    Hdf5Dataset& index = datasets_.front().dataset;
    index.attribute("sampling_ticks", layout_.index_steps->ticks);
    index.attribute("tick", layout_.index_steps->tick);
  }
  for (const Channel& channel : layout_.channels) add_channel(channel, scales);
  if (!layout_.plot.signal.empty()) make_nexus_data(group_, layout_.plot);
  group_.flush_file();
}

// Makes a dataset of its own, with its scales.
Hdf5Dataset SeriesWriter::make(const Channel& channel, std::vector<Hdf5Dataset>& scales) {
  const bool has_columns = !channel.labels.empty();
  const std::size_t labels = has_columns ? place_of(layout_.labels, channel.labels) : 0;
  const std::size_t columns = has_columns ? layout_.labels[labels].letters.size() : 1;
  Hdf5Dataset dataset = group_.extendible(channel.name, columns, has_columns, layout_.chunk_rows,
                                          channel.storage, layout_.compression, channel.meaning);
  if (datasets_.empty()) {
    dataset.make_scale(channel.name);
    return dataset;
  }
  std::vector<Hdf5Dataset*> of_dimensions = {&datasets_.front().dataset};
  if (has_columns) of_dimensions.push_back(&scales[labels]);
  if (layout_.index_same_as.empty()) {
    for (unsigned i = 0; i < of_dimensions.size(); ++i) dataset.attach_scale(*of_dimensions[i], i);
  } else {
    dataset.refer_to_scales(of_dimensions);
  }
  if (has_columns) {
    dataset.attribute("columns", layout_.labels[labels].letters);  // for readers without scales
  }
  return dataset;
}

void SeriesWriter::add_channel(const Channel& channel, std::vector<Hdf5Dataset>& scales) {
  const bool is_shared = !channel.same_as.empty();
  if (is_shared) group_.link(channel.same_as, channel.name);
  Hdf5Dataset dataset = is_shared ? group_.dataset(channel.name) : make(channel, scales);
  const std::size_t columns = dataset.columns();
  datasets_.push_back({std::move(dataset), width_, columns, is_shared});
  width_ += columns;
}

void SeriesWriter::write(const ColumnPages& pages) {
  assert(pages.page_rows() == layout_.chunk_rows);
  const std::size_t count = (pages.rows() + pages.page_rows() - 1) / pages.page_rows();
  for (std::size_t first = 0; first < count; first += kRun) {
    const std::size_t last = std::min(first + kRun, count);
    for (Dataset& one : datasets_) {
      if (!one.is_shared) write_run(one, pages, first, last);
    }
    group_.flush_file();
  }
}

void SeriesWriter::write_run(Dataset& to, const ColumnPages& pages, std::size_t first,
                             std::size_t last) {
  std::vector<std::vector<std::uint8_t>> chunks(to.columns);
  for (std::size_t page = first; page < last; ++page) {
    std::size_t bytes = to.columns * kBytesPerChunk;
    for (std::size_t c = 0; c < to.columns; ++c) {
      if (!pages.read_encoded(to.offset + c, page, chunks[c])) {
        throw std::logic_error("recorded signals are not encoded");
      }
      bytes += chunks[c].size();
    }
    group_.reserve(bytes);
    const std::size_t rows = std::min(pages.page_rows(), pages.rows() - page * pages.page_rows());
    to.dataset.append(rows, chunks);
  }
}

}  // namespace

void write_pages(Hdf5Group group, const SeriesLayout& layout, const ColumnPages& pages) {
  SeriesWriter(std::move(group), layout).write(pages);
}

}  // namespace servomill::sim::records
