#include "sim/sweep/merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "sim/store.h"

namespace servomill::sim {
namespace {

constexpr std::size_t kMostNamed = 20;  // shards or ranges in one message

// Refuses a file that is no part of the same sweep as the first one.
void refuse_other(const SweepHeader& one, const std::string& path, const std::string& version,
                  const SweepHeader& first, const std::string& first_path,
                  const std::string& first_version) {
  const auto refuse = [&](const std::string& why) {
    throw InputError({path}, fmt::format("{} {}", why, first_path));
  };
  if (version != first_version) {
    refuse(fmt::format("was written by servomill {}, not {} as", version, first_version));
  }
  if (one.base.resolved != first.base.resolved) refuse("holds a sweep of another scenario than");
  if (one.selection.first != first.selection.first || one.selection.last != first.selection.last) {
    refuse(fmt::format("is of points {} to {}, others than those of", one.selection.first + 1,
                       one.selection.last));
  }
}

// "1-4, 9, 12-20" for sorted numbers.
std::string ranges(const std::vector<std::uint64_t>& numbers) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin < numbers.size();) {
    std::size_t end = begin + 1;
    while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
    if (parts.size() == kMostNamed) {
      parts.emplace_back("...");
      break;
    }
    parts.push_back(end - begin == 1 ? fmt::format("{}", numbers[begin])
                                     : fmt::format("{}-{}", numbers[begin], numbers[end - 1]));
    begin = end;
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

struct Shard {
  InputFile file;
  SweepHeader header;
};

// Which file holds each point of the whole selection.
class Owners {
 public:
  explicit Owners(const Selection& whole) : whole_(whole), owner_(whole.size(), kNobody) {}

  void add(const std::vector<Shard>& shards, std::size_t one) {
    const Selection& selection = shards[one].header.selection;
    for (std::uint64_t place = 0; place < selection.size(); ++place) {
      std::uint32_t& owner = owner_[whole_.place(selection.point(place))];
      if (owner != kNobody) {
        throw InputError({shards[one].file.path()},
                         fmt::format("overlaps {}: both hold point {}", shards[owner].file.path(),
                                     selection.point(place) + 1));
      }
      owner = static_cast<std::uint32_t>(one);
    }
  }

  // What nobody holds, by shard where all files are of one partition.
  std::string missing(const std::vector<Shard>& shards) const {
    const Selection& like = shards.front().header.selection;
    const bool one_partition = std::all_of(shards.begin(), shards.end(), [&](const Shard& shard) {
      return shard.header.selection.shards == like.shards;
    });
    std::vector<std::uint64_t> lacking;
    for (std::uint64_t place = 0; place < owner_.size(); ++place) {
      if (owner_[place] != kNobody) continue;
      const std::uint64_t point = whole_.point(place);
      lacking.push_back(one_partition ? like.shard_of(point) : point + 1);
    }
    if (lacking.empty()) return {};
    if (!one_partition) return fmt::format("no file holds the points {}", ranges(lacking));
    std::sort(lacking.begin(), lacking.end());
    lacking.erase(std::unique(lacking.begin(), lacking.end()), lacking.end());
    return fmt::format("{} {} of {} {} missing", lacking.size() == 1 ? "shard" : "shards",
                       ranges(lacking), like.shards, lacking.size() == 1 ? "is" : "are");
  }

 private:
  static constexpr std::uint32_t kNobody = 0xFFFFFFFF;
  Selection whole_;
  std::vector<std::uint32_t> owner_;
};

std::uint64_t not_run(const Shard& shard) {
  const auto statuses = shard.file.values("/sweep/status", 0, shard.header.selection.size());
  return static_cast<std::uint64_t>(std::count(statuses.begin(), statuses.end(), 0.0));
}

}  // namespace

Merged merge_sweeps(const std::vector<std::string>& paths, const std::string& out, bool force,
                    bool partial) {
  std::vector<Shard> shards;
  for (const std::string& path : paths) {
    InputFile file(path);
    SweepHeader header = read_sweep_header(file);
    shards.push_back({std::move(file), std::move(header)});
  }
  const Shard& first = shards.front();
  const auto version = [](const Shard& shard) { return shard.file.text("/", "servomill_version"); };
  const Selection whole{first.header.selection.first, first.header.selection.last};
  Owners owners(whole);
  Merged merged;
  for (std::size_t i = 0; i < shards.size(); ++i) {
    refuse_other(shards[i].header, shards[i].file.path(), version(shards[i]), first.header,
                 first.file.path(), version(first));
    owners.add(shards, i);
    if (const std::uint64_t count = not_run(shards[i]); count > 0) {
      merged.missing.push_back(fmt::format("{} lacks {} of its {} points", paths[i], count,
                                           shards[i].header.selection.size()));
    }
  }
  if (const std::string missing = owners.missing(shards); !missing.empty()) {
    merged.missing.push_back(missing);
  }
  if (!merged.missing.empty() && !partial) {
    throw InputError(
        {out}, fmt::format("{}; --partial merges what there is", fmt::join(merged.missing, "; ")));
  }

  SweepTable table(writable_name(out, force), force, first.header.base, columns_of(first.file),
                   whole);
  for (const Shard& shard : shards) table.copy(shard.file);
  merged.counts = table.counts();
  table.commit();
  return merged;
}

}  // namespace servomill::sim
