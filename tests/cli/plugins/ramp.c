/* The example of strategies/README.md, "Strategies out of the tree": two strategies in C. */
#include <math.h>
#include <stdlib.h>

#include "strategies/plugin_c.h"

/* `smooth_ramp`: Y follows the virtual displacement slope * X through a low-pass filter. */
struct ramp {
  double slope; /* m/m */
  double share; /* of the difference that a period closes */
  double y;     /* m */
};

static const servomill_parameter kSlope = {sizeof(servomill_parameter),
                                           "slope_um_per_m",
                                           "of the displacement of Y over X",
                                           "um/m",
                                           "100",
                                           -10000.0,
                                           10000.0};
static const servomill_parameter kTime = {sizeof(servomill_parameter),
                                          "time_constant_ms",
                                          "of the low-pass filter",
                                          "ms",
                                          "1",
                                          0.001,
                                          10000.0};
static const servomill_parameter* const kRampParameters[] = {&kSlope, &kTime};

static const char* create_ramp(const servomill_setup* setup, void** state) {
  struct ramp* ramp = malloc(sizeof *ramp);
  if (ramp == NULL) return "not enough memory";
  ramp->slope = setup->parameters[0];
  ramp->share = -expm1(-setup->period / setup->parameters[1]);
  ramp->y = 0.0;
  *state = ramp;
  return NULL;
}

static const char* settle_ramp(void* state, const servomill_reading* now) {
  struct ramp* ramp = state;
  ramp->y = ramp->slope * now->Q_fb[0];
  return NULL;
}

static const char* displace(void* state, const servomill_reading* now, double d[SERVOMILL_JOINTS]) {
  struct ramp* ramp = state;
  ramp->y += ramp->share * (ramp->slope * now->Q_fb[0] - ramp->y);
  d[1] = ramp->y; /* the other places hold 0 */
  return NULL;
}

static const servomill_strategy kRamp = {.size = sizeof(servomill_strategy),
                                         .name = "smooth_ramp",
                                         .summary = "displaces Y in proportion to X",
                                         .parameters = kRampParameters,
                                         .parameter_count = 2,
                                         .create = create_ramp,
                                         .destroy = free,
                                         .settle = settle_ramp,
                                         .displacement = displace};

/* `identified`: offsets the setpoints by the error that the identified model tells. */
static const char* create_identified(const servomill_setup* setup, void** state) {
  servomill_setup* copy = malloc(sizeof *copy);
  if (copy == NULL) return "not enough memory";
  *copy = *setup;
  *state = copy;
  return NULL;
}

static const char* offset(void* state, const servomill_reading* now, double out[SERVOMILL_JOINTS]) {
  const servomill_setup* setup = state;
  double error[3];
  setup->error_at(setup->model, now->Q_ref, error);
  for (int j = 0; j < 3; ++j) out[j] = setup->sign * error[j];
  return NULL;
}

static const servomill_strategy kIdentified = {.size = sizeof(servomill_strategy),
                                               .name = "identified",
                                               .summary = "offsets the setpoints, to first order",
                                               .knows_errors = 1,
                                               .create = create_identified,
                                               .destroy = free,
                                               .offset = offset};

static const servomill_strategy* const kStrategies[] = {&kRamp, &kIdentified};
static const servomill_plugin_c kPlugin = {.abi = SERVOMILL_PLUGIN_ABI,
                                           .size = sizeof(servomill_plugin_c),
                                           .name = "ramp",
                                           .version = "1.2",
                                           .strategies = kStrategies,
                                           .strategy_count = 2};

const servomill_plugin_c* servomill_plugin_c_entry(void);
const servomill_plugin_c* servomill_plugin_c_entry(void) { return &kPlugin; }
