#include "controllers/dialects/heidenhain_reader.h"

#include <fmt/format.h>

#include <utility>

#include "controllers/dialects/heidenhain_block.h"
#include "controllers/dialects/heidenhain_control.h"

namespace servomill::controllers {
namespace {

struct ProgramFrame {
  std::string name;
  bool is_inch = false;
};

// BEGIN PGM name MM, END PGM name MM
ProgramFrame read_frame(const HeidenhainBlock& block, std::string_view keyword) {
  const auto& words = block.words;
  if (words.size() < 2 || words[0].text != keyword || words[1].text != "PGM") {
    throw InputError(block.place, fmt::format("expected {} PGM name MM (or INCH)", keyword));
  }
  if (words.size() != 4 || (words[3].text != "MM" && words[3].text != "INCH")) {
    throw InputError(
        block.place,
        fmt::format("{} PGM requires a name without spaces, then MM or INCH", keyword));
  }
  return {words[2].text, words[3].text == "INCH"};
}

void check_end(const HeidenhainBlock& block, const ProgramFrame& begin) {
  const ProgramFrame end = read_frame(block, "END");
  if (end.name != begin.name) {
    throw InputError(
        block.words[2].place,
        fmt::format("END PGM {}: the name must match BEGIN PGM {}", end.name, begin.name));
  }
  if (end.is_inch != begin.is_inch) {
    throw InputError(block.words[3].place,
                     fmt::format("END PGM in {}: the unit must match BEGIN PGM ({})",
                                 end.is_inch ? "INCH" : "MM", begin.is_inch ? "INCH" : "MM"));
  }
}

// Block numbers count from 0, or there are none.
void check_number(const HeidenhainBlock& block, bool is_numbered, long expected) {
  if (is_numbered && !block.number) {
    throw InputError(block.place, fmt::format("no block number; it must be {}", expected));
  }
  if (!is_numbered && block.number) {
    throw InputError(block.place,
                     fmt::format("block number {}: BEGIN PGM has no block number", *block.number));
  }
  if (is_numbered && *block.number != expected) {
    throw InputError(block.place,
                     fmt::format("block number {}; it must be {}", *block.number, expected));
  }
}

struct Choice {
  bool HeidenhainSettings::*member;
  std::string_view name;  // of the other than the usual value
};

constexpr Choice kChoices[] = {
    {&HeidenhainSettings::is_rapid_straight, "FMAX by each axis"},
    {&HeidenhainSettings::is_rotary_display_reduced, "rotary display below 360 deg"},
    {&HeidenhainSettings::is_shorter_path_usual, "MP7682 bit 2"},
    {&HeidenhainSettings::is_m136_in_micrometres, "M136 in um"},
    {&HeidenhainSettings::is_feed_of_all_axes, "F of the linear axes"},
    {&HeidenhainSettings::is_stop_switching_off, "M0 leaves spindle and coolant on"},
    {&HeidenhainSettings::is_optional_stop_on, "M1 does not stop"},
    {&HeidenhainSettings::is_m6_halting, "M6 does not halt"}};

bool is_program_end(const HeidenhainBlock& block) {
  return block.words.size() >= 2 && block.words[0].text == "END" && block.words[1].text == "PGM";
}

}  // namespace

std::string to_string(const HeidenhainSettings& settings) {
  std::string text;
  for (const Choice& choice : kChoices) {
    if (settings.*choice.member == HeidenhainSettings{}.*choice.member) continue;
    text += (text.empty() ? "" : ", ") + std::string(choice.name);
  }
  return text.empty() ? "usual settings" : text;
}

std::vector<HeidenhainSettings> all_heidenhain_settings(bool has_tilting) {
  HeidenhainSettings usual;
  usual.has_tilting = has_tilting;
  std::vector<HeidenhainSettings> all{usual};
  HeidenhainSettings every = usual;
  for (const Choice& choice : kChoices) {
    HeidenhainSettings one = usual;
    one.*choice.member = every.*choice.member = !(usual.*choice.member);
    one.is_rotary_display_reduced |= one.is_shorter_path_usual;  // acts on a reduced display only
    all.push_back(one);
  }
  all.push_back(every);
  return all;
}

std::vector<MachineAction> read_heidenhain(std::string_view text, const std::string& file,
                                           const ControlSetup& setup,
                                           const HeidenhainSettings& settings,
                                           const HeidenhainRules& rules) {
  HeidenhainBlocks blocks(text, file);
  std::optional<HeidenhainBlock> block = blocks.next();
  if (!block) throw InputError({file, 1, 1}, "the program is empty; it must start with BEGIN PGM");
  const ProgramFrame begin = read_frame(*block, "BEGIN");
  const bool is_numbered = block->number.has_value();
  check_number(*block, is_numbered, 0);
  heidenhain::Control control(setup, settings, rules, begin.is_inch);

  for (long number = 1; (block = blocks.next()); ++number) {
    check_number(*block, is_numbered, number);
    if (is_program_end(*block)) {
      check_end(*block, begin);
      control.finish(block->place);
      if (!control.is_at_end()) {
        throw InputError(block->place,
                         "END PGM without M2 or M30: whether the spindle stops depends on the "
                         "machine");
      }
      if (const auto after = blocks.next()) {
        throw InputError(after->place, "no block is allowed after END PGM");
      }
      return control.take_actions();
    }
    if (block->words.empty() || (block->is_optional && setup.skips_blocks)) continue;
    if (control.is_at_end()) throw InputError(block->place, "no block is allowed after M2 or M30");
    control.run(*block);
  }
  throw InputError({file, blocks.line(), 0}, fmt::format("END PGM {} is missing", begin.name));
}

}  // namespace servomill::controllers
