#include "sim/run/isolated_case.h"

#include <fmt/format.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <new>
#include <utility>

#include "sim/engine/case_parts.h"
#include "sim/model/scenario.h"
#include "sim/run/result_stream.h"
#include "sim/system/system_error.h"

namespace servomill::sim::run {
namespace {

constexpr std::chrono::milliseconds kLookPeriod{20};  // an interrupt waits for it, too

std::shared_ptr<std::atomic<float>> in_shared_memory() {
  using Progress = std::atomic<float>;
  static_assert(Progress::is_always_lock_free);
  void* const place =
      ::mmap(nullptr, sizeof(Progress), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (place == MAP_FAILED) {
    throw system::SystemError("--isolate", "no memory to share", std::strerror(errno));
  }
  return {new (place) Progress(0.0F), [](Progress* one) { ::munmap(one, sizeof(Progress)); }};
}

// The plug-ins of a case: "strategy ramp (libramp.so)".
std::string plugins_of(const model::CaseSpec& spec) {
  std::vector<std::string_view> out;
  for (const model::StrategySpec& strategy : spec.strategies) {
    if (!strategy.entry->plugin.empty()) out.push_back(strategy.entry->plugin);
  }
  return fmt::format("{}", fmt::join(out, ", "));
}

// In the child.
strategies::PluginChild::Result simulated(const preparation::PreparedCase& prepared,
                                          const std::string& folder, std::atomic<float>& progress) {
  static const engine::StopFlag kNever = false;
  engine::CaseInputs inputs = prepared.inputs(folder);
  const auto result =
      std::make_shared<engine::CaseResult>(sim::engine::simulate(inputs, kNever, progress));
  return [result](strategies::ProcessPipe& to) { write_result(*result, to); };
}

}  // namespace

bool uses_plugin(const model::CaseSpec& spec) {
  return std::any_of(spec.strategies.begin(), spec.strategies.end(),
                     [](const model::StrategySpec& one) { return !one.entry->plugin.empty(); });
}

IsolatedCase::IsolatedCase(const preparation::PreparedCase& prepared, SignalStorage storage)
    : prepared_(prepared),
      storage_(std::move(storage)),
      progress_(in_shared_memory()),
      child_(plugins_of(prepared.spec()),
             [this] { return simulated(prepared_, storage_.scratch_folder, *progress_); }) {}

engine::CaseResult IsolatedCase::simulate(const engine::StopFlag& stop,
                                          std::atomic<float>& progress) {
  const auto begin = std::chrono::steady_clock::now();
  child_.begin();
  engine::CaseResult result = wait(stop, progress);
  result.wall_time =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

engine::CaseResult IsolatedCase::wait(const engine::StopFlag& stop, std::atomic<float>& progress) {
  try {
    while (!child_.wait(kLookPeriod)) {
      progress = progress_->load();
      if (!stop) continue;
      engine::CaseResult result = stopped("interrupted");
      result.outcome = engine::interrupted(0.0);
      return result;
    }
    return read_result(child_, inputs_with(prepared_, storage_).keeping);
  } catch (const strategies::PluginFailed& failed) {
    return stopped(failed.what());
  }
}

// The result of a case that stops where it begins.
engine::CaseResult IsolatedCase::stopped(std::string why) const {
  static const engine::StopFlag kNever = false;
  std::atomic<float> progress = 0.0F;
  engine::CaseInputs inputs = inputs_with(prepared_, storage_);
  inputs.setpoints.clear();
  inputs.feedback = nullptr;
  inputs.position_loop_terms.clear();
  inputs.stops_with = std::move(why);
  return sim::engine::simulate(inputs, kNever, progress);
}

}  // namespace servomill::sim::run
