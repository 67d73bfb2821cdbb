#include "controllers/siemens/block.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "controllers/siemens/codes.h"
#include "controllers/siemens/expression.h"

namespace servomill::controllers::siemens {
namespace {

constexpr std::size_t kMaxWords = 1000;

// A letter and its number, "X10", or a letter with an extension and a value, "S2=500".
struct Address {
  std::string name;
  std::optional<int> extension;
  bool is_assigned = false;  // behind '='
  Place place;
};

class Reader {
 public:
  Reader(Scanner& scanner, Variables& variables) : scanner_(scanner), variables_(variables) {}

  Block read() {
    scanner_.skip_blanks();
    block_.place = scanner_.place();
    for (std::size_t words = 0; !scanner_.at_end(); ++words) {
      if (words == kMaxWords) scanner_.fail("the block has too many words");
      read_word();
    }
    return std::move(block_);
  }

 private:
  [[noreturn]] static void fail(const Place& place, std::string message) {
    throw InputError(place, std::move(message));
  }
  void read_word();
  bool read_address();
  void read_name();
  void read_call(const std::string& name, const Place& place);
  Number read_number(const Address& address);
  Measure read_measure();
  void put(const Address& address);
  void put_function(const Address& address);
  bool put_position(const Address& address);
  std::optional<Number>* number_of(std::string_view name);
  void put_once(std::optional<Number>& place, const Address& address);
  void put_tool();
  void read_assigned(Address address, const std::string& index);
  void require_measure(const Number& number, const Address& address) const;
  int whole(double value, const Address& address) const;

