/* Behaviour that FMI asks of an FMU, and what servomill promises of its own. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unit.h"

static const double kMs = 1e-3, kAmplitude = 5e-3, kFrequency = 2.0;

struct Axis {
  const struct Unit* unit;
  void* instance;
  unsigned setpoint, velocity, acceleration, position, current;
};

static const char* token_of(const struct Unit* unit) {
  return xml_attribute(unit->model->root, unit->model->fmi == 2 ? "guid" : "instantiationToken");
}

static struct Axis new_axis(const struct Unit* unit) {
  struct Axis axis = {unit,
                      unit->api.instantiate(unit, token_of(unit)),
                      reference_of(unit, "position_setpoint"),
                      reference_of(unit, "velocity_setpoint"),
                      reference_of(unit, "acceleration_setpoint"),
                      reference_of(unit, "position"),
                      reference_of(unit, "current")};
  return axis;
}

static struct Axis initialised_axis(const struct Unit* unit) {
  struct Axis axis = new_axis(unit);
  if (axis.instance != NULL) {
    unit->api.enter(unit, axis.instance, 0.0);
    unit->api.leave(unit, axis.instance);
  }
  return axis;
}

static void end(struct Axis* axis) { axis->unit->api.free_instance(axis->unit, axis->instance); }

static int set(struct Axis* a, const char* name, double value) {
  return a->unit->api.set(a->unit, a->instance, reference_of(a->unit, name), value) == kOk;
}

static double get(struct Axis* a, const char* name) {
  double value = NAN;
  a->unit->api.get(a->unit, a->instance, reference_of(a->unit, name), &value);
  return value;
}

/* One millisecond of a smooth motion to and fro, in pieces. */
static int move_on(struct Axis* a, int millisecond, int pieces) {
  const double w = 2.0 * acos(-1.0) * kFrequency, t = kMs * millisecond, half = 0.5 * kAmplitude;
  const struct Api* api = &a->unit->api;
  int fine = api->set(a->unit, a->instance, a->setpoint, half * (1.0 - cos(w * t))) == kOk &&
             api->set(a->unit, a->instance, a->velocity, half * w * sin(w * t)) == kOk &&
             api->set(a->unit, a->instance, a->acceleration, half * w * w * cos(w * t)) == kOk;
  for (int n = 0; n < pieces; ++n) {
    const double from = t + kMs * n / pieces;
    fine &= api->step(a->unit, a->instance, from, t + kMs * (n + 1) / pieces - from) == kOk;
  }
  return fine;
}

struct Sample {
  double position, current;
};

static struct Sample sample_of(struct Axis* a) {
  struct Sample sample = {get(a, "position"), get(a, "current")};
  return sample;
}

/* True if an axis moved and two of them have the same bits. */
static int moved_alike(struct Sample a, struct Sample b) {
  return memcmp(&a, &b, sizeof a) == 0 && fabs(a.position) > 0.1 * kAmplitude && a.current != 0.0;
}

static struct Sample after(struct Axis* a, int from, int to, int pieces) {
  int fine = 1;
  for (int n = from; n < to; ++n) fine &= move_on(a, n, pieces);
  struct Sample failed = {NAN, NAN};
  return fine ? sample_of(a) : failed;
}

static int is_made_with_its_token_only(const struct Unit* unit) {
  void* wrong = unit->api.instantiate(unit, "{wrong}");
  if (wrong != NULL) return 0;
  struct Axis axis = new_axis(unit);
  const int made = axis.instance != NULL;
  if (made) end(&axis);
  return made;
}

static int has_start_values(const struct Unit* unit) {
  struct Axis axis = new_axis(unit);
  int same = axis.instance != NULL;
  for (int n = 0; same && n < unit->model->variable_count; ++n) {
    const struct Variable* v = &unit->model->variables[n];
    if (v->start == NULL) continue;
    const double value = get(&axis, v->name), start = atof(v->start);
    same &= memcmp(&value, &start, sizeof value) == 0;
  }
  end(&axis);
  return same;
}

static int starts_at_rest_at_the_setpoint(const struct Unit* unit) {
  struct Axis axis = new_axis(unit);
  double value = 0.0;
  int fine = unit->api.get(unit, axis.instance, axis.position, &value) == kRefused;
  fine &=
      set(&axis, "position_setpoint", 0.012) && unit->api.enter(unit, axis.instance, 3.0) == kOk;
  fine &= fabs(get(&axis, "position") - 0.012) < 1e-6;
  fine &= set(&axis, "position_setpoint", 0.014) && fabs(get(&axis, "position") - 0.014) < 1e-6;
  fine &= unit->api.leave(unit, axis.instance) == kOk && get(&axis, "time") == 3.0;
  fine &= unit->api.step(unit, axis.instance, 3.0, kMs) == kOk && get(&axis, "time") == 3.0 + kMs;
  fine &= unit->api.terminate(unit, axis.instance) == kOk;
  end(&axis);
  return fine;
}

