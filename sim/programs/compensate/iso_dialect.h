/// Common part of controls with G-codes: codes and modes in force.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/programs/compensate/dialect.h"

namespace servomill::sim::programs {

/// LinuxCNC's G61 keeps to the path and stops where it must only; other controls stop at each end.
inline constexpr std::string_view kExactPath =
    "needs the exact path of LinuxCNC's G61; use G61.1 (exact stop) or G64";

class IsoDialect : public DialectPrinter {
 public:
  using DialectPrinter::DialectPrinter;

  void spindle(int direction, double rpm, bool is_named) override;
  bool is_spindle_known() const override { return modes_.direction.has_value(); }
  void coolant(int code) override { put("M" + std::to_string(code)); }
  void stop(int code) override;
  void end() override { put("M30"); }
  void begin_optional() override;
  void end_optional() override;

 protected:
  /// nullopt: unknown.
  struct Modes {
    std::optional<std::string> code = std::nullopt, F = std::nullopt, S = std::nullopt;
    std::optional<FeedMode> feed_mode = FeedMode::units_per_minute;
    std::optional<int> direction = 0;  // of the spindle
    std::optional<int> work_system = std::nullopt;
    std::optional<int> length = 0;  // number of the tool in force

    /// Forgets what is not the same as it was.
    void join(const Modes& before);
  };

  /// G0 or G1, feed mode, positions, feed: of these what is not in force, behind the prefix.
  std::string motion_text(const DialectMotion& motion, std::string_view prefix);
  virtual std::string arc_code(const DialectArc& arc) const;
  /// The centre from the begin of the arc.
  virtual std::string arc_words(const DialectArc& arc) const;
  /// Everything that a tool change may have changed. The spindle has been off before.
  void forget_modes();
  /// A line with its number, which stands behind the '/'.
  static std::string numbered(const std::string& line, const std::string& number);
  virtual std::string number(std::string text) const { return text; }
  virtual std::string position_word(Axis axis, double value);
  virtual int feed_decimals() const { return 3; }
  virtual std::string speed(double rpm) const = 0;

  Modes modes_;

 private:
  Modes before_optional_;
  std::size_t first_optional_ = 0;  // of the lines

  void add_feed_mode(const DialectMotion& motion, std::string& text);
};

/// Adds a word behind a blank.
void add_word(std::string& line, std::string_view word);

}  // namespace servomill::sim::programs
