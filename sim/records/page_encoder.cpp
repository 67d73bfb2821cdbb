#include "sim/records/page_encoder.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cstring>
#include <utility>

#include "sim/system/worker_thread.h"

namespace servomill::sim::records {
namespace {

constexpr std::size_t kValuesPerThread = 65536;  // fewer are encoded before a thread has started

bool is_same(std::span<const double> one, std::span<const double> other) {
  return std::memcmp(one.data(), other.data(), one.size_bytes()) == 0;
}

}  // namespace

PageEncoder::PageEncoder(std::vector<Storage> storage, const PageFormat& format, unsigned threads)
    : storage_(std::move(storage)),
      chunk_rows_(format.chunk_rows),
      gathered_(storage_.size()),
      chunk_of_(storage_.size()) {
  assert(threads > 0);
  for (unsigned t = 0; t < threads; ++t) encoders_.emplace_back(format.compression);
}

void PageEncoder::encode(std::span<const double> rows) {
  gathered_.begin(rows);
  const auto useful = static_cast<unsigned>(1 + rows.size() / kValuesPerThread);
  const unsigned threads = std::min(static_cast<unsigned>(encoders_.size()), useful);
  system::for_each_index(gathered_.groups(), threads,
                         [&](std::size_t group) { gathered_.gather(group); });
  columns_.clear();
  for (std::size_t c = 0; c < storage_.size(); ++c) chunk_of_[c] = chunk_of(c);
  if (chunks_.size() < columns_.size()) chunks_.resize(columns_.size());
  encode_columns(threads);
}

// The chunk of an earlier column with the same numbers, or a new one.
std::size_t PageEncoder::chunk_of(std::size_t column) {
  const auto same = std::find_if(columns_.begin(), columns_.end(), [&](std::size_t earlier) {
    return storage_[earlier] == storage_[column] &&
           is_same(gathered_.column(earlier), gathered_.column(column));
  });
  const auto chunk = static_cast<std::size_t>(same - columns_.begin());
  if (same == columns_.end()) columns_.push_back(column);
  return chunk;
}

void PageEncoder::encode_columns(unsigned threads) {
  std::atomic<std::size_t> next = 0;
  system::for_each_index(threads, threads, [&](std::size_t thread) {
    for (std::size_t i = next++; i < columns_.size(); i = next++) {
      const std::size_t c = columns_[i];
      encoders_[thread].encode(gathered_.column(c), chunk_rows_, storage_[c], chunks_[i]);
    }
  });
}

}  // namespace servomill::sim::records
