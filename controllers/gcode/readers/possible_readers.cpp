#include "controllers/gcode/readers/possible_readers.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "controllers/gcode/macro/macro_program.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"

namespace servomill::controllers {
namespace {

struct Control {
  Reader reader;
  std::string_view name;
};
constexpr auto kControls = std::to_array<Control>({{Reader::linuxcnc, "LinuxCNC"},
                                                   {Reader::fanuc, "Fanuc"},
                                                   {Reader::haas, "Haas"},
                                                   {Reader::mach, "Mach"},
                                                   {Reader::grbl, "grbl"}});

constexpr std::uint8_t bit(Reader reader) {
  return static_cast<std::uint8_t>(1U << static_cast<unsigned>(reader));
}

// Line that stops the control, or 0.
int stop_of(Reader reader, ProgramText text, ProgramSetup setup) {
  setup.reader = reader;
  setup.is_trial = true;
  if (setup.tools.empty()) setup.tools.take_any_number();  // the control has a table of its own
  if (setup.decimal_point == DecimalPoint::unset) setup.decimal_point = DecimalPoint::calculator;
  int line = 1;
  try {
    Interpreter interpreter(std::move(text), std::move(setup));
    while (interpreter.next() != nullptr) throw_if_interrupted();
    return 0;
  } catch (const Undetermined&) {
    return 0;
  } catch (const InputError& error) {
    line = std::max(error.faults().front().place.line, 1);
  }
  return line;
}

}  // namespace

PossibleReaders::PossibleReaders(const ProgramText& text, const ProgramSetup& setup)
    : evidence_(control_evidence(text.again())) {
  ProgramText again = text.again();
  const int macro_line = macro::first_macro_line(again);
  for (const Control& control : kControls) {
    const bool has_macros = control.reader == Reader::fanuc || control.reader == Reader::haas;
    if (macro_line > 0 && !has_macros) {
      stops_.push_back({std::string(control.name), macro_line});
      continue;
    }
    const int line = stop_of(control.reader, text.again(), setup);
    if (line == 0) {
      possible_ |= bit(control.reader);
    } else {
      stops_.push_back({std::string(control.name), line});
    }
  }
}

std::optional<int> PossibleReaders::common_reading(WordDifference difference,
                                                   std::uint8_t readers) {
  std::optional<int> out;
  for (const Control& control : kControls) {
    if ((readers & bit(control.reader)) == 0) continue;
    const std::optional<int> one = controllers::reading_of(difference, control.reader);
    if (!one || (out && *out != *one)) return std::nullopt;
    out = one;
  }
  return out;
}

std::optional<DeducedReading> PossibleReaders::reading_of(WordDifference difference) const {
  if (const auto of_all = common_reading(difference, possible_)) {
    const std::string stops = who_stops();
    return DeducedReading{
        *of_all, stops.empty() ? "as on all controls that accept this program" : "since " + stops};
  }
  const auto named = static_cast<std::uint8_t>(possible_ & evidence_.readers);
  const std::optional<int> of_named = common_reading(difference, named);
  if (!of_named) return std::nullopt;
  const WordDifferenceEntry& entry = word_differences()[static_cast<std::size_t>(difference)];
  const WordReading& other = entry.readings[static_cast<std::size_t>(1 - *of_named)];
  return DeducedReading{
      *of_named, fmt::format("since {}; --reader selects the alternative: {} ({})", evidence_.text,
                             other.text, other.controls)};
}

std::string PossibleReaders::who_stops() const {
  std::string out;
  for (const Stop& stop : stops_) {
    out += fmt::format("{}{}{} at line {}", out.empty() ? "" : ", ", stop.control,
                       out.empty() ? " would stop" : "", stop.line);
  }
  return out;
}

}  // namespace servomill::controllers
