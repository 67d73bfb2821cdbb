// Values in parentheses, and assignments to variables.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "controllers/siemens/block.h"
#include "controllers/siemens/expression.h"

namespace servomill::controllers::siemens {

std::vector<Argument> read_arguments(Scanner& scanner, const Variables& variables) {
  constexpr std::size_t kMax = 127;
  std::vector<Argument> out;
  if (scanner.take(')')) return out;
  while (true) {
    if (out.size() == kMax) scanner.fail("too many values in the parentheses");
    Argument argument;
    scanner.skip_blanks();
    if (scanner.now() != ',' && scanner.now() != ')') {
      const std::size_t begin = scanner.position();
      const std::string name = scanner.peek_name();
      const bool is_R = name.size() > 1 && name.front() == 'R' &&
                        name.find_first_not_of("0123456789", 1) == name.npos;
      if (is_R || (!name.empty() && variables.is_known(name))) {
        const Reference reference = read_reference(scanner, variables);
        scanner.skip_blanks();
        if (scanner.now() == ',' || scanner.now() == ')') argument.variable = reference;
        scanner.go_to(begin);
      }
      argument.value = evaluate(scanner, variables);
    }
    out.push_back(std::move(argument));
    if (scanner.take(',')) continue;
    scanner.expect(')', "the values in parentheses");
    return out;
  }
}

bool read_assignment(Scanner& scanner, Variables& variables) {
  scanner.skip_blanks();
  const char first = scanner.now();
  const bool may_be_R = first == 'R' || first == 'r' || first == '$';
  if (!may_be_R && !variables.has_own()) return false;  // most words of long programs
  const std::string name = scanner.peek_name();
  if (name.empty()) return false;
  const bool is_R = name.front() == 'R' && name.find_first_not_of("0123456789", 1) == name.npos;
  if (!is_R && !variables.is_known(name)) return false;
  const std::size_t begin = scanner.position();
  const Reference reference = read_reference(scanner, variables);
  if (!scanner.take('=') || scanner.now() == '=' || (is_R && reference.indices.empty())) {
    scanner.go_to(begin);
    return false;
  }
  if (name.starts_with('$')) {
    throw InputError(reference.place,
                     fmt::format("{}: assignments to control variables are not supported; remove "
                                 "the block if it causes no motion",
                                 to_string(reference)));
  }
  assign(reference, scanner, variables);
  return true;
}

// R1=5, A[2]=7, A[0]=SET(1,2), A[0]=REP(0), DEF REAL A[2]=(1,2).
void assign(const Reference& reference, Scanner& scanner, Variables& variables) {
  const bool is_repeated = scanner.take_word("REP");
  const bool is_list = is_repeated || scanner.take_word("SET");
  const bool is_array = variables.size(reference) > 1;
  if (!is_list && !(is_array && reference.indices.empty())) {
    return variables.set(reference, evaluate(scanner, variables));
  }
  if (!is_array) {
    throw InputError(reference.place, fmt::format("{} is not an array", reference.name));
  }
  scanner.expect('(', "SET and REP");
  const std::vector<Argument> values = read_arguments(scanner, variables);
  const bool starts_elsewhere = std::any_of(reference.indices.begin(), reference.indices.end(),
                                            [](int index) { return index != 0; });
  if (starts_elsewhere) {
    throw InputError(reference.place, "SET and REP must start at the first element");
  }
  const std::size_t count = is_repeated ? variables.size(reference) : values.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = is_repeated ? 0 : i;
    if (at < values.size() && values[at].value) {
      variables.set_element(reference, i, *values[at].value);
    }
  }
}

}  // namespace servomill::controllers::siemens