  Scanner& scanner_;
  Variables& variables_;
  Block block_;
};

bool is_sign_or_point(char c) { return c == '+' || c == '-' || c == '.'; }

void Reader::read_word() {
  if (read_assignment(scanner_, variables_)) return;
  scanner_.skip_blanks();
  if (is_letter(scanner_.now()) && read_address()) return;
  if (scanner_.peek_name().empty()) {
    scanner_.fail(fmt::format("'{}' does not start a word", scanner_.now()));
  }
  read_name();
}

// "X10", "X-5", "X=R1", "S2=500", "F 100". False for names of more letters.
bool Reader::read_address() {
  const std::size_t begin = scanner_.position();
  Address address;
  address.place = scanner_.place();
  address.name = capitals(std::string_view(&scanner_.rest().front(), 1));
  scanner_.go_to(begin + 1);
  if (is_name_character(scanner_.now()) && !is_digit(scanner_.now())) {
    scanner_.go_to(begin);
    return false;
  }
  // digits are an extension before '='
  std::size_t end = scanner_.position();
  while (is_digit(scanner_.now())) scanner_.go_to(scanner_.position() + 1);
  const std::string digits(scanner_.from(end));
  const bool is_call = scanner_.now() == '(' && !digits.empty();
  const bool is_numbered_program = address.name == "L" && !digits.empty() && scanner_.now() != '=';
  const bool has_letters = is_name_character(scanner_.now()) && address.name == "L";
  if (is_call || has_letters) {
    scanner_.go_to(begin);
    return false;
  }
  if (is_numbered_program) {  // L010 is another program than L10
    block_.calls.push_back({address.name + digits, {}, false, address.place});
    return true;
  }
  if (scanner_.take('=') && scanner_.now() != '=') {
    constexpr std::size_t kLongest = 4;
    if (digits.size() > kLongest)
      fail(address.place, "an address extension of at most four digits");
    if (!digits.empty()) address.extension = std::stoi(digits);
    address.is_assigned = true;
  } else {
    scanner_.go_to(end);
    scanner_.skip_blanks();
    const bool has_number = is_digit(scanner_.now()) || is_sign_or_point(scanner_.now());
    if (!has_number) {
      fail(address.place, fmt::format("{} requires a number, or '=' and a value", address.name));
    }
  }
  put(address);
  return true;
}

Measure Reader::read_measure() {
  const std::string name = scanner_.peek_name();
  constexpr std::pair<std::string_view, Measure> kNames[] = {{"AC", Measure::absolute},
                                                             {"IC", Measure::incremental},
                                                             {"DC", Measure::shortest},
                                                             {"ACP", Measure::positive},
                                                             {"ACN", Measure::negative}};
  for (const auto& [known, measure] : kNames) {
    if (name != known) continue;
    const std::size_t begin = scanner_.position();
    scanner_.read_name();
    scanner_.skip_blanks();
    if (scanner_.now() == '(') return measure;
    scanner_.go_to(begin);
  }
  return Measure::modal;
}

Number Reader::read_number(const Address& address) {
  Number out;
  out.place = address.place;
  if (address.is_assigned) {
    scanner_.skip_blanks();
    out.measure = read_measure();
    if (out.measure != Measure::modal) {
      scanner_.take('(');
      require_measure(out, address);
    }
    out.value = evaluate_number(scanner_, variables_);
    if (out.measure != Measure::modal) scanner_.expect(')', address.name);
    scanner_.skip_blanks();
    if (out.measure != Measure::modal &&
        std::string_view("+-*/").find(scanner_.now()) != std::string_view::npos) {
      scanner_.fail(
          fmt::format("{}: AC, IC, DC, ACP and ACN must contain the whole value; write the sum in "
                      "their parentheses",
                      address.name));
    }
  } else {
    const bool is_negative = scanner_.now() == '-';
    if (is_negative || scanner_.now() == '+') scanner_.go_to(scanner_.position() + 1);
    const double value = scanner_.read_number();
    out.value = is_negative ? -value : value;
  }
  constexpr double kMax = 1e9;
  if (!(std::abs(out.value) <= kMax)) {
    fail(address.place,
         fmt::format("{} = {:g}: must be between -1e9 and 1e9", address.name, out.value));
  }
  return out;
}

// AC and IC are for positions, DC, ACP and ACN for rotary axes: [F] "Dimensions".
void Reader::require_measure(const Number& number, const Address& address) const {
  constexpr std::array<std::string_view, 6> kLinear = {"X", "Y", "Z", "I", "J", "K"};
  constexpr std::array<std::string_view, 3> kRotary = {"A", "B", "C"};
  const auto is_in = [&](const auto& names) {
    return std::find(names.begin(), names.end(), address.name) != names.end();
  };
  const bool is_rotary = is_in(kRotary) && !address.extension;
  const bool is_length =
      number.measure == Measure::absolute || number.measure == Measure::incremental;
  if (is_rotary || (is_length && (is_in(kLinear) || address.name == "AP"))) return;
  fail(address.place,
       is_length
           ? fmt::format("{}: AC and IC are allowed for positions only", address.name)
           : fmt::format("{}: DC, ACP and ACN are allowed for rotary axes only", address.name));
}

int Reader::whole(double value, const Address& address) const {
  if (value != std::floor(value) || value < 0.0) {
    fail(address.place, fmt::format("{}{:g}: must be an integer", address.name, value));
  }
  return static_cast<int>(value);
}

void Reader::put_once(std::optional<Number>& place, const Address& address) {
  if (place) fail(address.place, fmt::format("{} appears twice in the block", address.name));
  place = read_number(address);
}

void Reader::put_tool() {
  scanner_.skip_blanks();
  block_.tool = evaluate(scanner_, variables_);
}

void Reader::put_function(const Address& address) {
  Function function;
  function.place = address.place;
  if (address.extension) function.spindle = *address.extension;
  function.number = whole(read_number(address).value, address);
  block_.functions.push_back(function);
}

// X Y Z A B C, I J K, I1= J1= K1=, A3= B3= C3=.
bool Reader::put_position(const Address& address) {
  const char letter = address.name.front();
  const std::size_t centre = std::string_view("IJK").find(letter);
  const auto axis = axis_of(letter);
  if (!address.extension) {
    if (axis) put_once(block_.axes[static_cast<std::size_t>(index_of(*axis))], address);
    if (centre != std::string_view::npos) put_once(block_.centre[centre], address);
    return axis || centre != std::string_view::npos;
  }
  const std::size_t direction = std::string_view("ABC").find(letter);
  if (*address.extension == 1 && centre != std::string_view::npos) {
    put_once(block_.through[centre], address);
    return true;
  }
  if (*address.extension == 3 && direction != std::string_view::npos) {
    put_once(block_.direction[direction], address);
    return true;
  }
  if (axis) {
    fail(address.place, fmt::format("{}{}= is a machine axis or an orientation, which is not "
                                    "supported; program X, Y, Z, A, B, C",
                                    letter, *address.extension));
  }
  return false;
}

void Reader::put(const Address& address) {
  const char letter = address.name.front();
  if (letter == 'G' && !address.extension) {
    block_.codes.push_back(
        {fmt::format("G{}", whole(read_number(address).value, address)), address.place});
    return;
  }
  if (letter == 'M') return put_function(address);
  if (letter == 'T' && address.extension.value_or(1) == 1) {
    if (block_.tool) fail(address.place, "T appears twice in the block");
    block_.tool_place = address.place;
    return put_tool();
  }
  if (letter == 'N') fail(address.place, "N is the block number and must start the block");
  if (put_position(address)) return;
  if (letter == 'H') {  // a function of the PLC: its number and its value
    read_number(address);
    block_.settings.push_back({"H", address.place});
    return;
  }
  if (letter == 'S' && address.extension.value_or(1) != 1) {
    fail(address.place, fmt::format("S{}=: a second spindle is not supported", *address.extension));
  }
  std::optional<Number>* place =
      !address.extension || letter == 'S' ? number_of(address.name) : nullptr;
  if (place == nullptr) {
    fail(address.place,
         fmt::format("the address {}{} is not supported", address.name,
                     address.extension ? std::to_string(*address.extension) + "=" : std::string()));
  }
  put_once(*place, address);
}

std::optional<Number>* Reader::number_of(std::string_view name) {
  const std::pair<std::string_view, std::optional<Number>*> all[] = {
      {"F", &block_.F},     {"S", &block_.S},       {"D", &block_.D},       {"CR", &block_.CR},
      {"AR", &block_.AR},   {"TURN", &block_.TURN}, {"AP", &block_.AP},     {"RP", &block_.RP},
      {"RPL", &block_.RPL}, {"RND", &block_.RND},   {"RNDM", &block_.RNDM}, {"CHF", &block_.CHF},
      {"CHR", &block_.CHR}, {"FRC", &block_.FRC},   {"FRCM", &block_.FRCM}, {"P", &block_.P},
      {"L", &block_.L},     {"OVR", &block_.OVR},   {"SPOS", &block_.SPOS}, {"DISC", &block_.DISC}};
  for (const auto& [known, place] : all) {
    if (known == name) return place;
  }
  return nullptr;
}

void Reader::read_call(const std::string& name, const Place& place) {
  Call call;
  call.name = name;
  call.place = place;
  if (scanner_.take('(')) {
    call.has_parentheses = true;
    if (has_text_only(name)) {
      scanner_.read_to_parenthesis();
    } else {
      call.arguments = read_arguments(scanner_, variables_);
    }
  }
  block_.calls.push_back(std::move(call));
}

// "CR=5", "ACC[X]=50": behind '='.
void Reader::read_assigned(Address address, const std::string& index) {
  address.is_assigned = true;
  if (index.empty() || (address.name == "SPOS" && index == "[1]")) {
    if (std::optional<Number>* place = number_of(address.name)) return put_once(*place, address);
  }
  if (!warning_of(address.name).empty()) {
    evaluate(scanner_, variables_);
    block_.settings.push_back({address.name, address.place});
    return;
  }
  const std::string why = refusal_of(address.name);
  fail(address.place, why.empty() ? fmt::format("{}= is neither an address nor a variable: DEF is "
                                                "missing, or it is a machine variable",
                                                address.name + index)
                                  : fmt::format("{}: {}", address.name, why));
}

// A word of several letters: a code, an address with '=', a cycle or a subprogram.
void Reader::read_name() {
  Address address;
  address.place = scanner_.place();
  address.name = scanner_.read_name();
  if (scanner_.take(':')) return;  // a label behind others, as after a block number
  if (address.name == "MCALL") {
    block_.is_modal_call = true;
    return;
  }
  const std::size_t behind = scanner_.position();
  const std::string index = scanner_.read_brackets();
  if (scanner_.take('=')) return read_assigned(address, index);
  scanner_.go_to(behind);
  if (is_code(address.name)) {
    Code code{address.name, address.place};
    if (scanner_.take('(')) code.arguments = scanner_.read_to_parenthesis();
    block_.codes.push_back(std::move(code));
    return;
  }
  read_call(address.name, address.place);
}

}  // namespace

const Code* Block::find(std::string_view code) const {
  const auto found =
      std::find_if(codes.begin(), codes.end(), [&](const Code& one) { return one.name == code; });
  return found == codes.end() ? nullptr : &*found;
}

bool Block::has_axes() const {
  return std::any_of(axes.begin(), axes.end(), [](const auto& one) { return one.has_value(); });
}

bool Block::has_linear_axes() const { return axes[0] || axes[1] || axes[2]; }

bool Block::has_centre() const {
  return std::any_of(centre.begin(), centre.end(), [](const auto& one) { return one.has_value(); });
}

Block read_block(Scanner& scanner, Variables& variables) {
  return Reader(scanner, variables).read();
}

}  // namespace servomill::controllers::siemens
