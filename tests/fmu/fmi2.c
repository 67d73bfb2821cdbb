/* FMI 2.0 for co-simulation, declared from chapters 2.1 and 4.2 of the standard. */
#include <ctype.h>
#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unit.h"

typedef void* Component;
typedef int Fmi2Status; /* OK, warning, discard, error, fatal, pending */

struct Callbacks {
  void (*logger)(void*, const char*, Fmi2Status, const char*, const char*, ...);
  void* (*allocate)(size_t, size_t);
  void (*release)(void*);
  void (*step_finished)(void*, Fmi2Status);
  void* environment;
};

struct Functions {
  const char* (*get_types_platform)(void);
  const char* (*get_version)(void);
  Component (*instantiate)(const char*, int, const char*, const char*, const struct Callbacks*, int,
                           int);
  void (*free_instance)(Component);
  Fmi2Status (*setup)(Component, int, double, double, int, double);
  Fmi2Status (*enter)(Component);
  Fmi2Status (*leave)(Component);
  Fmi2Status (*terminate)(Component);
  Fmi2Status (*reset)(Component);
  Fmi2Status (*get_real)(Component, const unsigned*, size_t, double*);
  Fmi2Status (*set_real)(Component, const unsigned*, size_t, const double*);
  Fmi2Status (*get_state)(Component, void**);
  Fmi2Status (*set_state)(Component, void*);
  Fmi2Status (*free_state)(Component, void**);
  Fmi2Status (*state_size)(Component, void*, size_t*);
  Fmi2Status (*write_state)(Component, void*, char*, size_t);
  Fmi2Status (*read_state)(Component, const char*, size_t, void**);
  Fmi2Status (*do_step)(Component, double, double, int);
  Fmi2Status (*boolean_status)(Component, int, int*);
};

/* All functions that a co-simulation FMU exports; those without a place are not called. */
static const struct {
  const char* name;
  size_t place;
} kNames[] = {
#define PLACE(member) (offsetof(struct Functions, member) + 1)
    {"fmi2GetTypesPlatform", PLACE(get_types_platform)},
    {"fmi2GetVersion", PLACE(get_version)},
    {"fmi2SetDebugLogging", 0},
    {"fmi2Instantiate", PLACE(instantiate)},
    {"fmi2FreeInstance", PLACE(free_instance)},
    {"fmi2SetupExperiment", PLACE(setup)},
    {"fmi2EnterInitializationMode", PLACE(enter)},
    {"fmi2ExitInitializationMode", PLACE(leave)},
    {"fmi2Terminate", PLACE(terminate)},
    {"fmi2Reset", PLACE(reset)},
    {"fmi2GetReal", PLACE(get_real)},
    {"fmi2GetInteger", 0},
    {"fmi2GetBoolean", 0},
    {"fmi2GetString", 0},
    {"fmi2SetReal", PLACE(set_real)},
    {"fmi2SetInteger", 0},
    {"fmi2SetBoolean", 0},
    {"fmi2SetString", 0},
    {"fmi2GetFMUstate", PLACE(get_state)},
    {"fmi2SetFMUstate", PLACE(set_state)},
    {"fmi2FreeFMUstate", PLACE(free_state)},
    {"fmi2SerializedFMUstateSize", PLACE(state_size)},
    {"fmi2SerializeFMUstate", PLACE(write_state)},
    {"fmi2DeSerializeFMUstate", PLACE(read_state)},
    {"fmi2GetDirectionalDerivative", 0},
    {"fmi2SetRealInputDerivatives", 0},
    {"fmi2GetRealOutputDerivatives", 0},
    {"fmi2DoStep", PLACE(do_step)},
    {"fmi2CancelStep", 0},
    {"fmi2GetStatus", 0},
    {"fmi2GetRealStatus", 0},
    {"fmi2GetIntegerStatus", 0},
    {"fmi2GetBooleanStatus", PLACE(boolean_status)},
    {"fmi2GetStringStatus", 0},
};