static int fixes_parameters(const struct Unit* unit) {
  struct Axis stiff = initialised_axis(unit), soft = new_axis(unit);
  int fine = set(&soft, "Kv", 0.5 * get(&stiff, "Kv")) &&
             unit->api.enter(unit, soft.instance, 0.0) == kOk &&
             unit->api.leave(unit, soft.instance) == kOk && !set(&stiff, "Kv", 1.0);
  for (int n = 0; n < 100; ++n) fine &= move_on(&stiff, n, 1) & move_on(&soft, n, 1);
  fine &= get(&stiff, "position") != get(&soft, "position");
  end(&stiff);
  end(&soft);
  return fine;
}

static int refuses_impossible_parameters(const struct Unit* unit) {
  struct Axis axis = new_axis(unit);
  const int fine = set(&axis, "moving_mass", -1.0) &&
                   unit->api.enter(unit, axis.instance, 0.0) == kOk &&
                   unit->api.leave(unit, axis.instance) == kRefused &&
                   set(&axis, "moving_mass", 500.0) && unit->api.leave(unit, axis.instance) == kOk;
  end(&axis);
  return fine;
}

static int takes_any_step(const struct Unit* unit) {
  struct Axis a = initialised_axis(unit), b = initialised_axis(unit), c = initialised_axis(unit);
  const struct Sample whole = after(&a, 0, 200, 1);
  const int same =
      moved_alike(whole, after(&b, 0, 200, 10)) && moved_alike(whole, after(&c, 0, 200, 7));
  end(&a);
  end(&b);
  end(&c);
  return same;
}

static int keeps_instances_apart(const struct Unit* unit) {
  struct Axis alone = initialised_axis(unit), a = initialised_axis(unit),
              b = initialised_axis(unit);
  const struct Sample expected = after(&alone, 0, 200, 1);
  int fine = 1;
  for (int n = 0; n < 200; ++n) {
    fine &= move_on(&a, n, 1);
    if (n >= 50) fine &= move_on(&b, n - 50, 1); /* elsewhere on the motion */
  }
  fine &= moved_alike(expected, sample_of(&a)) && moved_alike(expected, after(&b, 150, 200, 1));
  end(&alone);
  end(&a);
  end(&b);
  return fine;
}

static int returns_to_states(const struct Unit* unit) {
  struct Axis a = initialised_axis(unit), other = new_axis(unit);
  void* state = NULL;
  after(&a, 0, 77, 1);
  int fine = unit->api.step(unit, a.instance, 77 * kMs, 0.4567 * kMs) == kOk &&
             unit->api.get_state(unit, a.instance, &state) == kOk && state != NULL;
  fine &= unit->api.step(unit, a.instance, 77.4567 * kMs, 0.5433 * kMs) == kOk;
  const struct Sample first = after(&a, 78, 200, 1);
  struct Axis* both[] = {&a, &other};
  for (int n = 0; fine && n < 2; ++n) {
    fine &= unit->api.set_state(unit, both[n]->instance, state) == kOk;
    fine &= unit->api.step(unit, both[n]->instance, 77.4567 * kMs, 0.5433 * kMs) == kOk;
    fine &= moved_alike(first, after(both[n], 78, 200, 1));
  }
  fine &= unit->api.free_state(unit, a.instance, &state) == kOk && state == NULL;
  end(&a);
  end(&other);
  return fine;
}

static int serialises_states(const struct Unit* unit) {
  struct Axis a = initialised_axis(unit), other = new_axis(unit);
  void *state = NULL, *copy = NULL;
  size_t size = 0;
  after(&a, 0, 77, 1);
  int fine = unit->api.get_state(unit, a.instance, &state) == kOk && state != NULL &&
             unit->api.state_size(unit, a.instance, state, &size) == kOk && size > 0;
  char* bytes = malloc(size + 1);
  fine = fine && unit->api.write_state(unit, a.instance, state, bytes, size) == kOk;
  fine = fine && unit->api.write_state(unit, a.instance, state, bytes, size - 1) == kRefused;
  const struct Sample first = after(&a, 77, 200, 1);
  fine = fine && unit->api.read_state(unit, other.instance, bytes, size, &copy) == kOk &&
         unit->api.set_state(unit, other.instance, copy) == kOk &&
         moved_alike(first, after(&other, 77, 200, 1));
  for (size_t n = 0; fine && n < size; n += size / 50 + 1) {
    void* none = NULL;
    bytes[n] ^= 4;
    fine &= unit->api.read_state(unit, other.instance, bytes, size, &none) == kRefused;
    bytes[n] ^= 4;
  }
  void* none = NULL;
  fine = fine && unit->api.read_state(unit, other.instance, bytes, size / 2, &none) == kRefused;
  unit->api.free_state(unit, a.instance, &state);
  unit->api.free_state(unit, other.instance, &copy);
  free(bytes);
  end(&a);
  end(&other);
  return fine;
}

static int resets(const struct Unit* unit) {
  struct Axis axis = initialised_axis(unit);
  const struct Sample first = after(&axis, 0, 200, 1);
  const int fine = unit->api.reset(unit, axis.instance) == kOk &&
                   unit->api.enter(unit, axis.instance, 0.0) == kOk &&
                   unit->api.leave(unit, axis.instance) == kOk &&
                   moved_alike(first, after(&axis, 0, 200, 1));
  end(&axis);
  return fine;
}

