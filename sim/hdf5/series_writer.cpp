#include "sim/hdf5/series_writer.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace servomill::sim {
namespace {

// Room for what the library notes about a new chunk; a node of its index is about half of it.
constexpr std::size_t kBytesPerChunk = 8192;

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
    scales.push_back(group_.labels(labels.name, labels.letters, labels.long_name));
  }
  add_channel({layout_.index, layout_.index_meaning, "", Storage::float64, 0.0}, scales);
  for (const Channel& channel : layout_.channels) add_channel(channel, scales);

  // all memory
  std::size_t most_columns = 1;
  for (const Column& column : columns_) most_columns = std::max(most_columns, column.columns);
  block_.resize(layout_.chunk_rows * width_);
  gathered_.resize(layout_.chunk_rows * most_columns);
  reserved_bytes_ = block_.size() * sizeof(double) + width_ * kBytesPerChunk;
  group_.flush_file();
}

SeriesWriter::~SeriesWriter() {
  if (finished_) return;
  try {
    finish();
  } catch (const SystemError&) {
    // whoever wants to know calls finish()
  }
}

void SeriesWriter::add_channel(const Channel& channel, std::vector<Hdf5Dataset>& scales) {
  const bool has_columns = !channel.labels.empty();
  const std::size_t labels = has_columns ? place_of(layout_.labels, channel.labels) : 0;
  const std::size_t columns = has_columns ? layout_.labels[labels].letters.size() : 1;
  Hdf5Dataset dataset = group_.extendible(channel.name, columns, has_columns, layout_.chunk_rows,
                                          channel.storage, channel.meaning);
  if (columns_.empty()) {
    dataset.make_scale(channel.name);
  } else {
    dataset.attach_scale(columns_.front().dataset, 0);
  }
  if (has_columns) {
    dataset.attach_scale(scales[labels], 1);
    dataset.attribute("columns", layout_.labels[labels].letters);  // for readers without scales
  }
  columns_.push_back({std::move(dataset), width_, columns, channel.quantum});
  width_ += columns;
}

std::size_t SeriesWriter::offset_of(std::string_view channel) const {
  for (std::size_t i = 0; i < layout_.channels.size(); ++i) {
    if (layout_.channels[i].name == channel) return columns_[i + 1].offset;
  }
  assert(channel == layout_.index);
  return 0;
}

void SeriesWriter::append(std::span<const double> row) {
  assert(row.size() == width_ && !finished_);
  std::copy(row.begin(), row.end(), block_.begin() + static_cast<std::ptrdiff_t>(rows_ * width_));
  if (++rows_ == layout_.chunk_rows) write_block();
}

void SeriesWriter::finish() {
  finished_ = true;
  if (rows_ > 0) write_block();
}

void SeriesWriter::gather(const Column& column, std::size_t rows) {
  double* out = gathered_.data();
  for (std::size_t row = 0; row < rows; ++row) {
    out = std::copy_n(block_.data() + row * width_ + column.offset, column.columns, out);
  }
  if (column.quantum <= 0.0) return;
  for (double* value = gathered_.data(); value != out; ++value) {
    *value = std::nearbyint(*value / column.quantum) * column.quantum;
  }
}

void SeriesWriter::write_block() {
  const std::size_t rows = std::exchange(rows_, 0);
  group_.reserve(reserved_bytes_);
  for (Column& column : columns_) {
    gather(column, rows);
    column.dataset.append(gathered_.data(), rows);
  }
  group_.flush_file();
}

}  // namespace servomill::sim
