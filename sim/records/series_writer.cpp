#include "sim/records/series_writer.h"

#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <utility>

namespace servomill::sim::records {
namespace {

// Room for what the library notes about a new chunk; a node of its index is about half of it.
constexpr std::size_t kBytesPerChunk = 8192;

constexpr std::size_t kRun = 64;  // chunks of a column next to each other, if all are there already

constexpr std::size_t kNeighbours = 8;  // doubles of a cache line

// Columns that are gathered side by side begin on different lines of the cache: a power of two
// apart, all of them would take the place of each other there.
constexpr std::size_t kApart = 8;

constexpr std::size_t kAhead = 16;  // rows, while which a line of the cache arrives from memory

void prefetch(const double* numbers) { __builtin_prefetch(numbers); }

constexpr std::size_t kValuesPerThread = 65536;  // fewer are encoded before a thread has started

std::size_t place_of(const std::vector<ColumnLabels>& labels, const std::string& name) {
  const auto at = std::find_if(labels.begin(), labels.end(),
                               [&name](const ColumnLabels& l) { return l.name == name; });
  assert(at != labels.end());
  return static_cast<std::size_t>(at - labels.begin());
}

}  // namespace

SeriesWriter::SeriesWriter(Hdf5Group group, SeriesLayout layout)
    : group_(std::move(group)), layout_(std::move(layout)) {
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
  if (!layout_.is_encoded) allocate();
  group_.flush_file();
}

void SeriesWriter::allocate() {
  if (!layout_.is_complete) {
    filling_.resize(layout_.chunk_rows * width_);
    writing_.resize(filling_.size());
  }
  chunks_.resize(width_);
  for (std::size_t begin = 0; begin < width_; begin += kNeighbours) {
    const std::size_t end = std::min(begin + kNeighbours, width_);
    neighbours_.push_back({begin, end,
                           std::vector<double>((end - begin) * (layout_.chunk_rows + kApart)),
                           ChunkEncoder(layout_.compression)});
  }
}

SeriesWriter::~SeriesWriter() {
  if (finished_) return;
  try {
    finish();
  } catch (...) {
    // whoever wants to know calls finish()
  }
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
  storage_.insert(storage_.end(), columns, channel.storage);
  shared_.insert(shared_.end(), columns, is_shared);
  width_ += columns;
}

std::size_t SeriesWriter::offset_of(std::string_view channel) const {
  for (std::size_t i = 0; i < layout_.channels.size(); ++i) {
    if (layout_.channels[i].name == channel) return datasets_[i + 1].offset;
  }
  assert(channel == layout_.index);
  return 0;
}

void SeriesWriter::append(std::span<const double> row) {
  assert(row.size() == width_ && !finished_ && !layout_.is_encoded && !layout_.is_complete);
  std::copy(row.begin(), row.end(), filling_.begin() + static_cast<std::ptrdiff_t>(rows_ * width_));
  if (++rows_ == layout_.chunk_rows) hand_over();
}

void SeriesWriter::append_all(std::span<const double> rows) {
  assert(rows.size() % width_ == 0 && layout_.is_complete && !finished_);
  while (!rows.empty()) {
    const std::size_t count = std::min(rows.size() / width_, layout_.chunk_rows);
    write_block(rows.data(), count);
    rows = rows.subspan(count * width_);
  }
}

void SeriesWriter::finish() {
  finished_ = true;
  if (rows_ > 0) hand_over();
  background_.wait();
}

void SeriesWriter::hand_over() {
  const std::size_t rows = std::exchange(rows_, 0);
  background_.wait();
  std::swap(filling_, writing_);
  background_.post([this, rows] { write_block(writing_.data(), rows); });
}

void SeriesWriter::encode(Neighbours& columns, const double* block, std::size_t rows) {
  const std::size_t apart = rows + kApart;
  for (std::size_t row = 0; row < rows; ++row) {
    const double* from = block + row * width_;
    if (row + kAhead < rows) prefetch(from + kAhead * width_ + columns.begin);
    double* to = columns.gathered.data() + row;
    for (std::size_t c = columns.begin; c < columns.end; ++c, to += apart) *to = from[c];
  }
  const double* values = columns.gathered.data();
  for (std::size_t c = columns.begin; c < columns.end; ++c, values += apart) {
    if (shared_[c]) continue;
    columns.encoder.encode({values, rows}, layout_.chunk_rows, storage_[c], chunks_[c]);
  }
}

void SeriesWriter::write_block(const double* block, std::size_t rows) {
  const auto useful = static_cast<unsigned>(1 + rows * width_ / kValuesPerThread);
  system::for_each_index(neighbours_.size(),
                         std::min(system::thread_count(layout_.threads), useful),
                         [&](std::size_t i) { encode(neighbours_[i], block, rows); });
  std::size_t bytes = width_ * kBytesPerChunk;
  for (const auto& chunk : chunks_) bytes += chunk.size();
  group_.reserve(bytes);
  for (Dataset& one : datasets_) {
    if (one.is_shared) continue;
    one.dataset.append(rows, std::span(chunks_).subspan(one.offset, one.columns));
  }
  group_.flush_file();
}

void SeriesWriter::append_pages(const ColumnPages& pages) {
  assert(layout_.is_encoded && !finished_ && pages.page_rows() == layout_.chunk_rows);
  const std::size_t count = (pages.rows() + pages.page_rows() - 1) / pages.page_rows();
  for (std::size_t first = 0; first < count; first += kRun) {
    const std::size_t last = std::min(first + kRun, count);
    for (Dataset& one : datasets_) {
      if (!one.is_shared) write_pages(one, pages, first, last);
    }
    group_.flush_file();
  }
}

void SeriesWriter::write_pages(Dataset& to, const ColumnPages& pages, std::size_t first,
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

}  // namespace servomill::sim::records
