/* A plug-in that was built with the first headers of this version of the interface: its structs end
 * where those of today go on. */
#include <stdlib.h>

#include "tests/cli/plugins/plugin_c_first.h"

static const char* create(const servomill_setup* setup, void** state) {
  (void)setup;
  *state = NULL;
  return NULL;
}

/* X displaces Y by 0.5 %. The reading is as long as this library knows it, or longer. */
static const char* displace(void* state, const servomill_reading* now, double d[SERVOMILL_JOINTS]) {
  (void)state;
  if (now->size < sizeof *now || now->sensor_count != 0) return "the reading is too short";
  d[1] = 0.005 * now->Q_fb[0];
  return NULL;
}

static const servomill_strategy kEarlier = {.size = sizeof(servomill_strategy),
                                            .name = "earlier",
                                            .summary = "displaces Y in proportion to X",
                                            .create = create,
                                            .displacement = displace};

/* What lies behind it must not be read as functions. */
static const struct {
  servomill_strategy strategy;
  const char* behind[8];
} kStrategy = {{.size = sizeof(servomill_strategy),
                .name = "earlier_guarded",
                .summary = "the same",
                .create = create,
                .displacement = displace},
               {"no", "functions", "of", "this", "library", "at", "this", "place"}};

static const servomill_strategy* const kStrategies[] = {&kEarlier, &kStrategy.strategy};
static const servomill_plugin_c kPlugin = {.abi = SERVOMILL_PLUGIN_ABI,
                                           .size = sizeof(servomill_plugin_c),
                                           .name = "earlier",
                                           .version = "1",
                                           .strategies = kStrategies,
                                           .strategy_count = 2};

const servomill_plugin_c* servomill_plugin_c_entry(void);
const servomill_plugin_c* servomill_plugin_c_entry(void) { return &kPlugin; }
