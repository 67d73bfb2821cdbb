// Siemens 840D: 6FC5397-0BP10-2BA0 (W1, Tool Offset), ISO Dialects Milling 04.07.
#include <fmt/format.h>

#include <cmath>

#include "controllers/gcode/number_text.h"
#include "sim/programs/compensate/iso_dialect.h"

namespace servomill::sim::programs {
namespace {

using controllers::fixed_text;

constexpr std::size_t kMaxNumbered = 99'999'999;  // N has nine digits, tens of them are used
constexpr double kMaxPosition = 999999.999;       // M
constexpr double kMaxTilt = 1e-3;  // mm; of a circle through points, against a plane of two axes

class Siemens final : public IsoDialect {
 public:
  Siemens(const DialectSettings& settings, std::vector<std::string>& lines)
      : IsoDialect(settings, lines) {
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      const auto& start = settings.rotary_start[i];
      if (start) counts_[i] = {*start / deg, 0.0};
    }
    skipped_counts_ = counts_;
  }

  void begin(const std::vector<std::string>& header) override {
    comment(settings_.name);
    for (const std::string& line : header) comment(line);
    put("G17 G40 G64 G90 G94 G710 COMPOF");
    put_frames_off();
    put(retract_text());
  }
  void put_comment(std::string_view text) override { put("; " + plain(text, false)); }
  void message(std::string_view text) override {
    put(fmt::format("MSG(\"{}\")", plain(text, false)));
  }

  // CYCLE832(tolerance, kind, orientation tolerance): 6FC5398-2EP40-0BA0 p. 1108
  void put_smoothing(bool is_on) override {
    put(is_on ? fmt::format("CYCLE832({},1,1)", fixed_text(settings_.smoothing / mm, 5))
              : "CYCLE832(0,0,1)");
  }

  // Tool length acts on G0, G1, POLY and POS only: no arc in a block that changes it (W1 p. 13).
  bool takes_arc(const DialectMotion& motion) const override {
    const bool is_in_XY = motion.arc->is_in_XY();
    const ArcSweep& path = motion.arc->path;
    if (!is_in_XY && std::abs(path.along_end - path.along_begin) > kMaxTilt) return false;
    return (is_in_XY && !motion.names(Axis::Z)) || modes_.length == edge(motion);
  }
  std::string_view why_lines() const override {
    return "G18 may assign the tool length to another axis (SD42940), and CIP cannot describe a "
           "helix";
  }

  void motion(const DialectMotion& motion) override {
    check_positions(motion, kMaxPosition);
    // 6FC5398-2EP40-0BA0 p. 181: G0 under G64 is a line, under G60 where RTLION is in force
    if (stops_at_ends_ && motion.may_leave_its_line()) {
      assume(
          "rapids of several axes are collision-free off their line (G60; RTLIOF may be active)");
    }
    if (motion.is_place) return place(motion);
    if (modes_.work_system != motion.work_system) work_system(motion.work_system);
    // Basic frames act with every settable one (6FC5397-0BP10-0BA0, K2)
    assume("work offsets are given including the basic frame of the control");
    std::string prefix;
    if (motion.names(Axis::Z)) {
      const int wanted = edge(motion);
      if (modes_.length != wanted) prefix = fmt::format("D{}", wanted);
      modes_.length = wanted;
      if (wanted != 0) {
        assume(fmt::format("D1 of tool {} contains its length", motion.tool));
      }
    }
    if (motion.arc && !motion.arc->is_in_XY()) return put_through_point(motion);
    put(motion_text(motion, prefix));
  }

  // Measuring with delete distance-to-go: 840D sl, Programming Manual Job
  // planning 03/2006, 6FC5398-2BP10-1BA0, section 5.7 (p. 5-24).
  void probe(const DialectMotion& motion, const DialectMotion&) override {
    check_positions(motion, kMaxPosition);
    put(motion_text(motion, "MEAS=1"));
    put("STOPRE");
    assume("the touch probe is probe 1 of MEAS");
  }
  void begin_report() override { put("DEF INT NERR"); }
  void report_touch() override {
    put("WRITE(NERR,\"TOUCHES\",$AA_MW[X]<<\" \"<<$AA_MW[Y]<<\" \"<<$AA_MW[Z])");
  }

