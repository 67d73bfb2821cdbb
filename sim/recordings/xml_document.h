/// XML of controls, with the line of every fault.
#pragma once

#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace servomill::sim::recordings {

/// True for a text that begins with an element or a declaration of XML.
bool is_xml(std::string_view text);

/// A document that was read, and messages on its elements.
class XmlDocument {
 public:
  /// @throws InputError with the line if it is no XML, as where it is cut off
  XmlDocument(std::string_view text, const std::string& file);

  pugi::xml_node child(const char* name) const { return document_.child(name); }

  /// Elements of that name, at the root or directly below it.
  std::vector<pugi::xml_node> all(const char* name) const;

  /// @throws InputError at the element
  [[noreturn]] void fail(pugi::xml_node node, const std::string& message) const;

  /// The content of an element as a number.
  /// @param what  its name in messages, where there is no element
  /// @throws InputError
  double number(pugi::xml_node node, const std::string& what) const;

 private:
  [[noreturn]] void fail_at(std::ptrdiff_t offset, const std::string& message) const;

  std::string text_, file_;
  pugi::xml_document document_;
};

}  // namespace servomill::sim::recordings
