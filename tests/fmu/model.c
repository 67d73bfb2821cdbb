#include "model.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int equal(const char* a, const char* b) { return a != NULL && b != NULL && strcmp(a, b) == 0; }

static char* text_of_file(const char* name) {
  FILE* file = fopen(name, "rb");
  if (file == NULL) return NULL;
  size_t size = 0, room = 1 << 16;
  char* text = malloc(room);
  for (size_t n; (n = fread(text + size, 1, room - size - 1, file)) > 0;) {
    size += n;
    if (size + 1 == room) text = realloc(text, room *= 2);
  }
  text[size] = '\0';
  fclose(file);
  return text;
}

static const char* or_default(const char* value, const char* otherwise) {
  return value == NULL ? otherwise : value;
}

/* FMI 2 keeps unit and start in a child named after the type, FMI 3 in the element itself. */
static struct Variable variable_of(const struct Model* model, const struct Element* element) {
  const struct Element* typed = model->fmi == 2 ? element->first_child : element;
  struct Variable v = {0};
  v.name = xml_attribute(element, "name");
  v.reference = xml_attribute(element, "valueReference");
  v.causality = or_default(xml_attribute(element, "causality"), "local");
  v.initial = xml_attribute(element, "initial");
  v.type = typed == NULL ? NULL : typed->name;
  const int real = equal(v.type, "Real") || equal(v.type, "Float64");
  v.variability =
      or_default(xml_attribute(element, "variability"), equal(v.causality, "parameter") ? "fixed"
                                                        : real ? "continuous"
                                                               : "discrete");
  if (typed == NULL) return v;
  v.unit = xml_attribute(typed, "unit");
  v.start = xml_attribute(typed, "start");
  v.min = xml_attribute(typed, "min");
  v.max = xml_attribute(typed, "max");
  return v;
}

void read_model(const char* folder, struct Model* model) {
  char name[kPathSize];
  snprintf(name, sizeof name, "%s/modelDescription.xml", folder);
  memset(model, 0, sizeof *model);
  char* text = text_of_file(name);
  model->folder = folder;
  model->root = text == NULL ? NULL : xml_parse(text);
  free(text);
  if (model->root == NULL) {
    printf("broken: well_formed\n");
    exit(1);
  }
  model->fmi = equal(xml_attribute(model->root, "fmiVersion"), "3.0") ? 3 : 2;
  model->interface = xml_child(model->root, "CoSimulation");
  model->structure = xml_child(model->root, "ModelStructure");
  const struct Element* all = xml_child(model->root, "ModelVariables");
  for (struct Element* one = all == NULL ? NULL : all->first_child;
       one != NULL && model->variable_count < kMaxVariables; one = one->next) {
    model->variables[model->variable_count++] = variable_of(model, one);
  }
  const char* identifier =
      model->interface == NULL ? NULL : xml_attribute(model->interface, "modelIdentifier");
  snprintf(model->library, sizeof model->library, "%s/binaries/%s/%s.so", folder,
           model->fmi == 2 ? "linux64" : "x86_64-linux", or_default(identifier, ""));
}

int broken_rules(const struct Model* model, const struct Rule* rules) {
  int broken = 0;
  for (const struct Rule* rule = rules; rule->name != NULL; ++rule) {
    if (rule->holds(model)) continue;
    printf("broken: %s (FMI %s, %s): %s\n", rule->name, model->fmi == 2 ? "2.0.4" : "3.0.2",
           model->fmi == 2 ? rule->clause : rule->clause3, rule->text);
    ++broken;
  }
  return broken;
}
