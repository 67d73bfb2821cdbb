/* An importer of FMUs of servomill, written from the standard.

     importer check FOLDER          rules of the model description, then the behaviour
     importer describe FOLDER       rules of the model description only
     importer rules                 names of all rules
     importer time FOLDER STEPS     communication steps of 1 ms: factor to real time
     importer clocks FOLDER END     FMI 3: event mode until END (s), ticks of the clocks

   FOLDER is an unpacked FMU. Each broken rule is a line "broken: NAME (clause): rule"; exit
   status 1. */
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "unit.h"

char logged_category[64] = "";
int logged_messages = 0;

int load_unit(const struct Model* model, struct Unit* unit) {
  memset(unit, 0, sizeof *unit);
  unit->model = model;
  unit->library = dlopen(model->library, RTLD_NOW | RTLD_LOCAL);
  if (unit->library == NULL) printf("%s\n", dlerror());
  return model->fmi == 2 ? load_fmi2(unit) : load_fmi3(unit);
}

void close_unit(struct Unit* unit) {
  if (unit->library != NULL) dlclose(unit->library);
  free(unit->functions);
}

/* True for "position" and, of several axes, "X.position". */
static int is_called(const struct Variable* v, const char* name) {
  const char* point = strrchr(v->name, '.');
  return equal(v->name, name) || (point != NULL && equal(point + 1, name));
}

unsigned reference_of(const struct Unit* unit, const char* name) {
  for (int n = 0; n < unit->model->variable_count; ++n) {
    const struct Variable* v = &unit->model->variables[n];
    if (is_called(v, name)) return (unsigned)strtoul(v->reference, NULL, 10);
  }
  printf("no variable %s\n", name);
  exit(2);
}

static int check_behaviour(const struct Model* model) {
  struct Unit unit;
  if (load_unit(model, &unit) > 0) {
    printf("broken: functions (%s): all functions are exported\n",
           model->fmi == 2 ? "2.3" : "2.5.1");
    close_unit(&unit);
    return 1;
  }
  int broken = 0;
  for (const struct Behaviour* one = kBehaviours; one->name != NULL; ++one) {
    if (one->holds(&unit)) continue;
    printf("broken: %s (FMI %s, %s): %s\n", one->name, model->fmi == 2 ? "2.0.4" : "3.0.2",
           model->fmi == 2 ? one->clause : one->clause3, one->text);
    ++broken;
  }
  close_unit(&unit);
  return broken;
}

static const char* token_of(const struct Model* model) {
  return xml_attribute(model->root, model->fmi == 2 ? "guid" : "instantiationToken");
}

static int clocks_until(const struct Model* model, double end) {
  struct Unit unit;
  const int broken =
      load_unit(model, &unit) > 0 || check_clocks(&unit, token_of(model), end);
  close_unit(&unit);
  return broken;
}

static double seconds_now(void) {
  struct timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int time_steps(const struct Model* model, long steps) {
  struct Unit u;
  if (load_unit(model, &u) > 0) return 1;
  void* axis = u.api.instantiate(&u, token_of(model));
  const unsigned setpoint = reference_of(&u, "position_setpoint"),
                 position = reference_of(&u, "position");
  const double begin = seconds_now(), ms = 1e-3;
  double sum = 0.0, value = 0.0, t = 0.0;
  int fine = u.api.enter(&u, axis, 0.0) == kOk && u.api.leave(&u, axis) == kOk;
  for (long n = 0; fine && n < steps; ++n) {
    fine = u.api.set(&u, axis, setpoint, 0.01 * sin(6.0 * t)) == kOk &&
           u.api.step(&u, axis, t, ms) == kOk && u.api.get(&u, axis, position, &value) == kOk;
    t += ms; /* as importers do: the sum of the steps, with its rounding */
    sum += value;
  }
  u.api.free_instance(&u, axis);
  close_unit(&u);
  const double seconds = seconds_now() - begin;
  printf("%ld steps of 1 ms in %.2f s of the processor: %.1f times real time (sum %.17g)\n", steps,
         seconds, (double)steps * ms / seconds, sum);
  return !fine;
}

int main(int count, char** words) {
  const char* command = count > 1 ? words[1] : "";
  if (equal(command, "rules")) {
    for (const struct Rule* rule = kDescriptionRules; rule->name; ++rule) puts(rule->name);
    for (const struct Behaviour* one = kBehaviours; one->name; ++one) puts(one->name);
    return 0;
  }
  if (count < 3) return 2;
  static struct Model model;
  read_model(words[2], &model);
  int broken = broken_rules(&model, kDescriptionRules);
  if (broken == 0 && equal(command, "check")) broken = check_behaviour(&model);
  if (broken == 0 && equal(command, "time"))
    broken = time_steps(&model, count > 3 ? atol(words[3]) : 1000);
  if (broken == 0 && equal(command, "clocks") && model.fmi == 3)
    broken = clocks_until(&model, count > 3 ? atof(words[3]) : 0.1);
  xml_free(model.root);
  return broken != 0;
}
