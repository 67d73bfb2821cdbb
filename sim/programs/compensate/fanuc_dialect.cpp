// Fanuc, Series 0i-MB and 30i: Operator's Manuals B-63844EN/02 and B-63944EN.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/gcode/number_text.h"
#include "sim/programs/compensate/iso_dialect.h"

namespace servomill::sim::programs {
namespace {

using controllers::fixed_text;

constexpr std::size_t kMaxNumbered = 9999;   // blocks; in longer programs every 1000th
constexpr double kMaxPosition = 99999.999;   // eight digits on IS-B (M)
constexpr double kLongestDwell = 99999.999;  // s, B-63844EN/02, dwell

class Fanuc final : public IsoDialect {
 public:
  Fanuc(const DialectSettings& settings, std::vector<std::string>& lines)
      : IsoDialect(settings, lines) {
    for (const FanucFunction& one : kFanucFunctions) {
      if (settings.lacks(one.name)) assume(std::string(one.absent));
    }
  }

  // G20 and G21 change origin offsets and compensation: the unit of the program stays (B-63944EN
  // p. 192).
  bool set_inches(bool is_inch) override {
    is_inch_ = is_inch;
    return true;
  }

  void begin(const std::vector<std::string>& header) override {
    put(fmt::format("O{:04} ({})", settings_.program_number, plain(settings_.name, true)));
    for (const std::string& line : header) comment(line);
    put(is_inch_ ? "G20" : "G21");  // in a block of its own: B-63944EN p. 192
    const auto put_unless = [&](std::string_view function, std::string line) {
      if (!settings_.lacks(function)) put(std::move(line));
    };
    put("G17 G40 G64 G80 G90 G94");
    // Ends of rotation and scaling: B-63944EN-2/02 p. 211; of polar coordinates: Series 16/18-C,
    // operator's manual for machining centers, section 9.2; of the others none was found (M).
    put_unless("surface-speed", "G97");
    put("G69");
    put_unless("polar", "G15");
    put_unless("scaling", "G50");
    put_unless("mirror", "G50.1" + zeros());
    put("G52" + zeros());
    put_unless("preset", "G92.1" + zeros());
    put(retract_text());
  }
  void put_comment(std::string_view text) override { put(fmt::format("({})", plain(text, true))); }

  // In a block of its own; its tolerance is the control's (B-63944EN, contour control of G5.1; M)
  void put_smoothing(bool is_on) override {
    put(is_on ? "G5.1 Q1" : "G5.1 Q0");
    warn(fmt::format("G5.1 Q1 has no tolerance: set the control's to {:g} mm",
                     settings_.smoothing / mm));
  }

  bool takes_arc(const DialectMotion& motion) const override {
    const bool is_in_XY = motion.arc->is_in_XY();
    if (!is_in_XY && !settings_.lacks("length-b")) return false;
    return (is_in_XY && !motion.names(Axis::Z)) || modes_.length == motion.length;
  }
  // B-63943EN-1/02 p. 1654: type A acts along Z, type B along one of X, Y and Z. That the length
  // stays on Z when the plane changes after its G43 was found for a control like it only
  // (Milltronics, system information, p. 253).
  std::string_view why_lines() const override {
    return "the tool length may follow a change of the plane (No. 5001#1, TLB, may be 1; --without "
           "length-b)";
  }

  void motion(const DialectMotion& motion) override {
    check_positions(motion, kMaxPosition);
    assume_ways(motion);
    check_rotation(motion);
    if (motion.is_place) return place(motion);
    if (modes_.work_system != motion.work_system) work_system(motion.work_system);
    std::string prefix = plane_text(motion);
    if (motion.names(Axis::Z)) {
      if (motion.length == 0 && modes_.length != 0) cancel_length(motion);
      // G53, G28 and G30 cancel the length while G43 stays displayed (B-63844EN/02 p. 204); with
      // EVO, No. 5001#6, = 0 only a new G43 H restores it (M)
      if (modes_.length != motion.length) {
        add_word(prefix, fmt::format("G43 H{}", motion.length));
        assume(fmt::format("H{} contains the length of tool {}", motion.length, motion.tool));
      }
      modes_.length = motion.length;
    }
    if (!motion.arc || motion.arc->share == 1.0) return put(motion_text(motion, prefix));
    DialectMotion helix = motion;
    helix.feed *= motion.arc->share;  // F is the rate along the arc (M)
    put(motion_text(helix, prefix));
  }

