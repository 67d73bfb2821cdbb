// Series in memory as a file holds them: the chunks of a ChunkEncoder.

#include "sim/records/encoded_series.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace servomill::sim::records::encoded_series_test {
namespace {

constexpr std::size_t kChunkRows = 16384, kColumns = 21;  // three groups of neighbours
constexpr PageFormat format(std::size_t chunk_rows) { return {chunk_rows, 1}; }

// Columns of all storages; the last but one equals the first, the last has its numbers as float32.
Series series(std::size_t rows) {
  std::vector<Signal> signals;
  for (std::size_t c = 0; c < kColumns; ++c) {
    Signal one{"c" + std::to_string(c), "mm", "signal", "", ""};
    if (c == 3) one.storage = Storage::int32;
    if (c == 4 || c == kColumns - 1) one.storage = Storage::float32;
    signals.push_back(one);
  }
  Series out(signals);
  std::vector<double> row(kColumns);
  for (std::size_t n = 0; n < rows; ++n) {
    for (std::size_t c = 0; c < kColumns; ++c) {
      row[c] = std::sin(0.01 * static_cast<double>(n) + static_cast<double>(c));
    }
    row[3] = std::floor(0.1 * static_cast<double>(n));
    row[kColumns - 2] = row[kColumns - 1] = row[0];
    out.append(row);
  }
  return out;
}

std::vector<std::vector<std::uint8_t>> chunks(const EncodedSeries& encoded) {
  std::vector<std::vector<std::uint8_t>> all;
  for (std::size_t first = 0; first < encoded.rows(); first += encoded.page_rows()) {
    for (std::size_t c = 0; c < kColumns; ++c) {
      EXPECT_TRUE(encoded.read_encoded(c, first / encoded.page_rows(), all.emplace_back()));
    }
  }
  return all;
}

TEST(EncodedSeries, HasTheChunksOfAnEncoder) {
  for (const std::size_t rows : {1u, 15u, 16u, 17u, 43u}) {
    const Series all = series(rows);
    const EncodedSeries encoded(all, format(16), 1);
    ChunkEncoder encoder(1);
    std::vector<double> values;
    std::vector<std::uint8_t> wanted, chunk;
    for (std::size_t page = 0; page * 16 < rows; ++page) {
      for (std::size_t c = 0; c < kColumns; ++c) {
        values.clear();
        const Storage storage = all.signals()[c].storage;
        for (std::size_t n = page * 16; n < std::min(rows, (page + 1) * 16); ++n) {
          const double value = all.at(n, c);
          values.push_back(storage == Storage::float32 ? static_cast<float>(value) : value);
        }
        encoder.encode(values, 16, storage, wanted);
        encoded.read_encoded(c, page, chunk);
        EXPECT_EQ(chunk, wanted) << rows << " rows, page " << page << ", column " << c;
        std::vector<double> read;
        encoded.read(c, page, read);
        EXPECT_EQ(read, values);
      }
    }
  }
}

TEST(EncodedSeries, HasNoneOfNoRows) {
  const Series none = series(0);
  const EncodedSeries encoded(none, format(16), 1);
  EXPECT_EQ(encoded.rows(), 0u);
  EXPECT_TRUE(chunks(encoded).empty());
}

TEST(EncodedSeries, IsTheSameForAnyNumberOfThreads) {
  const Series all = series(kChunkRows + 100);
  const auto one = chunks(EncodedSeries(all, format(kChunkRows), 1));
  for (const unsigned threads : {2u, 5u}) {
    EXPECT_TRUE(chunks(EncodedSeries(all, format(kChunkRows), threads)) == one) << threads;
  }
}

}  // namespace
}  // namespace servomill::sim::records::encoded_series_test
