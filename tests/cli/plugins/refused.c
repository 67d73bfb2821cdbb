/* Libraries that are refused, one for each value of REFUSED. */
#include <stddef.h>

#include "strategies/plugin_c.h"

#define OTHER_VERSION 1
#define NO_FUNCTION 2
#define TAKEN_NAME 3
#define SMALL_STRUCT 4
#define LATER_PART 5 /* 6: the same as far as it is known */
#define DEFAULT_OUTSIDE 7

static const char* create(const servomill_setup* setup, void** state) {
  (void)setup;
  *state = NULL;
  return NULL;
}
static const char* nothing(void* state, const servomill_reading* now, double d[SERVOMILL_JOINTS]) {
  (void)state;
  (void)now;
  (void)d;
  return NULL;
}

static const servomill_parameter kLimit = {.size = sizeof(servomill_parameter),
                                           .name = "limit_um",
                                           .help = "limit",
                                           .unit = "um",
                                           .default_text = "5",
                                           .min = 0.0,
                                           .max = 1.0};
static const servomill_parameter* const kParameters[] = {&kLimit};

/* The struct of a later program, with a function more. */
static const struct {
  servomill_strategy known;
  const char* (*later)(const servomill_setup* setup, void** state);
} kStrategy = {{.size = REFUSED == SMALL_STRUCT ? 8
                        : REFUSED >= LATER_PART ? sizeof kStrategy
                                                : sizeof(servomill_strategy),
                .name = REFUSED == TAKEN_NAME ? "feedback" : "refused",
                .parameters = kParameters,
                .parameter_count = REFUSED == DEFAULT_OUTSIDE ? 1 : 0,
                .create = create,
                .displacement = nothing},
               REFUSED == LATER_PART ? create : NULL};

static const servomill_strategy* const kStrategies[] = {&kStrategy.known};
static const servomill_plugin_c kPlugin = {
    .abi = REFUSED == OTHER_VERSION ? 999 : SERVOMILL_PLUGIN_ABI,
    .size = sizeof(servomill_plugin_c),
    .name = "refused",
    .version = "0",
    .strategies = kStrategies,
    .strategy_count = 1};

#if REFUSED == NO_FUNCTION
#define servomill_plugin_c_entry another_function
#endif
const servomill_plugin_c* servomill_plugin_c_entry(void);
const servomill_plugin_c* servomill_plugin_c_entry(void) { return &kPlugin; }