  void retract() override {
    put(retract_text());
    modes_.code = "G0";
    modes_.length = 0;
  }
  void path_mode(PathMode mode, double tolerance) override {
    if (mode == PathMode::exact_path) throw Unsayable{std::string(kExactPath)};
    stops_at_ends_ = mode == PathMode::exact_stop;
    if (stops_at_ends_) return put("G60");
    put(tolerance > 0.0 ? fmt::format("G642 CTOL={}", fixed_text(tolerance / mm, 5)) : "G64");
  }
  // T may change the tool by itself (MD22550 = 0; W1 p. 33): only with its M6.
  void preselect(int) override {}
  void tool(int number, double, int system) override {
    put(fmt::format("T{}", number));
    put("M6");
    assume("T selects the tool and M6 changes it");
    forget_modes();
    stops_at_ends_ = false;
    forget_counts();
    modes_.feed_mode = FeedMode::units_per_minute;
    modes_.work_system = system;
    put(fmt::format("G17 G40 G64 G90 G94 G710 {}", system_code(system)));
    put_frames_off();
  }
  void stop(int code) override {
    IsoDialect::stop(code);
    forget_counts();
  }
  void begin_optional() override {
    IsoDialect::begin_optional();
    is_optional_ = true;
  }
  void end_optional() override {
    IsoDialect::end_optional();
    is_optional_ = false;
  }
  void dwell(double seconds) override { put("G4 F" + rate(seconds, 4, "dwell")); }

  std::string text() const override {
    std::string out;
    std::size_t blocks = 0;
    for (const std::string& line : lines_) blocks += line.front() != ';' ? 1 : 0;
    const std::size_t step = blocks > kMaxNumbered ? 1000 : 1;
    std::size_t n = 0;
    for (const std::string& line : lines_) {
      const bool has_number = line.front() != ';' && n++ % step == 0;
      out +=
          has_number ? numbered(line, fmt::format("N{}", 10 * ((n - 1) / step + 1))) : line + "\n";
    }
    return out;
  }

 private:
  // TRANS without words: no programmable frame, whatever ROT, SCALE or MIRROR left
  void put_frames_off() {
    put("TRANS");
    if (settings_.has_rotary_axes) put("TRAFOOF");
  }

  // MD10760 decides if G53 and SUPA drop the length: D0 drops it (W1; ISO Dialects p.
  // 3-42).
  std::string retract_text() const {
    return fmt::format("SUPA G0 Z{} D0", fixed_text(settings_.retract_Z / mm, decimals(Axis::Z)));
  }

  // G18 and G19 exchange the components of the tool length where SD42940 is 0 (6FC5398-2EP40-0BA0
  // p. 750). CIP goes through a point in any plane and needs neither (p. 198). More than half a
  // circle is divided: near its begin the end would determine little.
  void put_through_point(const DialectMotion& motion) {
    constexpr double kHalfTurn = 180.01 * deg;
    const int parts = std::abs(motion.arc->sweep) > kHalfTurn ? 2 : 1;
    for (int i = 1; i <= parts; ++i) {
      DialectMotion part = motion;
      const Eigen::Vector3d end = motion.arc->path.point(static_cast<double>(i) / parts);
      if (i < parts) {
        for (auto& [axis, value] : part.words) value = end[index_of(axis)];
      }
      through_ = motion.arc->path.point((i - 0.5) / parts);
      put(motion_text(part, ""));
    }
  }

  std::string arc_code(const DialectArc& arc) const override {
    return arc.is_in_XY() ? IsoDialect::arc_code(arc) : "CIP";
  }
  std::string arc_words(const DialectArc& arc) const override {
    if (arc.is_in_XY()) return IsoDialect::arc_words(arc);
    std::string text;
    for (int i = 0; i < 3; ++i) {
      add_word(text,
               fmt::format("{}1=AC({})", "IJK"[i], fixed_text(through_[i], decimals(Axis::X))));
    }
    return text;
  }

  void place(const DialectMotion& motion) {
    assume("machine coordinates have the same zero as in the original");
    modes_.code.reset();
    is_of_machine_ = true;
    std::string text = motion_text(motion, "SUPA");
    is_of_machine_ = false;
    if (motion.names(Axis::Z)) {
      if (motion.arc) throw Unsayable{"moves on an arc in machine coordinates"};
      add_word(text, "D0");
      modes_.length = 0;
    }
    put(text);
  }

