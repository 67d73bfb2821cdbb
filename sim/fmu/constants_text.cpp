#include "sim/fmu/constants_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "plant/vocabulary/checksum.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::sim::fmu {
namespace {

constexpr std::string_view kChecksum = "checksum = ";

std::string checksum_of(std::string_view lines) {
  return fmt::format("{}{:016x}\n", kChecksum, crc64(lines));
}

}  // namespace

void ConstantsWriter::put(const std::string& key, std::string_view value) {
  std::string line = key + " = " + std::string(value);
  const auto ends_line = [](char c) { return c == '\n' || c == '\r'; };
  std::replace_if(line.begin(), line.end(), ends_line, ' ');
  text_ += line + "\n";
}

std::string ConstantsWriter::finished() const { return text_ + checksum_of(text_); }

ConstantsReader::ConstantsReader(std::string_view text, std::string name, std::string_view headline)
    : rest_(text), name_(std::move(name)) {
  if (next() != headline) {
    fail(fmt::format("must begin with '{}': it belongs to another version", headline));
  }
  const std::size_t end = text.rfind(kChecksum);
  if (end == std::string_view::npos || text.substr(end) != checksum_of(text.substr(0, end))) {
    fail("its checksum is wrong: the file has been changed");
  }
}

void ConstantsReader::fail(const std::string& why) const { throw InputError({name_, line_}, why); }

void ConstantsReader::fail_at(const std::string& key, std::string_view text) const {
  fail(fmt::format("'{}' is no value of '{}'", text, key));
}

std::string_view ConstantsReader::next() {
  const std::size_t end = rest_.find('\n');
  if (end == std::string_view::npos) fail("the file ends here too early");
  const std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(end + 1);
  ++line_;
  return line;
}

std::string_view ConstantsReader::value_of(const std::string& key) {
  constexpr std::string_view kIs = " = ";
  const std::string_view line = next();
  if (!line.starts_with(key) || !line.substr(key.size()).starts_with(kIs)) {
    fail(fmt::format("'{}' is expected here", key));
  }
  return line.substr(key.size() + kIs.size());
}

void ConstantsReader::finish() {
  next();  // the checksum
  if (!rest_.empty()) fail("the file continues after its checksum");
}

// Each text ends with the line of its checksum.
std::string_view first_text(std::string_view texts) {
  const std::size_t checksum = texts.find(fmt::format("\n{}", kChecksum));
  const std::size_t end =
      checksum == std::string_view::npos ? checksum : texts.find('\n', checksum + 1);
  return end == std::string_view::npos ? texts : texts.substr(0, end + 1);
}

}  // namespace servomill::sim::fmu
