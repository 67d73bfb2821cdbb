#include "sim/fmu/machine_instance.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "plant/vocabulary/checksum.h"
#include "sim/fmu/clocks.h"

namespace servomill::sim::fmu {
namespace {

// The tip as bytes.
struct Tip {
  std::array<double, 3> p_ST{};
  std::uint64_t checksum = 0;

  static std::uint64_t checksum_of(const std::array<double, 3>& p) {
    return crc64({reinterpret_cast<const char*>(p.data()), sizeof p});
  }
  static Tip of(const Eigen::Vector3d& p_ST) {
    Tip tip{{p_ST.x(), p_ST.y(), p_ST.z()}, 0};
    tip.checksum = checksum_of(tip.p_ST);
    return tip;
  }
  bool is_whole() const { return checksum == checksum_of(p_ST); }
};

template <class Part>
void append(std::string& bytes, const Part& part) {
  static_assert(std::has_unique_object_representations_v<Part> || std::is_same_v<Part, Tip>);
  bytes.append(reinterpret_cast<const char*>(&part), sizeof part);
}

// From the front of the bytes; false if there are too few.
template <class Part>
bool take(std::string_view& bytes, Part& part) {
  if (bytes.size() < sizeof part) return false;
  std::memcpy(&part, bytes.data(), sizeof part);
  bytes.remove_prefix(sizeof part);
  return true;
}

}  // namespace

MachineInstance::MachineInstance(const MachineConstants& machine, const Log& log) : log_(log) {
  assert(!machine.axes.empty());
  const auto of_axis = [log, stops = stops_](Severity severity, const std::string& message) {
    if (severity == Severity::stop) {
      stops->push_back(message);
    } else {
      log(severity, message);
    }
  };
  for (const AxisConstants& axis : machine.axes) {
    axes_.push_back(
        std::make_unique<AxisInstance>(std::make_shared<const AxisConstants>(axis), of_axis));
    joints_.push_back(axis.joint);
  }
  if (!machine.kinematics) return;
  tool_.emplace(*machine.kinematics);
  default_p_ST_ = p_ST_ = machine.kinematics->p_ST;
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
  if (all([](AxisInstance& axis) { return axis.exit_initialization(); })) {
    in_event_mode_ = events_used_;
    return true;
  }
  for (std::size_t n = 0; n < axes_.size(); ++n) {
    if (axes_[n]->memory().stage != before.axes[n].stage) axes_[n]->restore(before.axes[n]);
  }
  return false;
}

bool MachineInstance::terminate() {
  return all([](AxisInstance& axis) { return axis.terminate(); });
}

void MachineInstance::reset() {
  in_event_mode_ = false;
  p_ST_ = default_p_ST_;
  for (const auto& axis : axes_) axis->reset();
}

AxisInstance* MachineInstance::axis_of(std::uint32_t reference) {
  const std::size_t n = reference / kAxisStride;
  if (n < axes_.size()) return axes_[n].get();
  refuse(fmt::format("no variable has the value reference {}", reference));
  return nullptr;
}

bool MachineInstance::is_of_tool(std::uint32_t reference) const {
  return tool_ && reference >= kToolReference && reference - kToolReference < kToolVariables;
}

bool MachineInstance::get_of_tool(std::uint32_t n, double& value) {
  if (n < kTipCoordinates) {
    value = p_ST_[static_cast<int>(n)];
    return true;
  }
  static const std::uint32_t kPosition = reference_of("position");
  Joints Q = Joints::Zero();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (!axes_[i]->get(kPosition, Q[joints_[i]])) return false;
  }
  if (!tool_outputs_ || tool_outputs_->Q != Q || tool_outputs_->p_ST != p_ST_) {
    tool_outputs_ = {Q, p_ST_, tool_->values(Q, p_ST_)};
  }
  value = tool_outputs_->values[n];
  return true;
}

bool MachineInstance::set_of_tool(std::uint32_t n, double value) {
  const std::string fault = set_fault(tool_variables()[n], axes_.front()->stage(), value);
  if (!fault.empty()) return refuse(fault);
  p_ST_[static_cast<int>(n)] = value;
  return true;
}

bool MachineInstance::get(std::uint32_t reference, double& value) {
  if (is_of_tool(reference)) return get_of_tool(reference - kToolReference, value);
  AxisInstance* const axis = axis_of(reference);
  return axis != nullptr && axis->get(reference % kAxisStride, value);
}

bool MachineInstance::set(std::uint32_t reference, double value) {
  if (is_of_tool(reference)) return set_of_tool(reference - kToolReference, value);
  AxisInstance* const axis = axis_of(reference);
  return axis != nullptr && axis->set(reference % kAxisStride, value);
}

void MachineInstance::use_events(bool early_return) {
  events_used_ = true;
  early_return_ = early_return;
}

bool MachineInstance::enter_event_mode() {
  const bool may = events_used_ && !in_event_mode_ && axes_.front()->stage() == Stage::stepping;
  if (!may) return refuse("event mode follows a step, of an instance that uses it");
  in_event_mode_ = true;
  return true;
}

bool MachineInstance::enter_step_mode() {
  if (!in_event_mode_) return refuse("step mode follows event mode");
  in_event_mode_ = false;
  return true;
}

