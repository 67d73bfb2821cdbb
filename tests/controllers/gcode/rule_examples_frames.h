/// Examples of work offsets, tool offsets, polar coordinates, scaling, mirror image and rotation.
/// Private to rule_examples_test.cpp.
#pragma once

#include "rule_examples.h"

namespace servomill::controllers {

inline const std::string kPolar16 = "Fanuc B-62764EN/01, section 9.2",
                         kScaleHaas = "Haas 96-8000 p. 161",
                         kScale16i = "Fanuc B-63682EN/01 p. 117",
                         kTurn16 = "Fanuc B-62764EN/01 p. 354",
                         kTurnHaas = "Haas Mill operator's manual, G68 (Group 16)",
                         kBothHaas = "Haas 96-8000, June 1999, p. 178",
                         kBoth30i = "Fanuc B-63944EN-2/02 p. 211",
                         kMirror = "Siemens 6FC5397-0BP10-2BA0 p. 3-65 (ISO dialect)",
                         kOffsets = "Fanuc B-63944EN; from memory";

inline std::vector<RuleExample> offset_examples() {
  const Given tools = {.has_tools = true}, offsets = {.has_offsets = true};
  return {
      {ReaderRule::additional_work_offset, Reader::fanuc,
       "G54.1 P3 G90 G0 X1. Y2.\nZ5.\nG91 X1.\nG90 G54 X1. Y2.\nM2\n",
       "R 11 22 300 | R 11 22 35 | R 12 22 35 | R 101 202 35", "p.nc:1:1", kOffsets, offsets},
      {ReaderRule::additional_work_offset, Reader::fanuc, "G54 P3 G0 X1. Y2.\nG54 X1.\nM2\n",
       "R 11 22 300 | R 101 22 300", "p.nc:1:1", kOffsets, offsets},
      {ReaderRule::additional_work_offset, Reader::any, "G54 P3\nG0 X1.\nM2\n", "R 11 200 300",
       "p.nc:1:1", kOffsets, offsets},
      {ReaderRule::additional_work_offset, Reader::haas, "G20\nG154 P3\nG1 X1. F10.\nM2\n",
       "F 35.4 200 300 f254", "p.nc:2:1", kOffsets, offsets},
      {ReaderRule::additional_work_offset, Reader::fanuc,
       "G10 L20 P1 X50. Y60.\nG54.1 P1\nG0 X1. Y1.\nM2\n", "R 51 61 300", "p.nc:1:1", kOffsets,
       offsets},
      // left of +X is +Y: the centre of the cutter of 2 mm runs 1 mm beside the path
      {ReaderRule::modal_diameter_offset, Reader::fanuc,
       "D1\nG41 G1 X10. F100.\nX20.\nG40 Y5.\nM2\n", "F 10 1 0 f100 | F 20 1 0 | F 20 5 0",
       "p.nc:1:1", kOffsets, tools},
      {ReaderRule::modal_diameter_offset, Reader::haas,
       "G0 D2\nG91 G42 G1 X10. F100.\nX10.\nG40 X5.\nM2\n", "F 10 -2 0 f100 | F 20 -2 0 | F 25 0 0",
       "p.nc:1:4", kOffsets, tools},
      {ReaderRule::modal_length_offset, Reader::fanuc, "G43 H1\nG0 Z5.\nH2\nZ5.\nG49 Z5.\nM2\n",
       "R 0 0 15 | R 0 0 25 | R 0 0 5", "p.nc:3:1", kOffsets, tools},
      {ReaderRule::modal_length_offset, Reader::haas, "H2\nG0 X1.\nG43 Z5.\nG91 Z1.\nM2\n",
       "R 1 0 0 | R 1 0 25 | R 1 0 26", "p.nc:1:1", kOffsets, tools},
      {ReaderRule::unknown_length,
       Reader::any,
       "G43 H1\nG0 X1. Z1.\nG1 Y2. F100.\nM2\n",
       "R 1 0 ? | F 1 2 ? f100",
       "p.nc:1:1",
       "no control: the table is not in the program",
       {.lacks_lengths = true}},
  };
}

inline std::vector<RuleExample> frame_examples() {
  return {
      // 10 mm at 30 degrees: X 8.660254, Y 5; the radius is kept
      {ReaderRule::polar_coordinates, Reader::fanuc,
       "G17 G90 G16\nG0 X10. Y30.\nY90.\nG15 X1. Y1.\nM2\n", "R 8.660254 5 0 | R 0 10 0 | R 1 1 0",
       "p.nc:1:9", kPolar16},
      // the angle counts from the one before, the centre stays
      {ReaderRule::polar_coordinates, Reader::fanuc,
       "G90 G16\nG0 X10. Y30.\nG91 Y120.\nY120.\nG90 G15\nG0 X0. Y0.\nM2\n",
       "R 8.660254 5 0 | R -8.660254 5 0 | R 0 -10 0 | R 0 0 0", "p.nc:1:5", kPolar16},
      // the radius from where the tool stands
      {ReaderRule::polar_coordinates, Reader::fanuc,
       "G0 X1. Y2.\nG91 G16\nG1 X10. Y90. F100.\nG15\nX1.\nM2\n",
       "R 1 2 0 | F 1 12 0 f100 | F 2 12 0", "p.nc:2:5", kPolar16},
      // G18: the radius is Z, the angle X
      {ReaderRule::polar_coordinates, Reader::fanuc, "G18 G90 G16\nG0 Z10. X30.\nG15 Z0. X0.\nM2\n",
       "R 5 0 8.660254 | R 0 0 0", "p.nc:1:9", kPolar16},
      {ReaderRule::polar_coordinates, Reader::fanuc, "G20 G19 G16\nG0 Y1. Z90.\nG15\nM2\n",
       "R 0 0 25.4", "p.nc:1:9", kPolar16},
      // angles in thousandths of a degree, also with inches
      {ReaderRule::polar_coordinates,
       Reader::fanuc,
       "G20 G16\nG0 X10000 Y90000\nG15\nM2\n",
       "R 0 25.4 0",
       "p.nc:1:5",
       kPolar16,
       {.decimal_point = DecimalPoint::increments}},
      // the bolt circle: three holes, the depth as it was given
      {ReaderRule::polar_coordinates, Reader::fanuc,
       "G0 Z5.\nG17 G90 G16\nG99 G81 X10. Y30. Z-2. R1. F100.\nG91 Y120.\nY120.\nG15 G80\nM2\n",
       "R 0 0 5 | R 8.660254 5 5 | R 8.660254 5 1 | F 8.660254 5 -2 f100 | R 8.660254 5 1 | "
       "R -8.660254 5 1 | F -8.660254 5 -2 | R -8.660254 5 1 | R 0 -10 1 | F 0 -10 -2 | "
       "R 0 -10 1",
       "p.nc:2:9", kPolar16},
      {ReaderRule::scaling, Reader::haas,
       "G51 X0. Y0. Z0. P2.\nG0 X1. Y2.\nG1 Z-1. F100.\nG50\nX1.\nM2\n",
       "R 2 4 0 | F 2 4 -2 f100 | F 1 4 -2", "p.nc:1:1", kScaleHaas},
      // about the last position; arcs with their centre
      {ReaderRule::scaling, Reader::haas,
       "G0 X2. Y2.\nG51 P2.\nG1 X3. F100.\nG3 X5. I1.\nG50\nG1 X0.\nM2\n",
       "R 2 2 0 | F 4 2 0 f100 | CCW 8 2 0 o 6 2 0 | F 0 2 0", "p.nc:2:1", kScaleHaas},
      {ReaderRule::scaling, Reader::haas,
       "G20 G51 X0. Y0. P.5\nG91 G1 X1. F10.\nG2 X1. Y1. R1.\nG50\nG1 X1.\nM2\n",
       "F 12.7 0 0 f254 | CW 25.4 12.7 0 o 25.4 0 0 | F 50.8 12.7 0", "p.nc:1:5", kScaleHaas},
      // each axis by its own factor; a negative one mirrors
      {ReaderRule::scaling, Reader::fanuc,
       "G51 X0. Y0. I2000 J1000 K1000\nG0 X1. Y2.\nG50\nX1.\nM2\n", "R 2 2 0 | R 1 2 0", "p.nc:1:1",
       kScale16i},
      {ReaderRule::scaling, Reader::fanuc,
       "G51 X5. Y0. I-1000 J1000 K1000\nG1 X6. Y2. F100.\nG2 X7. Y3. I1. J0.\nG50\nG1 X0.\nM2\n",
       "F 4 2 0 f100 | CCW 3 3 0 o 3 2 0 | F 0 3 0", "p.nc:1:1", kScale16i},
      // X and Y are factors
      {ReaderRule::scaling, Reader::mach, "G51 X2. Y3.\nG0 X1. Y2.\nG91 X1.\nG50\nX1.\nM2\n",
       "R 2 6 0 | R 4 6 0 | R 5 6 0", "p.nc:1:1", "Mach3 Mill, G51; from memory"},
      {ReaderRule::mirror_image, Reader::fanuc,
       "G51.1 X5.\nG1 X6. Y2. F100.\nG2 X7. Y3. I1. J0.\nG50.1 X0.\nG1 X6.\nM2\n",
       "F 4 2 0 f100 | CCW 3 3 0 o 3 2 0 | F 6 3 0", "p.nc:1:1", kMirror},
      {ReaderRule::mirror_image, Reader::fanuc,
       "G0 X1. Y1.\nG51.1 X0. Y0.\nG91 G1 X1. Y2. F100.\nG3 X1. Y1. R1.\nG50.1 X0. Y0.\nG1 "
       "X1.\nM2\n",
       "R 1 1 0 | F 0 -1 0 f100 | CCW -1 -2 0 o 0 -2 0 | F 0 -2 0", "p.nc:2:1", kMirror},
      {ReaderRule::mirror_image, Reader::any, "G20 G51.1 Y1.\nG0 X1. Y2.\nG50.1\nY2.\nM2\n",
       "R 25.4 0 0 | R 25.4 50.8 0", "p.nc:1:5", kMirror},
      // a quarter turn about X5 Y5: X10 Y5 becomes X5 Y10
      {ReaderRule::rotation, Reader::fanuc,
       "G68 X5. Y5. R90.\nG0 X10. Y5.\nX5. Y10.\nG69\nX1. Y1.\nM2\n",
       "R 5 10 0 | R 0 5 0 | R 1 1 0", "p.nc:1:1", kTurn16},
      {ReaderRule::rotation, Reader::haas,
       "G0 X2. Y2.\nG68 R60.\nG91 G1 X1. F100.\nG3 X2. I1.\nG69\nG1 X1.\nM2\n",
       "R 2 2 0 | F 2.5 2.866025 0 f100 | CCW 3.5 4.598076 0 o 3 3.732051 0 | F 4.5 4.598076 0",
       "p.nc:2:1", kTurnHaas},
      // counter-clockwise seen from +Y: from Z to X
      {ReaderRule::rotation, Reader::fanuc, "G18 G68 Z0. X0. R90.\nG0 Z1. X0.\nG69\nZ0. X0.\nM2\n",
       "R 1 0 0 | R 0 0 0", "p.nc:1:5", kTurn16},
      {ReaderRule::rotation, Reader::fanuc, "G20 G19 G68 Y0. Z0. R-90.\nG0 Y1. Z0.\nG69\nM2\n",
       "R 0 0 -25.4", "p.nc:1:9", kTurn16},
      {ReaderRule::rotation, Reader::fanuc,
       "G0 Z5.\nG68 X0. Y0. R90.\nG99 G81 X1. Y0. Z-2. R1. F100.\nX3. Y1.\nG80 G69\nM2\n",
       "R 0 0 5 | R 0 1 5 | R 0 1 1 | F 0 1 -2 f100 | R 0 1 1 | R -1 3 1 | F -1 3 -2 | R -1 3 1",
       "p.nc:2:1", kTurn16},
      {ReaderRule::rotation, Reader::mach, "G68 A5. B5. R90.\nG0 X10. Y5.\nG69\nX1. Y1.\nM2\n",
       "R 5 10 0 | R 1 1 0", "p.nc:1:1", "Mach3 Mill, G68; from memory"},
  };
}

}  // namespace servomill::controllers
