/* FMI 3.0 for co-simulation, declared from chapters 2.2, 2.3 and 4.2 of the standard. */
#include <dlfcn.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unit.h"

typedef void* Instance;
typedef int Fmi3Status; /* OK, warning, discard, error, fatal */
typedef void (*LogMessage)(void*, Fmi3Status, const char*, const char*);
typedef void (*IntermediateUpdate)(void*, double, bool, bool, bool, bool, bool*, double*);

struct Functions {
  const char* (*get_version)(void);
  Instance (*instantiate)(const char*, const char*, const char*, bool, bool, bool, bool,
                          const uint32_t*, size_t, void*, LogMessage, IntermediateUpdate);
  void (*free_instance)(Instance);
  Fmi3Status (*enter)(Instance, bool, double, double, bool, double);
  Fmi3Status (*leave)(Instance);
  Fmi3Status (*terminate)(Instance);
  Fmi3Status (*reset)(Instance);
  Fmi3Status (*get_float64)(Instance, const uint32_t*, size_t, double*, size_t);
  Fmi3Status (*set_float64)(Instance, const uint32_t*, size_t, const double*, size_t);
  Fmi3Status (*get_state)(Instance, void**);
  Fmi3Status (*set_state)(Instance, void*);
  Fmi3Status (*free_state)(Instance, void**);
  Fmi3Status (*state_size)(Instance, void*, size_t*);
  Fmi3Status (*write_state)(Instance, void*, uint8_t*, size_t);
  Fmi3Status (*read_state)(Instance, const uint8_t*, size_t, void**);
  Fmi3Status (*do_step)(Instance, double, double, bool, bool*, bool*, bool*, double*);
  Fmi3Status (*enter_event_mode)(Instance);
  Fmi3Status (*enter_step_mode)(Instance);
  Fmi3Status (*get_clock)(Instance, const uint32_t*, size_t, bool*);
  Fmi3Status (*update)(Instance, bool*, bool*, bool*, bool*, bool*, double*);
};

#define PLACE(member) (offsetof(struct Functions, member) + 1)
static const struct {
  const char* name;
  size_t place;
} kNames[] = {
    {"fmi3GetVersion", PLACE(get_version)},
    {"fmi3InstantiateCoSimulation", PLACE(instantiate)},
    {"fmi3FreeInstance", PLACE(free_instance)},
    {"fmi3EnterInitializationMode", PLACE(enter)},
    {"fmi3ExitInitializationMode", PLACE(leave)},
    {"fmi3Terminate", PLACE(terminate)},
    {"fmi3Reset", PLACE(reset)},
    {"fmi3GetFloat64", PLACE(get_float64)},
    {"fmi3SetFloat64", PLACE(set_float64)},
    {"fmi3GetFMUState", PLACE(get_state)},
    {"fmi3SetFMUState", PLACE(set_state)},
    {"fmi3FreeFMUState", PLACE(free_state)},
    {"fmi3SerializedFMUStateSize", PLACE(state_size)},
    {"fmi3SerializeFMUState", PLACE(write_state)},
    {"fmi3DeserializeFMUState", PLACE(read_state)},
    {"fmi3DoStep", PLACE(do_step)},
    {"fmi3EnterEventMode", PLACE(enter_event_mode)},
    {"fmi3EnterStepMode", PLACE(enter_step_mode)},
    {"fmi3GetClock", PLACE(get_clock)},
    {"fmi3UpdateDiscreteStates", PLACE(update)},
};

/* Functions that are exported and not called here. */
static const char* const kOthers =
    "SetDebugLogging InstantiateModelExchange InstantiateScheduledExecution "
    "GetFloat32 GetInt8 GetUInt8 GetInt16 GetUInt16 GetInt32 GetUInt32 GetInt64 GetUInt64 "
    "GetBoolean GetString GetBinary SetFloat32 SetInt8 SetUInt8 SetInt16 SetUInt16 "
    "SetInt32 SetUInt32 SetInt64 SetUInt64 SetBoolean SetString SetBinary SetClock "
    "GetNumberOfVariableDependencies GetVariableDependencies GetDirectionalDerivative "
    "GetAdjointDerivative EnterConfigurationMode ExitConfigurationMode GetIntervalDecimal "
    "GetIntervalFraction GetShiftDecimal GetShiftFraction SetIntervalDecimal SetIntervalFraction "
    "SetShiftDecimal SetShiftFraction EvaluateDiscreteStates "
    "EnterContinuousTimeMode CompletedIntegratorStep SetTime SetContinuousStates "
    "GetContinuousStateDerivatives GetEventIndicators GetContinuousStates "
    "GetNominalsOfContinuousStates GetNumberOfEventIndicators GetNumberOfContinuousStates "
    "GetOutputDerivatives ActivateModelPartition";