  // An axis without ends may be a modulo axis: MD30455 then decides the way to a plain angle, and
  // angles outside 0 ... 360 are others (Axes and spindles 06/2019, p. 225). AC keeps to the turn,
  // IC to the count; settings decide whether IC carries a new offset along (K2 p. 1-7), and SUPA
  // needs absolute positions.
  std::string position_word(Axis axis, double value) override {
    const int k = index_of(axis) - kLinearJoints;
    if (k < 0 || !settings_.is_endless[static_cast<std::size_t>(k)]) {
      return IsoDialect::position_word(axis, value);
    }
    const auto i = static_cast<std::size_t>(k);
    const std::string text = fixed_text(value, decimals(axis));
    const double count = std::stod(text), offset = offset_of(i);
    const std::optional<Count> known = counts_[i];
    const std::optional<Count> skipped = is_optional_ ? known : skipped_counts_[i];
    const bool is_doubtful = known != skipped;
    counts_[i] = {count + offset, offset};
    if (!is_optional_) skipped_counts_[i] = counts_[i];
    const auto is_angle = [](double angle) { return angle >= 0.0 && angle < 360.0; };
    const double before = known ? known->machine - offset : 0.0;
    const auto has_angle = [&](const auto& one) { return !one || is_angle(one->machine - offset); };
    if (is_angle(count) && has_angle(known) && has_angle(skipped)) {
      return fmt::format("{}=AC({})", letter(axis), text);
    }
    if (is_doubtful) {
      throw Unsayable{
          fmt::format("rotates {0} to {1}, while it may be a modulo axis, whose absolute positions "
                      "are from 0 to 360 deg, and its start position depends on blocks with '/'; "
                      "program {0} without '/' between 0 and 360 deg before",
                      letter(axis), text)};
    }
    if (!known) return letter(axis) + text;
    if (is_of_machine_ || known->offset != offset) {
      throw Unsayable{
          fmt::format("rotates {0} from {1:.7g} to {2} {3}, while it may be a modulo axis, whose "
                      "absolute positions are from 0 to 360 deg; stay within that range",
                      letter(axis), before, text,
                      is_of_machine_ ? "of the machine" : "after a change of its work offset")};
    }
    return fmt::format("{}=IC({})", letter(axis), fixed_text(count - before, decimals(axis)));
  }

  void forget_counts() {
    counts_.fill({});
    if (!is_optional_) skipped_counts_.fill({});
  }

  static int edge(const DialectMotion& motion) {
    if (motion.length != 0 && motion.length != motion.tool) {
      throw Unsayable{
          fmt::format("moves with the length of tool {0} while tool {1} is in the spindle; D1 is "
                      "the length of that tool: program G43 H{1}",
                      motion.length, motion.tool)};
    }
    return motion.length == 0 ? 0 : 1;
  }
  static std::string system_code(int system) {
    return system <= 4 ? fmt::format("G{}", 53 + system) : fmt::format("G{}", 500 + system);
  }
  void work_system(int system) {
    put(system_code(system));
    modes_.work_system = system;
  }
  double offset_of(std::size_t i) const {  // deg, of A, B, C
    if (is_of_machine_) return 0.0;
    const auto system = static_cast<std::size_t>(modes_.work_system.value_or(1) - 1);
    return settings_.work_offset[system][kLinearJoints + static_cast<int>(i)] / deg;
  }

  struct Count {
    double machine = 0.0, offset = 0.0;  // deg; of the work system that it was written in
    bool operator==(const Count&) const = default;
  };
  // of A, B, C as written last; the second without the blocks with '/'
  std::array<std::optional<Count>, 3> counts_{}, skipped_counts_{};
  bool is_optional_ = false;
  bool is_of_machine_ = false;
  bool stops_at_ends_ = false;                         // G60
  Eigen::Vector3d through_ = Eigen::Vector3d::Zero();  // of an arc outside XY, half way along

  int feed_decimals() const override { return 4; }
  std::string speed(double rpm) const override { return fixed_text(rpm, 3); }
};

}  // namespace

std::unique_ptr<DialectPrinter> make_siemens(const DialectSettings& settings,
                                             std::vector<std::string>& lines) {
  return std::make_unique<Siemens>(settings, lines);
}

}  // namespace servomill::sim::programs
