#include "sim/fmu/axis_instance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "plant/vocabulary/checksum.h"

namespace servomill::sim::fmu {
namespace {

constexpr double kMaxTicks = 1e14;  // whose tenths a double still resolves

// Ticks that have passed after `seconds`.
Tick ticks_after(double seconds, double base) {
  return static_cast<Tick>(std::floor(seconds / base + kSameTick));
}

bool same_parameters(const Values& a, const Values& b) {
  for (const Variable& one : variables()) {
    if (one.causality == Causality::parameter && a[one.reference] != b[one.reference]) return false;
  }
  return true;
}

template <class Part>
void append(std::string& bytes, std::span<Part> part) {
  static_assert(std::is_trivially_copyable_v<Part>);
  bytes.append(reinterpret_cast<const char*>(part.data()), part.size_bytes());
}

// Takes parts from the front of bytes.
struct Taking {
  std::string_view rest;
  bool enough = true;

  template <class Part>
  void operator()(std::span<Part> part) {
    static_assert(std::is_trivially_copyable_v<Part>);
    if (rest.size() < part.size_bytes()) {
      enough = false;
      return;
    }
    if (part.empty()) return;
    std::memcpy(static_cast<void*>(part.data()), rest.data(), part.size_bytes());
    rest.remove_prefix(part.size_bytes());
  }
};

// Beginning of the bytes of a memory, before the simulation.
struct Head {
  char name[16] = "servomill state";
  std::uint64_t axis = 0;  // checksum of its constants
  Stage stage = Stage::instantiated;
  bool stopped = false, simulated = false, on_the_way = false;
  char spare[4] = {};  // no gap, whose bytes would be anything
  double start_time = 0.0, time = 0.0;
};

bool is_before_stepping(Stage stage) {
  return stage == Stage::instantiated || stage == Stage::initialising;
}

}  // namespace

std::string set_fault(const Variable& variable, Stage stage, double value) {
  const bool is_input = variable.causality == Causality::input;
  if (!is_input && variable.causality != Causality::parameter) {
    return fmt::format("'{}' cannot be set", variable.name);
  }
  if (!is_input && !is_before_stepping(stage)) {
    return fmt::format("'{}' is fixed after initialization", variable.name);
  }
  return std::isfinite(value) ? std::string() : fmt::format("'{}' must be finite", variable.name);
}

AxisInstance::AxisInstance(std::shared_ptr<const AxisConstants> axis, Log log)
    : axis_(std::move(axis)), log_(std::move(log)), values_(start_values(*axis_)) {}

bool AxisInstance::refuse(const std::string& why) const {
  log_(Severity::error, why);
  return false;
}

bool AxisInstance::set_up(double start_time) {
  if (stage_ != Stage::instantiated)
    return refuse("the experiment is set up before initialization");
  if (!std::isfinite(start_time)) return refuse("the start time must be finite");
  start_time_ = time_ = start_time;
  return true;
}

bool AxisInstance::enter_initialization() {
  if (stage_ != Stage::instantiated) return refuse("initialization follows instantiation");
  stage_ = Stage::initialising;
  settled_ = false;
  return true;
}

bool AxisInstance::exit_initialization() {
  if (stage_ != Stage::initialising) return refuse("no initialization to be ended");
  if (!settle_if_needed()) return false;
  stage_ = Stage::stepping;
  log_(Severity::event,
       fmt::format("axis {} is at rest at {} {}", axis_->axis, inputs_of(values_).setpoint,
                   unit_of(Kind::position, *axis_).name));
  return true;
}

bool AxisInstance::terminate() {
  if (stage_ != Stage::stepping) return refuse("only an axis that has been initialised terminates");
  stage_ = Stage::terminated;
  return true;
}

void AxisInstance::reset() {
  stage_ = Stage::instantiated;
  values_ = start_values(*axis_);
  stopped_ = settled_ = false;
  start_time_ = time_ = 0.0;
}

// Drives are prepared again where a parameter has changed.
bool AxisInstance::simulate_with_parameters() {
  if (simulation_ && same_parameters(*simulated_, values_)) return true;
  std::string fault;
  const AxisConstants axis = with_parameters(*axis_, values_, fault);
  if (!fault.empty()) return refuse(fault);
  simulation_ = std::make_unique<AxisSimulation>(axis);
  simulated_ = values_;
  settled_ = false;
  return true;
}

bool AxisInstance::settle_if_needed() {
  if (settled_) return true;
  if (!simulate_with_parameters()) return false;
  simulation_->settle(inputs_of(values_));
  settled_ = true;
  update_outputs();
  return true;
}

void AxisInstance::update_outputs() { put(simulation_->outputs(), time_, values_); }

bool AxisInstance::get(std::uint32_t reference, double& value) {
  if (reference >= values_.size()) {
    return refuse(fmt::format("no variable has the value reference {}", reference));
  }
  const Variable& variable = variables()[reference];
  if (variable.causality == Causality::output && stage_ == Stage::instantiated) {
    return refuse(fmt::format("'{}' has no value before initialization", variable.name));
  }
  if (stage_ == Stage::initialising && !settle_if_needed()) return false;
  value = variable.causality == Causality::independent ? time_ : values_[reference];
  return true;
}

bool AxisInstance::set(std::uint32_t reference, double value) {
  if (reference >= values_.size()) {
    return refuse(fmt::format("no variable has the value reference {}", reference));
  }
  const Variable& variable = variables()[reference];
  const std::string fault = set_fault(variable, stage_, value);
  if (!fault.empty()) return refuse(fault);
  values_[reference] = value;
  if (is_before_stepping(stage_)) settled_ = false;
  return true;
}

Step AxisInstance::step(double current, double step) {
  if (stage_ != Stage::stepping || stopped_) {
    refuse(stopped_ ? "the NC has stopped the machine" : "no step outside of the simulation");
    return Step::refused;
  }
  const double base = periods().base;
  if (!(std::abs(current - time_) <= kSameTick * base)) {
    refuse(fmt::format("a step from {} s: the last communication point is {} s", current, time_));
    return Step::refused;
  }
  const double end = current + step;
  if (!(step > 0.0 && (end - start_time_) / base < kMaxTicks)) {
    refuse(fmt::format("a step of {} s; must be > 0, and end within {:g} base periods", step,
                       kMaxTicks));
    return Step::refused;
  }
  const Tick to = std::max(ticks_after(end - start_time_, base), simulation_->now());
  stopped_ = !simulation_->advance(to, inputs_of(values_));
  time_ = stopped_ ? start_time_ + simulation_->seconds(simulation_->now()) : end;
  update_outputs();
  if (!stopped_) return Step::done;
  log_(Severity::stop,
       fmt::format("axis {}: {} at {:.4f} s", axis_->axis, simulation_->fault(), time_));
  return Step::stopped;
}

double AxisInstance::time() const { return time_; }

double AxisInstance::time_of(Tick tick) const { return start_time_ + periods().seconds(tick); }

std::optional<Tick> AxisInstance::tick() const {
  const double since_start = time_ - start_time_;
  const Tick tick = ticks_after(since_start, periods().base);
  const bool is_at = since_start - periods().seconds(tick) <= kSameTick * periods().base;
  return is_at ? std::optional(tick) : std::nullopt;
}

AxisInstance::Memory AxisInstance::memory() const {
  Memory memory{stage_, stopped_, start_time_, time_, values_, {}};
  if (settled_) memory.simulation = simulation_->memory();
  return memory;
}

bool AxisInstance::restore(const Memory& memory) {
  const Values before = values_;
  values_ = memory.values;
  if (memory.simulation && !simulate_with_parameters()) {
    values_ = before;
    return false;
  }
  stage_ = memory.stage;
  stopped_ = memory.stopped;
  start_time_ = memory.start_time;
  time_ = memory.time;
  settled_ = memory.simulation.has_value();
  if (settled_) simulation_->restore(*memory.simulation);
  return true;
}

std::string AxisInstance::bytes_of(const Memory& memory) const {
  Head head;
  head.axis = crc64(text_of(*axis_));
  head.stage = memory.stage;
  head.stopped = memory.stopped;
  head.simulated = memory.simulation.has_value();
  head.on_the_way = head.simulated && memory.simulation->clock.on_the_way;
  head.start_time = memory.start_time;
  head.time = memory.time;
  std::string bytes;
  append(bytes, std::span(&head, 1));
  append(bytes, std::span<const double>(memory.values));
  if (memory.simulation) {
    AxisSimulation::Memory copy = *memory.simulation;  // parts are visited as a reader writes them
    copy.each_part([&](auto part) { append(bytes, part); });
  }
  const std::uint64_t checksum = crc64(bytes);
  append(bytes, std::span(&checksum, 1));
  return bytes;
}

std::optional<AxisInstance::Memory> AxisInstance::memory_from(std::string_view bytes) {
  const auto damaged = [&] {
    refuse("the serialized state is damaged, or of another axis or version");
    return std::nullopt;
  };
  std::uint64_t checksum = 0;
  if (bytes.size() < sizeof checksum + sizeof(Head)) return damaged();
  Taking{bytes.substr(bytes.size() - sizeof checksum)}(std::span(&checksum, 1));
  bytes.remove_suffix(sizeof checksum);
  Taking taking{bytes};
  Head head;
  taking(std::span(&head, 1));
  if (checksum != crc64(bytes) || head.axis != crc64(text_of(*axis_)) ||
      std::strcmp(head.name, Head().name) != 0) {
    return damaged();
  }
  Memory memory{head.stage, head.stopped, head.start_time, head.time, {}, {}};
  taking(std::span<double>(memory.values));
  if (head.simulated) {
    // sizes are those of any state of this axis
    std::string fault;
    const AxisConstants axis = with_parameters(*axis_, memory.values, fault);
    if (!fault.empty()) return damaged();
    AxisSimulation model(axis);
    model.settle({});
    AxisSimulation::Memory simulation = model.memory();
    simulation.before = simulation.axes;
    simulation.clock.on_the_way = head.on_the_way;
    simulation.each_part([&](auto part) { taking(part); });
    memory.simulation = std::move(simulation);
  }
  if (!taking.enough || !taking.rest.empty()) return damaged();
  return memory;
}

}  // namespace servomill::sim::fmu
