#include "controllers/conversational/conversational.h"

#include <array>
#include <memory>
#include <string_view>
#include <utility>

#include "controllers/conversational/translator.h"
#include "controllers/translation/translated_source.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::conversational {
namespace {

constexpr auto kReadings = std::to_array<Reading>({
    {"F in a program in INCH", "tenths of an inch per minute", "all", "TNC 7, Cutting data"},
    {"F of TOOL DEF", "ignored; the next feed move must program F", "none found", "none found"},
    {"PATTERN DEF, CYCL CALL PAT", "at the height of the call or of Q204, whichever is higher",
     "iTNC 530, TNC 640", "from memory"},
    {"cycle 209", "back by Q256 pitches after each Q257", "TNC 640",
     "TNC 640 cycle programming (34059x-01) p. 102; the order of the moves from memory"},
    {"cycles 2 and 17", "tapping from the current Z, as cycles 206 and 207", "TNC 407 to 426",
     "TNC 407 (280 580) p. 8-7; cycle 17 from memory"},
    {"cycles 220 and 221", "the drilling cycle before them, at each hole of the pattern",
     "iTNC 530, TNC 640", "from memory"},
    {"PLANE with MB", "the tool retracts along its axis before the rotary axes turn",
     "iTNC 530, TNC 640", "from memory"},
    {"FUNCTION DWELL TIME", "a dwell in seconds", "TNC 640", "from memory"},
    {"cycle 19 without angles, or with angles of 0", "ends the tilting; no axis moves",
     "TNC 426, iTNC 530", "from memory"},
    {"N before block numbers", "a block number", "none; simulators of controls write it",
     "none needed"},
    {"TOOL DEF1, CYCL DEF9 .0", "as TOOL DEF 1, CYCL DEF 9.0",
     "none found; post-processors write it for HSC programs", "none needed"},
    {"words in brackets at the end of a block", "a comment",
     "none found; simulators and post-processors write it",
     "none needed: no control accepts words there"},
    {"a comment that ends with '~'", "continues on the next line", "TNC 640", "from memory"},
    {"preset 0 of cycle 247", "the preset active at the start, if the program activates no other",
     "TNC 640 (the datum last set manually)", "from memory"},
    {"M140 MB MAX", "to the upper travel limit of Z in the machine file", "iTNC 530, TNC 640",
     "from memory"},
    {"cycle 392 (ATC)", "no effect on motion: it adapts the drives to the load",
     "machines of DMG MORI", "from memory"},
    {"F of a block with linear and rotary axes", "the feed of the linear axes",
     "some machines: the feed of all axes combined", "none found"},
    {"M functions of the machine builder", "without effect on motion", "by machine", "from memory"},
    {"M functions of displays, messages and filters", "without effect on motion", "all",
     "from memory"},
    {"FN 15, FN 16, FN 19, FN 20, FN 26, FN 27, FN 38", "without effect on motion", "all",
     "from memory"},
    {"FN 18, FN 28", "an unknown value, unless --parameter sets it", "all", "from memory"},
    {"PLANE with SEQ+ or SEQ-",
     "the last rotary axis from the workpiece to the tool is >= 0 or <= 0", "iTNC 530, TNC 640",
     "from memory"},
    {"TOOL CALL of a tool without a tool table",
     "a tool of unknown length: machine Z is the TCP position",
     "every control has its own tool table", "none needed"},
    {"TOOL CALL of a name without a tool table", "a tool of unknown length, numbered from 30001",
     "every control has its own tool table", "none needed"},
    {"DR2 of TOOL CALL", "ignored: corner radii act only in 3-D compensation", "all",
     "from memory"},
    {"PLANE with TABLE ROT or COORD ROT", "ignored: they matter only with a free rotary table axis",
     "iTNC 530, TNC 640", "from memory"},
    {"cycle 13, orientation in cycle 202", "without effect on motion", "all", "from memory"},
});

// The first line that is neither blank nor a comment.
bool begins_program(ProgramText& text) {
  constexpr int kMaxLines = 1000;
  bool found = false;
  int lines = 0;
  for (std::string_view line; text.next(line) && ++lines < kMaxLines;) {
    const std::size_t at = line.find_first_not_of(" \t\r0123456789");
    if (at == std::string_view::npos || std::string_view(";*(").find(line[at]) != line.npos) {
      continue;
    }
    found = line.substr(at).starts_with("BEGIN PGM");
    break;
  }
  text.rewind();
  return found;
}

std::string all_of(ProgramText& text) {
  std::string all;
  for (std::string_view line; text.next(line);) all.append(line).append("\n");
  return all;
}

double unit_of(const HeidenhainBlock& begin) {
  return !begin.words.empty() && begin.words.back().text == "INCH" ? inch : mm;
}

// Reads TOOL DEF 5 L+12.5 R+5, unless the table has such a tool.
void add_tool(const HeidenhainBlock& block, double unit, ToolTable& tools) {
  if (block.words.size() < 3) return;
  const auto number = integer_of(block.words[2].text);
  if (!number || *number < 1 || tools.entry_of(static_cast<int>(*number)) != nullptr) return;
  try {
    Words words(std::span(block.words).subspan(3));
    const auto L = words.take_number("L");
    const auto R = words.take_number("R");
    if (!L || L->name || (R && R->name)) return;
    ToolEntry tool;
    tool.number = static_cast<int>(*number);
    tool.offset[2] = L->number * unit;
    if (R) tool.diameter = 2.0 * R->number * unit;  // else unknown: the block itself says so
    tools.add(tool);
  } catch (const InputError&) {  // reported where the block runs
  }
}

void add_tools(const std::string& text, const std::string& file, ToolTable& tools) {
  ProgramFile program(text, file);
  if (program.tool_definitions().empty()) return;
  double unit = mm;
  try {
    if (const auto begin = program.begin()) unit = unit_of(*begin);
  } catch (const InputError&) {
  }
  for (const HeidenhainBlock& block : program.tool_definitions()) add_tool(block, unit, tools);
}

using Source = translation::TranslatedSource<Translator>;

}  // namespace

std::span<const Reading> readings() { return kReadings; }

bool is_conversational(ProgramText& text, Reader reader) {
  if (text.is_generated()) return false;
  if (reader == Reader::heidenhain) return true;
  if (reader != Reader::any) return false;
  const std::string& file = text.file();
  return file.ends_with(".h") || file.ends_with(".H") || begins_program(text);
}

ProgramText as_gcode(ProgramText text, ProgramSetup& setup) {
  const std::string file = text.file();
  std::string all = all_of(text);
  add_tools(all, file, setup.tools);
  auto source = std::make_unique<Source>(std::move(all), file, setup);
  std::erase_if(setup.parameters, [](const auto& one) { return one.first.starts_with('Q'); });
  setup.reader = Reader::any;
  setup.block_delete = false;
  return ProgramText::of_source(std::move(source), file);
}

ProgramSetup gcode_setup(ProgramText text, ProgramSetup setup) {
  if (is_conversational(text, setup.reader)) as_gcode(std::move(text), setup);
  return setup;
}

bool is_parameter_name(std::string_view name) {
  std::size_t length = 0;
  return q_name_at(name, length) && length == name.size();
}

std::set<std::string> called_programs(ProgramText text) {
  const std::string file = text.file();
  const ProgramFile program(all_of(text), file);
  std::set<std::string> names;
  for (const std::string& name : program.called_programs()) names.insert(program_name(name));
  return names;
}

}  // namespace servomill::controllers::conversational
