// Heidenhain conversational: user's manuals TNC 426/430 and iTNC 530.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "controllers/gcode/number_text.h"
#include "sim/programs/compensate/dialect.h"
#include "sim/programs/compensate/iso_dialect.h"

namespace servomill::sim::programs {
namespace {

using controllers::fixed_text;

constexpr int kDecimals = 3;                 // of F and S: TNC 430 p. 468
constexpr double kLongestDwell = 3600.0;     // s, TNC 430 p. 468
constexpr double kMaxPosition = 99999.9999;  // mm, TNC 430 p. 468

class Heidenhain final : public DialectPrinter {
 public:
  using DialectPrinter::DialectPrinter;

  void begin(const std::vector<std::string>& header) override {
    put(fmt::format("BEGIN PGM {} MM", settings_.name));
    for (const std::string& line : header) comment(line);
    put("CYCL DEF 7.0 DATUM SHIFT");
    for (std::size_t i = 0; i < settings_.axes.size(); ++i) {
      put(fmt::format("CYCL DEF 7.{} {}+0", i + 1, letter(settings_.axes[i])));
    }
    for (const char* line :
         {"CYCL DEF 8.0 MIRROR IMAGE", "CYCL DEF 8.1", "CYCL DEF 10.0 ROTATION",
          "CYCL DEF 10.1 ROT+0", "CYCL DEF 11.0 SCALING", "CYCL DEF 11.1 SCL 1",
          // TNC 620 cycle programming (340 56x-02) p. 256: a factor of 1 for the same axis
          "CYCL DEF 26.0 AXIS-SPECIFIC SCALING", "CYCL DEF 26.1 X 1 Y 1 Z 1"}) {
      put(line);
    }
    path_mode(PathMode::continuous, 0.0);
    if (settings_.has_rotary_axes) {
      put("PLANE RESET STAY");
      put("M129");  // ends M128: TNC 410, 426, 430 ISO manual p. 169
      put("M127");  // rotary axes as programmed, not on the shorter path
      put("M117");  // F of rotary axes in deg/min: TNC 410, 426, 430 ISO manual p. 164
    }
    put("M137");  // feeds per minute: TNC 410, 426, 430 ISO manual p. 159
    if (settings_.preset) {
      put("CYCL DEF 247 DATUM SETTING");
      put(fmt::format("Q339=+{} ; DATUM NUMBER", *settings_.preset));
    }
    put(fmt::format("L {} R0 FMAX M91", retract_word()));
  }
  void put_comment(std::string_view text) override { put("; " + plain(text, false)); }

  bool takes_arc(const DialectMotion& motion) const override { return motion.arc->is_in_XY(); }
  std::string_view why_lines() const override {
    return "circles are in the plane normal to the tool axis (TNC 407 manual p. 5-20)";
  }

  // Cycle 32 without a tolerance takes that of the machine, MP1096 (technical manual TNC 426/430
  // p. 7-30; that the tolerance may be missing: M).
  void put_smoothing(bool is_on) override {
    path_mode(PathMode::continuous, is_on ? settings_.smoothing : 0.0);
  }

  // A helix turns by an angle about CC (TNC 430 p. 153).
  void turn_by_angle(const DialectMotion& motion, const AxisWords& begin,
                     AxisWords& end) const override {
    if (!motion.names(Axis::Z)) return;
    const Eigen::Vector2d centre(as_printed(motion.arc->centre.x(), Axis::X) * mm,
                                 as_printed(motion.arc->centre.y(), Axis::Y) * mm);
    const double angle = std::stod(angle_text(*motion.arc)) * deg;
    end.head<2>() = centre + Eigen::Rotation2Dd(angle) * (begin.head<2>() - centre);
  }

  void motion(const DialectMotion& motion) override {
    check_positions(motion, kMaxPosition);
    if (!motion.is_place) check_frame(motion);
    check_rotation(motion);
    // "Straight line at rapid traverse" is G00: iTNC 530 (60642x-03) ISO p. 211. Of FMAX none was
    // found.
    if (motion.may_leave_its_line()) {
      assume(
          "rapids of several axes are collision-free off their line (FMAX may not "
          "be straight)");
    }
    if (motion.arc) {
      const Eigen::Vector3d& centre = motion.arc->centre;
      put("CC" + words({{Axis::X, centre.x()}, {Axis::Y, centre.y()}}));
    }
    std::string text = motion.arc ? arc_text(motion) : "L" + words(motion.words);
    if (motion.arc) add_word(text, motion.arc->is_counter_clockwise ? "DR+" : "DR-");
    if (!has_R0_) add_word(text, "R0");
    has_R0_ = true;
    add_word(text, feed_word(motion));
    if (motion.is_place) {
      add_word(text, "M91");
      assume("machine coordinates have the same zero as in the original");
    }
    put(text);
  }

