#include "sim/fmu/library/component.h"

#include <algorithm>
#include <cstring>

namespace servomill::sim::fmu {
namespace {

using Memory = MachineInstance::Memory;

Memory* memory_of(void* state) { return static_cast<Memory*>(state); }

// Puts a state in place of another one, or of none.
void replace(void** state, Memory memory) {
  auto copy = std::make_unique<Memory>(std::move(memory));
  delete memory_of(*state);
  *state = copy.release();
}

}  // namespace

Component::Component(Log log, bool logs_events, const std::string& resources,
                     const std::string& token)
    : log_(std::move(log)),
      logs_events_(logs_events),
      machine_(std::make_unique<MachineInstance>(
          machine_in(resources, token), [this](Severity severity, const std::string& message) {
            this->log(severity, message);
          })) {}

void Component::log(Severity severity, const std::string& message) const {
  if (severity != Severity::event || logs_events_) log_(severity, message);
}

bool Component::refuse(const std::string& why) const {
  log(Severity::error, why);
  return false;
}

bool Component::log_events(bool on, std::size_t count, const char* const categories[]) {
  bool events = count == 0;
  for (std::size_t n = 0; n < count; ++n) {
    events = events || std::strcmp(categories[n], "logEvents") == 0;
  }
  if (events) logs_events_ = on;
  return true;
}

bool Component::get(const unsigned references[], std::size_t count, double values[]) {
  for (std::size_t n = 0; n < count; ++n) {
    if (!machine_->get(references[n], values[n])) return false;
  }
  return true;
}

bool Component::ticks(const unsigned references[], std::size_t count, bool values[]) {
  for (std::size_t n = 0; n < count; ++n) {
    if (!machine_->ticks(references[n], values[n])) return false;
  }
  return true;
}

bool Component::set(const unsigned references[], std::size_t count, const double values[]) {
  for (std::size_t n = 0; n < count; ++n) {
    if (!machine_->set(references[n], values[n])) return false;
  }
  return true;
}

bool Component::get_state(void** state) {
  replace(state, machine_->memory());
  return true;
}

bool Component::set_state(void* state) {
  return state != nullptr ? machine_->restore(*memory_of(state)) : refuse("there is no state");
}

bool Component::free_state(void** state) {
  if (state == nullptr) return true;
  delete memory_of(*state);
  *state = nullptr;
  return true;
}

bool Component::state_size(void* state, std::size_t* size) {
  if (state == nullptr) return refuse("there is no state");
  *size = machine_->bytes_of(*memory_of(state)).size();
  return true;
}

bool Component::write_state(void* state, char bytes[], std::size_t size) {
  if (state == nullptr) return refuse("there is no state");
  const std::string all = machine_->bytes_of(*memory_of(state));
  if (all.size() > size) return refuse("the serialized state is larger than its place");
  std::copy(all.begin(), all.end(), bytes);
  return true;
}

bool Component::read_state(const char bytes[], std::size_t size, void** state) {
  auto memory = machine_->memory_from({bytes, size});
  if (memory) replace(state, std::move(*memory));
  return memory.has_value();
}

}  // namespace servomill::sim::fmu
