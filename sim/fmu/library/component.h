/// An instance as the functions of both versions of FMI use it.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "sim/fmu/library/fmu_files.h"
#include "sim/fmu/machine_instance.h"

#define SERVOMILL_FMI extern "C" __attribute__((visibility("default")))

namespace servomill::sim::fmu {

/// An instance with its logger. The functions return false where the standard has an error.
class Component {
 public:
  using Log = MachineInstance::Log;

  /// @throws InputError
  Component(Log log, bool logs_events, const std::string& resources, const std::string& token);
  Component(const Component&) = delete;
  Component& operator=(const Component&) = delete;

  MachineInstance& machine() { return *machine_; }
  void log(Severity severity, const std::string& message) const;
  bool refuse(const std::string& why) const;
  /// Switches the logging of events; errors and stops are logged always. Without categories: all.
  bool log_events(bool on, std::size_t count, const char* const categories[]);

  /// True for clocks that tick now.
  bool ticks(const unsigned references[], std::size_t count, bool values[]);
  bool get(const unsigned references[], std::size_t count, double values[]);
  bool set(const unsigned references[], std::size_t count, const double values[]);

  /// States are owned by the importer until free_state.
  bool get_state(void** state);
  bool set_state(void* state);
  bool free_state(void** state);
  bool state_size(void* state, std::size_t* size);
  bool write_state(void* state, char bytes[], std::size_t size);
  bool read_state(const char bytes[], std::size_t size, void** state);

  /// True if `run`, which is bool(), neither fails nor throws; the exception is logged.
  template <class Run>
  bool does(Run run) noexcept {
    return guarded(run, [&](const std::string& why) { return refuse(why); });
  }

 private:
  Log log_;
  bool logs_events_;
  std::unique_ptr<MachineInstance> machine_;
};

}  // namespace servomill::sim::fmu
