/* Strategies that go wrong from some X on: each in its own way. */
#include <math.h>
#include <signal.h>
#include <stddef.h>

#include "strategies/plugin_c.h"

enum { kBeyond = 10 }; /* mm */

static const char* create(const servomill_setup* setup, void** state) {
  (void)setup;
  *state = NULL;
  return NULL;
}

static int is_beyond(const double Q[SERVOMILL_JOINTS]) { return Q[0] > kBeyond * 1e-3; }

static const char* refuse(void* state, const servomill_reading* now, double d[SERVOMILL_JOINTS]) {
  (void)state;
  d[1] = 1e-6;
  return is_beyond(now->Q_fb) ? "X is beyond 10 mm" : NULL;
}

static const char* write_nan(void* state, const servomill_reading* now,
                             double d[SERVOMILL_JOINTS]) {
  (void)state;
  d[1] = is_beyond(now->Q_fb) ? NAN : 1e-6;
  return NULL;
}

static const char* write_nan_offset(void* state, const servomill_reading* now,
                                    double out[SERVOMILL_JOINTS]) {
  (void)state;
  out[1] = is_beyond(now->Q_ref) ? INFINITY : 1e-6;
  return NULL;
}

/* A low-pass of which the period is not known, and errors that it does not declare. */
static double share_of_period;
static const char* create_low_pass(const servomill_setup* setup, void** state) {
  share_of_period = -expm1(-setup->period / 0.02);
  *state = NULL;
  return NULL;
}
static const char* low_pass(void* state, const servomill_reading* now,
                            double out[SERVOMILL_JOINTS]) {
  (void)state;
  out[1] = share_of_period * now->Q_ref[0];
  return NULL;
}
static servomill_setup undeclared;
static const char* create_undeclared(const servomill_setup* setup, void** state) {
  undeclared = *setup;
  *state = NULL;
  return NULL;
}
static const char* undeclared_errors(void* state, const servomill_reading* now,
                                     double out[SERVOMILL_JOINTS]) {
  (void)state;
  double error[3];
  undeclared.error_at(undeclared.model, now->Q_ref, error);
  out[1] = error[1];
  return NULL;
}

static const char* turn(void* state, const servomill_reading* now, double d[SERVOMILL_JOINTS]) {
  (void)state;
  d[3] = is_beyond(now->Q_fb) ? 1e-6 : 0.0;
  return NULL;
}

static const char* hang(void* state, const servomill_reading* now, double d[SERVOMILL_JOINTS]) {
  (void)state;
  (void)d;
  volatile int on = now->t > 0.01;
  while (on) {
  }
  return NULL;
}

static const char* crash(void* state, const servomill_reading* now, double d[SERVOMILL_JOINTS]) {
  (void)state;
  (void)d;
  if (now->t > 0.01) raise(SIGSEGV);
  return NULL;
}

static const char* create_never(const servomill_setup* setup, void** state) {
  (void)setup;
  (void)state;
  return "needs a licence";
}

#define STRATEGY(variable, name_, create_, member, function)                      \
  static const servomill_strategy variable = {.size = sizeof(servomill_strategy), \
                                              .name = name_,                      \
                                              .summary = "goes wrong",            \
                                              .create = create_,                  \
                                              .member = function}
STRATEGY(kRefusing, "refusing", create, displacement, refuse);
STRATEGY(kNan, "writing_nan", create, displacement, write_nan);
STRATEGY(kNanOffset, "offset_nan", create, offset, write_nan_offset);
STRATEGY(kLowPass, "low_pass", create_low_pass, offset, low_pass);
STRATEGY(kUndeclared, "undeclared", create_undeclared, offset, undeclared_errors);
STRATEGY(kTurning, "turning", create, displacement, turn);
STRATEGY(kHanging, "hanging", create, displacement, hang);
STRATEGY(kCrashing, "crashing", create, displacement, crash);
STRATEGY(kNever, "never_made", create_never, displacement, refuse);

static const servomill_strategy* const kStrategies[] = {&kRefusing, &kNan,        &kNanOffset,
                                                        &kLowPass,  &kUndeclared, &kTurning,
                                                        &kHanging,  &kCrashing,   &kNever};
static const servomill_plugin_c kPlugin = {.abi = SERVOMILL_PLUGIN_ABI,
                                           .size = sizeof(servomill_plugin_c),
                                           .name = "faulty",
                                           .version = "0",
                                           .strategies = kStrategies,
                                           .strategy_count = 9};

const servomill_plugin_c* servomill_plugin_c_entry(void);
const servomill_plugin_c* servomill_plugin_c_entry(void) { return &kPlugin; }
