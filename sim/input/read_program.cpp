#include "sim/input/read_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "controllers/conversational/conversational.h"
#include "controllers/gcode/called_subroutines.h"
#include "controllers/gcode/reader.h"
#include "controllers/siemens/siemens.h"
#include "plant/vocabulary/checksum.h"
#include "sim/input/read_cutter.h"
#include "sim/input/read_machine.h"
#include "sim/input/scenario_document.h"
#include "sim/input/subroutine_files.h"
#include "sim/model/scenario.h"
#include "sim/system/utf8.h"

namespace servomill::sim::input {
namespace {

constexpr double kLongestTool = 100.0;  // m: farther places are slips, and overflow

// Goes through characters and keeps the place of the next one.
class CharacterCheck {
 public:
  explicit CharacterCheck(const std::string& file) : file_(file) {}

  // The length of the character that a text begins with.
  // @throws InputError if it cannot be written as UTF-8 without NUL
  std::size_t pass(std::string_view text) {
    const std::size_t length = system::utf8_length(text);
    const auto byte = static_cast<unsigned char>(text.front());
    if (length == 0) {
      throw InputError({file_, line_, column_},
                       fmt::format("byte 0x{:02x} is not UTF-8; save the program as UTF-8", byte));
    }
    if (byte == 0) {
      throw InputError({file_, line_, column_}, "byte 0x00 is not allowed in a program");
    }
    column_ = byte == '\n' ? 1 : column_ + 1;
    if (byte == '\n') ++line_;
    return length;
  }

