#include "controllers/gcode/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstddef>

namespace servomill::controllers {
namespace {

constexpr std::uint8_t bit(Reader reader) {
  return static_cast<std::uint8_t>(1U << static_cast<unsigned>(reader));
}
constexpr std::uint8_t kFanuc = bit(Reader::fanuc), kHaas = bit(Reader::haas),
                       kMach = bit(Reader::mach), kGrbl = bit(Reader::grbl),
                       kAll = kFanuc | kHaas | kMach | kGrbl;

using enum ReaderRule;

constexpr auto kRules = std::to_array<ReaderRuleEntry>({
    {end_of_text, "a program that ends without M2, M30 or a closing '%'", "read as if M2 followed",
     "grbl, Mach", kGrbl | kMach,
     "grbl 1.1, protocol.c (runs lines as they come); Milltronics, System information, PL-551, "
     "p. 8 (the end code is assumed); Mach from memory. Fanuc requires the M code: B-64014EN/03 p. "
     "21"},
    {percent_at_end, "a '%' that no other '%' precedes", "read as the end of the program",
     "Fanuc, Haas", kFanuc | kHaas, "Fanuc B-64014EN/03 p. 21 (end of record)"},
    {percent_title, "text before or after the first '%'", "read as a title, without effect",
     "Fanuc, Haas", kFanuc | kHaas, "Fanuc B-64014EN/03 p. 21 (leader section)"},
    {control_characters, "control characters (NUL, DEL, ...)", "read as spaces", "Fanuc, Haas",
     kAll,
     "grbl 1.1, protocol.c (codes up to that of the space); from memory: NUL and DEL of tapes are "
     "skipped"},
    {open_comment, "a comment without ')'", "read as a comment to the end of the line", "grbl",
     kGrbl, "grbl 1.1, protocol.c"},
    {nested_comment, "brackets within a comment", "read as part of the comment",
     "undocumented; no control accepts words there", kAll, "none found"},
    {slash_comment, "a line that begins with '//'", "read as a comment",
     "undocumented; no control accepts words there", kAll, "none found"},
    {skip_level, "a block skip with level (/2 ... /9)", "read as '/': one switch serves all levels",
     "Fanuc, Haas", kFanuc | kHaas, "Fanuc B-63944EN, optional block skip (from memory)"},
    {colon_number, "a program number with ':'", "read as O", "Fanuc, Haas", kFanuc | kHaas,
     "Fanuc B-64124EN/01 p. 136 (':' in ISO code)"},
    {number_with_words, "words in the block of the program number", "read as a separate block",
     "Fanuc, Haas", kFanuc | kHaas, "from memory"},
    {block_number_anywhere, "an N word after other words", "read as a block number, without effect",
     "grbl, Mach", kGrbl | kMach, "grbl 1.1, gcode.c; Mach from memory"},
    {tool_without_table, "a tool number without a tool table",
     "read as a tool of unknown length and diameter", "every control has its own tool table", kAll,
     "not supported by LinuxCNC; the table of another control is not in the program"},
    {fan_code, "M106 and M107", "without effect on motion", "controls with fan outputs", 0,
     "Duet3D, G-codes, M106 and M107 (speed of a fan)"},
    {long_comment, "a comment beyond column 252", "truncated", "every control", kAll,
     "a comment has no effect"},
    {dwell_word, "G4 with X or U", "read as seconds", "Fanuc", kFanuc,
     "Fanuc B-63324EN/03 p. 759 (G04 X, G04 P); U, and that a point means seconds, from memory"},
    {given_feed, "G1, G2 or G3 before the first F", "read with the feed of --feed",
     "the user; Mach keeps its last feed", kAll, "Mach3 Mill G code reference, F; from memory"},
    {arc_radii, "an arc whose radii at its ends differ by more than LinuxCNC allows",
     "read as a spiral, whose radius changes in proportion to the angle", "Fanuc",
     kFanuc | kHaas | kMach,
     "Fanuc B-63324EN/01, section 4.4 (the radius changes linearly with the angle); 16-T, "
     "parameter 3410: a straight line after the arc; Haas and Mach from memory"},
    {repeated_group, "several G codes of one group in a block", "the last one is effective",
     "Fanuc, Haas", kFanuc | kHaas, "Fanuc B-63944EN, preparatory function, note 3 (from memory)"},
    {home_with_motion, "G28, G30 or G92 with a motion code",
     "the axis words do not belong to the motion code, which remains active", "Fanuc, Haas, Mach",
     kFanuc | kHaas | kMach, "Fanuc B-63944EN, group 00 is one-shot, and Haas, Mach from memory"},
    {second_home_number, "G30 P2", "read as G30", "Fanuc", kFanuc,
     "Fanuc B-63784EN/01 p. 183 (P2 can be omitted)"},
    {homing_cycle, "G28.2 (homing)", "read as a rapid to machine zero; homing is not simulated",
     "TinyG, g2core", 0,
     "TinyG wiki, TinyG Homing (G28.2: axes in the order ZXYABC, values are ignored)"},
    {home_letters, "G28 with axes and no numbers",
     "read as a rapid of those axes to machine zero; homing is not simulated", "Marlin", 0,
     "Marlin, G28 (homes the axes named)"},
    {additional_work_offset, "G54.1 P, G54 P and G154 P",
     "read as the work offset that --work-offset gives", "Fanuc, Haas", kFanuc | kHaas,
     "Fanuc B-63944EN, additional workpiece coordinate systems (G54.1), from memory"},
    {cycle_repeats, "K in a canned cycle", "read as the number of repetitions", "Fanuc", kFanuc,
     "Fanuc B-63944EN, canned cycle: K number of repeats (from memory)"},
    {cycle_without_hole, "a canned cycle with K0 or L0", "its words are stored, no hole is drilled",
     "Fanuc, Haas", kFanuc | kHaas, "Fanuc B-63944EN, canned cycle: K0 (from memory)"},
    {cycle_memory, "a canned cycle without words of an earlier cycle",
     "read with the words stored until G80", "Fanuc, Haas", kFanuc | kHaas,
     "Fanuc B-63944EN, canned cycle, from memory; Haas 96-8000, June 1999, p. 182 (active until "
     "G80)"},
    {cycle_without_dwell, "G82, G86, G88 or G89 without P", "read without a dwell", "Fanuc, Haas",
     kFanuc | kHaas, "Fanuc B-63944EN, formats of G82, G86, G88, G89 (from memory)"},
    {cycle_unused_dwell, "P of G81 or G85, which do not dwell",
     "read without a dwell; G82 and G89 after it use P", "Fanuc, Haas", kFanuc | kHaas,
     "zanotowane.pl/117/8692, G81 (lists P, and no dwell in its sequence); haascnc.com, G81 and "
     "G85 (no P); that P is kept from memory"},
    {fine_boring, "G76 with R",
     "read as fine boring: the spindle stops at the bottom and the tool retracts at rapid; the "
     "shift off the wall is omitted",
     "Fanuc, Haas", kFanuc | kHaas,
     "Fanuc B-63324EN/03 p. 293 (direction of the shift: parameter 6240; 5148 of others from "
     "memory); Haas 96-8000, June 1999, p. 188 (Q, I, J of G77; setting 27)"},
    {tapping_spindle, "G74 or G84 with the spindle stopped",
     "read as rigid tapping, which starts the spindle", "Fanuc (M29), Haas", kFanuc | kHaas,
     "Fanuc B-63944EN, rigid tapping, from memory; Haas online manual, G84 (Group 09): it starts "
     "the spindle"},
    {words_with_g80, "axis words with G80", "read as a move by the last G0 or G1", "Fanuc, Haas",
     kFanuc | kHaas, "Fanuc B-63944EN, G80; groups 01 and 09 are separate (from memory)"},
    {motion_behind_cycle, "axis words after G80 without G0 or G1",
     "read as a move by the last G0 or G1", "Fanuc, Haas", kFanuc | kHaas,
     "Fanuc B-63944EN, G80; groups 01 and 09 are separate (from memory)"},
    {modal_diameter_offset, "D before the block of G41 or G42", "read as the D of that block",
     "Fanuc, Haas", kFanuc | kHaas, "Fanuc B-63944EN, tool offset: D is modal (from memory)"},
    {modal_length_offset, "H without G43 in its block", "read as G43 H while G43 is active",
     "Fanuc, Haas", kFanuc | kHaas,
     "Fanuc B-63944EN, tool length compensation: H is modal (from memory)"},
    {unknown_length, "G43 without a tool table",
     "the length and hence the machine coordinates are unknown",
     "every control has its own tool table", kFanuc | kHaas | kMach,
     "not supported by LinuxCNC; the table of another control is not in the program"},
    {subprogram_repeats, "M98 P with repetitions before the four-digit number", "read as M98 P L",
     "Fanuc", kFanuc, "Fanuc B-64124EN/01 p. 136 and 137 (M98 P51002: five times 1002)"},
    {call_with_words, "M98 after other words", "read as a call after the block", "Fanuc, Haas",
     kFanuc | kHaas, "Fanuc B-64124EN/01 p. 137; that the move comes first from memory"},
    {local_subprogram, "M97", "read as a call of the block with the number P", "Haas", kHaas,
     "Haas 96-8000 p. 217"},
    {subprogram_file, "a subprogram in a file that is called by its number, not *.ngc",
     "read as the file of that subprogram", "Fanuc, Haas, Mach", kFanuc | kHaas | kMach,
     "HSC Kontrol, Pulser3, Sub Programs (O9001.cnc); Fanuc, Haas and Mach from memory"},
    {smoothing, "G5.1 Q, G5 P, G8 P, G187 and the like", "ignored: smoothing is not simulated",
     "Fanuc, Haas", kFanuc | kHaas,
     "Fanuc B-63944EN, AICC (G5.1), from memory; E of G187: a list of Haas's "
     "address codes, not the manual itself"},
    {machine_function, "M codes for coolant, clamps, chips, gears and the like",
     "without effect on motion", "Haas, builders of other machines", kHaas | kFanuc,
     "Haas Mill operator's manual, M codes; others from memory"},
    {ignored_function, "M codes of the machine builder", "ignored, by --ignore-code", "the user",
     kFanuc | kHaas | kMach,
     "none: defined by the machine builder, and some mirror axes (Makino Professional 5, list of M "
     "codes)"},
    {cancel_codes, "G13.1, G40.1, G50.2, G54.2 P0, G67, G69.1, G113 and G255",
     "ignored: they cancel functions that are never active", "Fanuc, Haas", kFanuc | kHaas,
     "Haas online manual, G254 (G255 ends it); Fanuc from memory"},
    {check_codes, "G22, G23, G25 and G26", "ignored: checks of travel limits and spindle speed",
     "Fanuc", kFanuc, "from memory"},
    {coolant_codes, "M7 and M8 in one block", "both are switched on", "Fanuc, Mach", kFanuc | kMach,
     "from memory: Fanuc takes three M codes (parameter 3404#7)"},
    {exact_stop, "G9", "read as G61.1 for this block", "Fanuc, Haas", kFanuc | kHaas,
     "Fanuc B-63324EN/03 p. 759 (G09, exact stop); Haas from memory"},
    {spindle_power, "M3 or M4 with P", "a power in percent: the speed is unknown", "Snapmaker", 0,
     "Snapmaker, G-code reference, M3"},
    {skip_behind_number, "'/' after a block number", "read as '/' before it", "Fanuc, Haas",
     kFanuc | kHaas, "from memory"},
    {polar_coordinates, "G15 and G16", "read as polar coordinates", "Fanuc, Mach", kFanuc | kMach,
     "Fanuc B-62764EN/01, section 9.2; Mach3 Mill, G0 and G1; that Haas lacks them from memory"},
    {scaling, "G50 and G51", "read as scaling about a point", "Fanuc, Haas, Mach",
     kFanuc | kHaas | kMach,
     "Haas 96-8000 p. 161 (last position as the centre); Fanuc B-63682EN/01 p. 117 (factors "
     "of each axis, negative ones mirror); Mach from memory"},
    {mirror_image, "G50.1 and G51.1", "read as a mirror image", "Fanuc", kFanuc,
     "Siemens 6FC5397-0BP10-2BA0 p. 3-65 (ISO dialect: arc direction and compensation side are "
     "interchanged); Fanuc from memory"},
    {rotation, "G68 and G69", "read as a rotation of the plane about a point", "Fanuc, Haas, Mach",
     kFanuc | kHaas | kMach,
     "Fanuc B-62764EN/01 p. 354, B-63324EN/03 p. 470, B-63944EN-2/02 p. 211 (scaling first); Haas "
     "96-8000, June 1999, p. 178; Mach (A B R) from memory"},
    {unit_codes, "G70 and G71", "read as G20 and G21", "Mach, Siemens", kMach,
     "Mach3 Mill G code reference, G70 and G71; from memory"},
    {sender_command, "$$, $G, $I, $N, $# or ?", "a request of a sender, without effect",
     "grbl, TinyG", kGrbl, "grbl 1.1, commands"},
    {sender_wait, "%wait of a sender to grbl",
     "the axes stop; the dwell of 0.5 s added by cncjs is omitted", "cncjs, bCNC", kGrbl,
     "cncjs, issue 118 (replaced with G4 P0.5, waits until the planner is empty); bCNC, issue 60 "
     "(waits until grbl is idle)"},
    {checksum, "a checksum after '*'", "without effect", "hosts of grbl, RepRap", kGrbl,
     "from memory"},
    {rapid_at_start, "axis words before the first G0, G1, G2, G3 and the first F",
     "read as a rapid: a feed move without F causes an alarm", "Fanuc, Haas, grbl",
     kFanuc | kHaas | kGrbl,
     "grbl 1.1, gcode.c (begins with G0); Fanuc, parameter 3402#0 (G01) and alarm 011, and Haas "
     "from memory"},
    {centre_off_plane, "a zero I, J or K outside the plane of the arc", "without effect",
     "every control but LinuxCNC", kAll, "grbl 1.1, gcode.c; others from memory: a shift by 0"},
    {circular_pocket, "G12 and G13 with I",
     "read as a full circle of radius I about the position, from its +X side", "Mach", kMach,
     "Using Mach3Mill, G12 and G13 (circular pocket); from memory"},
    {haas_pocket, "G12 and G13 with D",
     "read as circles of radius I, I + Q, ... K; the approach to the wall, semicircular on the "
     "control, is straight",
     "Haas", kHaas, "Haas 96-8000, June 1999, p. 237; gcodes.net, Haas G12 and G13"},
    {haas_mirror, "G100 and G101", "read as a mirror image about the origin of the work system",
     "Haas", kHaas, "Haas Mill operator's manual, G100 and G101, from memory"},
    {corner, ",R or ,C after a line",
     "read as an arc, or a chamfer, between that line and the next", "Fanuc, Haas", kFanuc | kHaas,
     "NCT 2000M programmer's manual, section 16.1, p. 120 (the same words); Fanuc and Haas from "
     "memory"},
    {macro_statement, "variables, IF, GOTO and WHILE of custom macro B",
     "executed as on the control: an unset variable is vacant, and its word is ignored",
     "Fanuc, Haas", kFanuc | kHaas,
     "Haas 96-8000, June 1999, p. 365 to 376; Fanuc B-63944EN, custom macro, from memory, "
     "B-63324EN/03 p. 619 (numbers are double precision)"},
    {several_statements, "several macro statements in a block", "executed from left to right",
     "Haas", kHaas, "none found: used in Haas programs with G100 and G101"},
    {variable_increment, "a variable or an expression in a word for a length or an angle",
     "rounded to 0.001 mm, 0.0001 inch or 0.001 degrees", "Fanuc, Haas", kFanuc | kHaas,
     "Haas 96-8000, June 1999, p. 374 (three places, four in inches); Fanuc B-63944EN, variables "
     "(least input increment), from memory"},
    {macro_call, "G65", "read as a call of program P with the words as variables", "Fanuc, Haas",
     kFanuc | kHaas,
     "Fanuc B-63684EN/01 p. 278 (arguments I and II); Haas 96-8000, June 1999, p. 365"},
    {modal_macro_call, "G66 and G67", "read as a call of program P after each motion block",
     "Fanuc", kFanuc | kHaas,
     "Fanuc B-63944EN, modal call, from memory; Mitsubishi M700V, Programming manual, 13.5"},
    {macro_output, "POPEN, DPRNT, BPRNT, PCLOS, and values for outputs and timers",
     "without effect on motion", "Fanuc, Haas", kFanuc | kHaas,
     "Fanuc B-63944EN, external output commands, from memory"},
    {arc_without_axes, "I, J or K without axis words while G2 or G3 is active",
     "read as a full circle", "Fanuc, Haas, Mach", kFanuc | kHaas | kMach,
     "Fanuc B-63944EN, circular interpolation (without an end point a circle of 360 degrees), from "
     "memory"},
    {home_under_tip_control, "G28 or G30 with zero distance with G43.4",
     "read as a rapid of those axes; TCP control resumes after it", "Fanuc", kFanuc,
     "none found: post-processors for Fanuc output it before G49"},
    {subprogram_behind_end, "a subprogram after the closing '%'", "read as one before it",
     "undocumented; without it the program stops at the call", kFanuc | kHaas, "none found"},
    {repeated_word, "a word repeated in a block",
     "the last F or S is effective; other words only if both values are equal", "Fanuc", kFanuc,
     "Fanuc, parameter 3403#6 (AD2) = 0: the next one is enabled, from memory"},
    {haas_tip_control, "G234", "read as G43.4", "Haas", kHaas,
     "Haas Mill operator's manual, G234 (group 08, with H, until G49), from memory"},
});

constexpr bool is_in_order() {
  for (std::size_t i = 0; i < kRules.size(); ++i) {
    if (static_cast<std::size_t>(kRules[i].rule) != i) return false;
  }
  return kRules.size() == static_cast<std::size_t>(ReaderRule::count);
}
static_assert(is_in_order());

const ReaderRuleEntry& entry(ReaderRule rule) { return kRules[static_cast<std::size_t>(rule)]; }

}  // namespace

std::optional<Reader> reader_named(std::string_view name) {
  const auto* found = std::find(kReaders.begin(), kReaders.end(), name);
  if (found == kReaders.end()) return std::nullopt;
  return static_cast<Reader>(found - kReaders.begin());
}

std::span<const ReaderRuleEntry> reader_rules() { return kRules; }

bool has_rule(Reader reader, ReaderRule rule) {
  if (reader == Reader::linuxcnc || reader == Reader::heidenhain || reader == Reader::siemens)
    return false;
  return reader == Reader::any || (entry(rule).readers & bit(reader)) != 0;
}

std::string sentence(ReaderRule rule) {
  const ReaderRuleEntry& one = entry(rule);
  return fmt::format("{}: {} ({}); not supported by LinuxCNC", one.found, one.reading,
                     one.controls);
}

IgnoredCode ignored_code(std::string_view text) {
  int number = -1;
  if (text.starts_with('M')) {
    const char* last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data() + 1, last, number);
    if (error != std::errc() || end != last) number = -1;
  }
  constexpr int kMax = 9999;
  if (number < 0 || number > kMax) {
    return {-1, "must be an M code of the machine builder, such as M82"};
  }
  if (is_known_function(number)) {
    return {-1, "is a standard code and cannot be ignored"};
  }
  return {number, {}};
}

}  // namespace servomill::controllers
