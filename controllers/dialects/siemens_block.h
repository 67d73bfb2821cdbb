/// A block of a program for Siemens 840D sl: its words sorted by what they set, each once.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/dialects/siemens_words.h"
#include "plant/vocabulary/axes.h"

namespace servomill::controllers {

/// Groups of which a block holds at most one word.
enum class SiemensGroup : std::uint8_t {
  motion,          // G0 G1 G2 G3 CIP
  dwell,           // G4
  frame,           // TRANS ROT SCALE MIRROR, without axes
  plane,           // G17 G18 G19
  cutter,          // G40
  work_offset,     // G500 G54 ... G57 G505 ... G599
  suppression,     // SUPA G153
  path,            // G60 G64 G641 G642
  exact_stop,      // G9
  units,           // G70 G71 G700 G710
  distance,        // G90 G91
  feed,            // G93 G94 G95
  rapid,           // RTLION RTLIOF
  transformation,  // TRAFOOF
  without_effect,  // on the path: jerk, dynamics, feed-forward, exact stop criteria, STOPRE
};
inline constexpr std::size_t kSiemensGroups = 15;

struct SiemensCode {
  std::string_view name;
  int value = 0;  // the number of a G code
  int column = 0;
};

struct SiemensNumber {
  double value = 0.0;
  SiemensForm form = SiemensForm::number;
  int column = 0;
};

struct SiemensTool {
  int number = 0;
  int column = 0;
};

/// CYCLE832(tolerance, kind, ...): `tolerance` nullopt where it is deselected.
struct SiemensSmoothing {
  std::optional<double> tolerance;
  int column = 0;
};

struct SiemensBlock {
  int line = 0;
  int column = 1;  // of the first word
  std::array<std::optional<SiemensCode>, kSiemensGroups> codes;
  std::array<std::optional<SiemensNumber>, kAxisWords> axes;
  std::array<std::optional<SiemensNumber>, 3> centre;   // I J K
  std::array<std::optional<SiemensNumber>, 3> through;  // I1 J1 K1: CIP
  std::optional<SiemensNumber> CR, TURN, F, S, D, ADIS, ADISPOS, CTOL, MEAS;
  std::optional<SiemensTool> T;
  std::optional<SiemensSmoothing> smoothing;
  std::vector<SiemensNumber> M;
  int words = 0;  // messages do not count

  const std::optional<SiemensCode>& code(SiemensGroup group) const {
    return codes[static_cast<std::size_t>(group)];
  }
  bool has(SiemensGroup group) const { return code(group).has_value(); }
  bool has_axes() const;
  bool has_centre() const;
  bool has_through() const;
  bool moves() const { return has_axes() || has_centre() || has_through() || CR || TURN; }
};

/// @throw InputError where a word is unknown or not read, or appears twice
SiemensBlock siemens_block(const SiemensLine& line, int number, const std::string& file);

}  // namespace servomill::controllers
