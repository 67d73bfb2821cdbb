#include "controllers/siemens/codes.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>
#include <vector>

#include "plant/vocabulary/input_error.h"

namespace servomill::controllers::siemens {
namespace {

using Entry = std::pair<std::string_view, Group>;

constexpr auto kCodes = std::to_array<Entry>({
    {"G0", Group::motion},
    {"G1", Group::motion},
    {"G2", Group::motion},
    {"G3", Group::motion},
    {"CIP", Group::motion},
    {"CT", Group::motion},
    {"G33", Group::motion},
    {"G331", Group::motion},
    {"G332", Group::motion},
    {"G4", Group::action},
    {"G25", Group::action},
    {"G26", Group::action},
    {"G63", Group::action},
    {"TRANS", Group::action},
    {"ATRANS", Group::action},
    {"ROT", Group::action},
    {"AROT", Group::action},
    {"SCALE", Group::action},
    {"ASCALE", Group::action},
    {"MIRROR", Group::action},
    {"AMIRROR", Group::action},
    {"G110", Group::action},
    {"G111", Group::action},
    {"G112", Group::action},
    {"G17", Group::plane},
    {"G18", Group::plane},
    {"G19", Group::plane},
    {"G40", Group::cutter},
    {"G41", Group::cutter},
    {"G42", Group::cutter},
    {"G450", Group::corner},
    {"G500", Group::work_offset},
    {"G54", Group::work_offset},
    {"G55", Group::work_offset},
    {"G56", Group::work_offset},
    {"G57", Group::work_offset},
    {"G53", Group::suppression},
    {"G153", Group::suppression},
    {"SUPA", Group::suppression},
    {"G60", Group::path},
    {"G64", Group::path},
    {"G641", Group::path},
    {"G642", Group::path},
    {"G645", Group::path},
    {"G9", Group::exact_stop},
    {"G70", Group::units},
    {"G71", Group::units},
    {"G700", Group::units},
    {"G710", Group::units},
    {"G90", Group::distance},
    {"G91", Group::distance},
    {"G93", Group::feed},
    {"G94", Group::feed},
    {"G95", Group::feed},
    {"G97", Group::feed},
    {"G971", Group::feed},
    {"G972", Group::feed},
    {"COMPON", Group::compressor},
    {"COMPCURV", Group::compressor},
    {"COMPCAD", Group::compressor},
    {"COMPSURF", Group::compressor},
    {"COMPOF", Group::compressor},
    {"CFC", Group::contour_feed},
    {"CFTCP", Group::contour_feed},
    {"TRAORI", Group::transformation},
    {"TRAFOOF", Group::transformation},
    {"RTLIOF", Group::rapid},
});

// Jerk, dynamics, feed-forward, exact-stop criteria, displays, preprocessing, monitoring.
constexpr auto kWithoutEffect = std::to_array<std::string_view>(
    {"G601",      "G602",       "G603",     "BRISK",   "SOFT",    "DRIVE",     "BRISKA",
     "SOFTA",     "DRIVEA",     "FFWON",    "FFWOF",   "DYNNORM", "DYNPOS",    "DYNROUGH",
     "DYNFINISH", "DYNSEMIFIN", "DYNPREC",  "DIAMOF",  "STOPRE",  "STARTFIFO", "STOPFIFO",
     "NORM",      "FNORM",      "CDON",     "CDOF",    "CDOF2",   "CUT2D",     "CUT2DF",
     "SETMS",     "RTLION",     "FIFOCTRL", "SBLON",   "SBLOF",   "DISPLON",   "DISPLOF",
     "WALIMON",   "WALIMOF",    "PAROTOF",  "TOROTOF", "ORIAXES", "ORIMKS",    "ORIWKS",
     "SPCOF",     "SPCON",      "FENDNORM", "G290"});

// Words of the list above that name axes or spindles in parentheses.
constexpr auto kWithNames = std::to_array<std::string_view>(
    {"BRISKA", "SOFTA", "DRIVEA", "SPCON", "SPCOF", "STOPRE", "FIFOCTRL", "SBLON", "SBLOF"});

// Words that do not belong to one of the lists above, and their meaning.
constexpr auto kRefused = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"GOTOS", "runs the program from its begin again, without end; remove the block"},
    {"G5", "oblique plunge-cut grinding is not supported"},
    {"G7", "oblique plunge-cut grinding is not supported"},
    {"G34", "threads of increasing pitch are not supported"},
    {"G35", "threads of decreasing pitch are not supported"},
    {"G43",
     "a function of the ISO dialect (G291), not of Siemens mode; if the program is written "
     "for ISO mode, choose --reader fanuc"},
    {"G44",
     "a function of the ISO dialect (G291), not of Siemens mode; if the program is written "
     "for ISO mode, choose --reader fanuc"},
    {"G49",
     "a function of the ISO dialect (G291), not of Siemens mode; if the program is written "
     "for ISO mode, choose --reader fanuc"},
    {"G80",
     "cycles with G functions are of the ISO dialect (G291), or of SINUMERIK 810M; use "
     "MCALL CYCLE81(...)"},
    {"G81",
     "cycles with G functions are of the ISO dialect (G291), or of SINUMERIK 810M; use "
     "MCALL CYCLE81(...)"},
    {"G82",
     "cycles with G functions are of the ISO dialect (G291), or of SINUMERIK 810M; use "
     "MCALL CYCLE82(...)"},
    {"G83",
     "cycles with G functions are of the ISO dialect (G291), or of SINUMERIK 810M; use "
     "MCALL CYCLE83(...)"},
    {"G84",
     "cycles with G functions are of the ISO dialect (G291), or of SINUMERIK 810M; use "
     "MCALL CYCLE84(...)"},
    {"G28", "a function of the ISO dialect (G291); write SUPA with the position"},
    {"G58",
     "an axial offset of the programmable frame, or a work offset, by the control; use "
     "ATRANS"},
    {"G59",
     "an axial offset of the programmable frame, or a work offset, by the control; use "
     "ATRANS"},
    {"G74",
     "moves to the reference point, which is not in the program; write SUPA with the "
     "position"},
    {"G75",
     "moves to a fixed point of the machine builder (MD30600); write SUPA with the position"},
    {"G96", "constant cutting speed is not supported; use G94 or G95 with S"},
    {"G961", "constant cutting speed is not supported; use G94 or G95 with S"},
    {"G962", "constant cutting speed is not supported; use G94 or G95 with S"},
    {"G931", "a feed as the time of a block in seconds is not supported; use G93"},
    {"G147", "soft approach and retraction (WAB) is not supported; program the moves"},
    {"G148", "soft approach and retraction (WAB) is not supported; program the moves"},
    {"G247", "soft approach and retraction (WAB) is not supported; program the moves"},
    {"G248", "soft approach and retraction (WAB) is not supported; program the moves"},
    {"G347", "soft approach and retraction (WAB) is not supported; program the moves"},
    {"G348", "soft approach and retraction (WAB) is not supported; program the moves"},
    {"G291", "ISO dialect; choose --reader fanuc for a program that is written in it"},
    {"G451", "corners by intersection are not supported; use G450"},
    {"G643", "smoothing by tolerances of single axes is not supported; use G642"},
    {"G644", "smoothing that depends on the machine's dynamics is not supported; use G642"},
    {"G703", "units by machine data are not supported; use G70, G71, G700 or G710"},
    {"G751", "moves to a fixed point of the machine builder (MD30600); write SUPA"},
    {"INVCW", "involutes are not supported"},
    {"INVCCW", "involutes are not supported"},
    {"ASPLINE", "splines are not supported; post-process to lines"},
    {"BSPLINE", "splines are not supported; post-process to lines"},
    {"CSPLINE", "splines are not supported; post-process to lines"},
    {"POLY", "polynomials are not supported; post-process to lines"},
    {"DIAMON", "diameters are of turning, which is not supported"},
    {"DIAM90", "diameters are of turning, which is not supported"},
    {"KONT", "approach around the contour is not supported; use NORM"},
    {"KONTC", "approach by polynomials is not supported; use NORM"},
    {"KONTT", "approach by polynomials is not supported; use NORM"},
    {"CUT3DC",
     "3-D radius compensation is not supported; post-process the path of the tool centre"},
    {"CUT3DF",
     "3-D radius compensation is not supported; post-process the path of the tool centre"},
    {"CUT3DFS",
     "3-D radius compensation is not supported; post-process the path of the tool "
     "centre"},
    {"CFIN", "feed reduction at inner radii only is not supported; use CFC or CFTCP"},
    {"ROTS", "rotations by solid angles are not supported; use ROT"},
    {"AROTS", "rotations by solid angles are not supported; use AROT"},
    {"TOFRAME", "frames along the tool are not supported"},
    {"TOROT", "frames along the tool are not supported"},
    {"PAROT", "frames aligned with the workpiece are not supported"},
    {"TRANSMIT", "transformations of turning are not supported"},
    {"TRACYL", "cylinder surfaces are not supported"},
    {"TRAANG", "inclined axes are not supported"},
    {"TRACON", "concatenated transformations are not supported"},
    {"TCARR", "orientable tool holders are not supported; use TRAORI"},
    {"TCOABS", "orientable tool holders are not supported; use TRAORI"},
    {"ORIVECT", "large-circle interpolation of the tool is not supported; use ORIAXES"},
    {"ORIPLANE", "large-circle interpolation of the tool is not supported; use ORIAXES"},
    {"OFFN", "an allowance on the contour is not supported"},
    {"TOFFL", "offsets of the tool length in the program are not supported"},
    {"TOFFR", "offsets of the tool radius in the program are not supported"},
    {"FGROUP", "a choice of the axes that F counts is not supported"},
    {"FL", "limits of single axes' feeds are not supported"},
    {"FD", "a feed by the handwheel has no time; remove the word"},
    {"FDA", "a feed by the handwheel has no time; remove the word"},
    {"FA", "feeds of positioning axes are not supported; use F"},
    {"FB", "a feed of one block only is not supported; use F in both blocks"},
    {"OVRA",
     "overrides of positioning axes and spindles are not supported; program the speed by S"},
    {"SPP", "division of the path for punching is not supported; remove the word"},
    {"SPN", "division of the path for punching is not supported; remove the word"},
    {"DISPR", "repositioning is of interrupts, which are not supported"},
    {"ORIRESET", "turns the rotary axes to a place that is not in the program; program them"},
    {"ATOL", "tolerances of single axes are not supported; use CYCLE832"},
    {"FZ", "feed per tooth needs the number of teeth; use G94 or G95"},
    {"POS", "positioning axes that move beside the path are not supported; use G0 or G1"},
    {"POSA", "positioning axes that move beside the path are not supported; use G0 or G1"},
    {"SPOSA", "positioning of the spindle beside the path is not supported; use SPOS"},
    {"MEAS", "measuring is not supported: the measured values are unknown"},
    {"MEAW", "measuring is not supported: the measured values are unknown"},
    {"WHEN", "synchronised actions are not supported; remove the block if it causes no motion"},
    {"WHENEVER", "synchronised actions are not supported; remove the block if it causes no motion"},
    {"ID", "synchronised actions are not supported; remove the block if it causes no motion"},
    {"IDS", "synchronised actions are not supported; remove the block if it causes no motion"},
    {"EVERY", "synchronised actions are not supported; remove the block if it causes no motion"},
    {"GEOAX", "exchange of geometry axes is not supported"},
    {"CTRANS", "frames as values are not supported; use TRANS"},
    {"EXECTAB", "contour tables are not supported"},
    {"CONTPRON", "contour tables are not supported"},
    {"PUNCHACC", "punching is not supported"},
    {"ANG", "contours by angles are not supported; program the end points"},
    {"REPOSA", "repositioning is of interrupts, which are not supported"},
    {"ASUP", "interrupts are not supported"},
    {"SETINT", "interrupts are not supported"},
    {"FXS", "travel to fixed stop is not supported"},
});

