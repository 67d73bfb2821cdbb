#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "model.h"

static int has_text(const struct Element* element, const char* name) {
  const char* value = element == NULL ? NULL : xml_attribute(element, name);
  return value != NULL && value[0] != '\0';
}

static int is_one_of(const char* word, const char* const* words) {
  while (*words != NULL && !equal(word, *words)) ++words;
  return *words != NULL;
}

static int has_version(const struct Model* m) {
  return equal(m->root->name, "fmiModelDescription") &&
         equal(xml_attribute(m->root, "fmiVersion"), m->fmi == 2 ? "2.0" : "3.0");
}

static int has_name_and_token(const struct Model* m) {
  return has_text(m->root, "modelName") &&
         has_text(m->root, m->fmi == 2 ? "guid" : "instantiationToken");
}

static int has_elements_in_order(const struct Model* m) {
  static const char* const kOrder[] = {
      "ModelExchange",   "CoSimulation",   "ScheduledExecution", "UnitDefinitions",
      "TypeDefinitions", "LogCategories",  "DefaultExperiment",  "VendorAnnotations",
      "ModelVariables",  "ModelStructure", "Annotations",        NULL};
  int place = 0;
  for (const struct Element* one = m->root->first_child; one != NULL; one = one->next) {
    while (kOrder[place] != NULL && !equal(kOrder[place], one->name)) ++place;
    if (kOrder[place++] == NULL) return 0;
  }
  return xml_child(m->root, "ModelVariables") != NULL && m->structure != NULL;
}

static int has_interface(const struct Model* m) { return m->interface != NULL; }

static int has_c_identifier(const struct Model* m) {
  if (!has_text(m->interface, "modelIdentifier")) return 0;
  const char* name = xml_attribute(m->interface, "modelIdentifier");
  if (isdigit((unsigned char)*name)) return 0;
  for (; *name != '\0'; ++name) {
    if (!isalnum((unsigned char)*name) && *name != '_') return 0;
  }
  return 1;
}

static int has_binary(const struct Model* m) { return access(m->library, R_OK) == 0; }

/* True if no two children have the same value of an attribute, and all have one. */
static int all_differ(const struct Element* parent, const char* attribute) {
  for (const struct Element* a = parent == NULL ? NULL : parent->first_child; a; a = a->next) {
    if (!has_text(a, attribute)) return 0;
    for (const struct Element* b = a->next; b != NULL; b = b->next) {
      if (equal(xml_attribute(a, attribute), xml_attribute(b, attribute))) return 0;
    }
  }
  return 1;
}

static int has_unique_units(const struct Model* m) {
  return all_differ(xml_child(m->root, "UnitDefinitions"), "name");
}

static int has_whole_powers(const struct Model* m) {
  const struct Element* all = xml_child(m->root, "UnitDefinitions");
  static const char* const kBase[] = {"kg", "m",   "s",      "A",      "K", "mol",
                                      "cd", "rad", "factor", "offset", NULL};
  for (const struct Element* unit = all ? all->first_child : NULL; unit; unit = unit->next) {
    const struct Element* base = xml_child(unit, "BaseUnit");
    for (int n = 0; base != NULL && n < base->attribute_count; ++n) {
      char* end;
      const double power = strtod(base->attributes[n].value, &end);
      const int is_power =
          !equal(base->attributes[n].name, "factor") && !equal(base->attributes[n].name, "offset");
      if (*end != '\0' || !is_one_of(base->attributes[n].name, kBase)) return 0;
      if (is_power && power != floor(power)) return 0;
    }
  }
  return 1;
}

static int has_unique_log_categories(const struct Model* m) {
  return all_differ(xml_child(m->root, "LogCategories"), "name");
}

static int has_sensible_experiment(const struct Model* m) {
  const struct Element* e = xml_child(m->root, "DefaultExperiment");
  const char* step = e == NULL ? NULL : xml_attribute(e, "stepSize");
  const char* start = e == NULL ? NULL : xml_attribute(e, "startTime");
  const char* stop = e == NULL ? NULL : xml_attribute(e, "stopTime");
  if (step != NULL && !(atof(step) > 0.0)) return 0;
  return start == NULL || stop == NULL || atof(stop) >= atof(start);
}

