/* A loaded FMU and its instances, whatever its version of FMI. */
#ifndef SERVOMILL_TESTS_FMU_UNIT_H
#define SERVOMILL_TESTS_FMU_UNIT_H

#include <stddef.h>

#include "model.h"

enum Status { kOk, kStopped, kRefused };

struct Unit;

/* Functions of FMI that both versions have, in the form of kOk, kStopped (the FMU wants to end) and
   kRefused. */
struct Api {
  /* NULL with another token. */
  void* (*instantiate)(const struct Unit*, const char* token);
  void (*free_instance)(const struct Unit*, void* instance);
  enum Status (*enter)(const struct Unit*, void* instance, double start_time);
  enum Status (*leave)(const struct Unit*, void* instance);
  enum Status (*terminate)(const struct Unit*, void* instance);
  enum Status (*reset)(const struct Unit*, void* instance);
  enum Status (*get)(const struct Unit*, void* instance, unsigned reference, double* value);
  enum Status (*set)(const struct Unit*, void* instance, unsigned reference, double value);
  enum Status (*step)(const struct Unit*, void* instance, double time, double step);
  enum Status (*get_state)(const struct Unit*, void* instance, void** state);
  enum Status (*set_state)(const struct Unit*, void* instance, void* state);
  enum Status (*free_state)(const struct Unit*, void* instance, void** state);
  enum Status (*state_size)(const struct Unit*, void* instance, void* state, size_t* size);
  enum Status (*write_state)(const struct Unit*, void* instance, void* state, char* bytes,
                             size_t size);
  enum Status (*read_state)(const struct Unit*, void* instance, const char* bytes, size_t size,
                            void** state);
  int (*names_its_version)(const struct Unit*);
};

struct Unit {
  const struct Model* model;
  void* library;
  struct Api api;
  void* functions; /* of the version */
};

/* Functions of FMI that the library lacks are printed; their number. */
int load_unit(const struct Model* model, struct Unit* unit);
void close_unit(struct Unit* unit);

int load_fmi2(struct Unit* unit);
int load_fmi3(struct Unit* unit);

/* FMI 3 only: prints how often each clock ticks until `end` (s), and "the same bits" if the axis
   moves in event mode as it does without; 0 then. */
int check_clocks(const struct Unit* unit, const char* token, double end);

/* Last message of a logger: its category; "" before the first. */
extern char logged_category[64];
extern int logged_messages;

/* Value reference of a variable by its name, of several axes that of the first; ends the program if
   there is none. */
unsigned reference_of(const struct Unit* unit, const char* name);

extern const struct Behaviour {
  const char *name, *clause, *clause3, *text;
  int (*holds)(const struct Unit*);
} kBehaviours[];

#endif