  // Touch probe cycle 0; feed and range are those of the control's table of touch probes (M).
  void probe(const DialectMotion& motion, const DialectMotion& from) override {
    check_positions(from, kMaxPosition);
    const auto& [axis, to] = motion.words.front();
    const auto begin = std::find_if(from.words.begin(), from.words.end(),
                                    [axis = axis](const auto& word) { return word.first == axis; });
    put(fmt::format("TCH PROBE 0.0 REF. PLANE Q5 {}{}", letter(axis),
                    to > begin->second ? '+' : '-'));
    put("TCH PROBE 0.1" + words(from.words));
    assume(fmt::format("the table of touch probes has a feed and a range of {:g} mm or more",
                       std::abs(to - begin->second)));
  }
  void report_touch() override {
    put("FN 16: F-PRINT TOUCH.A / TNC:\\TOUCHES.TXT");
    assume("TOUCH.A is a mask that prints Q115, Q116 and Q117");
  }

  void retract() override {
    put(fmt::format("L {} R0 FMAX M91", retract_word()));
    has_R0_ = true;
  }

  void path_mode(PathMode mode, double tolerance) override {
    if (mode != PathMode::continuous) {
      throw Unsayable{"needs exact stops (G61, G61.1), which the control cannot set; use G64"};
    }
    put("CYCL DEF 32.0 TOLERANCE");
    put(tolerance > 0.0 ? "CYCL DEF 32.1 T" + fixed_text(tolerance / mm, 4) : "CYCL DEF 32.1");
  }
  void preselect(int tool) override { put(fmt::format("TOOL DEF {}", tool)); }
  void tool(int number, double rpm, int) override {
    S_.reset();
    std::string text = fmt::format("TOOL CALL {} Z", number);
    if (rpm > 0.0) {
      S_ = fixed_text(rpm, kDecimals);
      text += " S" + *S_;
    }
    put(text);
    has_R0_ = false;
    F_.reset();
    tool_ = number;
    rotary_.clear();
    direction_ = 0;
  }
  void spindle(int direction, double rpm, bool is_named) override {
    if (const std::string S = fixed_text(rpm, kDecimals); rpm > 0.0 && S_ != S) {
      put("TOOL CALL S" + S);
      S_ = S;
    }
    if (is_named || direction_ != direction) {
      put(direction > 0 ? "L M3" : direction < 0 ? "L M4" : "L M5");
    }
    direction_ = direction;
  }
  bool is_spindle_known() const override { return direction_.has_value(); }
  bool has_optional_blocks() const override { return false; }
  void coolant(int code) override {
    if (code == 7)
      throw Unsayable{
          "switches mist (M7), which is defined by the machine builder; use M8, or remove it"};
    put(fmt::format("L M{}", code));
  }
  void dwell(double seconds) override {
    if (seconds > kLongestDwell) {
      throw Unsayable{fmt::format("dwells for {:g} s, more than 3600 s", seconds)};
    }
    put("CYCL DEF 9.0 DWELL TIME");
    put("CYCL DEF 9.1 DWELL " + fixed_text(seconds, kDecimals));
  }
  void stop(int code) override {
    put(fmt::format("L M{}", code));
    if (direction_ != 0) direction_.reset();  // M0 and M1 stop the spindle (TNC 155 p. 15)
  }
  void end() override { put("L M30"); }

  std::string text() const override {
    std::string out;
    std::size_t number = 0;
    for (const std::string& line : lines_) {
      if (line.starts_with("Q339")) {  // continues its block
        out.insert(out.size() - 1, " ~");
        out += "    " + line + "\n";
        continue;
      }
      out += fmt::format("{} {}\n", number++, line);
    }
    return out + fmt::format("{} END PGM {} MM\n", number, settings_.name);
  }