enum { kDiscard = 2, kTerminated = 3, kCoSimulation = 1 };

static const struct Functions* functions_of(const struct Unit* unit) { return unit->functions; }

static enum Status status_of(Fmi2Status status) { return status <= 1 ? kOk : kRefused; }

static void log_message(void* environment, const char* instance, Fmi2Status status,
                        const char* category, const char* message, ...) {
  (void)environment;
  (void)status;
  va_list arguments;
  va_start(arguments, message);
  char text[512];
  vsnprintf(text, sizeof text, message, arguments);
  va_end(arguments);
  snprintf(logged_category, sizeof logged_category, "%s", category);
  ++logged_messages;
  if (getenv("VERBOSE") != NULL) printf("%s: %s: %s\n", instance, category, text);
}

static const struct Callbacks kCallbacks = {log_message, calloc, free, NULL, NULL};

/* Appends a path to a URI, other characters than those of RFC 3986 as %XX. */
static void append_path(char* uri, size_t size, const char* path) {
  size_t end = strlen(uri);
  for (; *path != '\0' && end + 4 < size; ++path) {
    const unsigned char c = (unsigned char)*path;
    const int plain = isalnum(c) || strchr("/-_.~", c) != NULL;
    end += (size_t)snprintf(uri + end, size - end, plain ? "%c" : "%%%02X", c);
  }
}

static void* instantiate(const struct Unit* u, const char* token) {
  char path[kPathSize], uri[3 * kPathSize] = "file://";
  if (realpath(u->model->folder, path) == NULL) return NULL;
  append_path(uri, sizeof uri, path);
  append_path(uri, sizeof uri, "/resources");
  return functions_of(u)->instantiate("axis", kCoSimulation, token, uri, &kCallbacks, 0, 1);
}
static void free_instance(const struct Unit* u, void* c) { functions_of(u)->free_instance(c); }
static enum Status enter(const struct Unit* u, void* c, double start_time) {
  const enum Status status = status_of(functions_of(u)->setup(c, 0, 0.0, start_time, 0, 0.0));
  return status == kOk ? status_of(functions_of(u)->enter(c)) : status;
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
  return status_of(functions_of(u)->get_real(c, &reference, 1, value));
}
static enum Status set(const struct Unit* u, void* c, unsigned reference, double value) {
  return status_of(functions_of(u)->set_real(c, &reference, 1, &value));
}
static enum Status step(const struct Unit* u, void* c, double time, double length) {
  const Fmi2Status status = functions_of(u)->do_step(c, time, length, 1);
  int terminated = 0;
  if (status == kDiscard && functions_of(u)->boolean_status(c, kTerminated, &terminated) == 0 &&
      terminated) {
    return kStopped;
  }
  return status_of(status);
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
  return status_of(functions_of(u)->write_state(c, state, bytes, size));
}
static enum Status read_state(const struct Unit* u, void* c, const char* bytes, size_t size,
                              void** state) {
  return status_of(functions_of(u)->read_state(c, bytes, size, state));
}
static int names_its_version(const struct Unit* u) {
  return equal(functions_of(u)->get_version(), "2.0") &&
         equal(functions_of(u)->get_types_platform(), "default");
}

int load_fmi2(struct Unit* unit) {
  int missing = 0;
  char* functions = calloc(1, sizeof(struct Functions));
  for (size_t n = 0; n < sizeof kNames / sizeof kNames[0]; ++n) {
    void* found = unit->library == NULL ? NULL : dlsym(unit->library, kNames[n].name);
    if (found == NULL) {
      printf("missing: %s\n", kNames[n].name);
      ++missing;
    } else if (kNames[n].place > 0) {
      memcpy(functions + kNames[n].place - 1, &found, sizeof found);
    }
  }
  unit->functions = functions;
  unit->api = (struct Api){instantiate, free_instance, enter,      leave,
                           terminate,   reset,         get,        set,
                           step,        get_state,     set_state,  free_state,
                           state_size,  write_state,   read_state, names_its_version};
  return missing;
}
