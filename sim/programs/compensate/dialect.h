/// Programs for other controls than LinuxCNC: lines, modes in force, safe frames.
///
/// | | blocks | numbers | source |
/// |---|---|---|---|
/// | Heidenhain | `12 L X+10 Y-3.5 R0 FMAX M3` | 1 um, 0.001 deg | TNC 426/430, iTNC 530 manuals |
/// | Fanuc | `N12 G0 X10. Y-3.5` | 1 um, 0.001 deg (IS-B) | B-63844EN/02, B-63944EN |
/// | Siemens 840D | `N12 G0 X10 Y-3.5` | 10 nm, 0.00001 deg | 6FC5397-0BP10-2BA0 |
///
/// "M" marks a rule that was not found in a manual.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/move.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::programs {

enum class Dialect : std::uint8_t { linuxcnc, heidenhain, fanuc, siemens };
inline constexpr std::array<std::string_view, 4> kDialects = {"linuxcnc", "heidenhain", "fanuc",
                                                              "siemens"};

/// Functions and settings that Fanuc controls may have and a control, on the user's word, has not.
/// By default every mode is ended that may be in force: where its function is missing, the code is
/// an alarm before anything moves.
struct FanucFunction {
  std::string_view name, absent;  // the latter as a clause
};
inline constexpr std::array<FanucFunction, 7> kFanucFunctions = {{
    {"polar", "the control has no polar coordinate command (G16), so that G15 is omitted"},
    {"scaling", "the control has no scaling (G51), so that G50 is omitted"},
    {"mirror", "the control has no mirror image by G51.1, so that G50.1 is omitted"},
    {"surface-speed", "the control has no constant surface speed (G96), so that G97 is omitted"},
    {"preset", "no G92 has shifted the work systems, so that G92.1 is omitted"},
    {"rollover", "rotary axes count beyond 360 deg (No. 1008#0, ROA, is 0)"},
    {"length-b", "the tool length acts along Z in every plane (No. 5001#1, TLB, is 0)"},
}};

/// Everything but the moves that a program for another control needs.
struct DialectSettings {
  Dialect dialect = Dialect::fanuc;
  std::string name;                      // of the program, as its file is called
  int program_number = 0;                // Fanuc: O
  double resolution = 1e-6;              // m; a power of ten
  std::array<AxisWords, 9> work_offset;  // m, rad: as the operator has entered them, from G54 on
  double retract_Z = 0.0;                // m, machine coordinate
  bool has_rotary_axes = false;          // of the machine
  std::array<bool, 3> is_endless{};      // A, B, C: without ends of travel
  std::array<std::optional<double>, 3> rotary_start{};   // A, B, C: rad, machine, where known
  std::vector<Axis> axes = {Axis::X, Axis::Y, Axis::Z};  // of the machine
  std::optional<int> preset;         // Heidenhain: number in the preset table that is activated
  double smoothing = 0.0;            // m, tolerance of the control's smoothing; 0: not set
  std::vector<std::string> without;  // names of kFanucFunctions

  bool lacks(std::string_view function) const;
};

/// An arc in the plane of two linear axes, or a helix. In the units of positions.
struct DialectArc {
  ArcSweep path;
  bool is_counter_clockwise = false;  // about the positive normal
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), from_begin = Eigen::Vector3d::Zero();
  double sweep = 0.0;  // rad, counter-clockwise positive
  double share = 1.0;  // of the length of the path: the arc without its normal

  bool is_in_XY() const { return path.c == 2; }
};

/// Positions of one block, in mm (inch in inch programs) and deg.
struct DialectMotion {
  bool is_rapid = false;
  bool is_place = false;  // of the machine: without work offset and tool length
  std::vector<std::pair<Axis, double>> words;
  std::optional<DialectArc> arc;
  FeedMode feed_mode = FeedMode::units_per_minute;
  double feed = 0.0;        // mm/min or deg/min, mm or deg a revolution, 1/min
  int work_system = 1;      // 1: G54
  int length = 0;           // number of the tool whose length is in force; 0: none
  int tool = 0;             // in the spindle
  bool is_Z_known = false;  // before it

  bool names(Axis axis) const;
  /// A rapid whose axes may arrive one after the other, off the line between its ends.
  bool may_leave_its_line() const { return is_rapid && words.size() > 1; }
  bool rises() const { return arc && names(kAllAxes[static_cast<std::size_t>(arc->path.c)]); }
};

/// A thing that a dialect cannot express, as a part of a sentence.
struct Unsayable {
  std::string why;
};