constexpr auto kTextOnly = std::to_array<std::string_view>(
    {"MSG", "WORKPIECE", "GROUP_BEGIN", "GROUP_END", "GROUP_ADDEND", "EXTERN"});

// Words with '=' that change neither the path nor F: of the machine's limits, which are those of
// the machine file, of tolerances, and of what no supported function reads. H is of the PLC.
constexpr auto kPassedOver = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"ACC", "the acceleration stays that of the machine"},
    {"ACCLIMA", "the acceleration of following axes stays that of the machine"},
    {"ADIS", "the distance is not read; CYCLE832 gives a tolerance"},
    {"ADISPOS", "the distance is not read; rapid moves keep the tolerance of the others"},
    {"CTOL", "the tolerance is not read; CYCLE832 gives one"},
    {"H", "a function of the PLC; ignored: no effect on motion"},
    {"JERKLIM", "the jerk stays that of the machine"},
    {"JERKLIMA", "the jerk of following axes stays that of the machine"},
    {"LIMS",
     "the limit of the spindle speed is not applied; it acts with G96, which is refused, and "
     "with G97"},
    {"OTOL", "the tolerance of the tool's orientation is not read"},
    {"OVRRAP", "rapid moves keep the velocity of the machine"},
    {"VELOLIM", "the velocity stays that of the machine"},
    {"VELOLIMA", "the velocity of following axes stays that of the machine"},
});

