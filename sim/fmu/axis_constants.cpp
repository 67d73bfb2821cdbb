#include "sim/fmu/axis_constants.h"

#include <fmt/format.h>

#include <charconv>
#include <concepts>
#include <type_traits>

#include "plant/vocabulary/checksum.h"
#include "plant/vocabulary/input_error.h"
#include "sim/fmu/axis_fields.h"

namespace servomill::sim::fmu {
namespace {

constexpr std::string_view kChecksum = "checksum = ";
constexpr std::size_t kMaxListSize = 1'000'000;  // of a list whose size a file gives

std::string headline() { return fmt::format("servomill axis {}\n", kAxisFileVersion); }

template <class T>
std::string text_of_value(const T& value) {
  if constexpr (std::is_same_v<T, std::string>) {
    std::string line = value;  // a line stays a line
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    return line;
  } else if constexpr (std::is_enum_v<T>) {
    return std::to_string(static_cast<int>(value));
  } else if constexpr (std::is_same_v<T, bool>) {
    return value ? "1" : "0";
  } else {
    char digits[64];
    const auto end = std::to_chars(std::begin(digits), std::end(digits), value);
    return {digits, end.ptr};
  }
}

// Lines of the file in their order.
class Lines {
 public:
  Lines(std::string_view text, std::string name) : rest_(text), name_(std::move(name)) {}

  std::string_view next() {
    const std::size_t end = rest_.find('\n');
    if (end == std::string_view::npos) fail("the file ends here too early");
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    ++line_;
    return line;
  }
  bool at_end() const { return rest_.empty(); }
  [[noreturn]] void fail(const std::string& why) const { throw InputError({name_, line_}, why); }

  template <class T>
  void operator()(const std::string& key, T& value) {
    std::string_view line = next();
    if (!line.starts_with(key) || !line.substr(key.size()).starts_with(" = ")) {
      fail(fmt::format("'{}' is expected here", key));
    }
    line.remove_prefix(key.size() + 3);
    if constexpr (std::is_same_v<T, std::string>) {
      value = line;
    } else if constexpr (std::is_enum_v<T>) {
      value = static_cast<T>(number<std::uint8_t>(key, line));
    } else if constexpr (std::is_same_v<T, bool>) {
      value = number<int>(key, line) != 0;
    } else {
      value = number<T>(key, line);
      if (std::is_same_v<T, std::size_t> && static_cast<double>(value) > kMaxListSize &&
          !key.ends_with("noise_seed")) {
        fail(fmt::format("'{}' is too large", key));
      }
      if (key == "joint" && !(value >= T{0} && value < T{kJoints})) fail("there is no such joint");
      if (key == "filters" && value > T{controllers::kMaxSections}) fail("too many filters");
    }
  }

 private:
  template <class T>
  T number(const std::string& key, std::string_view text) const {
    T value{};
    const char* end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, value);
    if (read.ec != std::errc() || read.ptr != end) {
      fail(fmt::format("'{}' is no value of '{}'", text, key));
    }
    return value;
  }

  std::string_view rest_;
  std::string name_;
  int line_ = 0;
};

}  // namespace

std::string why_not_exported(const AxisConstants& axis) {
  if (axis.machine.integrator != model::Integrator::exact) {
    return "its drives are integrated by CVODE, which an FMU does not contain; use integrator = "
           "\"exact\"";
  }
  const plant::ErrorFunction& lead = axis.machine.screw[static_cast<std::size_t>(axis.joint)].lead;
  if (!lead.grids.empty() || !lead.reversals.empty()) {
    return "the lead error of its screw is a grid or has a reversal, which an FMU does not contain";
  }
  return {};
}

std::string text_of(const AxisConstants& axis) {
  std::string text = headline();
  const auto write = [&](const std::string& key, const auto& value) {
    text += key + " = " + text_of_value(value) + "\n";
  };
  AxisConstants copy = axis;  // fields are visited as a reader may change them
  AxisFields<decltype(write)>(write).all(copy);
  return text + fmt::format("{}{:016x}\n", kChecksum, crc64(text));
}

AxisConstants read_axis_constants(std::string_view text, const std::string& name) {
  Lines lines(text, name);
  if (std::string(lines.next()) + "\n" != headline()) {
    lines.fail(fmt::format("must begin with 'servomill axis {}': it belongs to another version",
                           kAxisFileVersion));
  }
  const std::size_t end = text.rfind(kChecksum);
  if (end == std::string_view::npos ||
      text.substr(end) != fmt::format("{}{:016x}\n", kChecksum, crc64(text.substr(0, end)))) {
    lines.fail("its checksum is wrong: the file has been changed");
  }
  AxisConstants axis;
  const auto read = [&](const std::string& key, auto& value) { lines(key, value); };
  AxisFields<decltype(read)>(read).all(axis);
  lines.next();
  if (!lines.at_end()) lines.fail("the file goes on behind its checksum");
  return axis;
}

std::string text_of(const std::vector<AxisConstants>& axes) {
  std::string text;
  for (const AxisConstants& axis : axes) text += text_of(axis);
  return text;
}

// Each text ends with the line of its checksum.
std::vector<AxisConstants> read_axes(std::string_view text, const std::string& name) {
  std::vector<AxisConstants> axes;
  do {
    const std::size_t checksum = text.find(fmt::format("\n{}", kChecksum));
    const std::size_t end =
        checksum == std::string_view::npos ? checksum : text.find('\n', checksum + 1);
    const std::size_t size = end == std::string_view::npos ? text.size() : end + 1;
    axes.push_back(read_axis_constants(text.substr(0, size), name));
    text.remove_prefix(size);
  } while (!text.empty());
  return axes;
}

std::string token_of(std::string_view text) {
  return fmt::format("{{{:016x}-{:016x}}}", crc64(text), crc64(fmt::format("servomill {}", text)));
}

}  // namespace servomill::sim::fmu
