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
    : storage_(std::move(storage)), chunk_rows_(format.chunk_rows), chunk_of_(storage_.size()) {
  assert(threads > 0);
  for (unsigned t = 0; t < threads; ++t) encoders_.emplace_back(format.compression);
}

void PageEncoder::encode(std::span<const std::span<const double>> columns) {
  assert(columns.size() == storage_.size());
  first_.clear();
  for (std::size_t c = 0; c < columns.size(); ++c) chunk_of_[c] = chunk_of(columns, c);
  if (chunks_.size() < first_.size()) chunks_.resize(first_.size());
  const std::size_t values = columns.empty() ? 0 : columns.size() * columns.front().size();
  const auto useful = static_cast<unsigned>(1 + values / kValuesPerThread);
  encode_first(columns, std::min(static_cast<unsigned>(encoders_.size()), useful));
}

// The chunk of an earlier column with the same numbers, or a new one.
std::size_t PageEncoder::chunk_of(Columns columns, std::size_t column) {
  const auto same = std::find_if(first_.begin(), first_.end(), [&](std::size_t earlier) {
    return storage_[earlier] == storage_[column] && is_same(columns[earlier], columns[column]);
  });
  const auto chunk = static_cast<std::size_t>(same - first_.begin());
  if (same == first_.end()) first_.push_back(column);
  return chunk;
}

void PageEncoder::encode_first(Columns columns, unsigned threads) {
  std::atomic<std::size_t> next = 0;
  system::for_each_index(threads, threads, [&](std::size_t thread) {
    for (std::size_t i = next++; i < first_.size(); i = next++) {
      const std::size_t c = first_[i];
      encoders_[thread].encode(columns[c], chunk_rows_, storage_[c], chunks_[i]);
    }
  });
}

}  // namespace servomill::sim::records
