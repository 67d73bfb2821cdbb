#include "sim/fmu/machine_instance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>

namespace servomill::sim::fmu {

MachineInstance::MachineInstance(const std::vector<AxisConstants>& axes, const Log& log)
    : log_(log) {
  assert(!axes.empty());
  for (const AxisConstants& axis : axes) {
    axes_.push_back(
        std::make_unique<AxisInstance>(std::make_shared<const AxisConstants>(axis), log));
  }
}

template <class Do>
bool MachineInstance::all(Do what) {
  return std::all_of(axes_.begin(), axes_.end(), [&](const auto& axis) { return what(*axis); });
}

bool MachineInstance::refuse(const std::string& why) const {
  log_(Severity::error, why);
  return false;
}

bool MachineInstance::set_up(double start_time) {
  return all([&](AxisInstance& axis) { return axis.set_up(start_time); });
}

bool MachineInstance::enter_initialization() {
  return all([](AxisInstance& axis) { return axis.enter_initialization(); });
}

// An axis that cannot be initialised leaves all as they were.
bool MachineInstance::exit_initialization() {
  const Memory before = memory();
  if (all([](AxisInstance& axis) { return axis.exit_initialization(); })) return true;
  for (std::size_t n = 0; n < axes_.size(); ++n) {
    if (axes_[n]->memory().stage != before.axes[n].stage) axes_[n]->restore(before.axes[n]);
  }
  return false;
}

bool MachineInstance::terminate() {
  return all([](AxisInstance& axis) { return axis.terminate(); });
}

void MachineInstance::reset() {
  stopped_ = false;
  for (const auto& axis : axes_) axis->reset();
}

AxisInstance* MachineInstance::axis_of(std::uint32_t reference) {
  const std::size_t n = reference / kAxisStride;
  if (n < axes_.size()) return axes_[n].get();
  refuse(fmt::format("no variable has the value reference {}", reference));
  return nullptr;
}

bool MachineInstance::get(std::uint32_t reference, double& value) {
  AxisInstance* const axis = axis_of(reference);
  return axis != nullptr && axis->get(reference % kAxisStride, value);
}

bool MachineInstance::set(std::uint32_t reference, double value) {
  AxisInstance* const axis = axis_of(reference);
  return axis != nullptr && axis->set(reference % kAxisStride, value);
}

Step MachineInstance::step(double current, double step) {
  if (stopped_) {
    refuse("the NC has stopped the machine");
    return Step::refused;
  }
  // only several axes may have to step back
  const Memory before = axes_.size() > 1 ? memory() : Memory();
  double end = std::numeric_limits<double>::infinity();
  for (const auto& axis : axes_) {
    const Step done = axis->step(current, step);
    if (done == Step::refused) {
      if (axis != axes_.front()) restore(before);
      return done;
    }
    if (done == Step::stopped) end = std::min(end, axis->time());
  }
  stopped_ = end < std::numeric_limits<double>::infinity();
  if (!stopped_) return Step::done;
  return axes_.size() > 1 ? stop_at(current, end, before) : Step::stopped;
}

// All axes go to the position period in which the first was stopped.
Step MachineInstance::stop_at(double current, double end, const Memory& before) {
  for (std::size_t n = 0; n < axes_.size(); ++n) {
    axes_[n]->restore(before.axes[n]);
    if (end > current) axes_[n]->step(current, end - current);
  }
  return Step::stopped;
}

MachineInstance::Memory MachineInstance::memory() const {
  Memory memory{stopped_, {}};
  for (const auto& axis : axes_) memory.axes.push_back(axis->memory());
  return memory;
}

bool MachineInstance::restore(const Memory& memory) {
  for (std::size_t n = 0; n < axes_.size(); ++n) {
    if (!axes_[n]->restore(memory.axes.at(n))) return false;
  }
  stopped_ = memory.stopped;
  return true;
}

// "1" or "0" for stopped; then of each axis the number of its bytes, and these.
std::string MachineInstance::bytes_of(const Memory& memory) const {
  std::string bytes = memory.stopped ? "1" : "0";
  for (std::size_t n = 0; n < axes_.size(); ++n) {
    const std::string own = axes_[n]->bytes_of(memory.axes.at(n));
    const std::uint64_t size = own.size();
    bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
    bytes += own;
  }
  return bytes;
}

std::optional<MachineInstance::Memory> MachineInstance::memory_from(std::string_view bytes) {
  const auto damaged = [&] {
    refuse("the serialized state is damaged, or of another axis or version");
    return std::nullopt;
  };
  if (bytes.empty() || (bytes[0] != '0' && bytes[0] != '1')) return damaged();
  Memory memory{bytes[0] == '1', {}};
  bytes.remove_prefix(1);
  for (const auto& axis : axes_) {
    std::uint64_t size = 0;
    if (bytes.size() < sizeof size) return damaged();
    std::memcpy(&size, bytes.data(), sizeof size);
    bytes.remove_prefix(sizeof size);
    if (bytes.size() < size) return damaged();
    auto own = axis->memory_from(bytes.substr(0, size));
    if (!own) return std::nullopt;
    memory.axes.push_back(std::move(*own));
    bytes.remove_prefix(size);
  }
  return bytes.empty() ? std::optional(std::move(memory)) : damaged();
}

}  // namespace servomill::sim::fmu
