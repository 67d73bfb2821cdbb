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
    {"GOTOS", "repeats the program from the start endlessly; remove the block"},
    {"G5", "oblique plunge-cut grinding is not supported"},
    {"G7", "oblique plunge-cut grinding is not supported"},
    {"G34", "threads with increasing pitch are not supported"},
    {"G35", "threads with decreasing pitch are not supported"},
    {"G43",
     "an ISO dialect function (G291), not available in Siemens mode; for programs in ISO mode "
     "choose --reader fanuc"},
    {"G44",
     "an ISO dialect function (G291), not available in Siemens mode; for programs in ISO mode "
     "choose --reader fanuc"},
    {"G49",
     "an ISO dialect function (G291), not available in Siemens mode; for programs in ISO mode "
     "choose --reader fanuc"},
    {"G80", "a cycle of the ISO dialect (G291) or of SINUMERIK 810M; use MCALL CYCLE81(...)"},
    {"G81", "a cycle of the ISO dialect (G291) or of SINUMERIK 810M; use MCALL CYCLE81(...)"},
    {"G82", "a cycle of the ISO dialect (G291) or of SINUMERIK 810M; use MCALL CYCLE82(...)"},
    {"G83", "a cycle of the ISO dialect (G291) or of SINUMERIK 810M; use MCALL CYCLE83(...)"},
    {"G84", "a cycle of the ISO dialect (G291) or of SINUMERIK 810M; use MCALL CYCLE84(...)"},
    {"G28", "an ISO dialect function (G291); use SUPA and the position"},
    {"G58",
     "an axial offset of the programmable frame or a work offset, depending on the control; use "
     "ATRANS"},
    {"G59",
     "an axial offset of the programmable frame or a work offset, depending on the control; use "
     "ATRANS"},
    {"G74", "moves to the reference point, which is unknown here; use SUPA and the position"},
    {"G75",
     "moves to a fixed point of the machine builder (MD30600), which is unknown here; use SUPA and "
     "the position"},
    {"G96", "constant cutting rate is not supported; use G94 or G95 with S"},
    {"G961", "constant cutting rate is not supported; use G94 or G95 with S"},
    {"G962", "constant cutting rate is not supported; use G94 or G95 with S"},
    {"G931", "block time in seconds as feed is not supported; use G93"},
    {"G147", "soft approach and retraction (WAB) is not supported; program the moves"},
    {"G148", "soft approach and retraction (WAB) is not supported; program the moves"},
    {"G247", "soft approach and retraction (WAB) is not supported; program the moves"},
    {"G248", "soft approach and retraction (WAB) is not supported; program the moves"},
    {"G347", "soft approach and retraction (WAB) is not supported; program the moves"},
    {"G348", "soft approach and retraction (WAB) is not supported; program the moves"},
    {"G291", "ISO dialect; for programs in ISO mode choose --reader fanuc"},
    {"G451", "intersection at outside corners is not supported; use G450"},
    {"G643", "smoothing with axis tolerances is not supported; use G642"},
    {"G644", "smoothing limited by axis dynamics is not supported; use G642"},
    {"G703", "units set by machine data are not supported; use G70, G71, G700 or G710"},
    {"G751",
     "moves to a fixed point of the machine builder (MD30600), which is unknown here; use SUPA and "
     "the position"},
    {"INVCW", "involutes are not supported"},
    {"INVCCW", "involutes are not supported"},
    {"ASPLINE", "splines are not supported; post-process to lines"},
    {"BSPLINE", "splines are not supported; post-process to lines"},
    {"CSPLINE", "splines are not supported; post-process to lines"},
    {"POLY", "polynomials are not supported; post-process to lines"},
    {"DIAMON", "diameter programming is for turning, which is not supported"},
    {"DIAM90", "diameter programming is for turning, which is not supported"},
    {"KONT", "approach around the contour is not supported; use NORM"},
    {"KONTC", "approach with a polynomial is not supported; use NORM"},
    {"KONTT", "approach with a polynomial is not supported; use NORM"},
    {"CUT3DC", "3D tool radius compensation is not supported; post-process the tool centre path"},
    {"CUT3DF", "3D tool radius compensation is not supported; post-process the tool centre path"},
    {"CUT3DFS", "3D tool radius compensation is not supported; post-process the tool centre path"},
    {"CFIN", "feed reduction at inside radii only is not supported; use CFC or CFTCP"},
    {"ROTS", "rotations with solid angles are not supported; use ROT"},
    {"AROTS", "rotations with solid angles are not supported; use AROT"},
    {"TOFRAME", "frames in tool direction are not supported"},
    {"TOROT", "frames in tool direction are not supported"},
    {"PAROT", "frames aligned with the workpiece are not supported"},
    {"TRANSMIT", "transformations for turning are not supported"},
    {"TRACYL", "cylinder surface transformation is not supported"},
    {"TRAANG", "inclined axis transformations are not supported"},
    {"TRACON", "concatenated transformations are not supported"},
    {"TCARR", "orientable tool holders are not supported; use TRAORI"},
    {"TCOABS", "orientable tool holders are not supported; use TRAORI"},
    {"ORIVECT", "large-circle interpolation of the tool orientation is not supported; use ORIAXES"},
    {"ORIPLANE",
     "large-circle interpolation of the tool orientation is not supported; use ORIAXES"},
    {"OFFN", "a contour allowance is not supported"},
    {"TOFFL", "programmed tool length offsets are not supported"},
    {"TOFFR", "programmed tool radius offsets are not supported"},
    {"FGROUP", "selection of the axes that F refers to is not supported"},
    {"FL", "feed limits of single axes are not supported"},
    {"FD", "handwheel feed has no defined duration; remove the word"},
    {"FDA", "handwheel feed has no defined duration; remove the word"},
    {"FA", "feed rates of positioning axes are not supported; use F"},
    {"FB", "a non-modal feed rate is not supported; use F in this and the next block"},
    {"OVRA", "overrides of positioning axes and spindles are not supported; program S"},
    {"SPP", "path segmentation for punching is not supported; remove the word"},
    {"SPN", "path segmentation for punching is not supported; remove the word"},
    {"DISPR", "repositioning belongs to interrupt routines, which are not supported"},
    {"ORIRESET", "moves the rotary axes to positions outside the program; program the positions"},
    {"ATOL", "axis tolerances are not supported; use CYCLE832"},
    {"FZ", "feed per tooth requires the number of teeth; use G94 or G95"},
    {"POS", "asynchronous positioning axes are not supported; use G0 or G1"},
    {"POSA", "asynchronous positioning axes are not supported; use G0 or G1"},
    {"SPOSA", "asynchronous spindle positioning is not supported; use SPOS"},
    {"MEAS", "measuring is not supported: the measured values are unknown"},
    {"MEAW", "measuring is not supported: the measured values are unknown"},
    {"WHEN", "synchronised actions are not supported; remove the block if it causes no motion"},
    {"WHENEVER", "synchronised actions are not supported; remove the block if it causes no motion"},
    {"ID", "synchronised actions are not supported; remove the block if it causes no motion"},
    {"IDS", "synchronised actions are not supported; remove the block if it causes no motion"},
    {"EVERY", "synchronised actions are not supported; remove the block if it causes no motion"},
    {"GEOAX", "exchange of geometry axes is not supported"},
    {"CTRANS", "frame variables are not supported; use TRANS"},
    {"EXECTAB", "contour tables are not supported"},
    {"CONTPRON", "contour tables are not supported"},
    {"PUNCHACC", "punching is not supported"},
    {"ANG", "contour definition with angles is not supported; program the end points"},
    {"REPOSA", "repositioning belongs to interrupt routines, which are not supported"},
    {"ASUP", "interrupts are not supported"},
    {"SETINT", "interrupts are not supported"},
    {"FXS", "travel to fixed stop is not supported"},
});

