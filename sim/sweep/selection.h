/// The part of a sweep's points that one process runs.
#pragma once

#include <cstdint>
#include <string>

namespace servomill::sim::sweep {

/// Points first ... last - 1 of a sweep (counted from 0), or one shard of them. Shards take turns
/// in blocks of neighbours, at most 16 points long: neighbours have most in common, and no shard
/// gets all the slow ones. Together they hold every point once.
struct Selection {
  std::uint64_t first = 0, last = 0;
  std::uint64_t shard = 1, shards = 1;  // counted from 1

  bool operator==(const Selection&) const = default;
  std::uint64_t size() const;
  /// Number of the point at a place in the selection; rises with it.
  /// @pre place < size()
  std::uint64_t point(std::uint64_t place) const;
  /// The place of a point. @pre the selection has it
  std::uint64_t place(std::uint64_t point) const;
  /// The shard that holds a point. @pre first <= point < last
  std::uint64_t shard_of(std::uint64_t point) const;

 private:
  std::uint64_t block() const;
};

/// Reads --points A-B and --shard I/N, counted from 1; empty texts: all.
/// @param points  of the sweep
/// @throws InputError at "--points ..." or "--shard ..."
Selection read_selection(std::uint64_t points, const std::string& range, const std::string& shard);

/// "OUT.h5" as shard 2 of 8 calls it: "OUT.2-of-8.h5".
std::string shard_name(const std::string& path, const Selection& selection);

}  // namespace servomill::sim::sweep