template <std::size_t n>
bool is_in(const std::array<std::string_view, n>& all, std::string_view name) {
  return std::find(all.begin(), all.end(), name) != all.end();
}

bool is_further_offset(std::string_view code) {
  int number = 0;
  const char* end = code.data() + code.size();
  const bool is_G =
      code.starts_with('G') && std::from_chars(code.data() + 1, end, number).ptr == end;
  constexpr int kFirst = 505, kLast = 599;
  return is_G && number >= kFirst && number <= kLast;
}

}  // namespace

std::optional<Group> group_of(std::string_view code) {
  for (const auto& [name, group] : kCodes) {
    if (name == code) return group;
  }
  if (is_further_offset(code)) return Group::work_offset;
  if (is_in(kWithoutEffect, code)) return Group::without_effect;
  return std::nullopt;
}

bool is_code(std::string_view name) { return group_of(name).has_value(); }

std::string refusal_of(std::string_view name) {
  for (const auto& [known, why] : kRefused) {
    if (known == name) return std::string(why);
  }
  return {};
}

bool has_text_only(std::string_view name) { return is_in(kTextOnly, name); }
bool takes_names(std::string_view code) { return is_in(kWithNames, code); }

std::string_view warning_of(std::string_view setting) {
  for (const auto& [known, why] : kPassedOver) {
    if (known == setting) return why;
  }
  return {};
}

std::string similar_word(std::string_view name) {
  std::vector<std::string_view> names;
  for (const auto& entry : kCodes) names.push_back(entry.first);
  for (const std::string_view one : kTextOnly) names.push_back(one);
  for (const std::string_view one :
       {"CYCLE81", "CYCLE82", "CYCLE83", "CYCLE84", "CYCLE832", "CYCLE800", "HOLES1", "HOLES2",
        "MCALL", "REPEAT", "GOTOF", "GOTOB", "ENDIF", "ENDFOR", "ENDWHILE", "ENDLOOP", "UNTIL"}) {
    names.push_back(one);
  }
  std::erase(names, name);
  return did_you_mean(name, names);
}

}  // namespace servomill::controllers::siemens