static const struct Functions* functions_of(const struct Unit* unit) { return unit->functions; }

static enum Status status_of(Fmi3Status status) { return status <= 1 ? kOk : kRefused; }

static void log_message(void* environment, Fmi3Status status, const char* category,
                        const char* message) {
  (void)environment;
  (void)status;
  snprintf(logged_category, sizeof logged_category, "%s", category);
  ++logged_messages;
  if (getenv("VERBOSE") != NULL) printf("%s: %s\n", category, message);
}

static void* instantiate_with(const struct Unit* u, const char* token, bool events) {
  char path[kPathSize], resources[kPathSize + 16];
  if (realpath(u->model->folder, path) == NULL) return NULL;
  snprintf(resources, sizeof resources, "%s/resources/", path);
  return functions_of(u)->instantiate("axis", token, resources, false, true, events, events, NULL, 0,
                                      NULL, log_message, NULL);
}
static void* instantiate(const struct Unit* u, const char* token) {
  return instantiate_with(u, token, false);
}
static void free_instance(const struct Unit* u, void* c) { functions_of(u)->free_instance(c); }
static enum Status enter(const struct Unit* u, void* c, double start_time) {
  return status_of(functions_of(u)->enter(c, false, 0.0, start_time, false, 0.0));
}
static enum Status leave(const struct Unit* u, void* c) {
  return status_of(functions_of(u)->leave(c));
}
static enum Status terminate(const struct Unit* u, void* c) {
  return status_of(functions_of(u)->terminate(c));
}
static enum Status reset(const struct Unit* u, void* c) {
  return status_of(functions_of(u)->reset(c));
}
static enum Status get(const struct Unit* u, void* c, unsigned reference, double* value) {
  return status_of(functions_of(u)->get_float64(c, &reference, 1, value, 1));
}
static enum Status set(const struct Unit* u, void* c, unsigned reference, double value) {
  return status_of(functions_of(u)->set_float64(c, &reference, 1, &value, 1));
}
static enum Status step(const struct Unit* u, void* c, double time, double length) {
  bool event = false, ends = false, early = false;
  double last = 0.0;
  const Fmi3Status status =
      functions_of(u)->do_step(c, time, length, true, &event, &ends, &early, &last);
  return ends ? kStopped : status_of(status);
}
static enum Status get_state(const struct Unit* u, void* c, void** state) {
  return status_of(functions_of(u)->get_state(c, state));
}
static enum Status set_state(const struct Unit* u, void* c, void* state) {
  return status_of(functions_of(u)->set_state(c, state));
}
static enum Status free_state(const struct Unit* u, void* c, void** state) {
  return status_of(functions_of(u)->free_state(c, state));
}
static enum Status state_size(const struct Unit* u, void* c, void* state, size_t* size) {
  return status_of(functions_of(u)->state_size(c, state, size));
}
static enum Status write_state(const struct Unit* u, void* c, void* state, char* bytes,
                               size_t size) {
  return status_of(functions_of(u)->write_state(c, state, (uint8_t*)bytes, size));
}
static enum Status read_state(const struct Unit* u, void* c, const char* bytes, size_t size,
                              void** state) {
  return status_of(functions_of(u)->read_state(c, (const uint8_t*)bytes, size, state));
}
static int names_its_version(const struct Unit* u) {
  return strncmp(functions_of(u)->get_version(), "3.0", 3) == 0;
}

/* The function of a name, which is printed if it is missing. */
static void* function(const struct Unit* unit, const char* name, int* missing) {
  void* found = unit->library == NULL ? NULL : dlsym(unit->library, name);
  if (found != NULL) return found;
  printf("missing: %s\n", name);
  ++*missing;
  return NULL;
}

int load_fmi3(struct Unit* unit) {
  int missing = 0;
  char* functions = calloc(1, sizeof(struct Functions));
  for (size_t n = 0; n < sizeof kNames / sizeof kNames[0]; ++n) {
    void* found = function(unit, kNames[n].name, &missing);
    memcpy(functions + kNames[n].place - 1, &found, sizeof found);
  }
  char* others = strdup(kOthers);
  for (char* word = strtok(others, " "); word != NULL; word = strtok(NULL, " ")) {
    char name[64];
    snprintf(name, sizeof name, "fmi3%s", word);
    function(unit, name, &missing);
  }
  free(others);
  unit->functions = functions;
  unit->api = (struct Api){instantiate, free_instance, enter,      leave,
                           terminate,   reset,         get,        set,
                           step,        get_state,     set_state,  free_state,
                           state_size,  write_state,   read_state, names_its_version};
  return missing;
}