static int has_unique_names(const struct Model* m) {
  return all_differ(xml_child(m->root, "ModelVariables"), "name");
}

static int has_unique_references(const struct Model* m) {
  return all_differ(xml_child(m->root, "ModelVariables"), "valueReference");
}

static int has_known_types(const struct Model* m) {
  static const char* const kTypes2[] = {"Real",   "Integer",     "Boolean",
                                        "String", "Enumeration", NULL};
  static const char* const kTypes3[] = {
      "Float32", "Float64", "Int8",    "UInt8",  "Int16",  "UInt16",      "Int32", "UInt32",
      "Int64",   "UInt64",  "Boolean", "String", "Binary", "Enumeration", "Clock", NULL};
  for (int n = 0; n < m->variable_count; ++n) {
    if (!is_one_of(m->variables[n].type, m->fmi == 2 ? kTypes2 : kTypes3)) return 0;
  }
  return m->variable_count > 0;
}

static int has_defined_units(const struct Model* m) {
  const struct Element* all = xml_child(m->root, "UnitDefinitions");
  for (int n = 0; n < m->variable_count; ++n) {
    const char* unit = m->variables[n].unit;
    if (unit == NULL) continue;
    const struct Element* one = all ? all->first_child : NULL;
    while (one != NULL && !equal(xml_attribute(one, "name"), unit)) one = one->next;
    if (one == NULL) return 0;
  }
  return 1;
}

/* Rows of the tables of FMI for causality, variability and initial. */
static const struct {
  const char *causality, *variabilities, *initials; /* words between spaces; the first: default */
} kCombinations[] = {
    {"parameter", " fixed tunable ", " exact "},
    {"calculatedParameter", " fixed tunable ", " calculated approx "},
    {"input", " discrete continuous ", ""},
    {"output", " constant ", " exact "},
    {"output", " discrete continuous ", " calculated exact approx "},
    {"local", " constant ", " exact "},
    {"local", " fixed tunable ", " calculated approx "},
    {"local", " discrete continuous ", " calculated exact approx "},
    {"independent", " continuous ", ""},
};

static int is_among(const char* word, const char* words) {
  char spaced[64];
  snprintf(spaced, sizeof spaced, " %s ", word);
  return strstr(words, spaced) != NULL;
}

/* Initials that a variable may have, the first by default; NULL for a combination that there is
 * not. */
static const char* initials_of(const struct Variable* v) {
  for (size_t n = 0; n < sizeof kCombinations / sizeof kCombinations[0]; ++n) {
    if (equal(v->causality, kCombinations[n].causality) &&
        is_among(v->variability, kCombinations[n].variabilities)) {
      return kCombinations[n].initials;
    }
  }
  return NULL;
}

static int has_allowed_variabilities(const struct Model* m) {
  for (int n = 0; n < m->variable_count; ++n) {
    if (initials_of(&m->variables[n]) == NULL) return 0;
  }
  return 1;
}

static int has_allowed_initials(const struct Model* m) {
  for (int n = 0; n < m->variable_count; ++n) {
    const char *allowed = initials_of(&m->variables[n]), *initial = m->variables[n].initial;
    if (allowed != NULL && initial != NULL && !is_among(initial, allowed)) return 0;
  }
  return 1;
}

/* "exact", "calculated", "approx" as given or by default; "" for inputs and time. */
static int is_initially(const struct Variable* v, const char* initial) {
  const char* allowed = initials_of(v);
  if (v->initial != NULL) return equal(v->initial, initial);
  return allowed != NULL && strncmp(allowed + (*allowed != '\0'), initial, strlen(initial)) == 0 &&
         *allowed != '\0';
}

