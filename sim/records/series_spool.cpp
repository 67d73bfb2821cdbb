#include "sim/records/series_spool.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace servomill::sim::records {

std::size_t even_chunk_rows(std::size_t rows) {
  constexpr std::size_t kMaxRows = 16384;
  const std::size_t chunks = std::max<std::size_t>(1, (rows + kMaxRows - 1) / kMaxRows);
  return std::max<std::size_t>(1, (rows + chunks - 1) / chunks);
}

SeriesSpool::SeriesSpool(const std::vector<Signal>& signals, SpoolFormat format)
    : format_(format.page),
      storage_(Series(signals).storage_of_columns()),
      file_(std::move(format.folder), "recorded signals"),
      encoder_(storage_, format_, 1) {
  filling_.reserve(format_.chunk_rows * storage_.size());
}

void SeriesSpool::append(std::span<const double> rows) {
  const std::size_t full = format_.chunk_rows * storage_.size();
  while (!rows.empty()) {
    const std::size_t count = std::min(rows.size(), full - filling_.size());
    filling_.insert(filling_.end(), rows.begin(),
                    rows.begin() + static_cast<std::ptrdiff_t>(count));
    rows = rows.subspan(count);
    if (filling_.size() == full) write_page();
  }
}

void SeriesSpool::finish() {
  assert(filling_.size() % storage_.size() == 0);
  if (!filling_.empty()) write_page();
  filling_ = {};
}

void SeriesSpool::write_page() {
  encoder_.encode(filling_);
  std::vector<Chunk> written;
  for (const std::vector<std::uint8_t>& chunk : encoder_.chunks()) {
    written.push_back({file_.append(chunk), static_cast<std::uint32_t>(chunk.size())});
  }
  for (const std::size_t chunk : encoder_.chunk_of_columns()) {
    chunks_.push_back(written[chunk]);
    bytes_ += written[chunk].size;
  }
  rows_ += filling_.size() / storage_.size();
  filling_.clear();
  ++pages_;
}

std::size_t SeriesSpool::rows_in(std::size_t page) const {
  return std::min(format_.chunk_rows, rows_ - page * format_.chunk_rows);
}

bool SeriesSpool::read_encoded(std::size_t column, std::size_t page,
                               std::vector<std::uint8_t>& chunk) const {
  const Chunk& at = chunks_.at(page * storage_.size() + column);
  chunk.resize(at.size);
  file_.read(at.place, chunk);
  return true;
}

void SeriesSpool::read(std::size_t column, std::size_t page, std::vector<double>& values) const {
  read_encoded(column, page, encoded_);
  values.resize(rows_in(page));
  decoder_.decode(encoded_, format_.chunk_rows, storage_[column], format_.compression, values);
}

}  // namespace servomill::sim::records