enum { kClocks = 3 };
static const double kRounding = 1e-9; /* s, of sums of steps */
static const char* const kClockNames[kClocks] = {"position_clock", "velocity_clock",
                                                 "current_clock"};

/* An instance in event mode, driven by the ticks of its clocks. */
struct Clocked {
  const struct Unit* unit;
  Instance instance;
  uint32_t clocks[kClocks];
  unsigned setpoint, position;
  long ticks[kClocks];
  int fine;
};

/* Of a tick of the position loop. */
static double setpoint_at(long tick) { return 1e-10 * (double)tick * (double)tick; }

/* Event mode: counts the ticks, and sets the setpoint where the position loop samples it. */
static void handle_events(struct Clocked* it, double t) {
  const struct Functions* f = functions_of(it->unit);
  bool ticks[kClocks], more, ends, nominals, states, defined;
  double next;
  it->fine &= f->get_clock(it->instance, it->clocks, kClocks, ticks) == 0;
  for (int n = 0; n < kClocks; ++n) it->ticks[n] += ticks[n];
  if (ticks[0]) it->fine &= set(it->unit, it->instance, it->setpoint, setpoint_at(it->ticks[0] - 1)) == kOk;
  it->fine &=
      f->update(it->instance, &more, &ends, &nominals, &states, &defined, &next) == 0;
  it->fine &= !more && !ends && defined && next > t;
  it->fine &= f->enter_step_mode(it->instance) == 0;
}

/* Steps to the end, as far each time as the FMU lets; the position there. */
static double run_clocked(struct Clocked* it, double end) {
  const struct Functions* f = functions_of(it->unit);
  double t = 0.0, position = 0.0;
  bool event = false, ends = false, early = false;
  handle_events(it, t);
  while (it->fine && t < end - kRounding) {
    it->fine &= f->do_step(it->instance, t, end - t, true, &event, &ends, &early, &t) == 0;
    it->fine &= !ends && event && early == (t < end - kRounding);
    it->fine &= f->enter_event_mode(it->instance) == 0;
    handle_events(it, t);
  }
  it->fine &= f->enter_step_mode(it->instance) != 0; /* it is in step mode */
  it->fine &= f->get_clock(it->instance, it->clocks, 1, &event) != 0;
  it->fine &= get(it->unit, it->instance, it->position, &position) == kOk;
  return position;
}

/* The same motion in steps of the position period, without events. */
static double run_stepwise(const struct Unit* u, const char* token, unsigned setpoint,
                           unsigned position, double end, long steps) {
  void* plain = instantiate(u, token);
  double value = 0.0;
  int fine = enter(u, plain, 0.0) == kOk && leave(u, plain) == kOk;
  for (long n = 0; fine && n < steps; ++n) {
    const double from = end * (double)n / (double)steps;
    fine = set(u, plain, setpoint, setpoint_at(n)) == kOk &&
           step(u, plain, from, end * (double)(n + 1) / (double)steps - from) == kOk;
  }
  fine = fine && get(u, plain, position, &value) == kOk;
  free_instance(u, plain);
  return fine ? value : -1.0;
}

int check_clocks(const struct Unit* u, const char* token, double end) {
  struct Clocked it = {.unit = u,
                       .instance = instantiate_with(u, token, true),
                       .setpoint = reference_of(u, "position_setpoint"),
                       .position = reference_of(u, "position"),
                       .fine = 1};
  for (int n = 0; n < kClocks; ++n) it.clocks[n] = reference_of(u, kClockNames[n]);
  it.fine = it.instance != NULL && enter(u, it.instance, 0.0) == kOk && leave(u, it.instance) == kOk;
  const double position = it.fine ? run_clocked(&it, end) : 0.0;
  for (int n = 0; n < kClocks; ++n) printf("%s %ld\n", kClockNames[n], it.ticks[n]);
  const double expected =
      run_stepwise(u, token, it.setpoint, it.position, end, it.ticks[0] - 1);
  const int same = it.fine && position == expected && position > 0.0;
  if (same) puts("the same bits");
  if (it.instance != NULL) free_instance(u, it.instance);
  return !same;
}