/// Writes lines without numbers and keeps account of what is in force at the control. Functions
/// throw Unsayable.
class DialectPrinter {
 public:
  DialectPrinter(const DialectSettings& settings, std::vector<std::string>& lines)
      : settings_(settings), lines_(lines) {}
  virtual ~DialectPrinter() = default;

  int decimals(Axis axis) const;
  /// m or rad
  double unit(Axis axis) const;
  /// @return false where positions of the program are in mm all the same
  virtual bool set_inches(bool) { return false; }

  /// Header and the first blocks, which bring any control into one state: the state that a printer
  /// begins with.
  virtual void begin(const std::vector<std::string>& header) = 0;
  /// In as many lines as it takes.
  void comment(std::string_view text);
  virtual void message(std::string_view text) { comment(text); }
  virtual void motion(const DialectMotion& motion) = 0;
  /// True if the arc can be written as one: not in a block that changes the tool length.
  virtual bool takes_arc(const DialectMotion& motion) const = 0;
  /// Reason for which arcs outside the XY plane become lines, as the rest of a sentence.
  virtual std::string_view why_lines() const = 0;
  /// A line along one axis until the probe switches; rapid and feed are as in `motion`.
  /// @param from  X, Y and Z that it begins at, where the axes stand
  virtual void probe(const DialectMotion& motion, const DialectMotion& from) = 0;
  /// Blocks in front of the program that the control needs to put out numbers.
  virtual void begin_report() {}
  /// Position of the last touch put out to a file or interface.
  virtual void report_touch() = 0;
  virtual void end_report() {}
  /// Sets the end of the arc of `motion`, if the control computes it from an angle.
  virtual void turn_by_angle(const DialectMotion&, const AxisWords&, AxisWords&) const {}
  /// Z to settings.retract_Z, without tool length.
  virtual void retract() = 0;
  /// G28 of Z alone. @return false if Z is at settings.retract_Z, true if at the control's
  /// reference
  virtual bool reference_Z() {
    retract();
    return false;
  }
  virtual void path_mode(PathMode mode, double tolerance) = 0;
  virtual void preselect(int tool) = 0;
  /// Everything but units is unknown behind it and restated.
  /// @param work_system  in force behind it
  virtual void tool(int number, double rpm, int work_system) = 0;
  /// @param is_named  the program names the direction (M3, M4, M5): it is written in any case
  virtual void spindle(int direction, double rpm, bool is_named) = 0;
  /// False if the control may have stopped the spindle by itself.
  virtual bool is_spindle_known() const = 0;
  virtual void coolant(int code) = 0;  // 7, 8, 9
  virtual void dwell(double seconds) = 0;
  virtual void stop(int code) = 0;  // 0, 1
  virtual void end() = 0;           // M30
  /// The control's smoothing of short blocks, where it is wanted: not in force at tool changes,
  /// stops, machine positions and the end.
  void begin_smoothing();
  void end_smoothing();

  /// False if no manual says how the control writes blocks with '/'.
  virtual bool has_optional_blocks() const { return true; }
  /// Blocks with '/' are between these. Behind them is unknown whatever they have changed.
  virtual void begin_optional() {}
  virtual void end_optional() {}

  /// The whole text, numbered.
  virtual std::string text() const = 0;
  /// Things that the operator has to make sure of, one clause each.
  void assume(std::string clause);
  const std::vector<std::string>& assumptions() const { return assumptions_; }
  const std::vector<std::string>& warnings() const { return warnings_; }

 protected:
  virtual void put_comment(std::string_view text) = 0;
  virtual void put_smoothing(bool is_on) = 0;
  void put(std::string line) { lines_.push_back(std::move(line)); }
  void warn(std::string sentence);
  /// A feed or a speed. @throws Unsayable if nothing of it stays
  std::string rate(double x, int decimals, std::string_view name) const;
  void check_positions(const DialectMotion& motion, double most) const;

  const DialectSettings& settings_;
  std::vector<std::string>& lines_;
  bool is_inch_ = false;

 private:
  bool smooths_ = false;
  std::vector<std::string> assumptions_, warnings_;
};

/// Letters and signs that every control shows.
std::string plain(std::string_view text, bool is_upper);

/// @pre settings.dialect is not linuxcnc
std::unique_ptr<DialectPrinter> make_dialect(const DialectSettings& settings,
                                             std::vector<std::string>& lines);
std::unique_ptr<DialectPrinter> make_fanuc(const DialectSettings& settings,
                                           std::vector<std::string>& lines);
std::unique_ptr<DialectPrinter> make_siemens(const DialectSettings& settings,
                                             std::vector<std::string>& lines);
std::unique_ptr<DialectPrinter> make_heidenhain(const DialectSettings& settings,
                                                std::vector<std::string>& lines);

}  // namespace servomill::sim::programs
