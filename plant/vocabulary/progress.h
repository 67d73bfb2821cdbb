/// How far a long computation is, for whoever shows it.
///
/// A loop that may take seconds announces a stage and counts its steps. Like the wish to interrupt
/// (interrupt.h), a stage passes by all signatures between a command and its loops: it is seen by
/// the watch of the thread that begins it, and by nobody where there is none. It never changes a
/// result.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace servomill {

class ProgressWatch;

/// Steps that take about the same time allow a forecast of the time left; others do not.
enum class Steps : std::uint8_t { alike, unlike };

/// A stage as a watch sees it.
struct StageState {
  std::string counted;  // plural of what is counted, "frequencies"; empty: only the share matters
  double done = 0.0;
  double total = 0.0;  // 0: not known in advance
  Steps steps = Steps::unlike;
  double seconds = 0.0;  // since it began
};

/// Done of the outermost stage, 0 to 1, with what those within it have done of its step; 0 where
/// that is not known.
double share_done(const std::vector<StageState>& stages);

/// Part of a computation. Stages nest: one that begins while another lives is a part of that
/// one's step.
class Stage {
 public:
  /// @param counted  plural of what is counted; empty: only the share matters
  /// @param total    number of steps; 0: not known in advance
  Stage(std::string_view counted, double total, Steps steps = Steps::alike)
      : Stage(counted, total, steps, nullptr) {}
  /// A stage of which somebody else says how far it is.
  /// @param share  done, 0 to 1; must outlive this
  explicit Stage(const std::atomic<float>& share) : Stage("", 1.0, Steps::alike, &share) {}
  ~Stage();
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// Adds steps; from any thread.
  void advance(double steps = 1.0) { done_.fetch_add(steps, std::memory_order_relaxed); }
  /// Number of steps done; from any thread.
  void reach(double done) { done_.store(done, std::memory_order_relaxed); }

  StageState state() const;

 private:
  Stage(std::string_view counted, double total, Steps steps, const std::atomic<float>* share);

  const std::string counted_;
  const double total_;
  const Steps steps_;
  const std::chrono::steady_clock::time_point begin_;
  std::atomic<double> done_ = 0.0;
  const std::atomic<float>* const share_;  // of somebody else, in place of done_; or none
  ProgressWatch* const watch_;             // of this thread; or none
};

/// Watches the stages that the constructing thread begins while this lives, instead of the watch
/// before it.
class ProgressWatch {
 public:
  ProgressWatch();
  ~ProgressWatch();
  ProgressWatch(const ProgressWatch&) = delete;
  ProgressWatch& operator=(const ProgressWatch&) = delete;

  /// Stages that live now, the outermost first; for any thread.
  std::vector<StageState> stages() const;

  /// In a process that was forked off: its stages are seen by nobody.
  static void forget();

 private:
  friend class Stage;
  static ProgressWatch* of_this_thread();

  ProgressWatch* const before_;
  mutable std::mutex mutex_;
  std::vector<const Stage*> stages_;
};

}  // namespace servomill
