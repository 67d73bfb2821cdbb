#include "sim/records/series_spool.h"

#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <filesystem>

#include "sim/system/system_error.h"

namespace servomill::sim::records::series_spool_test {
namespace {

constexpr std::size_t kChunkRows = 100;
constexpr std::size_t kRows = 5 * kChunkRows + 7;  // the last chunk is not full

std::vector<Signal> signals() {
  return {{"time", "s", "", "", ""},
          {"p", "mm", "", "XYZ", "xyz"},
          {"single", "um", "", "", "", 0, Storage::float32},
          {"count", "1", "", "", "", 0, Storage::int32}};
}

// Rows of signals() that their storage holds exactly.
std::vector<double> rows() {
  boost::random::mt19937 random(1);
  const boost::random::uniform_real_distribution<double> any(-100.0, 100.0);
  std::vector<double> out;
  for (std::size_t n = 0; n < kRows; ++n) {
    for (int i = 0; i < 4; ++i) out.push_back(any(random));
    out.push_back(static_cast<double>(static_cast<float>(any(random))));
    out.push_back(static_cast<double>(n));
  }
  return out;
}

std::string folder() { return testing::TempDir(); }

Series spooled(const SpoolFormat& format, const std::vector<double>& rows) {
  auto spool = std::make_shared<SeriesSpool>(signals(), format);
  // in portions that do not fit the chunks
  const std::span<const double> all(rows);
  const std::size_t portion = 6 * 37;
  for (std::size_t from = 0; from < all.size(); from += portion) {
    spool->append(all.subspan(from, std::min(portion, all.size() - from)));
  }
  spool->finish();
  return {signals(), std::move(spool)};
}

Series spooled(int compression, const std::vector<double>& rows) {
  return spooled({folder(), {kChunkRows, compression}}, rows);
}

void expect_equal(const Series& series, const std::vector<double>& wanted) {
  ASSERT_EQ(series.rows(), kRows);
  for (std::size_t row = 0; row < kRows; ++row) {
    for (std::size_t c = 0; c < series.width(); ++c) {
      ASSERT_EQ(series.at(row, c), wanted[row * series.width() + c]) << row << ", " << c;
    }
  }
}

TEST(SeriesSpool, GivesItsRowsBackBitForBit) {
  const std::vector<double> wanted = rows();
  for (const int compression : {kNoCompression, 1, kMaxCompression}) {
    SCOPED_TRACE(compression);
    expect_equal(spooled(compression, wanted), wanted);
  }
}

TEST(SeriesSpool, HasTheSameChunksAndNumbersWhereverTheyAre) {
  const std::vector<double> wanted = rows();
  const Series on_disk = spooled(1, wanted);
  const std::vector<bool> none, some = {false, true, false, true, true, false}, all(6, true);
  for (const double most_in_memory : {1.0, 4000.0, 1e6}) {  // bytes: nothing, some chunks, all
    for (const std::vector<bool>& kept : {none, some, all}) {
      const Series one = spooled(
          {folder(), {kChunkRows, 1}, most_in_memory, kept.empty() || kept[1], kept}, wanted);
      expect_equal(one, wanted);
      std::vector<std::uint8_t> chunk, other;
      for (std::size_t page = 0; page * kChunkRows < kRows; ++page) {
        for (std::size_t c = 0; c < one.width(); ++c) {
          ASSERT_TRUE(one.pages()->read_encoded(c, page, chunk));
          ASSERT_TRUE(on_disk.pages()->read_encoded(c, page, other));
          ASSERT_EQ(chunk, other) << page << ", " << c;
        }
      }
    }
  }
}

TEST(SeriesSpool, NeedsNoFileForWhatItHoldsInMemory) {
  const std::vector<double> wanted = rows();
  expect_equal(spooled({"/nowhere/at/all", {kChunkRows, 1}, 1e6}, wanted), wanted);
}

TEST(SeriesSpool, SaysThatItCannotWriteWhereItsMemoryIsFull) {
  EXPECT_THROW(spooled({"/nowhere/at/all", {kChunkRows, 1}, 1000.0}, rows()), system::SystemError);
}

TEST(SeriesSpool, IsReadInAnyOrder) {
  const std::vector<double> wanted = rows();
  const Series series = spooled(1, wanted);
  for (std::size_t row = kRows; row-- > 0;) ASSERT_EQ(series.at(row, 2), wanted[row * 6 + 2]);
  for (std::size_t row = kChunkRows - 2; row < kChunkRows + 2; ++row) {  // around the end of a page
    ASSERT_EQ(series.at(row + 1, 0), wanted[(row + 1) * 6]);
    ASSERT_EQ(series.at(row, 0), wanted[row * 6]);
  }
}

TEST(SeriesSpool, ReadsAPageOnceHoweverOftenItsRowsAreAskedFor) {
  class Counted final : public ColumnPages {
   public:
    std::size_t rows() const override { return kRows; }
    std::size_t page_rows() const override { return kChunkRows; }
    void read(std::size_t, std::size_t page, std::vector<double>& values) const override {
      ++reads;
      values.assign(std::min(kChunkRows, kRows - page * kChunkRows), static_cast<double>(page));
    }
    bool read_encoded(std::size_t, std::size_t, std::vector<std::uint8_t>&) const override {
      return false;
    }
    mutable int reads = 0;
  };
  const auto pages = std::make_shared<Counted>();
  const Series series({{"a", "1", "", "", ""}}, pages);
  for (std::size_t row = 1; row < kRows; ++row) {
    EXPECT_EQ(series.at(row, 0), static_cast<double>(row / kChunkRows));
    EXPECT_EQ(series.at(row - 1, 0), static_cast<double>((row - 1) / kChunkRows));
  }
  EXPECT_EQ(pages->reads, 6);
}

TEST(SeriesSpool, HoldsOneChunkOfRowsInMemory) {
  SeriesSpool spool(signals(), {folder(), kChunkRows, 1});
  const std::vector<double> wanted = rows();
  spool.append(wanted);
  EXPECT_EQ(spool.rows_encoded(), kRows / kChunkRows * kChunkRows);
  EXPECT_GT(spool.bytes(), 0U);
  EXPECT_LT(spool.bytes(), wanted.size() * sizeof(double));
}

TEST(SeriesSpool, LeavesNoFileBehind) {
  const std::filesystem::path own = std::filesystem::path(folder()) / "spool_test";
  std::filesystem::create_directories(own);
  {
    SeriesSpool spool(signals(), {own, kChunkRows, 1});
    spool.append(rows());
    EXPECT_TRUE(std::filesystem::is_empty(own));
  }
  std::filesystem::remove(own);
}

TEST(SeriesSpool, SaysWhichFolderItCannotWrite) {
  try {
    SeriesSpool({}, {"/nowhere/at/all", kChunkRows, 1});
    FAIL();
  } catch (const system::SystemError& error) {
    EXPECT_STREQ(error.what(),
                 "/nowhere/at/all: error: recorded signals cannot be stored there: No such file or "
                 "directory");
  }
}

TEST(EvenChunkRows, LeavesLittleOfTheLastChunkEmpty) {
  EXPECT_EQ(even_chunk_rows(0), 1U);
  EXPECT_EQ(even_chunk_rows(10), 10U);
  EXPECT_EQ(even_chunk_rows(16384), 16384U);
  EXPECT_EQ(even_chunk_rows(16386), 8193U);
}

}  // namespace
}  // namespace servomill::sim::records::series_spool_test
