/// Chains of a long program, on the disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "controllers/path/trajectory.h"
#include "plant/vocabulary/scratch_file.h"

namespace servomill::controllers {

/// Plan, spans and shares of one chain. For any number of threads.
class StoredChain {
 public:
  /// @throws SystemError, as all members
  StoredChain(std::shared_ptr<ScratchFile> file, const Trajectory::Chain& chain);

  /// The chain as it was, bit for bit; one for all who read it at the same time.
  std::shared_ptr<const Trajectory::Chain> read() const;

 private:
  struct Part {
    std::uint64_t place = 0;
    std::size_t count = 0;
  };
  template <class T>
  Part write(const std::vector<T>& values);
  template <class T>
  void read(const Part& part, std::vector<T>& values) const;

  std::shared_ptr<ScratchFile> file_;
  Trajectory::Chain head_;  // without what is in the file
  Part pieces_, vertices_, phases_, spans_, shares_;
  mutable std::mutex mutex_;
  mutable std::weak_ptr<const Trajectory::Chain> in_use_;
};

/// Keeps chains of some megabytes in memory, and those behind on the disk.
class ChainStore {
 public:
  explicit ChainStore(std::size_t most_in_memory) : left_(most_in_memory) {}

  /// @return the chain, or what it is without its contents if these are stored
  Trajectory::Chain keep(Trajectory::Chain chain);

 private:
  std::size_t left_;  // bytes
  std::shared_ptr<ScratchFile> file_;
};

}  // namespace servomill::controllers
