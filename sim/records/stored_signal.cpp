#include "sim/records/stored_signal.h"

#include <algorithm>
#include <cassert>
#include <filesystem>
#include <optional>
#include <utility>

#include "sim/records/chunk_decoder.h"
#include "sim/records/chunk_encoder.h"
#include "sim/records/series_spool.h"

namespace servomill::sim::records {

struct SignalStore::Parts {
  // Bytes of a chunk, here or in the file.
  struct Chunk {
    std::vector<std::uint8_t> bytes;
    std::uint64_t place = 0;
    std::size_t size = 0;
  };

  std::string folder;
  std::size_t left_in_memory = 0;
  std::vector<Chunk> chunks;
  std::optional<ScratchFile> file;
  ChunkEncoder encoder{kCompression};
  ChunkDecoder decoder;
  std::vector<std::uint8_t> encoded;
};

SignalStore::SignalStore(std::string folder, std::size_t most_in_memory)
    : parts_(std::make_unique<Parts>()) {
  parts_->folder =
      folder.empty() ? std::filesystem::temp_directory_path().string() : std::move(folder);
  parts_->left_in_memory = most_in_memory;
}

SignalStore::~SignalStore() = default;

std::size_t SignalStore::add(std::span<const double> values, std::size_t chunk_rows) {
  Parts& p = *parts_;
  p.encoder.encode(values, chunk_rows, Storage::float64, p.encoded);
  Parts::Chunk chunk;
  chunk.size = p.encoded.size();
  if (chunk.size <= p.left_in_memory) {
    p.left_in_memory -= chunk.size;
    chunk.bytes = p.encoded;
  } else {
    if (!p.file) p.file.emplace(p.folder, "recorded signals");
    chunk.place = p.file->append(p.encoded);
  }
  p.chunks.push_back(std::move(chunk));
  return p.chunks.size() - 1;
}

std::vector<std::uint8_t> SignalStore::encoded(std::size_t chunk) const {
  const Parts::Chunk& from = parts_->chunks[chunk];
  if (!from.bytes.empty()) return from.bytes;
  std::vector<std::uint8_t> out(from.size);
  parts_->file->read(from.place, out);
  return out;
}

void SignalStore::read(std::size_t chunk, std::size_t chunk_rows, std::span<double> values) {
  parts_->decoder.decode(encoded(chunk), chunk_rows, Storage::float64, kCompression, values);
}

StoredSignal::StoredSignal(std::shared_ptr<SignalStore> store, std::size_t size)
    : store_(std::move(store)), size_(size), chunk_rows_(even_chunk_rows(size)) {}

void StoredSignal::append(double value) {
  assert(come_ < size_);
  if (filling_.empty()) filling_.reserve(chunk_rows_);
  filling_.push_back(value);
  if (++come_ < size_ && filling_.size() < chunk_rows_) return;
  chunks_.push_back(store_->add(filling_, chunk_rows_));
  filling_.clear();
  if (come_ == size_) filling_ = {};
}

std::size_t StoredSignal::rows_of(std::size_t chunk) const {
  return std::min(chunk_rows_, size_ - chunk * chunk_rows_);
}

std::vector<std::uint8_t> StoredSignal::encoded(std::size_t chunk) const {
  return store_->encoded(chunks_[chunk]);
}

std::vector<double> StoredSignal::all() const {
  std::vector<double> out(size_);
  Reader values(*this);
  for (double& value : out) value = values.next();
  return out;
}

double StoredSignal::Reader::next() {
  if (at_ == values_.size()) {
    assert(chunk_ < signal_->chunks());
    values_.resize(signal_->rows_of(chunk_));
    signal_->store_->read(signal_->chunks_[chunk_++], signal_->chunk_rows_, values_);
    at_ = 0;
  }
  return values_[at_++];
}

}  // namespace servomill::sim::records