constexpr auto kTextOnly = std::to_array<std::string_view>(
    {"MSG", "WORKPIECE", "GROUP_BEGIN", "GROUP_END", "GROUP_ADDEND", "EXTERN"});

// Words with '=' that change neither the path nor F: of the machine's limits, which are those of
// the machine file, of tolerances, and of what no supported function reads. H is of the PLC.
constexpr auto kPassedOver = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"ACC", "ignored: the acceleration limit of the machine applies"},
    {"ACCLIMA", "ignored: the acceleration limits of the machine apply to following axes"},
    {"ADIS", "ignored: the smoothing distance is not evaluated; set a tolerance with CYCLE832"},
    {"ADISPOS",
     "ignored: the smoothing distance is not evaluated; rapid moves use the tolerance of feed "
     "moves"},
    {"CTOL", "ignored: the tolerance is not evaluated; set it with CYCLE832"},
    {"H", "ignored: a PLC function without effect on motion"},
    {"JERKLIM", "ignored: the jerk limit of the machine applies"},
    {"JERKLIMA", "ignored: the jerk limits of the machine apply to following axes"},
    {"LIMS",
     "ignored: the spindle speed limit applies with G96, which is not supported, and with G97"},
    {"OTOL", "ignored: the orientation tolerance is not evaluated"},
    {"OVRRAP", "ignored: rapid moves use the rapid velocity of the machine"},
    {"VELOLIM", "ignored: the velocity limit of the machine applies"},
    {"VELOLIMA", "ignored: the velocity limits of the machine apply to following axes"},
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
