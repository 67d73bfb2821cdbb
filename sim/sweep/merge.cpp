#include "sim/sweep/merge.h"
#include "plant/vocabulary/progress.h"
#include "sim/sweep/table_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "sim/records/input_file.h"
#include "sim/run/build_identity.h"
#include "sim/run/result_file.h"

namespace servomill::sim::sweep {
namespace {

constexpr std::size_t kMaxNamed = 20;  // shards or ranges in one message

// Data that a merge keeps of each file; files are opened one at a time, there may be thousands.
struct Shard {
  std::string path, build, resolved, swept_files;
  Selection selection;
  std::uint64_t not_run = 0;  // of its points
};

Shard read_shard(const std::string& path) {
  const records::InputFile file(path);
  const SweepHeader header = read_sweep_header(file);
  const auto statuses = file.values("/sweep/status", 0, header.selection.size());
  return {path,
          run::build_of(file),
          header.base.resolved,
          header.base.swept_files,
          header.selection,
          static_cast<std::uint64_t>(std::count(statuses.begin(), statuses.end(), 0.0))};
}

// Refuses a file that is no part of the same sweep as the first one.
void refuse_other(const Shard& one, const Shard& first) {
  const auto refuse = [&](const std::string& why) {
    throw InputError({one.path}, fmt::format("{} {}", why, first.path));
  };
  if (one.build != first.build) {
    throw InputError({one.path},
                     fmt::format("was written by servomill {}, {} by {}: points of two builds may "
                                 "differ; run these shards again with one build",
                                 one.build, first.path, first.build));
  }
  if (one.build != run::result_identity()) {
    throw InputError({one.path}, fmt::format("was written by servomill {}; this is {}, which did "
                                             "not write all of it: merge with that build",
                                             one.build, run::result_identity()));
  }
  if (const auto file = changed_file(first.swept_files, one.swept_files); !file.empty()) {
    refuse(fmt::format("was run with another file '{}' than", file));
  }
  if (one.resolved != first.resolved) refuse("contains a sweep of another scenario than");
  if (one.selection.first != first.selection.first || one.selection.last != first.selection.last) {
    refuse(fmt::format("has points {} to {}, not those of", one.selection.first + 1,
                       one.selection.last));
  }
}

// "1-4, 9, 12-20" for sorted numbers.
std::string ranges(const std::vector<std::uint64_t>& numbers) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin < numbers.size();) {
    std::size_t end = begin + 1;
    while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
    if (parts.size() == kMaxNamed) {
      parts.emplace_back("...");
      break;
    }
    parts.push_back(end - begin == 1 ? fmt::format("{}", numbers[begin])
                                     : fmt::format("{}-{}", numbers[begin], numbers[end - 1]));
    begin = end;
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

// Which file holds each point of the whole selection.
class Owners {
 public:
  explicit Owners(const Selection& whole) : whole_(whole), owner_(whole.size(), kNobody) {}

  void add(const std::vector<Shard>& shards, std::size_t one) {
    const Selection& selection = shards[one].selection;
    for (std::uint64_t place = 0; place < selection.size(); ++place) {
      std::uint32_t& owner = owner_[whole_.place(selection.point(place))];
      if (owner != kNobody) {
        throw InputError({shards[one].path},
                         fmt::format("overlaps {}: both contain point {}", shards[owner].path,
                                     selection.point(place) + 1));
      }
      owner = static_cast<std::uint32_t>(one);
    }
  }

  // Points in none of the files, by shard where all files are of one partition.
  std::string missing(const std::vector<Shard>& shards) const {
    const Selection& like = shards.front().selection;
    const bool one_partition = std::all_of(shards.begin(), shards.end(), [&](const Shard& shard) {
      return shard.selection.shards == like.shards;
    });
    std::vector<std::uint64_t> lacking;
    for (std::uint64_t place = 0; place < owner_.size(); ++place) {
      if (owner_[place] != kNobody) continue;
      const std::uint64_t point = whole_.point(place);
      lacking.push_back(one_partition ? like.shard_of(point) : point + 1);
    }
    if (lacking.empty()) return {};
    if (!one_partition) return fmt::format("no file contains the points {}", ranges(lacking));
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

}  // namespace

Merged merge_sweeps(const std::vector<std::string>& paths, const std::string& out, bool force,
                    bool partial) {
  std::vector<Shard> shards;
  for (const std::string& path : paths) {
    shards.push_back(read_shard(path));
    refuse_other(shards.back(), shards.front());
  }
  const Selection whole{shards.front().selection.first, shards.front().selection.last};
  Owners owners(whole);
  Merged merged;
  for (std::size_t i = 0; i < shards.size(); ++i) {
    owners.add(shards, i);
    if (shards[i].not_run == 0) continue;
    merged.missing.push_back(fmt::format("{} lacks {} of its {} points", shards[i].path,
                                         shards[i].not_run, shards[i].selection.size()));
  }
  if (const std::string missing = owners.missing(shards); !missing.empty()) {
    merged.missing.push_back(missing);
  }
  if (!merged.missing.empty() && !partial) {
    throw InputError({out}, fmt::format("{}; use --partial to merge the existing ones",
                                        fmt::join(merged.missing, "; ")));
  }

  std::optional<SweepTable> table;
  Stage stage("shards", static_cast<double>(shards.size()), Steps::unlike);
  for (const Shard& shard : shards) {
    const records::InputFile file(shard.path);
    if (!table) {
      table.emplace(run::writable_name(out, force), force, read_sweep_header(file).base,
                    columns_of(file), whole);
      table->remove_unless_committed();
    }
    table->copy(file);
    stage.advance();
  }
  merged.counts = table->counts();
  merged.simd_levels = table->simd_levels();
  table->commit();
  return merged;
}

}  // namespace servomill::sim::sweep
