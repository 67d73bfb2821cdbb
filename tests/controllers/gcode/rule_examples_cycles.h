/// Examples of canned cycles. Private to rule_examples_test.cpp.
#pragma once

#include "rule_examples.h"

namespace servomill::controllers {

// Six operations: positioning, rapid to R, drilling, what happens at the bottom, back to R, rapid
// to the initial level (G98).
inline const std::string kCycleHaas = "Haas 96-8000, June 1999, p. 182",
                         kBoring15i = "Fanuc B-63324EN/03 p. 293",
                         kCycleFanuc = "Fanuc B-63944EN, canned cycles; from memory",
                         kLongTapHaas = "haascnc.com, G84 (Group 09)";

inline std::vector<RuleExample> cycle_examples() {
  const std::string drill = "G0 Z5.\nG99 G81 X1. Z-2. R1. F100.\n",
                    drilled = "R 0 0 5 | R 1 0 5 | R 1 0 1 | F 1 0 -2 f100 | R 1 0 1";
  const Given increments = {.decimal_point = DecimalPoint::increments};
  return {
      // R 1 mm below the level of 5 mm, the bottom 2 mm below R
      {ReaderRule::cycle_repeats, Reader::fanuc,
       "G0 Z5.\nG91 G99 G81 X1. Z-2. R-1. K3 F100.\nG80 G0 Y1.\nM2\n",
       "R 0 0 5 | R 1 0 5 | R 1 0 4 | F 1 0 2 f100 | R 1 0 4 | R 2 0 4 | F 2 0 2 | R 2 0 4 | "
       "R 3 0 4 | F 3 0 2 | R 3 0 4 | R 3 1 4",
       "p.nc:2:27", kCycleFanuc},
      {ReaderRule::cycle_repeats, Reader::fanuc, "G0 Z5.\nG91 G98 G81 X1. Z-2. R-1. K2 F100.\nM2\n",
       "R 0 0 5 | R 1 0 5 | R 1 0 4 | F 1 0 2 f100 | R 1 0 5 | R 2 0 5 | R 2 0 4 | F 2 0 2 | "
       "R 2 0 5",
       "p.nc:2:27", kCycleFanuc},
      {ReaderRule::cycle_repeats, Reader::any, "G0 Z5.\nG90 G99 G81 X1. Z-2. R1. K2 F100.\nM2\n",
       drilled + " | F 1 0 -2 | R 1 0 1", "p.nc:2:26", kCycleFanuc},
      // along Y: G18 drills across its plane
      {ReaderRule::cycle_repeats, Reader::fanuc,
       "G0 Y5.\nG91 G18 G99 G81 Z3. Y-2. R-1. K2 F100.\nG17\nM2\n",
       "R 0 5 0 | R 0 5 3 | R 0 4 3 | F 0 2 3 f100 | R 0 4 3 | R 0 4 6 | F 0 2 6 | R 0 4 6",
       "p.nc:2:31", kCycleFanuc},
      {ReaderRule::cycle_repeats, Reader::fanuc,
       "G20 G0 X5.\nG91 G19 G99 G81 Y1. X-2. R-1. K2 F10.\nM2\n",
       "R 127 0 0 | R 127 25.4 0 | R 101.6 25.4 0 | F 50.8 25.4 0 f254 | R 101.6 25.4 0 | "
       "R 101.6 50.8 0 | F 50.8 50.8 0 | R 101.6 50.8 0",
       "p.nc:2:31", kCycleFanuc},
      // lengths in micrometres; K counts
      {ReaderRule::cycle_repeats, Reader::fanuc,
       "G0 Z5000\nG91 G99 G81 X1000 Z-2000 R-1000 K2 F100\nM2\n",
       "R 0 0 5 | R 1 0 5 | R 1 0 4 | F 1 0 2 f100 | R 1 0 4 | R 2 0 4 | F 2 0 2 | R 2 0 4",
       "p.nc:2:33", kCycleFanuc, increments},
      {ReaderRule::cycle_without_hole, Reader::fanuc,
       "G0 Z5.\nG99 G81 Z-2. R1. K0 F100.\nX3.\nM2\n",
       "R 0 0 5 | R 3 0 5 | R 3 0 1 | F 3 0 -2 f100 | R 3 0 1", "p.nc:2:18", kCycleFanuc},
      {ReaderRule::cycle_without_hole, Reader::haas,
       "G0 Z5.\nG98 G83 Z-2. R1. Q2. L0 F100.\nY3.\nG80\nG0 X1.\nM2\n",
       "R 0 0 5 | R 0 3 5 | R 0 3 1 | F 0 3 -1 f100 | R 0 3 1 | R 0 3 -0.746 | F 0 3 -2 | "
       "R 0 3 5 | R 1 3 5",
       "p.nc:2:22", kCycleFanuc},
      // G85 leaves at feed
      {ReaderRule::cycle_memory, Reader::fanuc, drill + "G85 X3.\nM2\n",
       drilled + " | R 3 0 1 | F 3 0 -2 | F 3 0 1", "p.nc:3:1", kCycleFanuc},
      {ReaderRule::cycle_memory, Reader::haas, drill + "G82 X3. Z-1. P500\nG81 X4.\nM2\n",
       drilled + " | R 3 0 1 | F 3 0 -1 | W 0.5 | R 3 0 1 | R 4 0 1 | F 4 0 -1 | R 4 0 1",
       "p.nc:3:1", kCycleFanuc},
      {ReaderRule::cycle_without_dwell, Reader::fanuc, "G0 Z5.\nG99 G82 X1. Z-2. R1. F100.\nM2\n",
       drilled, "p.nc:2:5", kCycleFanuc},
      {ReaderRule::cycle_without_dwell, Reader::haas,
       "G0 Z5.\nG91 G98 G89 X1. Z-2. R-1. F100.\nG90 G80 X0.\nM2\n",
       "R 0 0 5 | R 1 0 5 | R 1 0 4 | F 1 0 2 f100 | F 1 0 4 | R 1 0 5 | R 0 0 5", "p.nc:2:9",
       kCycleFanuc},
      // P serves the next cycle that dwells
      {ReaderRule::cycle_unused_dwell, Reader::haas,
       "G0 Z5.\nG99 G81 X1. Z-2. R1. P0.5 F100.\nM2\n", drilled, "p.nc:2:22", kCycleHaas},
      {ReaderRule::cycle_unused_dwell, Reader::fanuc,
       "G0 Z5.\nG99 G85 X1. Z-2. R1. P500 F100.\nG82 X3.\nM2\n",
       "R 0 0 5 | R 1 0 5 | R 1 0 1 | F 1 0 -2 f100 | F 1 0 1 | R 3 0 1 | F 3 0 -2 | W 0.5 | "
       "R 3 0 1",
       "p.nc:2:22", kCycleFanuc},
      {ReaderRule::fine_boring, Reader::fanuc,
       "S100 M3\nG0 Z5.\nG99 G76 X1. Z-2. R1. Q0.1 P500 F100.\nM2\n",
       "S+100 | R 0 0 5 | R 1 0 5 | R 1 0 1 | F 1 0 -2 f100 | W 0.5 | S0 | R 1 0 1 | S+100",
       "p.nc:3:5", kBoring15i},
      {ReaderRule::fine_boring, Reader::any,
       "S100 M3\nG0 Z5.\nG98 G76 X1. Z-2. R1. Q0.1 P0 F100.\nX3.\nG80\nG0 Y1.\nM2\n",
       "S+100 | R 0 0 5 | R 1 0 5 | R 1 0 1 | F 1 0 -2 f100 | S0 | R 1 0 5 | S+100 | R 3 0 5 | "
       "R 3 0 1 | F 3 0 -2 | S0 | R 3 0 5 | S+100 | R 3 1 5",
       "p.nc:3:5", kBoring15i},
      {ReaderRule::tapping_spindle, Reader::haas, "S100\nG0 Z5.\nG99 G84 X1. Z-2. R1. F100.\nM2\n",
       "R 0 0 5 | S+100 | R 1 0 5 | R 1 0 1 | F 1 0 -2 f100 | S0 | S-100 | F 1 0 1 | S0 | S+100",
       "p.nc:3:5", kLongTapHaas},
      {ReaderRule::tapping_spindle, Reader::fanuc, "S100\nG0 Z5.\nG99 G74 X1. Z-2. R1. F100.\nM2\n",
       "R 0 0 5 | S-100 | R 1 0 5 | R 1 0 1 | F 1 0 -2 f100 | S0 | S+100 | F 1 0 1 | S0 | S-100",
       "p.nc:3:5", kCycleFanuc},
      {ReaderRule::tapping_spindle, Reader::fanuc,
       "S100\nG0 Z5.\nG98 G84 X1. Z-2. R1. F100.\nX3.\nG80\nG0 Y1.\nM2\n",
       "R 0 0 5 | S+100 | R 1 0 5 | R 1 0 1 | F 1 0 -2 f100 | S0 | S-100 | F 1 0 1 | S0 | S+100 | "
       "R 1 0 5 | R 3 0 5 | R 3 0 1 | F 3 0 -2 | S0 | S-100 | F 3 0 1 | S0 | S+100 | R 3 0 5 | "
       "R 3 1 5",
       "p.nc:3:5", kCycleFanuc},
      {ReaderRule::words_with_g80, Reader::fanuc, drill + "G80 X3.\nX4.\nM2\n",
       drilled + " | R 3 0 1 | R 4 0 1", "p.nc:3:1", kCycleFanuc},
      {ReaderRule::words_with_g80, Reader::haas,
       "G1 Z5. F100.\nG99 G81 X1. Z-2. R1.\nG91 G80 X3.\nM2\n",
       "F 0 0 5 f100 | R 1 0 5 | R 1 0 1 | F 1 0 -2 | R 1 0 1 | F 4 0 1", "p.nc:3:5", kCycleFanuc},
      {ReaderRule::motion_behind_cycle, Reader::fanuc, drill + "G80\nX3.\nY1.\nM2\n",
       drilled + " | R 3 0 1 | R 3 1 1", "p.nc:4:1", kCycleFanuc},
      {ReaderRule::motion_behind_cycle, Reader::haas,
       "G1 Z5. F100.\nG99 G81 X1. Z-2. R1.\nG80\nG91 X3.\nM2\n",
       "F 0 0 5 f100 | R 1 0 5 | R 1 0 1 | F 1 0 -2 | R 1 0 1 | F 4 0 1", "p.nc:4:1", kCycleFanuc},
  };
}

}  // namespace servomill::controllers