  // G31 is one-shot: G0 or G1 stay in force (Series 15i/150i-MA, Programming, p. 564).
  void probe(const DialectMotion& motion, const DialectMotion&) override {
    check_positions(motion, kMaxPosition);
    const auto code = modes_.code;
    modes_.code = "G1";
    std::string text = motion_text(motion, "G31");
    modes_.code = code;
    put(std::move(text));
    assume("the probe acts as the skip signal of G31, and stops axes at this feed in its travel");
  }
  void report_touch() override {
    if (!reports_) put("POPEN");
    reports_ = true;
    put("DPRNT[X#5061[53]*Y#5062[53]*Z#5063[53]]");
    assume(
        "custom macro B outputs #5061 to #5063, the position at the skip signal, to the interface");
  }
  void end_report() override { put("PCLOS"); }

  void retract() override {
    put(retract_text());
    modes_.code = "G0";
    modes_.length = 0;
  }

  bool reference_Z() override {
    // the macro of a tool change may leave any motion code behind
    put(modes_.code ? "G91 G28 Z0." : "G0 G91 G28 Z0.");
    if (!modes_.code) modes_.code = "G0";
    put("G90");
    modes_.length.reset();
    return true;
  }

  void path_mode(PathMode mode, double tolerance) override {
    if (mode == PathMode::exact_path) throw Unsayable{std::string(kExactPath)};
    if (tolerance > 0.0)
      warn("G64 P: the tolerance is omitted; smoothing is set by G5.1 on this control");
    put(mode == PathMode::exact_stop ? "G61" : "G64");
  }
  void preselect(int tool) override { put(fmt::format("T{}", tool)); }
  void tool(int number, double, int system) override {
    put(fmt::format("T{} M6", number));
    assume("T and M6 in one block change the tool, T first");
    forget_modes();
    modes_.feed_mode = FeedMode::units_per_minute;
    modes_.work_system = system;
    normal_axis_ = 2;
    rotary_ = {};
    put(fmt::format("G90 {} G17 G94 G40 G80 G64", system_code(system)));
  }
  void stop(int code) override {
    IsoDialect::stop(code);
    rotary_ = {};
  }
  // X of G4 counts revolutions under G95 where DWL, No. 3405#1, is 1 (M)
  void end_optional() override {
    IsoDialect::end_optional();
    if (normal_axis_ != normal_before_) {
      throw Unsayable{"the active plane depends on blocks with '/'; program arcs in G17 there"};
    }
    for (std::size_t i = 0; i < rotary_.size(); ++i) {
      if (rotary_[i] != rotary_before_[i]) rotary_[i].reset();
    }
  }
  void begin_optional() override {
    IsoDialect::begin_optional();
    rotary_before_ = rotary_;
    normal_before_ = normal_axis_;
  }
  void dwell(double seconds) override {
    if (seconds > kLongestDwell) {
      throw Unsayable{fmt::format("dwells for {:g} s, more than {:g} s", seconds, kLongestDwell)};
    }
    std::string text;
    if (modes_.feed_mode != FeedMode::units_per_minute) {
      text = "G94";
      modes_.feed_mode = FeedMode::units_per_minute;
      modes_.F.reset();
    }
    add_word(text, "G4 X" + number(fixed_text(seconds, 3)));
    put(text);
  }

  std::string text() const override {
    std::string out = "%\n";
    std::size_t blocks = 0;
    for (const std::string& line : lines_) blocks += is_numbered(line) ? 1 : 0;
    const std::size_t step = blocks > kMaxNumbered ? 1000 : 1;
    std::size_t n = 0;
    for (const std::string& line : lines_) {
      const bool has_number = is_numbered(line) && n++ % step == 0;
      out += has_number ? numbered(line, fmt::format("N{}", (n - 1) / step + 1)) : line + "\n";
    }
    return out + "%\n";
  }

 private:
  bool reports_ = false;
  // Motions to an end point that no block can express.
  void assume_ways(const DialectMotion& motion) {
    // B-63844EN/02 p. 48
    if (motion.may_leave_its_line()) {
      assume(
          "rapids of several axes are collision-free off their line (No. 1401#1, "
          "LRP, may be 0)");
    }
  }

