/// Cost of writing a row of 40 signals: `all` on all threads together, and `wall` until the file is
/// written, each in us a row; `bytes` in the file for each row.

#include <benchmark/benchmark.h>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "sim/records/output_file.h"
#include "sim/records/series_spool.h"
#include "sim/records/series_writer.h"

namespace servomill::sim {
namespace {

constexpr std::size_t kSignals = 40;
constexpr std::size_t kRows = 65536;

double seconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Axes that swing by tens of millimetres with 10 nm of noise, rounded as a scenario's recorder
// does; the first column is the time.
std::vector<double> swinging_rows() {
  constexpr double kQuantum = 0x1p-27;  // mm
  std::vector<double> all(kRows * kSignals);
  std::uint64_t random = 1;
  for (std::size_t n = 0; n < kRows; ++n) {
    const double t = 1e-3 * static_cast<double>(n);
    double* row = all.data() + n * kSignals;
    row[0] = t;
    for (std::size_t c = 1; c < kSignals; ++c) {
      random = random * 6364136223846793005U + 1442695040888963407U;
      const double noise = 1e-5 * (static_cast<double>(random >> 11) * 0x1p-53 - 0.5);
      const double rate = 0.1 * static_cast<double>(c);
      const double value = 50.0 * std::sin(2.0 * std::numbers::pi * rate * t) + noise;
      row[c] = std::nearbyint(value / kQuantum) * kQuantum;
    }
  }
  return all;
}

std::vector<records::Signal> signals(records::Storage storage) {
  std::vector<records::Signal> out = {{"time", "s", "time", "", ""}};
  for (std::size_t c = 1; c < kSignals; ++c) {
    out.push_back({"signal" + std::to_string(c), "mm", "signal", "", "", 0, storage});
  }
  return out;
}

records::SeriesLayout layout(int compression, records::Storage storage) {
  records::SeriesLayout out;
  out.compression = compression;
  for (std::size_t c = 1; c < kSignals; ++c) {
    out.channels.push_back({"signal" + std::to_string(c), {"mm", "signal"}, "", storage});
  }
  return out;
}

void BM_Write(benchmark::State& state, int compression, records::Storage storage) {
  static const std::vector<double> kNumbers = swinging_rows();
  constexpr std::size_t kBlock = 1024 * kSignals;  // as rows come from a recorder
  const std::string path = std::filesystem::temp_directory_path() / "servomill_recorder_bench.h5";
  double process = 0.0, wall = 0.0;
  for (auto _ : state) {
    records::OutputFile file(path, true);
    process -= seconds(CLOCK_PROCESS_CPUTIME_ID);
    wall -= seconds(CLOCK_MONOTONIC);
    const records::SeriesLayout wanted = layout(compression, storage);
    records::SeriesSpool spool(
        signals(storage),
        {.folder = "", .page = {wanted.chunk_rows, compression}, .most_in_memory = 1e9});
    for (std::size_t first = 0; first < kNumbers.size(); first += kBlock) {
      spool.append(std::span(kNumbers).subspan(first, kBlock));
    }
    spool.finish();
    records::write_pages(file.root().group("servo"), wanted, spool);
    process += seconds(CLOCK_PROCESS_CPUTIME_ID);
    wall += seconds(CLOCK_MONOTONIC);
  }
  const double per_row = 1e6 / static_cast<double>(kRows * state.iterations());
  state.counters["all"] = process * per_row;
  state.counters["wall"] = wall * per_row;
  state.counters["bytes"] =
      static_cast<double>(std::filesystem::file_size(path + ".partial")) / kRows;
  std::filesystem::remove(path + ".partial");
}
BENCHMARK_CAPTURE(BM_Write, uncompressed, records::kNoCompression, records::Storage::float64)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Write, compressed_1, 1, records::Storage::float64)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Write, compressed_6, 6, records::Storage::float64)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Write, compressed_1_float32, 1, records::Storage::float32)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace servomill::sim
