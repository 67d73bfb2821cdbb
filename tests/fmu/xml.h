/* Elements and attributes of a small XML document: what a model description consists of. */
#ifndef SERVOMILL_TESTS_FMU_XML_H
#define SERVOMILL_TESTS_FMU_XML_H

enum { kMaxAttributes = 24 };

struct Attribute {
  char *name, *value;
};

struct Element {
  char* name;
  struct Attribute attributes[kMaxAttributes];
  int attribute_count;
  struct Element *first_child, *last_child, *next;
};

/* Root element of a document, or NULL where it is not well-formed: tags that do not match, a
   missing quote, a repeated attribute. Comments and declarations are skipped. The text is changed.
 */
struct Element* xml_parse(char* text);
void xml_free(struct Element* element);

/* Value of an attribute, NULL if it is not there. */
const char* xml_attribute(const struct Element* element, const char* name);
/* First child of that name, NULL if there is none; of a NULL element, too. */
struct Element* xml_child(const struct Element* element, const char* name);

#endif