static int has_starts_where_due(const struct Model* m) {
  for (int n = 0; n < m->variable_count; ++n) {
    const struct Variable* v = &m->variables[n];
    const int due =
        equal(v->causality, "input") || is_initially(v, "exact") || is_initially(v, "approx");
    if (due != (v->start != NULL)) return 0;
  }
  return 1;
}

static int has_starts_in_range(const struct Model* m) {
  for (int n = 0; n < m->variable_count; ++n) {
    const struct Variable* v = &m->variables[n];
    if (v->start != NULL && v->min != NULL && atof(v->start) < atof(v->min)) return 0;
    if (v->start != NULL && v->max != NULL && atof(v->start) > atof(v->max)) return 0;
    if (v->min != NULL && v->max != NULL && atof(v->max) < atof(v->min)) return 0;
  }
  return 1;
}

/* FMI 2: none or one; FMI 3: exactly one. */
static int has_independent(const struct Model* m) {
  int count = 0;
  for (int n = 0; n < m->variable_count; ++n) {
    count += equal(m->variables[n].causality, "independent");
  }
  return count == 1 || (m->fmi == 2 && count == 0);
}

/* Number of the variable that an entry of the structure names, counted from 0; -1: none. */
static int named_by(const struct Model* m, const char* word) {
  if (word == NULL) return -1;
  if (m->fmi == 2) {
    const int index = atoi(word);
    return index >= 1 && index <= m->variable_count ? index - 1 : -1;
  }
  for (int n = 0; n < m->variable_count; ++n) {
    if (equal(m->variables[n].reference, word)) return n;
  }
  return -1;
}

/* Next entry of a list of the structure, the first after NULL. */
static const struct Element* next_entry(const struct Model* m, const char* list2,
                                        const char* element3, const struct Element* last) {
  const struct Element* parent = m->fmi == 2 ? xml_child(m->structure, list2) : m->structure;
  const struct Element* one = last ? last->next : (parent ? parent->first_child : NULL);
  while (one != NULL && m->fmi == 3 && !equal(one->name, element3)) one = one->next;
  return one;
}

static const char* entry_name(const struct Model* m, const struct Element* entry) {
  return xml_attribute(entry, m->fmi == 2 ? "index" : "valueReference");
}

/* How often a list names each variable, compared with what is due. */
static int lists_exactly(const struct Model* m, const char* list2, const char* element3,
                         int (*is_due)(const struct Variable*)) {
  int named[kMaxVariables] = {0};
  for (const struct Element* e = NULL; (e = next_entry(m, list2, element3, e)) != NULL;) {
    const int n = named_by(m, entry_name(m, e));
    if (n < 0 || named[n]++ > 0) return 0;
  }
  for (int n = 0; n < m->variable_count; ++n) {
    if (named[n] != is_due(&m->variables[n])) return 0;
  }
  return 1;
}

static int is_output(const struct Variable* v) { return equal(v->causality, "output"); }
static int is_initial_unknown(const struct Variable* v) {
  if (equal(v->causality, "calculatedParameter")) return 1;
  if (equal(v->type, "Clock")) return 0;
  return is_output(v) && (is_initially(v, "calculated") || is_initially(v, "approx"));
}

static int lists_outputs(const struct Model* m) {
  return lists_exactly(m, "Outputs", "Output", is_output);
}
static int lists_initial_unknowns(const struct Model* m) {
  return lists_exactly(m, "InitialUnknowns", "InitialUnknown", is_initial_unknown);
}

/* FMI 2 wants the initial unknowns in the order of their indices. */
static int sorts_initial_unknowns(const struct Model* m) {
  int last = -1;
  for (const struct Element* e = NULL;
       m->fmi == 2 && (e = next_entry(m, "InitialUnknowns", "InitialUnknown", e)) != NULL;) {
    const int n = named_by(m, entry_name(m, e));
    if (n <= last) return 0;
    last = n;
  }
  return 1;
}

