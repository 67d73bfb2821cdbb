#include "controllers/gcode/readers/differences.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace servomill::controllers {
namespace {

constexpr std::uint8_t bit(Reader reader) {
  return static_cast<std::uint8_t>(1U << static_cast<unsigned>(reader));
}
constexpr std::uint8_t kLinuxCnc = bit(Reader::linuxcnc), kFanuc = bit(Reader::fanuc),
                       kHaas = bit(Reader::haas), kMach = bit(Reader::mach),
                       kGrbl = bit(Reader::grbl);

using enum WordDifference;

constexpr auto kDifferences = std::to_array<WordDifferenceEntry>({
    {dwell_unit,
     "G4 P without a decimal point",
     {{{"seconds", "LinuxCNC, grbl", kLinuxCnc | kGrbl},
       {"milliseconds", "Fanuc, Haas", kFanuc | kHaas}}},
     "",
     "LinuxCNC 2.9, G4; Fanuc B-63944EN, dwell (G04). Mach has a setting for it"},
    {dwell_increments,
     "G4 X or U without a decimal point",
     {{{"milliseconds", "Fanuc with increments", 0},
       {"seconds", "Fanuc with calculator-type decimal points", 0}}},
     "--decimal-point",
     "Fanuc B-63944EN, dwell (G04), parameter 3401#0 (DPI), from memory"},
    {cycle_dwell_unit,
     "P of a canned cycle without a decimal point",
     {{{"seconds", "LinuxCNC, Mach", kLinuxCnc | kMach},
       {"milliseconds", "Fanuc, Haas", kFanuc | kHaas}}},
     "",
     "LinuxCNC 2.9, G82; Fanuc B-63944EN, G82"},
    {length_offset_zero,
     "G43 H0",
     {{{"the length of the tool in the spindle", "LinuxCNC", kLinuxCnc},
       {"no length", "Fanuc, Haas, Mach", kFanuc | kHaas | kMach}}},
     "",
     "LinuxCNC 2.9, G43; Haas 96-8000 p. 161 (H0 cancels); Fanuc and Mach from memory"},
    {stored_home,
     "G28.1",
     {{{"stores the position for G28", "LinuxCNC, grbl, TinyG", kLinuxCnc | kGrbl},
       {"homes axes", "Mach", kMach}}},
     "",
     "LinuxCNC 2.9, G28.1; grbl 1.1, gcode.c; TinyG wiki, TinyG Homing; Mach from memory"},
    {retract_level,
     "a canned cycle from above R before the first G98 or G99",
     {{{"returns to R", "LinuxCNC", kLinuxCnc},
       {"returns to the initial level", "Fanuc, Haas", kFanuc | kHaas}}},
     "",
     "LinuxCNC 2.9 (rs274 starts with G99); Fanuc B-63944EN, G98 is active at power-on"},
    {cycle_distance,
     "a canned cycle continued after switching between G90 and G91 without R and depth",
     {{{"R and depth are reinterpreted as distances or positions", "LinuxCNC", kLinuxCnc},
       {"R and depth keep their positions", "Fanuc, Haas", kFanuc | kHaas}}},
     "",
     "LinuxCNC 2.9, interp_cycles.cc; Fanuc, bolt circle of polar coordinates (G90 G81, then G91 "
     "Y120.), and Haas, drilling a grid, from memory"},
    {polar_centre,
     "G16 away from the origin of the work system",
     {{{"polar coordinates about that origin", "Fanuc", kFanuc},
       {"polar coordinates about the tool position", "Mach", kMach}}},
     "",
     "Fanuc B-62764EN/01, section 9.2; Mach3 Mill, G0 (G16 sets a polar origin), G16 from memory"},
    {feed_beside_unit,
     "F with G20 or G21 that changes the unit",
     {{{"in the old unit", "LinuxCNC", kLinuxCnc},
       {"in the new unit", "grbl, Fanuc, Haas", kGrbl | kFanuc | kHaas}}},
     "",
     "LinuxCNC 2.9, order of execution; grbl 1.1, gcode.c; Fanuc and Haas from memory"},
    {subprogram_digits,
     "M98 P with more than four digits",
     {{{"the number of a subprogram", "LinuxCNC, Haas", kLinuxCnc | kHaas},
       {"repetitions, then four digits of the number", "Fanuc", kFanuc}}},
     "",
     "LinuxCNC 2.9, M98; Haas 96-8000 p. 217 (L repeats); Fanuc B-64124EN/01 p. 136"},
    {lone_machine_coordinates,
     "G53 without axis words",
     {{{"no effect", "LinuxCNC, grbl, Fanuc, Haas, Mach",
        kLinuxCnc | kGrbl | kFanuc | kHaas | kMach},
       {"machine coordinates until the next work offset", "DDCSV, as its G54", 0}}},
     "",
     "Siemens ISO Milling 04.07 p. 3-42 and Mitsubishi M700V p. 508 (one-shot, as of Fanuc); grbl "
     "1.1, gcode.c; LinuxCNC 2.9 (G53 G0 without axes does nothing); DDCSV, description of its "
     "coordinate systems (a variable holds G53 or G54); Haas and Mach from memory"},
    {preset_words,
     "G92.1 with axis words",
     {{{"the G92 offset of all axes is cancelled", "LinuxCNC", kLinuxCnc},
       {"only that of the named axes is cancelled", "Fanuc", kFanuc}}},
     "",
     "LinuxCNC 2.9, G92.1; Fanuc B-63944EN, workpiece coordinate system preset"},
    {missing_diameter_offset,
     "G41 or G42 before the first D",
     {{{"the diameter of the tool in the spindle", "LinuxCNC, Mach", kLinuxCnc | kMach},
       {"no compensation", "Fanuc, Haas", kFanuc | kHaas}}},
     "",
     "LinuxCNC 2.9, G41; Fanuc B-62764EN/01, cutter compensation (the vector is zero at power-on); "
     "Haas and Mach from memory"},
    {tool_table_input,
     "G10 L10 or L11",
     {{{"sets a tool from the position", "LinuxCNC", kLinuxCnc},
       {"sets a length offset to R", "Fanuc, Haas", kFanuc | kHaas}}},
     "",
     "LinuxCNC 2.9, G10; Fanuc and Haas from memory. Series 15i has L10 for wear: B-63324EN/03 p. "
     "759"},
    {work_offset_input,
     "G10 L20",
     {{{"sets the offset so that the position equals the words", "LinuxCNC, grbl",
        kLinuxCnc | kGrbl},
       {"sets an additional work offset (G54.1, G154)", "Fanuc, Haas", kFanuc | kHaas}}},
     "",
     "LinuxCNC 2.9, G10; grbl 1.1, gcode.c; Fanuc B-63944EN, G10 L20, from memory"},
    {override_codes,
     "M50 ... M53",
     {{{"switches for overrides", "LinuxCNC", kLinuxCnc},
       {"pallet change and outputs of the machine builder", "Haas, Fanuc", kHaas | kFanuc}}},
     "",
     "LinuxCNC 2.9, M50; Haas Mill operator's manual, M50 ... M58"},
    {start_motion,
     "axis words before the first G0, G1, G2, G3",
     {{{"a rapid", "grbl, Haas", kGrbl | kHaas},
       {"a rapid or a feed move, depending on a control setting", "Fanuc, Mach", 0}}},
     "",
     "grbl 1.1, gcode.c, gc_init(); Fanuc, parameter 3402#0 (G01), and Haas from memory"},
    {decimal_point,
     "a length or an angle without a decimal point",
     {{{"in millimetres, inches or degrees", "calculator-type decimal points", 0},
       {"in least input increments", "Fanuc and Haas with increments", 0}}},
     "--decimal-point",
     "Haas, Help with the Decimal Points (setting 162); Fanuc, parameter 3401#0 (DPI), from "
     "memory"},
    {scale_factor,
     "P of G51 without a decimal point",
     {{{"a factor", "controls with calculator-type decimal points", 0},
       {"thousandths", "Fanuc", kFanuc}}},
     "",
     "Fanuc B-63682EN/01 p. 117 (or 0.00001, a parameter); Haas 96-8000 p. 161 has three decimals "
     "and its examples a point"},
    {circular_pocket,
     "G12 or G13",
     {{{"a full circle from the +X side", "Mach", kMach},
       {"a circle with its own lead-in", "Haas", kHaas}}},
     "",
     "Using Mach3Mill, G12 and G13; Haas Mill operator's manual, G12 and G13; both from memory"},
    {common_variable,
     "a common variable (#100 ... #499) read before it is set",
     {{{"vacant, as after power-on", "Fanuc", kFanuc},
       {"the value from an earlier program", "Haas", 0}}},
     "",
     "Fanuc B-63944EN, variables; Haas Mill operator's manual, macro variables (saved on power "
     "off); both from memory"},
    {angle_range,
     "ATAN or ASIN with a negative result",
     {{{"from 180 or 270 to 360 degrees", "Fanuc as delivered", kFanuc},
       {"from -180 or -90 to 0 degrees", "Fanuc with parameter 6004#0 (NAT)", 0}}},
     "",
     "Fanuc B-63944EN, arithmetic and logic operation, from memory; none found for Haas"},
    {remainder,
     "MOD of numbers that are negative or not integers",
     {{{"of the numbers rounded to integers, with the sign of the first", "Fanuc", kFanuc},
       {"undocumented", "Haas", 0}}},
     "",
     "Fanuc B-64304EN, MOD, from memory; Haas 96-8000, June 1999, p. 374 (27 MOD 20 is 7)"},
    {variable_dwell,
     "P of a dwell from a variable",
     {{{"whole milliseconds", "Fanuc", kFanuc}, {"seconds or milliseconds", "Haas", 0}}},
     "",
     "Fanuc B-63944EN, dwell (G04); Haas has seconds where P has a point; both from memory"},
    {argument_point,
     "an argument of G65 or G66 without a decimal point",
     {{{"as it is", "controls with calculator-type decimal points", 0},
       {"in least input increments of its letter", "Fanuc and Haas with increments", 0}}},
     "--decimal-point",
     "Fanuc B-63684EN/01 p. 278 (least input increment of each address)"},
    {return_block,
     "M99 P in a called program",
     {{{"returns to that block of the calling program", "Fanuc", kFanuc},
       {"jumps to that block of the same program", "Haas", kHaas}}},
     "",
     "Haas 96-8000, June 1999, p. 376 (does not return control); Fanuc B-64124EN/01, subprogram, "
     "from memory"},
    {system_zero,
     "G10 L2 P0",
     {{{"sets the active work system", "LinuxCNC, grbl", kLinuxCnc | kGrbl},
       {"sets an offset of all work systems", "Fanuc, Haas", kFanuc | kHaas}}},
     "",
     "LinuxCNC 2.9, G10; grbl 1.1, gcode.c; Fanuc B-63944EN, G10 L2 (P0: external offset), and "
     "Haas (P0: G52), from memory"},
    {incremental_input,
     "G10 L2 under G91",
     {{{"sets the offset to the words", "LinuxCNC, grbl", kLinuxCnc | kGrbl},
       {"adds the words to the offset", "Fanuc, Haas", kFanuc | kHaas}}},
     "",
     "LinuxCNC 2.9, interp_convert.cc; grbl 1.1, gcode.c; Haas 96-8000, June 1999, G10 (example "
     "G10 L2 P1 G91 X6.0); Fanuc B-63944EN, G10 L2, from memory"},
    {cycle_from_below,
     "a canned cycle from below R",
     {{{"rises to R, then goes to the hole", "LinuxCNC, Mach", kLinuxCnc | kMach},
       {"goes to the hole at the current level, then rises to R", "Fanuc, Haas", kFanuc | kHaas}}},
     "",
     "LinuxCNC 2.9, canned cycles, preliminary motion; zanotowane.pl/117/8692, G81 (operation 1: "
     "X and Y, operation 2: R, as Fanuc); Haas and Mach from memory"},
});

// Codes of LinuxCNC and of five axes (of Fanuc), by ten times their numbers, and readers whose
// control lacks them.
struct ForeignCodes {
  char letter;
  int from, to;
  std::uint8_t without;
};
// LinuxCNC 2.9, G codes and M codes; grbl 1.1, gcode.c (all that it has); CNC Conversion, G and M
// codes used by Mach3 (no G87, no five axes); Haas has G234 and G254 in place of G43.4 and G68.2;
// Fanuc, Haas and other codes of Mach from memory
constexpr auto kForeign = std::to_array<ForeignCodes>({
    {'G', 410, 429, kGrbl},
    {'G', 430, 430, kGrbl},
    {'G', 434, 435, kHaas | kMach | kGrbl},
    {'G', 531, 531, kHaas | kMach | kGrbl},
    {'G', 591, 593, kFanuc | kHaas | kGrbl},
    {'G', 640, 640, kGrbl},
    {'G', 682, 682, kHaas | kMach | kGrbl},
    {'G', 690, 690, kGrbl},
    {'G', 730, 730, kGrbl},
    {'G', 810, 890, kGrbl},
    {'G', 870, 870, kMach},
    {'G', 901, 901, kFanuc | kHaas | kGrbl},
    {'G', 911, 911, kFanuc | kHaas},
    {'G', 922, 923, kFanuc | kHaas | kGrbl},
    {'G', 980, 990, kGrbl},
    {'M', 500, 530, kGrbl},
    {'M', 620, 630, kFanuc | kMach | kGrbl},
    {'M', 700, 730, kFanuc | kMach | kGrbl},
    {'M', 980, 990, kGrbl},
});

constexpr bool is_in_order() {
  for (std::size_t i = 0; i < kDifferences.size(); ++i) {
    if (static_cast<std::size_t>(kDifferences[i].difference) != i) return false;
  }
  return kDifferences.size() == static_cast<std::size_t>(WordDifference::count);
}
static_assert(is_in_order());

const WordDifferenceEntry& entry(WordDifference difference) {
  return kDifferences[static_cast<std::size_t>(difference)];
}

}  // namespace

std::span<const WordDifferenceEntry> word_differences() { return kDifferences; }

std::optional<int> reading_of(WordDifference difference, Reader reader) {
  const auto& readings = entry(difference).readings;
  for (int k = 0; k < 2; ++k) {
    if ((readings[static_cast<std::size_t>(k)].readers & bit(reader)) != 0) return k;
  }
  return std::nullopt;
}

bool lacks(Reader reader, char letter, int tenths) {
  return std::any_of(kForeign.begin(), kForeign.end(), [&](const ForeignCodes& one) {
    return one.letter == letter && one.from <= tenths && tenths <= one.to &&
           (one.without & bit(reader)) != 0;
  });
}

std::string both_readings(WordDifference difference) {
  const WordDifferenceEntry& one = entry(difference);
  return fmt::format("{}: {} ({}), or {} ({}); choose with {}", one.found, one.readings[0].text,
                     one.readings[0].controls, one.readings[1].text, one.readings[1].controls,
                     one.option.empty() ? "--reader" : one.option);
}

}  // namespace servomill::controllers
