/// Cases that a run keeps when it does not end.
#pragma once

#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace servomill::sim::run {
struct CaseOutput;  // sim/run/run_case.h
}  // namespace servomill::sim::run

namespace servomill::tools {

/// Output that a run leaves behind when it does not end. For any thread.
class KeptCases {
 public:
  explicit KeptCases(std::vector<std::string> cases) : incomplete_(std::move(cases)) {}
  /// Name of the file in which complete cases are kept.
  void in(const std::string& partial_path);
  void add(const sim::run::CaseOutput& one);
  bool all_complete() const;
  /// "complete cases a, b; interrupted c are kept in FILE"; empty: there is no file yet.
  std::string said() const;

 private:
  mutable std::mutex mutex_;
  std::string partial_path_;
  std::vector<std::string> complete_, incomplete_;
};

}  // namespace servomill::tools
