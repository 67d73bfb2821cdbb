/// Third stage: a block with numbers in place of expressions, checked against the tables of codes.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>

#include "controllers/gcode/block.h"
#include "controllers/gcode/modal_groups.h"
#include "controllers/gcode/parameters.h"

namespace servomill::controllers {

/// Codes and words of a block. At most one code of each group.
struct Request {
  struct Cell {
    double value = 0.0;
    int column = 0;  // 0: not in the block
  };
  struct Chosen {
    const Code* code = nullptr;
    int column = 0;
  };

  int line = 0;
  std::array<Cell, kWordLetters> words;  // by word_index(); G and M are in `codes`
  std::uint32_t letters = 0;  // those of `words` that are in the block, a word_bit() each
  std::uint32_t groups = 0;   // those of `codes` that are in the block, a bit each
  std::array<Chosen, static_cast<std::size_t>(Group::count)> codes;
  Chosen motion;  // in this block, programmed or still in force; not G80

  void clear() {
    for (; letters != 0; letters &= letters - 1) {
      words[static_cast<std::size_t>(std::countr_zero(letters))] = {};
    }
    for (; groups != 0; groups &= groups - 1) {
      codes[static_cast<std::size_t>(std::countr_zero(groups))] = {};
    }
    motion = {};
  }
  void set(char letter, double value, int column) {
    words[word_index(letter)] = {value, column};
    letters |= word_bit(letter);
  }
  void set(Group group, const Chosen& chosen) {
    codes[static_cast<std::size_t>(group)] = chosen;
    groups |= 1U << static_cast<unsigned>(group);
  }

  const Cell& word(char letter) const { return words[word_index(letter)]; }
  bool has(char letter) const { return (letters & word_bit(letter)) != 0; }
  /// @ or ^: X and Y in polar coordinates.
  bool has_polar() const { return (letters & (word_bit('@') | word_bit('^'))) != 0; }
  double operator[](char letter) const { return word(letter).value; }

  const Chosen& of(Group group) const { return codes[static_cast<std::size_t>(group)]; }
  /// Ten times the code of a group, or -1.
  int code(Group group) const { return of(group).code == nullptr ? -1 : of(group).code->tenths; }
  /// Ten times the motion code, or -1.
  int motion_code() const { return motion.code == nullptr ? -1 : motion.code->tenths; }
};

inline constexpr int kNoMotion = 800;       // G80
inline constexpr int kVectorControl = 435;  // G43.5

/// @param block    its values are evaluated
/// @param request  set anew; it may hold any other
/// @param modal_motion  ten times the motion code in force
/// @param has_vectors   whether I J K of G0 and G1 give the tool axis (G43.5 in force)
/// @throws InputError for an unknown or unsupported code, two codes of a group, axis words that no
/// code or more than one code claims, and words that belong to no code of the block
void resolve(Block& block, const Parameters& parameters, int modal_motion, bool has_vectors,
             const std::string& file, Request& request);

/// The part of `resolve` that needs no run: codes that are plain numbers.
void check_codes(const Block& block, const std::string& file);

}  // namespace servomill::controllers
