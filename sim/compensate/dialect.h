/// How other controls than LinuxCNC say what a program of straight blocks asks for.
///
/// | | blocks | numbers | source |
/// |---|---|---|---|
/// | Heidenhain conversational | `12 L X+10 Y-3.5 R0 FMAX M3` | 0.1 um, 0.0001 deg | User's Manual
/// iTNC 530 | | Fanuc | `N12 G0 X10. Y-3.5` | 0.1 um (IS-C), 0.0001 deg | Operator's Manual 30i |
/// | Siemens 840D | `N12 G0 X10 Y-3.5` | 10 nm, 0.00001 deg | Programming Manual, Fundamentals |
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/move.h"
#include "sim/compensate/compensate.h"

namespace servomill::sim {

/// Positions of one block, in mm and deg.
struct DialectMotion {
  bool is_rapid = false;
  bool is_place = false;  // of the machine: without work offset and tool length
  std::vector<std::pair<Axis, double>> words;
  double feed = 0.0;        // mm/min or deg/min; 1/min with is_inverse
  bool is_inverse = false;  // G93
};

/// What a dialect cannot say, as a part of a sentence.
struct Unsayable {
  std::string why;
};

/// Lines without numbers; a DialectPrinter knows what is in force. Functions throw Unsayable.
class DialectPrinter {
 public:
  explicit DialectPrinter(std::vector<std::string>& lines) : lines_(lines) {}
  virtual ~DialectPrinter() = default;

  virtual int decimals() const = 0;  // of mm and deg
  virtual void begin(const std::string& name, const std::vector<std::string>& header) = 0;
  /// In as many lines as it takes.
  void comment(std::string_view text);
  virtual void message(std::string_view text) { comment(text); }
  virtual void motion(const DialectMotion& motion) = 0;
  /// G54 is 1. Known to be in force at the start.
  virtual void work_system(int system) = 0;
  /// @param offset  number of the tool whose length is in force; 0: none
  /// @param tool    in the spindle
  virtual void tool_length(int offset, int tool) = 0;
  virtual void path_mode(PathMode mode, double tolerance) = 0;
  virtual void preselect(int tool) = 0;
  virtual void tool(int number, double rpm) = 0;
  virtual void spindle(int direction, double rpm) = 0;
  virtual void coolant(int code) = 0;  // 7, 8, 9
  virtual void dwell(double seconds) = 0;
  virtual void stop(int code) = 0;  // 0, 1
  virtual void end() = 0;           // M30

  /// The whole text, numbered.
  virtual std::string text(const std::string& name) const = 0;

 protected:
  virtual void put_comment(std::string_view text) = 0;
  void put(std::string line) { lines_.push_back(std::move(line)); }
  std::vector<std::string>& lines_;
};

/// @pre dialect is not linuxcnc
std::unique_ptr<DialectPrinter> make_dialect(Dialect dialect, std::vector<std::string>& lines);

}  // namespace servomill::sim
