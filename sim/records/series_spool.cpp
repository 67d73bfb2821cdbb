#include "sim/records/series_spool.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace servomill::sim::records {
namespace {

std::vector<Storage> storage_of_columns(const std::vector<Signal>& signals) {
  std::vector<Storage> out;
  for (const Signal& signal : signals) out.insert(out.end(), signal.columns(), signal.storage);
  return out;
}

}  // namespace

std::size_t even_chunk_rows(std::size_t rows) {
  constexpr std::size_t kMaxRows = 16384;
  const std::size_t chunks = std::max<std::size_t>(1, (rows + kMaxRows - 1) / kMaxRows);
  return std::max<std::size_t>(1, (rows + chunks - 1) / chunks);
}

SeriesSpool::SeriesSpool(const std::vector<Signal>& signals, SpoolFormat format)
    : format_(std::move(format)),
      storage_(storage_of_columns(signals)),
      file_(format_.folder, "recorded signals"),
      encoder_(format_.compression) {
  filling_.reserve(format_.chunk_rows * storage_.size());
}

void SeriesSpool::append(std::span<const double> rows) {
  const std::size_t full = format_.chunk_rows * storage_.size();
  while (!rows.empty()) {
    const std::size_t count = std::min(rows.size(), full - filling_.size());
    filling_.insert(filling_.end(), rows.begin(),
                    rows.begin() + static_cast<std::ptrdiff_t>(count));
    rows = rows.subspan(count);
    if (filling_.size() == full) write_chunk(format_.chunk_rows);
  }
}

void SeriesSpool::finish() {
  assert(filling_.size() % storage_.size() == 0);
  if (!filling_.empty()) write_chunk(filling_.size() / storage_.size());
  filling_ = {};
  gathered_ = {};
}

void SeriesSpool::write_chunk(std::size_t rows) {
  gathered_.resize(rows);
  for (std::size_t column = 0; column < storage_.size(); ++column) {
    const double* from = filling_.data() + column;
    for (std::size_t row = 0; row < rows; ++row, from += storage_.size()) gathered_[row] = *from;
    encoder_.encode(gathered_, format_.chunk_rows, storage_[column], encoded_);
    const std::uint64_t place = file_.append(encoded_);
    chunks_.push_back({place, static_cast<std::uint32_t>(encoded_.size())});
  }
  filling_.clear();
  rows_ += rows;
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
