/// The memory that planning takes from the heap, for each line.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "programs.h"
#include "tests/counting_new.h"

namespace servomill::controllers::test::plan_memory_test {
namespace {

// Rows over a curved surface, in chords of that length (m). At the end of a row the motion turns
// back and stops, or a block leads to the next one.
MoveList surface(std::size_t lines, double shortest, double longest, double feed,
                 bool stops = true) {
  std::mt19937 dice(5);
  Program program;
  MoveList out;
  double x = 0.0, y = 0.0, direction = 1.0, s = 0.0;
  AxisWords at = AxisWords::Zero();
  for (std::size_t n = 0; n < lines; ++n) {
    const double share = static_cast<double>(dice()) / 4294967296.0;
    const double next = x + direction * (shortest + share * (longest - shortest));
    const bool ends_row = std::abs(next - 0.1) > 0.1;
    if (!ends_row || stops) x = next;
    if (ends_row) {
      direction = -direction;
      y += 0.3 * mm;
    }
    Move move;
    move.line = static_cast<int>(n) + 1;
    move.feed = feed;
    move.path_tolerance = 10 * um;
    move.end.head<3>() << x, y, 0.006 * std::sin(x / 0.031) * std::cos(y / 0.023);
    move.end_machine = move.end;
    move.s_begin = s;
    s += (move.end - at).head<3>().norm();
    move.s_end = s;
    at = move.end;
    out.push_back(move);
  }
  return out;
}

struct Memory {
  double peak = 0.0, kept = 0.0;  // bytes a line
};

Memory memory_of(const MoveList& moves) {
  const std::size_t before = bytes_in_use;
  most_bytes_in_use = before;
  const Trajectory path = plan(moves, kLayout, Joints::Zero(), machine_limits());
  const auto lines = static_cast<double>(moves.size());
  return {static_cast<double>(most_bytes_in_use - before) / lines,
          static_cast<double>(bytes_in_use - before) / lines};
}

void expect_bounded(const char* what, const Memory& one, const Memory& twice, const Memory& most) {
  fmt::print(
      "{}: {:.0f} bytes a line at most, {:.0f} kept; {:.0f} and {:.0f} at twice the length\n", what,
      one.peak, one.kept, twice.peak, twice.kept);
  EXPECT_LE(one.peak, most.peak);
  EXPECT_LE(twice.peak, most.peak);
  EXPECT_LE(twice.peak, 1.1 * one.peak);
  EXPECT_LE(one.kept, most.kept);
  EXPECT_LE(twice.kept, most.kept);
}

// Ten intervals of a time law a line, whose points took 11 000 bytes more.
TEST(PlanMemory, OfLongLinesIsBounded) {
  constexpr std::size_t kLines = 4000;
  constexpr Memory kMax = {1800.0, 900.0};
  const auto moves = [](std::size_t n) { return surface(n, 0.6 * mm, 4.0 * mm, 10 * mm); };
  expect_bounded("long lines", memory_of(moves(kLines)), memory_of(moves(2 * kLines)), kMax);
}

// Vertices, windows and spans: 560 bytes when each of them said all about itself.
TEST(PlanMemory, OfShortLinesIsBounded) {
  constexpr std::size_t kLines = 60'000;
  constexpr Memory kMax = {250.0, 150.0};
  const auto moves = [](std::size_t n) { return surface(n, 0.05 * mm, 0.2 * mm, 50 * mm); };
  expect_bounded("short lines", memory_of(moves(kLines)), memory_of(moves(2 * kLines)), kMax);
}

// Beyond what is kept, planning needs the memory of a stretch and of the one ahead: undivided,
// these motions took 57 and 114 MB.
TEST(PlanMemory, OfPlanningDoesNotGrowWithTheMotion) {
  constexpr double kMax = 20e6;  // bytes
  for (const std::size_t lines : {300'000U, 600'000U}) {
    const Memory memory = memory_of(surface(lines, 0.05 * mm, 0.2 * mm, 50 * mm, false));
    const double extra = (memory.peak - memory.kept) * static_cast<double>(lines);
    fmt::print("planning of {} lines takes {:.1f} MB\n", lines, extra / 1e6);
    EXPECT_LE(extra, kMax);
  }
}

}  // namespace
}  // namespace servomill::controllers::test::plan_memory_test