  // An axis that rolls over goes the shorter way to the same angle (No. 1008#0, ROA, 1 and #1, RAB,
  // 0: B-63534EN/02 p. 531), one that does not the way of its count: below half a turn that is the
  // same.
  void check_rotation(const DialectMotion& motion) {
    constexpr double kHalfTurn = 180.0;
    if (settings_.lacks("rollover")) return;
    for (const auto& [axis, value] : motion.words) {
      const int i = index_of(axis) - kLinearJoints;
      if (i < 0 || !settings_.is_endless[static_cast<std::size_t>(i)]) continue;
      const auto system = static_cast<std::size_t>(std::max(motion.work_system, 1) - 1);
      const double origin =
          motion.is_place ? 0.0 : settings_.work_offset[system][index_of(axis)] / deg;
      std::optional<double>& before = rotary_[static_cast<std::size_t>(i)];
      const double way = before ? std::abs(origin + value - *before) : 0.0;
      if (way >= kHalfTurn) {
        throw Unsayable{
            fmt::format("rotates {} by {:g} deg in one block, for which a control with rollover "
                        "axes (No. 1008#0, ROA = 1) takes the shorter direction; split it, or pass "
                        "--without rollover if ROA = 0",
                        letter(axis), way)};
      }
      before = origin + value;
      assume(
          fmt::format("{}, if it rolls over (No. 1008#0, ROA), takes the shorter direction (#1, "
                      "RAB, and #3, RAA, are 0)",
                      letter(axis)));
    }
  }

  // X0. Y0. Z0., and so on for every axis.
  std::string zeros() const {
    std::string out;
    for (const Axis axis : settings_.axes) out += fmt::format(" {}0.", letter(axis));
    return out;
  }

  // G17 comes back with the next block that is no arc in another plane.
  std::string plane_text(const DialectMotion& motion) {
    const int normal = motion.arc ? motion.arc->path.c : 2;
    if (normal_axis_ == normal) return {};
    normal_axis_ = normal;
    return fmt::format("G{}", 19 - normal);
  }

  static bool is_numbered(const std::string& line) {
    return line.front() != 'O' && line.front() != '(';
  }

  // G49 alone moves Z by the old length where length works by axis motion, TOS, No. 5006#6, = 0
  // (B-63943EN-1/02 p. 1654); with G53 it is cancelled safely (B-63844EN/02 p. 204).
  std::string retract_text() const {
    const double Z = settings_.retract_Z / unit(Axis::Z);
    return "G90 G49 G53 G0 Z" + number(fixed_text(Z, decimals(Axis::Z)));
  }

  // By way of the retracted height, which no cut can take.
  void cancel_length(const DialectMotion& motion) {
    const bool is_in_force = motion.is_Z_known && modes_.length != 0;
    if (!motion.is_rapid || motion.words.size() > 1 || is_in_force) {
      throw Unsayable{
          "moves Z after the tool length was cancelled (G49 after G43), which is safe on the "
          "control only after a retract; program G53 G0 Z... before G49"};
    }
    retract();
  }

  void place(const DialectMotion& motion) {
    if (!motion.is_rapid)
      throw Unsayable{
          "feeds in machine coordinates (G53 G1), but G53 is always a rapid there; use G53 G0, or "
          "feed in work coordinates"};
    assume("machine coordinates have the same zero as in the original");
    const bool has_Z = motion.names(Axis::Z);
    modes_.code.reset();
    put(motion_text(motion, has_Z ? "G90 G49 G53" : "G53"));
    if (has_Z) {
      modes_.length = 0;
    } else if (modes_.length != 0) {
      modes_.length.reset();
    }
  }

  static std::string system_code(int system) {
    if (system > 6) {
      throw Unsayable{"selects G59.1 ... G59.3; use one of G54 ... G59"};
    }
    return fmt::format("G{}", 53 + system);
  }
  void work_system(int system) {
    put(system_code(system));
    modes_.work_system = system;
  }

  // A number without point counts in increments.
  std::string number(std::string text) const override {
    return text.find('.') == std::string::npos ? text + "." : text;
  }
  std::string speed(double rpm) const override { return fmt::format("{:.0f}", std::round(rpm)); }

  int normal_axis_ = 2, normal_before_ = 2;  // of the plane in force; before '/'
  // deg of the machine, as written last; before '/'
  std::array<std::optional<double>, 3> rotary_, rotary_before_;
};

}  // namespace

std::unique_ptr<DialectPrinter> make_fanuc(const DialectSettings& settings,
                                           std::vector<std::string>& lines) {
  return std::make_unique<Fanuc>(settings, lines);
}

}  // namespace servomill::sim::programs
