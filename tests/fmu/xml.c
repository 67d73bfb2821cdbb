#include "xml.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

struct Parser {
  char* at;
  int failed;
};

static void skip_space(struct Parser* p) {
  while (isspace((unsigned char)*p->at)) ++p->at;
}

/* Skips text, comments and declarations up to the next tag. */
static void skip_to_tag(struct Parser* p) {
  for (;;) {
    while (*p->at != '\0' && *p->at != '<') ++p->at;
    const char* end = NULL;
    if (strncmp(p->at, "<!--", 4) == 0) end = "-->";
    if (strncmp(p->at, "<?", 2) == 0) end = "?>";
    if (end == NULL) return;
    char* found = strstr(p->at, end);
    if (found == NULL) {
      p->failed = 1;
      return;
    }
    p->at = found + strlen(end);
  }
}

static int is_name(char c) { return isalnum((unsigned char)c) || strchr("_-.:", c) != NULL; }

/* A copy of the name at which the parser stands; NULL if there is none. */
static char* take_name(struct Parser* p) {
  const char* begin = p->at;
  while (*p->at != '\0' && is_name(*p->at)) ++p->at;
  if (p->at == begin) {
    p->failed = 1;
    return NULL;
  }
  return strndup(begin, (size_t)(p->at - begin));
}

/* Replaces the entities of a value. */
static void decode(char* text) {
  static const struct {
    const char* entity;
    char character;
  } kEntities[] = {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}};
  char* to = text;
  for (const char* from = text; *from != '\0';) {
    size_t length = 1;
    char character = *from;
    for (size_t n = 0; n < sizeof kEntities / sizeof kEntities[0]; ++n) {
      if (strncmp(from, kEntities[n].entity, strlen(kEntities[n].entity)) != 0) continue;
      length = strlen(kEntities[n].entity);
      character = kEntities[n].character;
    }
    *to++ = character;
    from += length;
  }
  *to = '\0';
}

static void take_attribute(struct Parser* p, struct Element* element) {
  char* name = take_name(p);
  if (name == NULL) return;
  skip_space(p);
  char* end = p->at[0] == '=' && p->at[1] == '"' ? strchr(p->at + 2, '"') : NULL;
  if (end == NULL || element->attribute_count == kMaxAttributes ||
      xml_attribute(element, name) != NULL) {
    free(name);
    p->failed = 1;
    return;
  }
  struct Attribute* to = &element->attributes[element->attribute_count++];
  to->name = name;
  to->value = strndup(p->at + 2, (size_t)(end - p->at - 2));
  decode(to->value);
  p->at = end + 1;
}

static struct Element* take_element(struct Parser* p);

/* Children up to the end tag of the element. */
static void take_children(struct Parser* p, struct Element* element) {
  for (;;) {
    skip_to_tag(p);
    if (p->failed || *p->at == '\0') break;
    if (p->at[1] == '/') {
      p->at += 2;
      char* name = take_name(p);
      if (name == NULL || strcmp(name, element->name) != 0 || *p->at++ != '>') p->failed = 1;
      free(name);
      return;
    }
    struct Element* child = take_element(p);
    if (child == NULL) break;
    if (element->last_child != NULL) element->last_child->next = child;
    if (element->first_child == NULL) element->first_child = child;
    element->last_child = child;
  }
  p->failed = 1;
}

static struct Element* take_element(struct Parser* p) {
  struct Element* element = calloc(1, sizeof *element);
  if (*p->at++ != '<') p->failed = 1;
  element->name = p->failed ? NULL : take_name(p);
  while (!p->failed) {
    skip_space(p);
    if (strncmp(p->at, "/>", 2) == 0) {
      p->at += 2;
      return element;
    }
    if (*p->at == '>') {
      ++p->at;
      take_children(p, element);
      break;
    }
    take_attribute(p, element);
  }
  if (!p->failed) return element;
  xml_free(element);
  return NULL;
}

struct Element* xml_parse(char* text) {
  struct Parser parser = {text, 0};
  skip_to_tag(&parser);
  return parser.failed || *parser.at == '\0' ? NULL : take_element(&parser);
}

void xml_free(struct Element* element) {
  while (element != NULL) {
    struct Element* next = element->next;
    xml_free(element->first_child);
    for (int n = 0; n < element->attribute_count; ++n) {
      free(element->attributes[n].name);
      free(element->attributes[n].value);
    }
    free(element->name);
    free(element);
    element = next;
  }
}

const char* xml_attribute(const struct Element* element, const char* name) {
  for (int n = 0; n < element->attribute_count; ++n) {
    if (strcmp(element->attributes[n].name, name) == 0) return element->attributes[n].value;
  }
  return NULL;
}

struct Element* xml_child(const struct Element* element, const char* name) {
  struct Element* child = element == NULL ? NULL : element->first_child;
  while (child != NULL && strcmp(child->name, name) != 0) child = child->next;
  return child;
}