static int refuses_wrong_calls(const struct Unit* unit) {
  struct Axis axis = initialised_axis(unit);
  double value;
  void* c = axis.instance;
  const int fine = unit->api.step(unit, c, 0.5, kMs) == kRefused &&
                   unit->api.step(unit, c, 0.0, -kMs) == kRefused &&
                   unit->api.step(unit, c, 0.0, NAN) == kRefused &&
                   unit->api.step(unit, c, 0.0, 1e300) == kRefused &&
                   unit->api.enter(unit, c, 0.0) == kRefused &&
                   unit->api.leave(unit, c) == kRefused &&
                   unit->api.get(unit, c, 9999, &value) == kRefused &&
                   unit->api.set(unit, c, 9999, 0.0) == kRefused && !set(&axis, "position", 0.0) &&
                   !set(&axis, "base_period", 1.0) && !set(&axis, "position_setpoint", NAN) &&
                   unit->api.step(unit, c, 0.0, kMs) == kOk;
  end(&axis);
  return fine;
}

static int logs_in_its_categories(const struct Unit* unit) {
  struct Axis axis = initialised_axis(unit);
  const int before = logged_messages;
  set(&axis, "position", 0.0);
  const int logged = logged_messages == before + 1;
  const struct Element* all = xml_child(unit->model->root, "LogCategories");
  const struct Element* one = all == NULL ? NULL : all->first_child;
  while (one != NULL && !equal(xml_attribute(one, "name"), logged_category)) one = one->next;
  end(&axis);
  return logged && one != NULL;
}

static int stops_where_the_nc_does(const struct Unit* unit) {
  struct Axis axis = initialised_axis(unit);
  int fine =
      unit->api.step(unit, axis.instance, 0.0, kMs) == kOk && set(&axis, "position_setpoint", 1.0);
  fine &= unit->api.step(unit, axis.instance, kMs, kMs) == kStopped && get(&axis, "time") == kMs;
  fine &= unit->api.step(unit, axis.instance, kMs, kMs) == kRefused;
  end(&axis);
  return fine;
}

/* The description says that no output depends on an input of the same communication point. */
static int passes_no_input_through(const struct Unit* unit) {
  static const char* const kInputs[] = {"position_setpoint", "velocity_setpoint",
                                        "acceleration_setpoint", "load", "feedback_displacement"};
  struct Axis axis = initialised_axis(unit);
  int fine = 1;
  for (int n = 0; n < 60; ++n) fine &= move_on(&axis, n, 1);
  const struct Sample before = sample_of(&axis);
  const double error = get(&axis, "following_error");
  for (size_t n = 0; n < sizeof kInputs / sizeof *kInputs; ++n) {
    fine &= set(&axis, kInputs[n], 1e-3) && moved_alike(before, sample_of(&axis)) &&
            get(&axis, "following_error") == error;
  }
  fine &= unit->api.step(unit, axis.instance, 60 * kMs, kMs) == kOk &&
          !moved_alike(before, sample_of(&axis));
  end(&axis);
  return fine;
}

static int names_its_version(const struct Unit* unit) { return unit->api.names_its_version(unit); }

const struct Behaviour kBehaviours[] = {
    {"names_version", "2.1.4", "2.2.5", "version (and platform) are as described",
     names_its_version},
    {"token", "2.1.5", "2.3.1", "instances are made with the token of the description only",
     is_made_with_its_token_only},
    {"start_values", "2.1.7", "2.3.2", "variables start as described, bit for bit",
     has_start_values},
    {"at_rest", "4.2.4", "2.3.3", "the axis starts at rest at its setpoint",
     starts_at_rest_at_the_setpoint},
    {"fixed", "2.2.7", "2.4.7.4", "parameters act, and are fixed after initialization",
     fixes_parameters},
    {"impossible", "2.1.6", "2.3.3", "impossible parameters are refused",
     refuses_impossible_parameters},
    {"any_step", "4.2.2", "4.2.1", "communication steps do not change the result", takes_any_step},
    {"instances", "2.1.5", "2.3.1", "instances do not change one another", keeps_instances_apart},
    {"states", "2.1.8", "2.2.8", "states are returned to", returns_to_states},
    {"serialised", "2.1.8", "2.2.8", "states are serialised; damaged ones refused",
     serialises_states},
    {"reset", "2.1.6", "2.3.1", "a reset axis is a new one", resets},
    {"wrong_calls", "4.2.4", "2.3", "wrong calls are refused and change nothing",
     refuses_wrong_calls},
    {"no_feedthrough", "2.2.8", "2.4.8", "inputs change no output of their communication point",
     passes_no_input_through},
    {"logger", "2.1.5", "2.3.1", "refusals are logged in a category of the description",
     logs_in_its_categories},
    {"stop", "4.2.2", "4.2.1", "the NC stops the machine: the FMU ends", stops_where_the_nc_does},
    {NULL, NULL, NULL, NULL, NULL},
};
