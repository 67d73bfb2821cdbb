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
    : format_(std::move(format)),
      storage_(Series(signals).storage_of_columns()),
      filling_(storage_.size()),
      working_(storage_.size()) {
  for (std::size_t c = 0; c < format_.kept.size(); ++c) {
    if (format_.kept[c]) kept_.push_back(c);
  }
  if (format_.most_in_memory <= 0.0) file();
  filling_.reserve(page_rows());
  encoder_.emplace(storage_, format_.page, 1);
  if (format_.encodes_beside) background_.emplace();
}

void SeriesSpool::append(std::span<const double> rows) {
  const std::size_t width = storage_.size();
  assert(rows.size() % width == 0);
  while (!rows.empty()) {
    const std::size_t count = std::min(rows.size() / width, page_rows() - filling_.rows());
    filling_.append(rows.first(count * width));
    rows = rows.subspan(count * width);
    if (filling_.rows() == page_rows()) hand_over();
  }
}

void SeriesSpool::hand_over() {
  if (!background_) {
    write_page(filling_);
    return filling_.clear();
  }
  background_->wait();
  std::swap(filling_, working_);
  filling_.clear();
  filling_.reserve(page_rows());
  background_->post([this] { write_page(working_); });
}

void SeriesSpool::finish() {
  if (background_) background_->wait();
  background_.reset();
  if (pages_ == 0 && filling_.rows() > 0) {  // fewer rows came than were expected
    format_.page.chunk_rows = filling_.rows();
    encoder_.emplace(storage_, format_.page, 1);
  }
  if (filling_.rows() > 0) write_page(filling_);
  filling_ = working_ = ColumnTable();
  encoder_.reset();
}

void SeriesSpool::write_page(const ColumnTable& page) {
  std::vector<std::span<const double>> columns;
  for (std::size_t c = 0; c < storage_.size(); ++c) columns.push_back(page.column(c));
  encoder_->encode(columns);
  std::vector<Chunk> written;
  for (const std::vector<std::uint8_t>& chunk : encoder_->chunks())
    written.push_back(stored(chunk));
  for (const std::size_t chunk : encoder_->chunk_of_columns()) {
    chunks_.push_back(written[chunk]);
    bytes_ += written[chunk].size;
  }
  for (const std::size_t c : kept_) numbers_.emplace_back(columns[c].begin(), columns[c].end());
  rows_ += page.rows();
  ++pages_;
}

SeriesSpool::Chunk SeriesSpool::stored(const std::vector<std::uint8_t>& chunk) {
  const auto size = static_cast<std::uint32_t>(chunk.size());
  bytes_stored_ += size;
  if (bytes_stored_ > format_.most_in_memory) return {file().append(chunk), size, true};
  in_memory_.push_back(chunk);
  return {in_memory_.size() - 1, size, false};
}

ScratchFile& SeriesSpool::file() {
  if (!file_) file_.emplace(format_.folder, "recorded signals");
  return *file_;
}

std::uint64_t SeriesSpool::bytes() const {
  if (background_) background_->wait();
  return bytes_;
}

std::size_t SeriesSpool::rows_encoded() const {
  if (background_) background_->wait();
  return pages_ * page_rows();
}

std::size_t SeriesSpool::rows_in(std::size_t page) const {
  return std::min(page_rows(), rows_ - page * page_rows());
}

bool SeriesSpool::read_encoded(std::size_t column, std::size_t page,
                               std::vector<std::uint8_t>& chunk) const {
  const Chunk& at = chunks_.at(page * storage_.size() + column);
  if (!at.is_on_disk) {
    chunk = in_memory_[at.place];
    return true;
  }
  chunk.resize(at.size);
  file_->read(at.place, chunk);
  return true;
}

void SeriesSpool::read(std::size_t column, std::size_t page, std::vector<double>& values) const {
  const auto kept = std::lower_bound(kept_.begin(), kept_.end(), column);
  if (kept != kept_.end() && *kept == column) {
    values = numbers_[page * kept_.size() + static_cast<std::size_t>(kept - kept_.begin())];
    return;
  }
  read_encoded(column, page, encoded_);
  values.resize(rows_in(page));
  decoder_.decode(encoded_, page_rows(), storage_[column], format_.page.compression, values);
}

}  // namespace servomill::sim::records
