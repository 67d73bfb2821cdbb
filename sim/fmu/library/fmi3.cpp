/// The functions of FMI 3.0 for co-simulation: an axis in the form that the standard asks for.
#include "sim/fmu/library/fmi3_status.h"

namespace servomill::sim::fmu {
namespace {

Component::Log log_of(fmi3LogMessageCallback logger, fmi3InstanceEnvironment environment) {
  if (logger == nullptr) return [](Severity, const std::string&) {};
  return [logger, environment](Severity severity, const std::string& message) {
    constexpr fmi3Status kStatus[] = {fmi3OK, fmi3Warning, fmi3Error};
    constexpr const char* kCategory[] = {"logEvents", "logStatusDiscard", "logStatusError"};
    const auto n = static_cast<std::size_t>(severity);
    logger(environment, kStatus[n], kCategory[n], message.c_str());
  };
}

}  // namespace

SERVOMILL_FMI const char* fmi3GetVersion() { return "3.0"; }

SERVOMILL_FMI fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, std::size_t count,
                                             const fmi3String categories[]) {
  return status_of(c, [&](Component& it) { return it.log_events(on, count, categories); });
}

SERVOMILL_FMI fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean /*visible*/,
    fmi3Boolean logging, fmi3Boolean event_mode, fmi3Boolean early_return,
    const fmi3ValueReference /*intermediate*/[], std::size_t intermediate_count,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger, void (*)()) {
  Component::Log log;
  const auto fail = [&](const std::string& why) -> fmi3Instance {
    if (log) log(Severity::error, why);
    return nullptr;
  };
  return guarded(
      [&]() -> fmi3Instance {
        log = log_of(logger, environment);
        if (name == nullptr || *name == '\0') return fail("an instance needs a name");
        if (token == nullptr || resources == nullptr) return fail("token and resources are needed");
        if (intermediate_count > 0) return fail("intermediate variables are not supported");
        auto component = std::make_unique<Component>(log, logging, resources, token);
        if (event_mode) component->machine().use_events(early_return);
        return component.release();
      },
      fail);
}
SERVOMILL_FMI fmi3Instance fmi3InstantiateModelExchange(fmi3String, fmi3String, fmi3String,
                                                        fmi3Boolean, fmi3Boolean,
                                                        fmi3InstanceEnvironment,
                                                        fmi3LogMessageCallback) {
  return nullptr;
}
SERVOMILL_FMI fmi3Instance fmi3InstantiateScheduledExecution(fmi3String, fmi3String, fmi3String,
                                                             fmi3Boolean, fmi3Boolean,
                                                             fmi3InstanceEnvironment,
                                                             fmi3LogMessageCallback, void (*)(),
                                                             void (*)(), void (*)()) {
  return nullptr;
}
SERVOMILL_FMI void fmi3FreeInstance(fmi3Instance c) { delete static_cast<Component*>(c); }

SERVOMILL_FMI fmi3Status fmi3EnterInitializationMode(
    fmi3Instance c, fmi3Boolean /*tolerance_defined*/, fmi3Float64 /*tolerance*/,
    fmi3Float64 start_time, fmi3Boolean /*stop_defined*/, fmi3Float64 /*stop_time*/) {
  return status_of(c, [&](Component& it) {
    return it.machine().set_up(start_time) && it.machine().enter_initialization();
  });
}
SERVOMILL_FMI fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
  return status_of(c, [](Component& it) { return it.machine().exit_initialization(); });
}
SERVOMILL_FMI fmi3Status fmi3Terminate(fmi3Instance c) {
  return status_of(c, [](Component& it) { return it.machine().terminate(); });
}
SERVOMILL_FMI fmi3Status fmi3Reset(fmi3Instance c) {
  return status_of(c, [](Component& it) {
    it.machine().reset();
    return true;
  });
}

