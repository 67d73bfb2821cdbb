/// The functions of FMI 2.0 for co-simulation: an axis in the form that the standard asks for.
#include "sim/fmu/library/component.h"
#include "sim/fmu/library/fmi2_functions.h"

namespace servomill::sim::fmu {
namespace {

struct Instance {
  std::unique_ptr<Component> component;
  fmi2Status step_status = fmi2OK;
};

Instance& instance_of(fmi2Component c) { return *static_cast<Instance*>(c); }

// Status of `run`, which is bool(Component&).
template <class Run>
fmi2Status status_of(fmi2Component c, Run run) {
  if (c == nullptr) return fmi2Error;
  Component& component = *instance_of(c).component;
  return component.does([&] { return run(component); }) ? fmi2OK : fmi2Error;
}

// Status of functions for kinds of variables that there are not.
fmi2Status none_of(fmi2Component c, std::size_t count, const char* kind) {
  return status_of(c, [&](Component& it) {
    return count == 0 || it.refuse(std::string("an axis has no variables of type ") + kind);
  });
}

fmi2Status unsupported(fmi2Component c, const char* what) {
  return status_of(
      c, [&](Component& it) { return it.refuse(std::string(what) + " is not supported"); });
}

Component::Log log_of(const fmi2CallbackFunctions& callbacks, const std::string& name) {
  if (callbacks.logger == nullptr) return [](Severity, const std::string&) {};
  return [callbacks, name](Severity severity, const std::string& message) {
    constexpr fmi2Status kStatus[] = {fmi2OK, fmi2Discard, fmi2Error};
    constexpr const char* kCategory[] = {"logEvents", "logStatusDiscard", "logStatusError"};
    const auto n = static_cast<std::size_t>(severity);
    callbacks.logger(callbacks.componentEnvironment, name.c_str(), kStatus[n], kCategory[n], "%s",
                     message.c_str());
  };
}

}  // namespace

SERVOMILL_FMI const char* fmi2GetTypesPlatform() { return "default"; }
SERVOMILL_FMI const char* fmi2GetVersion() { return "2.0"; }

SERVOMILL_FMI fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, std::size_t count,
                                             const fmi2String categories[]) {
  return status_of(c, [&](Component& it) { return it.log_events(on != 0, count, categories); });
}

SERVOMILL_FMI fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid,
                                            fmi2String resources,
                                            const fmi2CallbackFunctions* callbacks,
                                            fmi2Boolean /*visible*/, fmi2Boolean logging) {
  if (callbacks == nullptr || name == nullptr) return nullptr;
  Component::Log log;
  const auto fail = [&](const std::string& why) -> fmi2Component {
    if (log) log(Severity::error, why);
    return nullptr;
  };
  return guarded(
      [&]() -> fmi2Component {
        log = log_of(*callbacks, name);
        if (type != fmi2CoSimulation) return fail("only co-simulation is supported");
        if (*name == '\0') return fail("an instance needs a name");
        if (guid == nullptr || resources == nullptr) return fail("guid and resources are needed");
        auto instance = std::make_unique<Instance>();
        instance->component =
            std::make_unique<Component>(log, logging != 0, path_of(resources), guid);
        return instance.release();
      },
      fail);
}

SERVOMILL_FMI void fmi2FreeInstance(fmi2Component c) { delete static_cast<Instance*>(c); }

SERVOMILL_FMI fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean /*tolerance_defined*/,
                                             fmi2Real /*tolerance*/, fmi2Real start_time,
                                             fmi2Boolean /*stop_defined*/, fmi2Real /*stop_time*/) {
  return status_of(c, [&](Component& it) { return it.machine().set_up(start_time); });
}
SERVOMILL_FMI fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  return status_of(c, [](Component& it) { return it.machine().enter_initialization(); });
}
SERVOMILL_FMI fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  return status_of(c, [](Component& it) { return it.machine().exit_initialization(); });
}
SERVOMILL_FMI fmi2Status fmi2Terminate(fmi2Component c) {
  return status_of(c, [](Component& it) { return it.machine().terminate(); });
}
SERVOMILL_FMI fmi2Status fmi2Reset(fmi2Component c) {
  return status_of(c, [&](Component& it) {
    it.machine().reset();
    instance_of(c).step_status = fmi2OK;
    return true;
  });
}