bool MachineInstance::ticks(std::uint32_t reference, bool& value) {
  if (!in_event_mode_) return refuse("clocks are read in event mode");
  if (reference < kClockReference || reference - kClockReference >= kClocks.size()) {
    return refuse(fmt::format("no clock has the value reference {}", reference));
  }
  const Tick period = axes_.front()->periods().*kClocks[reference - kClockReference].period;
  const auto tick = axes_.front()->tick();
  value = tick && *tick % period == 0;
  return true;
}

bool MachineInstance::event_is_due() const {
  const auto tick = axes_.front()->tick();
  return events_used_ && tick && any_ticks(axes_.front()->periods(), *tick);
}

double MachineInstance::next_event_time() const {
  const AxisInstance& axis = *axes_.front();
  const double base = axis.periods().base;
  const Tick now =
      axis.tick().value_or(static_cast<Tick>(std::floor((axis.time() - axis.time_of(0)) / base)));
  return axis.time_of(next_tick(axis.periods(), now));
}

Step MachineInstance::step(double current, double step) {
  if (in_event_mode_) {
    refuse("no step in event mode");
    return Step::refused;
  }
  if (!early_return_ || axes_.front()->stage() != Stage::stepping) return step_all(current, step);
  const double to_event = next_event_time() - current;
  const double rounding = kSameTick * axes_.front()->periods().base;
  return step_all(current, step > to_event + rounding ? to_event : step);
}

Step MachineInstance::step_all(double current, double step) {
  if (is_stopped()) {
    refuse("the NC has stopped the machine");
    return Step::refused;
  }
  // only several axes may have to step back
  const Memory before = axes_.size() > 1 ? memory() : Memory();
  double end = std::numeric_limits<double>::infinity();
  stops_->clear();
  std::vector<double> stopped_at;  // as stops_
  for (const auto& axis : axes_) {
    const Step done = axis->step(current, step);
    if (done == Step::refused) {
      if (axis != axes_.front()) restore(before);
      return done;
    }
    if (done == Step::done) continue;
    stopped_at.push_back(axis->time());
    end = std::min(end, axis->time());
  }
  if (stopped_at.empty()) return Step::done;
  for (std::size_t n = 0; n < stopped_at.size(); ++n) {
    if (stopped_at[n] == end) log_(Severity::stop, (*stops_)[n]);
  }
  if (axes_.size() > 1) stop_at(current, end, before);
  return Step::stopped;
}

// The others go to the position period in which the first were stopped.
void MachineInstance::stop_at(double current, double end, const Memory& before) {
  for (std::size_t n = 0; n < axes_.size(); ++n) {
    if (axes_[n]->is_stopped() && axes_[n]->time() == end) continue;
    axes_[n]->restore(before.axes[n]);
    if (end > current) axes_[n]->step(current, end - current);
  }
}

bool MachineInstance::is_stopped() const {
  return std::any_of(axes_.begin(), axes_.end(),
                     [](const auto& axis) { return axis->is_stopped(); });
}

MachineInstance::Memory MachineInstance::memory() const {
  Memory memory{in_event_mode_, {}, p_ST_};
  for (const auto& axis : axes_) memory.axes.push_back(axis->memory());
  return memory;
}

bool MachineInstance::restore(const Memory& memory) {
  for (std::size_t n = 0; n < axes_.size(); ++n) {
    if (!axes_[n]->restore(memory.axes.at(n))) return false;
  }
  in_event_mode_ = memory.in_event_mode;
  p_ST_ = memory.p_ST;
  return true;
}

// "1" or "0" for event mode; then of each axis the number of its bytes, and these;
// last the tip of the tool with its checksum.
std::string MachineInstance::bytes_of(const Memory& memory) const {
  std::string bytes = {memory.in_event_mode ? '1' : '0'};
  for (std::size_t n = 0; n < axes_.size(); ++n) {
    const std::string own = axes_[n]->bytes_of(memory.axes.at(n));
    append(bytes, std::uint64_t{own.size()});
    bytes += own;
  }
  append(bytes, Tip::of(memory.p_ST));
  return bytes;
}

std::optional<MachineInstance::Memory> MachineInstance::memory_from(std::string_view bytes) {
  const auto damaged = [&] {
    refuse("the serialized state is damaged, or of another axis or version");
    return std::nullopt;
  };
  if (bytes.empty() || (bytes[0] != '0' && bytes[0] != '1')) return damaged();
  Memory memory{bytes[0] == '1', {}, {}};
  bytes.remove_prefix(1);
  for (const auto& axis : axes_) {
    std::uint64_t size = 0;
    if (!take(bytes, size) || bytes.size() < size) return damaged();
    auto own = axis->memory_from(bytes.substr(0, size));
    if (!own) return std::nullopt;
    memory.axes.push_back(std::move(*own));
    bytes.remove_prefix(size);
  }
  Tip tip;
  if (!take(bytes, tip) || !tip.is_whole() || !bytes.empty()) return damaged();
  memory.p_ST = Eigen::Vector3d::Map(tip.p_ST.data());
  return memory;
}

}  // namespace servomill::sim::fmu