static int has_known_dependencies(const struct Model* m) {
  static const char* const kLists[][2] = {{"Outputs", "Output"},
                                          {"InitialUnknowns", "InitialUnknown"}};
  for (int list = 0; list < 2; ++list) {
    for (const struct Element* e = NULL;
         (e = next_entry(m, kLists[list][0], kLists[list][1], e)) != NULL;) {
      const char* all = xml_attribute(e, "dependencies");
      char words[1024];
      snprintf(words, sizeof words, "%s", all == NULL ? "" : all);
      for (char* word = strtok(words, " "); word != NULL; word = strtok(NULL, " ")) {
        if (named_by(m, word) < 0) return 0;
      }
    }
  }
  return 1;
}

/* Here all clocks are outputs, which are triggered, and are read in event mode. */
static int has_triggered_clocks(const struct Model* m) {
  const struct Element* all = xml_child(m->root, "ModelVariables");
  if (m->interface == NULL) return 1; /* another rule */
  for (const struct Element* one = all ? all->first_child : NULL; one; one = one->next) {
    if (!equal(one->name, "Clock")) continue;
    if (!equal(xml_attribute(one, "intervalVariability"), "triggered")) return 0;
    if (!equal(xml_attribute(one, "causality"), "output")) return 0;
    if (!equal(xml_attribute(m->interface, "hasEventMode"), "true")) return 0;
  }
  return 1;
}

const struct Rule kDescriptionRules[] = {
    {"version", "2.2.1", "2.4.1", "the root is fmiModelDescription of this version", has_version},
    {"name_and_token", "2.2.1", "2.4.1", "model name and guid (token) are there",
     has_name_and_token},
    {"elements", "2.2.1", "2.4.1", "elements are known, single and in order",
     has_elements_in_order},
    {"interface", "2.2.1", "2.4.1", "the FMU is for co-simulation", has_interface},
    {"identifier", "4.3.1", "2.4.1", "modelIdentifier is a C identifier", has_c_identifier},
    {"binary", "2.3", "2.5.1", "the binary of the platform is there", has_binary},
    {"unit_names", "2.2.2", "2.4.3", "names of units are unique", has_unique_units},
    {"base_units", "2.2.2", "2.4.3", "base units have whole powers", has_whole_powers},
    {"log_categories", "2.2.4", "2.4.5", "log categories are unique", has_unique_log_categories},
    {"experiment", "2.2.5", "2.4.6", "the step is > 0, the end not before the start",
     has_sensible_experiment},
    {"variable_names", "2.2.7", "2.4.7", "names of variables are unique", has_unique_names},
    {"references", "2.2.7", "2.4.7", "value references are unique (no aliases here)",
     has_unique_references},
    {"types", "2.2.7", "2.4.7", "types of variables are known", has_known_types},
    {"units", "2.2.7", "2.4.7", "units of variables are defined", has_defined_units},
    {"variability", "2.2.7", "2.4.7.4", "causality and variability go together",
     has_allowed_variabilities},
    {"initial", "2.2.7", "2.4.7.5", "initial is allowed for them", has_allowed_initials},
    {"start", "2.2.7", "2.4.7.5", "start is there where it is due, and nowhere else",
     has_starts_where_due},
    {"range", "2.2.7", "2.4.7", "start is within min and max", has_starts_in_range},
    {"independent", "2.2.7", "2.4.7.4", "one variable is independent", has_independent},
    {"outputs", "2.2.8", "2.4.8", "outputs are listed once, and nothing else", lists_outputs},
    {"initial_unknowns", "2.2.8", "2.4.8", "initial unknowns are listed once, and nothing else",
     lists_initial_unknowns},
    {"initial_order", "2.2.8", "2.4.8", "initial unknowns are sorted by index",
     sorts_initial_unknowns},
    {"dependencies", "2.2.8", "2.4.8", "dependencies name variables", has_known_dependencies},
    {"clocks", "-", "2.2.8", "output clocks are triggered, and there is an event mode",
     has_triggered_clocks},
    {NULL, NULL, NULL, NULL, NULL},
};
