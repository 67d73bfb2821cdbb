#include "sim/run/store_series.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "sim/records/chunk_encoder.h"
#include "sim/records/hdf5_group.h"
#include "sim/records/input_file.h"
#include "sim/records/output_file.h"
#include "sim/records/series.h"

namespace servomill::sim::run::store_series_test {
namespace {

records::Series series_at(const std::vector<double>& times) {
  records::Series series({{"time", "s", "time", "", ""}, {"s", "mm", "arc length", "", ""}});
  for (const double time : times) series.append(std::vector{time, 0.0});
  return series;
}

constexpr records::EvenSteps kSteps = {30, 1e-5};

void write(records::OutputFile& out, const std::string& group, const records::Series& series) {
  const SeriesFormat format = {kSteps};
  write_series(out.root().group(group), series, *encoded_pages(series, format), format);
}

std::vector<double> even_times(int rows) {
  std::vector<double> times;
  for (int row = 0; row < rows; ++row) times.push_back(row * 30 * 1e-5);
  return times;
}

TEST(EvenTimes, AreThoseOfTheirTicksToTheBit) {
  std::vector<double> times = even_times(200'000);
  EXPECT_TRUE(has_even_times(series_at(times), kSteps));
  times.back() = std::nextafter(times.back(), 0.0);
  EXPECT_FALSE(has_even_times(series_at(times), kSteps));
}

TEST(EvenTimes, AreNotThoseOfWhichOneIsMissingOrAdded) {
  std::vector<double> missing = even_times(10), added = missing;
  missing.erase(missing.begin() + 4);
  EXPECT_FALSE(has_even_times(series_at(missing), kSteps));
  added.insert(added.begin() + 4, 0.001);
  EXPECT_FALSE(has_even_times(series_at(added), kSteps));
}

TEST(EvenTimes, AreNotThoseThatBeginLater) {
  EXPECT_FALSE(has_even_times(series_at({30 * 1e-5, 60 * 1e-5}), kSteps));
}

TEST(WrittenSeries, SaysThatItsTimesAreEvenWhereTheyAre) {
  namespace fs = std::filesystem;
  const fs::path path = fs::path(testing::TempDir()) / ("s" + std::to_string(getpid()) + ".h5");
  records::OutputFile out(path, true);
  write(out, "even", series_at(even_times(3)));
  write(out, "windows", series_at({0.0, 30 * 1e-5, 7.0}));
  out.commit();
  const records::InputFile in(path);
  EXPECT_EQ(in.number("/even/time", "sampling_ticks"), 30.0);
  EXPECT_EQ(in.number("/even/time", "tick"), 1e-5);
  EXPECT_EQ(in.values("/even/time"), even_times(3));
  EXPECT_FALSE(in.has_attribute("/windows/time", "sampling_ticks"));
  fs::remove(path);
}

// Pages that tell their column and their rows, encoded as a spool on the disk has them.
class EncodedPages final : public records::ColumnPages {
 public:
  static constexpr std::size_t kPages = 5, kPageRows = 64;
  std::size_t rows() const override { return kPages * kPageRows - 7; }
  std::size_t page_rows() const override { return kPageRows; }
  void read(std::size_t column, std::size_t page, std::vector<double>& values) const override {
    values.clear();
    for (std::size_t row = page * kPageRows; row < std::min((page + 1) * kPageRows, rows());
         ++row) {
      values.push_back(static_cast<double>(row) + 0.125 * static_cast<double>(column));
    }
  }
  bool read_encoded(std::size_t column, std::size_t page,
                    std::vector<std::uint8_t>& chunk) const override {
    std::vector<double> values;
    read(column, page, values);
    records::ChunkEncoder(1).encode(values, kPageRows, records::Storage::float64, chunk);
    return true;
  }
};

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(WrittenSeries, OfPagesHasTheChunksOfASignalNextToEachOther) {
  namespace fs = std::filesystem;
  const fs::path path = fs::path(testing::TempDir()) / ("p" + std::to_string(getpid()) + ".h5");
  const auto pages = std::make_shared<const EncodedPages>();
  const records::Series series(
      {{"time", "s", "time", "", ""}, {"s", "mm", "s", "", ""}, {"error", "um", "error", "", ""}},
      pages);
  records::OutputFile out(path, true);
  write(out, "servo", series);
  out.commit();

  const records::InputFile in(path);
  const std::string file = bytes_of(path);
  for (std::size_t column = 0; column < series.width(); ++column) {
    std::vector<double> wanted, page;
    std::string neighbours;
    for (std::size_t n = 0; n < EncodedPages::kPages; ++n) {
      pages->read(column, n, page);
      wanted.insert(wanted.end(), page.begin(), page.end());
      std::vector<std::uint8_t> chunk;
      pages->read_encoded(column, n, chunk);
      neighbours.append(chunk.begin(), chunk.end());
    }
    EXPECT_EQ(in.values("/servo/" + series.signals()[column].name), wanted);
    EXPECT_NE(file.find(neighbours), std::string::npos) << series.signals()[column].name;
  }
  fs::remove(path);
}

}  // namespace
}  // namespace servomill::sim::run::store_series_test