 private:
  static std::string signed_number(double value, int decimals) {
    const std::string number = fixed_text(value, decimals);
    return (number.front() == '-' ? "" : "+") + number;
  }
  std::string retract_word() const {
    return "Z" + signed_number(settings_.retract_Z / mm, decimals(Axis::Z));
  }
  double as_printed(double value, Axis axis) const {
    return std::stod(fixed_text(value, decimals(axis)));
  }
  std::string words(const std::vector<std::pair<Axis, double>>& all) const {
    std::string out;
    for (const auto& [axis, value] : all) {
      out += fmt::format(" {}{}", letter(axis), signed_number(value, decimals(axis)));
    }
    return out;
  }

  static std::string angle_text(const DialectArc& arc) {
    constexpr int kAngleDecimals = 4;  // TNC 430 p. 468
    return fixed_text(arc.sweep / deg, kAngleDecimals);
  }
  std::string arc_text(const DialectMotion& motion) const {
    if (!motion.names(Axis::Z)) return "C" + words(motion.words);
    const auto Z = std::find_if(motion.words.begin(), motion.words.end(),
                                [](const auto& word) { return word.first == Axis::Z; });
    const bool is_positive = motion.arc->sweep > 0.0;
    return fmt::format("CP IPA{}{}{}", is_positive ? "+" : "", angle_text(*motion.arc),
                       words({*Z}));
  }

  void check_frame(const DialectMotion& motion) {
    if (motion.work_system != 1) {
      throw Unsayable{
          "selects a work offset other than G54; write one program per offset, with its --preset"};
    }
    if (!settings_.preset) assume("the active preset is G54");
    // No manual was found that describes how these end; scaling: TNC 410 p. 186, TNC 620 p. 256
    assume(settings_.has_rotary_axes
               ? "CYCL DEF 7, 8, 10 and PLANE RESET cancel shift, mirror image, rotation and tilt"
               : "CYCL DEF 7, 8 and 10 cancel shift, mirror image and rotation");
    if (!tool_) {
      throw Unsayable{
          "moves before a tool call; the control takes tool axis and length from the tool call: "
          "program T... M6 first"};
    }
    if (!motion.names(Axis::Z)) return;
    if (motion.length != motion.tool) {
      throw Unsayable{
          fmt::format("moves with the length of tool {0} while tool {1} is active; the control "
                      "uses the length of the active tool: program G43 H{1}",
                      motion.length, motion.tool)};
    }
    if (motion.length != 0) {
      assume(fmt::format("the tool table contains the length of tool {}", motion.length));
    }
  }

  // From a half turn on, some controls take the shorter path (MP7682, iTNC 530 manual p. 520).
  void check_rotation(const DialectMotion& motion) {
    constexpr double kHalfTurn = 180.0;
    for (const auto& [axis, value] : motion.words) {
      if (is_linear(axis)) continue;
      const auto before = rotary_.find(axis);
      if (before != rotary_.end() && std::abs(value - before->second) >= kHalfTurn) {
        throw Unsayable{
            fmt::format("rotates {} by {:g} deg in one block, for which some controls take the "
                        "shorter direction; split it",
                        letter(axis), std::abs(value - before->second))};
      }
      rotary_[axis] = value;
    }
  }

  std::string feed_word(const DialectMotion& motion) {
    if (motion.is_rapid) return "FMAX";
    if (motion.feed_mode == FeedMode::inverse_time) {
      warn("G93 is output as FT, in seconds, which is undocumented: test it before use");
      F_.reset();
      return "FT" + rate(60.0 / motion.feed, kDecimals, "FT");
    }
    if (motion.feed_mode == FeedMode::units_per_revolution) {
      F_.reset();  // how long FU holds was not found in a manual
      return "FU" + rate(motion.feed, kDecimals, "FU");
    }
    const std::string F = "F" + rate(motion.feed, kDecimals, "F");
    if (F_ == F) return "";
    F_ = F;
    return F;
  }

  bool has_R0_ = true;
  std::optional<std::string> F_, S_;
  std::optional<int> direction_ = 0, tool_;
  std::map<Axis, double> rotary_;  // deg, as written last
};

}  // namespace

std::unique_ptr<DialectPrinter> make_heidenhain(const DialectSettings& settings,
                                                std::vector<std::string>& lines) {
  return std::make_unique<Heidenhain>(settings, lines);
}

}  // namespace servomill::sim::programs
