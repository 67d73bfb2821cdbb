#include "tools/servomill/json_list.h"

#include <fmt/format.h>

namespace servomill::tools {

void JsonList::add(std::string_view object) {
  fmt::print("{}{}\n", is_begun_ ? ',' : '[', object);
  is_begun_ = true;
}

void JsonList::end() { fmt::print("{}]\n", is_begun_ ? "" : "["); }

}  // namespace servomill::tools