 private:
  const std::string& file_;
  int line_ = 1, column_ = 1;
};

// A program becomes a text of the result file, which is UTF-8 without NUL.
void refuse_unwritable(const std::string& file, const StoredText& text) {
  constexpr std::size_t kLongest = 4;  // bytes of a character
  CharacterCheck check(file);
  std::string ahead;  // a character that a piece cuts, and the piece after it
  std::size_t taken = 0;
  text.each_piece([&](std::string_view piece) {
    ahead += piece;
    taken += piece.size();
    const bool is_last = taken == text.size();
    const std::size_t end = is_last ? ahead.size() : ahead.size() - (kLongest - 1);
    std::size_t at = 0;
    while (at < end) at += check.pass(std::string_view(ahead).substr(at));
    ahead.erase(0, at);
  });
}

// Files of subroutines that a text may call, and those that they may call in turn.
void read_subroutines(const std::shared_ptr<const StoredText>& text, const Place& at,
                      InputFiles& files, model::ProgramSpec& program) {
  for (const std::string& name : controllers::called_subroutines(
           controllers::ProgramText::of_shared_text(text, program.file))) {
    const std::string file = subroutine_file(program.file, name);
    if (program.subroutines.contains(name) || !std::filesystem::is_regular_file(file)) continue;
    const std::shared_ptr<const StoredText> called = files.program(file, at, "subroutine");
    program.subroutines[name] = called->all();
    refuse_unwritable(file, *called);
    read_subroutines(called, at, files, program);
  }
}

void read_stored_subroutines(config::Reader& table, model::ProgramSpec& program) {
  if (!table.has("subroutines")) return;
  config::Reader texts = table.table("subroutines");
  for (const std::string& name : texts.keys()) program.subroutines[name] = texts.text(name);
}

// A resolved document has the checksum of a long program.
bool is_stored_beside(config::Reader& table) {
  return table.has("text_checksum") && !is_outdated_copy(table, "file", "text_checksum");
}

// The text of the program, from its file or as a resolved document holds it.
void read_text(config::Reader& table, InputFiles& files, model::ProgramSpec& program) {
  program.file = table.text("file");
  if (table.has("text") && !is_outdated_copy(table, "file", "text")) {
    program.shared_text = std::make_shared<const StoredText>(table.text("text"));
    read_stored_subroutines(table, program);
  } else if (is_stored_beside(table) && files.provided_program() != nullptr) {
    program.shared_text = files.provided_program();
    read_stored_subroutines(table, program);
  } else if (!program.file.empty()) {
    for (const char* stored : {"text", "subroutines"}) table.raw(stored);
    const Place at = table.place("file");
    program.file = beside(at, program.file);
    program.shared_text = files.program(program.file, at, "program");
    read_subroutines(program.shared_text, at, files, program);
  }
  if (is_stored_beside(table) &&
      table.text("text_checksum") != checksum_text(*program.shared_text)) {
    table.fault("text_checksum",
                fmt::format("differs from that of {}: the program has changed", program.file));
  }
  if (table.is("file", config::Value::Type::text) && table.text("file").empty()) {
    table.fault("file", "must not be empty");
  }
  refuse_unwritable(program.file, *program.shared_text);
}

// The program of tests.
void use_program_of(const model::MachineTests& tests, const JointLayout& layout,
                    config::Reader& table, model::ProgramSpec& program) {
  for (const char* const key : {"file", "text", "text_checksum", "subroutines"}) {
    if (table.raw(key) != nullptr) table.fault(key, "has no effect: [[test]] writes the program");
  }
  program.file = "[[test]]";
  if (std::any_of(tests.begin(), tests.end(), [](const auto& one) { return !one->moves(); })) {
    return;  // its faults are reported
  }
  program.shared_text = std::make_shared<const StoredText>(model::program_of(tests, layout));
}

// "#101", "#<name>" or "Q5"
bool is_parameter_name(std::string_view key) {
  if (key.starts_with('Q')) return controllers::conversational::is_parameter_name(key);
  if (controllers::siemens::is_parameter_name(key)) return true;
  if (key.starts_with("#<")) return key.size() > 3 && key.ends_with('>');
  return key.size() > 1 && key.size() < 8 && key[0] == '#' &&
         key.find_first_not_of("0123456789", 1) == std::string_view::npos;
}

std::map<std::string, double> read_parameters(config::Reader& table) {
  std::map<std::string, double> out;
  for (const std::string& key : table.keys()) {
    out[key] = table.real(key, config::kNumber);
    if (!is_parameter_name(key)) {
      table.fault(
          key,
          "must be named #N or #<name>, QN in a conversational program, or RN or $NAME in one of "
          "Siemens");
    }
  }
  return out;
}

void read_tool(config::Reader& table, model::ProgramSpec& program) {
  controllers::ToolEntry tool;
  tool.number =
      static_cast<int>(table.integer("number", {config::at_least(1), config::at_most(99999)}));
  tool.pocket = tool.number;
  tool.offset[index_of(Axis::Z)] = table.real(
      "length_mm", config::kLength, {config::at_least(0.0), config::at_most(kLongestTool)});
  tool.diameter = table.real_or("diameter_mm", 0.0, config::kLength, {config::at_least(0.0)});
  const bool teeth_are_given = table.has("teeth");
  const auto cutter = read_cutter(table, tool.diameter);
  if (program.tools.find(tool.number) != nullptr) {
    table.fault("number", "is already used by an earlier tool");
    return;
  }
  program.tools.add(tool);
  if (cutter) program.cutters[tool.number] = *cutter;
  if (cutter && !teeth_are_given) program.assumed_teeth.insert(tool.number);
}

}  // namespace

std::set<int> read_ignored_codes(config::Reader& table, const std::set<int>& fallback) {
  std::vector<std::string> usual;
  for (const int code : fallback) usual.push_back(fmt::format("M{}", code));
  std::set<int> out;
  for (const std::string& text : table.texts_or("ignore_codes", usual)) {
    const controllers::IgnoredCode code = controllers::ignored_code(text);
    if (code.fault.empty()) {
      out.insert(code.number);
    } else {
      table.fault("ignore_codes", fmt::format("{}: {}", text, code.fault));
    }
  }
  return out;
}

std::string checksum_text(const StoredText& program) {
  return fmt::format("{:016x}", crc64_in_pieces(program));
}

model::ProgramSpec read_program(config::Reader& table, const model::MachineSettings& machine,
                                InputFiles& files, const model::MachineTests& tests) {
  model::ProgramSpec program;
  if (tests.empty()) {
    read_text(table, files, program);
  } else {
    use_program_of(tests, machine.chain.layout, table, program);
  }
  const model::NcSettings& nc = machine.nc;
  program.reader = static_cast<controllers::Reader>(table.choice_or(
      "reader", static_cast<std::size_t>(nc.program_reader), controllers::kReaders));
  const bool is_of_other_language = program.reader == controllers::Reader::heidenhain ||
                                    program.reader == controllers::Reader::siemens;
  if (!tests.empty() && is_of_other_language) {
    if (table.has("reader")) table.fault("reader", "must read G-code, which [[test]] makes");
    program.reader = controllers::Reader::any;
  }
  program.decimal_point = static_cast<controllers::DecimalPoint>(table.choice_or(
      "decimal_point", static_cast<std::size_t>(nc.decimal_point), controllers::kDecimalPoints));
  program.ignored_codes = read_ignored_codes(table, nc.ignored_codes);
  if (table.has("first_feed"))
    program.first_feed = table.real("first_feed", config::kVelocity, {config::above(0.0)});
  program.feed_override =
      table.real_or("feed_override", 1.0, config::kNumber, {config::above(0.0)});
  if (table.has("parameters")) {
    config::Reader parameters = table.table("parameters");
    program.parameters = read_parameters(parameters);
  }
  const JointLayout& layout = machine.chain.layout;
  if (table.has("work_offset")) {
    config::Reader words = table.table("work_offset");
    program.work_offset = read_offsets(words, layout);
  }
  program.start_place = table.place("start");
  if (table.has("start")) {
    config::Reader words = table.table("start");
    program.start = read_offsets(words, layout);
  }
  for (config::Reader& tool : table.tables_or_none("tool")) read_tool(tool, program);
  return program;
}

AxisWords read_offsets(config::Reader& table, const JointLayout& layout) {
  if (layout == JointLayout{}) {
    for (const std::string& key : table.keys()) table.raw(key);
  }
  return read_words(table, layout);
}

}  // namespace servomill::sim::input