SERVOMILL_FMI fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference references[],
                                        std::size_t count, fmi3Float64 values[],
                                        std::size_t value_count) {
  return status_of(c, [&](Component& it) {
    if (count != value_count) return it.refuse("all variables are scalars");
    return it.get(references, count, values);
  });
}
SERVOMILL_FMI fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference references[],
                                        std::size_t count, const fmi3Float64 values[],
                                        std::size_t value_count) {
  return status_of(c, [&](Component& it) {
    if (count != value_count) return it.refuse("all variables are scalars");
    return it.set(references, count, values);
  });
}

SERVOMILL_FMI fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState* state) {
  return status_of(c, [&](Component& it) { return it.get_state(state); });
}
SERVOMILL_FMI fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) {
  return status_of(c, [&](Component& it) { return it.set_state(state); });
}
SERVOMILL_FMI fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState* state) {
  return status_of(c, [&](Component& it) { return it.free_state(state); });
}
SERVOMILL_FMI fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state,
                                                    std::size_t* size) {
  return status_of(c, [&](Component& it) { return it.state_size(state, size); });
}
SERVOMILL_FMI fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[],
                                               std::size_t size) {
  return status_of(c, [&](Component& it) {
    return it.write_state(state, reinterpret_cast<char*>(bytes), size);
  });
}
SERVOMILL_FMI fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[],
                                                 std::size_t size, fmi3FMUState* state) {
  return status_of(c, [&](Component& it) {
    return it.read_state(reinterpret_cast<const char*>(bytes), size, state);
  });
}

SERVOMILL_FMI fmi3Status fmi3EnterEventMode(fmi3Instance c) {
  return status_of(c, [](Component& it) { return it.machine().enter_event_mode(); });
}
SERVOMILL_FMI fmi3Status fmi3EnterStepMode(fmi3Instance c) {
  return status_of(c, [](Component& it) { return it.machine().enter_step_mode(); });
}
SERVOMILL_FMI fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference references[],
                                      std::size_t count, fmi3Boolean values[]) {
  return status_of(c, [&](Component& it) { return it.ticks(references, count, values); });
}
SERVOMILL_FMI fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference[], std::size_t count,
                                      const fmi3Boolean[]) {
  return count == 0 ? fmi3OK : unsupported(c, "the activation of an output clock");
}

// One update is enough: nothing but clocks changes in event mode.
SERVOMILL_FMI fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean* needs_update,
                                                  fmi3Boolean* terminate,
                                                  fmi3Boolean* nominals_changed,
                                                  fmi3Boolean* states_changed,
                                                  fmi3Boolean* next_event_defined,
                                                  fmi3Float64* next_event) {
  return status_of(c, [&](Component& it) {
    if (!it.machine().is_in_event_mode()) return it.refuse("only event mode updates states");
    *needs_update = *nominals_changed = *states_changed = false;
    *terminate = it.machine().is_stopped();
    *next_event_defined = true;
    *next_event = it.machine().next_event_time();
    return true;
  });
}
SERVOMILL_FMI fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c) {
  return status_of(c, [](Component& it) {
    return it.machine().is_in_event_mode() || it.refuse("only event mode evaluates states");
  });
}

// A machine that the NC stops: the FMU asks to end the simulation at the time that it reached.
SERVOMILL_FMI fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 current, fmi3Float64 step,
                                    fmi3Boolean /*no_state_before*/, fmi3Boolean* event_needed,
                                    fmi3Boolean* terminate, fmi3Boolean* early_return,
                                    fmi3Float64* last_time) {
  return status_of(c, [&](Component& it) {
    MachineInstance& machine = it.machine();
    const Step done = machine.step(current, step);
    *terminate = done == Step::stopped;
    *event_needed = done == Step::done && machine.event_is_due();
    *last_time = machine.time();
    *early_return = done == Step::done && *last_time < current + step;
    return done != Step::refused;
  });
}

}  // namespace servomill::sim::fmu
