/// Readings of a real machine: what lasers, squares, ball bars, nests of sensors and touch probes
/// have shown, where, and how well they measure.
///
/// One sign convention for all: a reading is the deviation of the tool as seen from the workpiece,
/// actual minus nominal, positive along the positive direction of the axis that it is named after;
/// angles count right-handed. Lengths in m, angles in rad.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plant/kinematics/chain.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::sim::readings {

/// Measuring task of a group.
enum class Kind : std::uint8_t {
  positioning,   // along the motion of an axis (rotary: its angle), or along a diagonal
  straightness,  // across it, from a straight edge, a laser or a wire
  angle,         // of the tool body, by an autocollimator, laser or levels: pitch, yaw, roll
  squareness,    // angle between the mean lines of two axes, minus 90 degrees
  circle,        // radial deviation on a circle in a plane of two linear axes
  ball_bar,      // length between a ball on the table and one in the spindle, wherever they stand
  r_test,        // shift of a ball in the spindle relative to a nest on the table, three numbers
  sphere,        // joints at which a touch probe has found the centre of a sphere
  touch,         // joints at which a touch probe has met a sphere
  part,          // deviation of a surface that the machine has cut, as measured elsewhere
};
inline constexpr std::array<std::string_view, 10> kKinds = {
    "positioning", "straightness", "angle",  "squareness", "circle",
    "ball_bar",    "r_test",       "sphere", "touch",      "part"};

/// Numbers of one reading: three of an R-test and of a sphere, else one.
int numbers_of(Kind kind);
/// True if rows name spheres, and hold joints instead of deviations.
bool is_of_spheres(Kind kind);
/// True if the readings of a group are angles.
bool is_angular(Kind kind, std::optional<Axis> axis);

/// One row of a file.
struct Reading {
  Joints Q = Joints::Zero();                               // m, rad; nominal
  std::array<int, kJoints> direction{};                    // of travel: 1, -1; 0: not known
  Eigen::Vector3d deviation = Eigen::Vector3d::Zero();     // m or rad; of one number: the first
  int run = 0;                                             // from 0
  double time = std::numeric_limits<double>::quiet_NaN();  // s; NaN: not known
  double temperature = std::numeric_limits<double>::quiet_NaN();  // degC; NaN: not known
  std::size_t sphere = 0;                                         // index into Group::spheres
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // of a part's surface, in W, outwards; unit
  int line = 0;                                       // of the file
};

/// An instrument that several groups may share: its scale is wrong by the same share in all.
struct Instrument {
  std::string name;
  double scale_uncertainty = 0.0;  // m/m; standard
};

/// A ball of an artefact.
struct Ball {
  std::string name;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // m, in the frame of the artefact
};

/// Balls whose distances are known: a ball plate, a ball beam. Several groups may measure it.
struct Artefact {
  std::string name;
  std::string file;                // of the centres
  double uncertainty = 0.0;        // m; standard, of each coordinate
  double scale_uncertainty = 0.0;  // m/m; standard: temperature, calibration
  std::vector<Ball> balls;

  std::optional<std::size_t> find(const std::string& ball) const;
};

/// The path of a laser before its measuring range, over which its wavelength counts, too.
struct DeadPath {
  double length = 0.0;  // m, from the instrument to the first row; negative: it stands beyond +
  double change = 0.0;  // m/m; standard, of the wavelength from the first row to the last one
};

/// Thermal expansion of what a length is compared with.
struct Expansion {
  double coefficient = 0.0;              // 1/K
  double coefficient_uncertainty = 0.0;  // 1/K; standard
  double temperature_uncertainty = 0.0;  // K; standard, common to all readings of the group
};

/// Readings of one kind, taken with one set-up.
struct Group {
  std::string name;
  Kind kind = Kind::positioning;
  std::optional<Axis> axis;       // that moves; none: of a diagonal and of kinds that need none
  std::optional<Axis> direction;  // straightness: X, Y, Z; angle: A, B, C
  std::array<Axis, 2> plane = {Axis::X, Axis::Y};  // of a circle; axes of a squareness
  Eigen::Vector3d p_ST = Eigen::Vector3d::Zero();  // m, measured point in the spindle nose
  std::optional<std::size_t> instrument;           // index into Readings::instruments
  std::optional<double> uncertainty;  // m or rad; standard, of independent readings; none: estimate
  Joints at = Joints::Zero();         // m, rad; where axes stand that the rows do not name
  std::array<bool, kJoints> stands{};  // joints that `at` names
  double radius = 0.0;                 // m, nominal, of a circle; of sphere and stylus at a touch
  double length = 0.0;                 // m, nominal, of a ball bar
  std::optional<double> size_uncertainty;  // m; standard, of radius or length; none: not known
  Eigen::Vector3d ball_W = Eigen::Vector3d::Zero();  // m, nominal, on the table
  std::array<double, 2> legs{};                      // m, lengths of the lines of a squareness
  int targets = 0;                                   // on each of these lines
  bool tool_is_known = false;      // the ball or stylus is at p_ST, adjusted to the spindle
  bool directions_unused = false;  // rows have a direction of travel that says nothing here
  bool drifts = false;             // linearly in time; without times: from row to row
  std::optional<Expansion> expansion;
  std::optional<DeadPath> dead_path;
  std::optional<std::size_t> artefact;  // index into Readings::artefacts; its balls are the spheres
  int lobes = 0;                        // waves of the pre-travel by direction; below 2: none
  double lobe_size = 0.0;               // m; standard deviation that is expected of each
  bool is_surface = true;               // of a part: cut with the side of a tool; else a centre
  std::vector<std::string> spheres;     // names, in the order of their first reading
  std::string file;                     // of the rows; empty: the number stands in the group
  Place place;
  std::vector<Reading> rows;
};

/// The content of one file of readings.
struct Readings {
  std::string path;
  std::string machine;  // path as named in the file; empty: not named
  std::vector<Instrument> instruments;
  std::vector<Artefact> artefacts;
  std::vector<Group> groups;
  Joints lower = Joints::Constant(-std::numeric_limits<double>::infinity());  // travel (m, rad)
  Joints upper = Joints::Constant(std::numeric_limits<double>::infinity());   // infinite: endless,
                                                                              // or not known
};

/// "laser.csv:7", the place of a row.
std::string place_of(const Group& group, const Reading& reading);

/// A plan of what to measure has no numbers yet.
enum class Numbers : std::uint8_t { required, ignored };

/// Reads the groups and their files.
/// @param chain  of the machine that was measured; rows must name no axis that it lacks
/// @param lower, upper  travel (5; m, rad); a row beyond it is a fault
/// @throws InputError with all faults at once
Readings read_readings(const std::string& path, const plant::MachineChain& chain,
                       const Joints& lower, const Joints& upper,
                       Numbers numbers = Numbers::required);

/// The machine file that a file of readings names, relative to the folder of that file; empty:
/// none.
/// @throws InputError if the file cannot be read
std::string named_machine(const std::string& path);

/// Largest deviation that counts as one; beyond it the unit is taken to be wrong.
inline constexpr double kLargestDeviation = 5e-3;  // m
inline constexpr double kLargestAngle = 50e-3;     // rad

}  // namespace servomill::sim::readings
