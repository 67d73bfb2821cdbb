/* A model description as the rules of FMI look at it. */
#ifndef SERVOMILL_TESTS_FMU_MODEL_H
#define SERVOMILL_TESTS_FMU_MODEL_H

#include "xml.h"

enum { kMaxVariables = 256, kPathSize = 4096 };

struct Variable {
  const char *name, *reference, *causality, *variability, *initial;
  const char *type, *unit, *start, *min, *max;
};

struct Model {
  const char* folder;
  int fmi; /* 2 or 3 */
  struct Element *root, *interface, *structure;
  struct Variable variables[kMaxVariables];
  int variable_count;
  char library[kPathSize];
};

struct Rule {
  const char* name;   /* for messages and tests */
  const char* clause; /* of FMI 2.0.4, of FMI 3.0.2 */
  const char* clause3;
  const char* text;
  int (*holds)(const struct Model*);
};

/* Reads FOLDER/modelDescription.xml. Ends the program where that is not well-formed. */
void read_model(const char* folder, struct Model* model);
/* All rules, ended by one without a name. */
extern const struct Rule kDescriptionRules[];

/* Prints the rules that are broken; their number. */
int broken_rules(const struct Model* model, const struct Rule* rules);

int equal(const char* a, const char* b); /* of texts that may be NULL */

#endif
