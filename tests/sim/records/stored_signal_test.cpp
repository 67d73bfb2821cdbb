#include "sim/records/stored_signal.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/records/chunk_decoder.h"

namespace servomill::sim::records::stored_signal_test {
namespace {

constexpr std::size_t kMany = 40'001;  // three chunks

double value(std::size_t n) { return std::sin(1e-3 * static_cast<double>(n * n)); }

StoredSignal stored(const std::shared_ptr<SignalStore>& store, std::size_t size) {
  StoredSignal out(store, size);
  for (std::size_t n = 0; n < size; ++n) out.append(value(n));
  return out;
}

void expect_all(const StoredSignal& signal, std::size_t size) {
  const std::vector<double> values = signal.all();
  ASSERT_EQ(values.size(), size);
  for (std::size_t n = 0; n < size; ++n) ASSERT_EQ(values[n], value(n)) << n;
}

TEST(StoredSignal, ReadsWhatWasPutIn) {
  for (const std::size_t in_memory : {std::size_t{0}, std::size_t{200'000}, std::size_t{1} << 30}) {
    const auto store = std::make_shared<SignalStore>(testing::TempDir(), in_memory);
    const StoredSignal few = stored(store, 3), many = stored(store, kMany), one = stored(store, 1);
    expect_all(few, 3);
    expect_all(many, kMany);
    expect_all(one, 1);
    EXPECT_EQ(many.chunks(), 3U);
  }
}

TEST(StoredSignal, SeveralReadersGoTheirOwnWay) {
  const StoredSignal signal = stored(std::make_shared<SignalStore>(testing::TempDir(), 0), kMany);
  StoredSignal::Reader one(signal), other(signal);
  for (std::size_t n = 0; n < kMany / 2; ++n) one.next();
  EXPECT_EQ(other.next(), value(0));
  EXPECT_EQ(one.next(), value(kMany / 2));
  EXPECT_EQ(other.next(), value(1));
}

TEST(StoredSignal, KeepsChunksAsAFileHoldsThem) {
  const StoredSignal signal = stored(std::make_shared<SignalStore>(testing::TempDir(), 0), kMany);
  const std::size_t last = signal.chunks() - 1;
  std::vector<double> values(signal.rows_of(last));
  ChunkDecoder().decode(signal.encoded(last), signal.chunk_rows(), Storage::float64,
                        SignalStore::kCompression, values);
  EXPECT_EQ(values.front(), value(last * signal.chunk_rows()));
  EXPECT_EQ(values.back(), value(kMany - 1));
}

TEST(StoredSignal, WithoutValuesIsEmpty) {
  EXPECT_TRUE(StoredSignal().empty());
  EXPECT_TRUE(StoredSignal().all().empty());
}

}  // namespace
}  // namespace servomill::sim::records::stored_signal_test
