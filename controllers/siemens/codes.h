/// Words of the language of Siemens 840D sl: G functions by their groups, words without effect on
/// motion, and words that are not supported, with the reason.
/// Source: 840D sl, Fundamentals (6FC5398-1BP40), "G commands (G groups)" and "Operations"; words
/// that are not in its lists from memory.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace servomill::controllers::siemens {

/// Groups of which a block holds at most one word.
enum class Group {
  motion,          // G0 G1 G2 G3 CIP CT G33 G331 G332
  action,          // G4 G25 G26 G63 and frames: TRANS ... AMIRROR, G110 G111 G112
  plane,           // G17 G18 G19
  cutter,          // G40 G41 G42
  corner,          // G450
  work_offset,     // G500 G54 ... G57 G505 ... G599
  suppression,     // G53 G153 SUPA
  path,            // G60 G64 G641 G642 G645
  exact_stop,      // G9
  units,           // G70 G71 G700 G710
  distance,        // G90 G91
  feed,            // G93 G94 G95 G97 G971 G972
  contour_feed,    // CFC CFTCP
  transformation,  // TRAORI TRAFOOF
  rapid,           // RTLIOF
  compressor,      // COMPON COMPCURV COMPCAD COMPSURF COMPOF
  without_effect,  // on the path
};
inline constexpr std::size_t kGroups = 17;

std::optional<Group> group_of(std::string_view code);

/// True for a word of the language without a value: a G function, or one without effect.
bool is_code(std::string_view name);

/// The reason why a word is not supported; empty: it is not known as one.
std::string refusal_of(std::string_view name);

/// True for functions whose parentheses hold texts for the operator and pictures: MSG, WORKPIECE.
bool has_text_only(std::string_view name);

/// True for words without effect whose parentheses name axes or spindles: SOFTA(X).
bool takes_names(std::string_view code);

/// The reason why a word with '=' may be passed over, for the warning; empty: it may not.
std::string_view warning_of(std::string_view setting);

/// The word of the language that is meant by another: "; did you mean 'TRANS'?", or nothing.
std::string similar_word(std::string_view name);

}  // namespace servomill::controllers::siemens