SERVOMILL_FMI fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference references[],
                                     std::size_t count, fmi2Real values[]) {
  return status_of(c, [&](Component& it) { return it.get(references, count, values); });
}
SERVOMILL_FMI fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference references[],
                                     std::size_t count, const fmi2Real values[]) {
  return status_of(c, [&](Component& it) { return it.set(references, count, values); });
}
SERVOMILL_FMI fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference[],
                                        std::size_t count, fmi2Integer[]) {
  return none_of(c, count, "Integer");
}
SERVOMILL_FMI fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference[],
                                        std::size_t count, fmi2Boolean[]) {
  return none_of(c, count, "Boolean");
}
SERVOMILL_FMI fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference[],
                                       std::size_t count, fmi2String[]) {
  return none_of(c, count, "String");
}
SERVOMILL_FMI fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference[],
                                        std::size_t count, const fmi2Integer[]) {
  return none_of(c, count, "Integer");
}
SERVOMILL_FMI fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference[],
                                        std::size_t count, const fmi2Boolean[]) {
  return none_of(c, count, "Boolean");
}
SERVOMILL_FMI fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference[],
                                       std::size_t count, const fmi2String[]) {
  return none_of(c, count, "String");
}

SERVOMILL_FMI fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* state) {
  return status_of(c, [&](Component& it) { return it.get_state(state); });
}
SERVOMILL_FMI fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
  return status_of(c, [&](Component& it) { return it.set_state(state); });
}
SERVOMILL_FMI fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate* state) {
  return status_of(c, [&](Component& it) { return it.free_state(state); });
}
SERVOMILL_FMI fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state,
                                                    std::size_t* size) {
  return status_of(c, [&](Component& it) { return it.state_size(state, size); });
}
SERVOMILL_FMI fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state,
                                               fmi2Byte bytes[], std::size_t size) {
  return status_of(c, [&](Component& it) { return it.write_state(state, bytes, size); });
}
SERVOMILL_FMI fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[],
                                                 std::size_t size, fmi2FMUstate* state) {
  return status_of(c, [&](Component& it) { return it.read_state(bytes, size, state); });
}

SERVOMILL_FMI fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference[],
                                                      std::size_t, const fmi2ValueReference[],
                                                      std::size_t, const fmi2Real[], fmi2Real[]) {
  return unsupported(c, "a directional derivative");
}
SERVOMILL_FMI fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference[],
                                                     std::size_t count, const fmi2Integer[],
                                                     const fmi2Real[]) {
  return count == 0 ? fmi2OK : unsupported(c, "the interpolation of inputs");
}
SERVOMILL_FMI fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference[],
                                                      std::size_t count, const fmi2Integer[],
                                                      fmi2Real[]) {
  return count == 0 ? fmi2OK : unsupported(c, "a derivative of an output");
}

SERVOMILL_FMI fmi2Status fmi2DoStep(fmi2Component c, fmi2Real current, fmi2Real step,
                                    fmi2Boolean /*no_state_before*/) {
  Step done = Step::refused;
  const fmi2Status status = status_of(c, [&](Component& it) {
    done = it.machine().step(current, step);
    return done != Step::refused;
  });
  if (c == nullptr) return fmi2Error;
  instance_of(c).step_status = done == Step::stopped ? fmi2Discard : status;
  return instance_of(c).step_status;
}
SERVOMILL_FMI fmi2Status fmi2CancelStep(fmi2Component c) {
  return unsupported(c, "a step in the background");
}

SERVOMILL_FMI fmi2Status fmi2GetStatus(fmi2Component c, fmi2StatusKind kind, fmi2Status* value) {
  if (c == nullptr || kind != fmi2DoStepStatus) return fmi2Discard;
  *value = instance_of(c).step_status;
  return fmi2OK;
}
SERVOMILL_FMI fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real* value) {
  if (c == nullptr || kind != fmi2LastSuccessfulTime) return fmi2Discard;
  *value = instance_of(c).component->machine().time();
  return fmi2OK;
}
SERVOMILL_FMI fmi2Status fmi2GetIntegerStatus(fmi2Component, fmi2StatusKind, fmi2Integer*) {
  return fmi2Discard;
}
SERVOMILL_FMI fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind,
                                              fmi2Boolean* value) {
  if (c == nullptr || kind != fmi2Terminated) return fmi2Discard;
  *value = instance_of(c).component->machine().is_stopped() ? 1 : 0;
  return fmi2OK;
}
SERVOMILL_FMI fmi2Status fmi2GetStringStatus(fmi2Component, fmi2StatusKind, fmi2String*) {
  return fmi2Discard;
}

}  // namespace servomill::sim::fmu
