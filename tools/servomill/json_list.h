/// The one document that a command prints with --json where it has several objects: a list.
#pragma once

#include <string_view>

namespace servomill::tools {

/// A list on standard output, one object a line, each printed as soon as it is known:
///
///     [{"axis": "X", "Kv_per_s": 33.3}
///     ,{"axis": "Y", "Kv_per_s": 28.1}
///     ]
///
/// A command that fails or is interrupted leaves it without its end.
class JsonList {
 public:
  /// @param object  JSON already
  void add(std::string_view object);
  void end();

 private:
  bool is_begun_ = false;
};

}  // namespace servomill::tools
