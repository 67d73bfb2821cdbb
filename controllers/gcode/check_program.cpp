#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controllers/gcode/interpreter.h"
#include "controllers/gcode/line_reader.h"
#include "controllers/gcode/macro/macro_program.h"
#include "controllers/gcode/other_language.h"
#include "controllers/gcode/program_text.h"
#include "controllers/gcode/request.h"
#include "controllers/translation/translated_program.h"

namespace servomill::controllers {
namespace {

bool ends_program(const Block& block) {
  return std::any_of(block.words.begin(), block.words.end(), [](const Word& word) {
    return word.letter == 'M' && word.value.is_constant() &&
           (word.value.number == 2.0 || word.value.number == 30.0);
  });
}

void append(std::vector<Fault>& faults, const InputError& error) {
  for (const Fault& fault : error.faults()) {
    const bool known = std::any_of(faults.begin(), faults.end(), [&](const Fault& other) {
      return other.place == fault.place && fault.message.starts_with(other.message);
    });
    if (!known) faults.push_back(fault);
  }
}

// Subroutines may stand behind M2: where the program has O-words it is read to its last line.
std::vector<Fault> syntax_faults(ProgramText& text, const ProgramSetup& setup) {
  std::vector<Fault> faults;
  LineReader reader(setup.block_delete, setup.reader);
  Block block;
  PercentRule percent;
  bool has_o_words = false;
  for (std::string_view line; text.next(line);) {
    if (is_blank(line)) continue;
    try {
      reader.parse(line, text.file(), text.number(), block);
      if (block.percent) {
        if (percent.saw_percent() != Percent::start) break;
        continue;
      }
      percent.saw_line();
      has_o_words = has_o_words || block.o_word.flow != Flow::none;
      // a run says which codes another reader takes
      if (setup.reader == Reader::linuxcnc) check_codes(block, text.file());
      if (ends_program(block) && !has_o_words) break;
    } catch (const InputError& error) {
      percent.saw_line();
      append(faults, error);
    }
  }
  text.rewind();
  return faults;
}

// Adds the first fault met on running the program. Where that is an M code of the machine's
// builder, which options can leave out, the program runs again without it, so that one answer names
// them all.
void run_to_faults(const ProgramText& text, ProgramSetup setup, std::vector<Fault>& faults,
                   std::vector<Fault>* warnings) {
  constexpr int kMaxRuns = 20;
  for (int run = 0; run < kMaxRuns; ++run) {
    std::optional<int> refused;
    setup.refuses_code = [&](int code) { refused = code; };
    try {
      Interpreter interpreter(text.again(), setup);
      while (interpreter.next() != nullptr) {
      }
      if (warnings != nullptr && run == 0) *warnings = interpreter.warnings();
      return;
    } catch (const InputError& error) {
      append(faults, error);
    }
    if (!refused || !setup.ignored_codes.insert(*refused).second) return;
  }
}

}  // namespace

std::vector<Fault> check_program(ProgramText text, ProgramSetup setup,
                                 std::vector<Fault>* warnings) {
  std::vector<Fault> faults;
  const bool is_gcode =
      translation::language_of(text, setup.reader) == translation::Language::gcode &&
      !macro::is_macro_program(text, setup.reader) && refused_program(text).empty();
  if (is_gcode) faults = syntax_faults(text, setup);
  const std::string file = text.file();
  run_to_faults(text, setup, faults, warnings);
  std::stable_sort(faults.begin(), faults.end(), [&](const Fault& a, const Fault& b) {
    if (a.place.file != b.place.file) return a.place.file == file;
    return std::pair(a.place.line, a.place.column) < std::pair(b.place.line, b.place.column);
  });
  return faults;
}

std::vector<Fault> check_program(std::string text, std::string file, ProgramSetup setup) {
  return check_program(ProgramText::of_text(std::move(text), std::move(file)), std::move(setup));
}

}  // namespace servomill::controllers
