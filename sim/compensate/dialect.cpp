#include "sim/compensate/dialect.h"

#include <fmt/format.h>

#include <cassert>

#include "controllers/gcode/number_text.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim {
namespace {

using controllers::fixed_text;

constexpr int kFeedDecimals = 4;
constexpr std::size_t kLongestComment = 100;

// Letters and signs that every control shows.
std::string plain(std::string_view text, bool is_upper) {
  std::string out;
  for (char c : text) {
    if (c == '(') c = '[';
    if (c == ')') c = ']';
    if (c == '"' || c == '%' || static_cast<unsigned char>(c) >= 0x7f) c = '\'';
    if (is_upper && c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    out += c;
  }
  return out;
}

std::string significant(double x) { return fixed_text(x, kFeedDecimals); }

// ------------------------------------------------------------------------------------- Heidenhain

class Heidenhain final : public DialectPrinter {
 public:
  using DialectPrinter::DialectPrinter;

  int decimals() const override { return 4; }

  void begin(const std::string& name, const std::vector<std::string>& header) override {
    put(fmt::format("BEGIN PGM {} MM", name));
    for (const std::string& line : header) comment(line);
  }
  void put_comment(std::string_view text) override { put("; " + plain(text, false)); }

  void motion(const DialectMotion& motion) override {
    if (motion.is_inverse) {
      throw Unsayable{"feeds rotary axes together with linear ones, which needs G93"};
    }
    std::string text = "L";
    for (const auto& [axis, value] : motion.words) {
      const std::string number = fixed_text(value, decimals());
      text += fmt::format(" {}{}{}", letter(axis), number.front() == '-' ? "" : "+", number);
    }
    if (!has_R0_) text += " R0";
    has_R0_ = true;
    if (motion.is_rapid) {
      text += " FMAX";
    } else if (const std::string F = significant(motion.feed); F != F_) {
      text += " F" + F;
      F_ = F;
    }
    if (motion.is_place) text += " M91";
    put(text);
  }

  void work_system(int system) override {
    if (system != 1)
      throw Unsayable{"selects a work system other than G54; presets are the control's"};
  }
  void tool_length(int offset, int tool) override {
    if (offset != tool) {
      throw Unsayable{
          fmt::format("moves with the length of tool {} while tool {} is called; the "
                      "control takes that of the tool called",
                      offset, tool)};
    }
  }
  void path_mode(PathMode mode, double tolerance) override {
    if (mode != PathMode::continuous) throw Unsayable{"asks for exact stops (G61, G61.1)"};
    put("CYCL DEF 32.0 TOLERANCE");
    put(tolerance > 0.0 ? fmt::format("CYCL DEF 32.1 T{}", fixed_text(tolerance / mm, decimals()))
                        : "CYCL DEF 32.1");
  }
  void preselect(int tool) override { put(fmt::format("TOOL DEF {}", tool)); }
  void tool(int number, double rpm) override {
    S_ = rpm;
    put(fmt::format("TOOL CALL {} Z{}", number,
                    rpm > 0.0 ? " S" + significant(rpm) : std::string()));
    has_R0_ = false;
  }
  void spindle(int direction, double rpm) override {
    if (rpm != S_) put("TOOL CALL S" + significant(rpm));
    S_ = rpm;
    if (direction == direction_) return;
    direction_ = direction;
    put(direction > 0 ? "L M3" : direction < 0 ? "L M4" : "L M5");
  }
  void coolant(int code) override {
    if (code == 7) throw Unsayable{"switches mist (M7), which is the machine builder's"};
    put(fmt::format("L M{}", code));
  }
  void dwell(double seconds) override {
    put("CYCL DEF 9.0 DWELL TIME");
    put("CYCL DEF 9.1 DWELL " + significant(seconds));
  }
  void stop(int code) override { put(fmt::format("L M{}", code)); }
  void end() override { put("L M30"); }

  std::string text(const std::string& name) const override {
    std::string out;
    std::size_t number = 0;
    for (const std::string& line : lines_) out += fmt::format("{} {}\n", number++, line);
    return out + fmt::format("{} END PGM {} MM\n", number, name);
  }

 private:
  bool has_R0_ = false;
  std::string F_;
  double S_ = 0.0;
  int direction_ = 0;
};

// ------------------------------------------------------------------------- what codes of ISO share

class IsoCodes : public DialectPrinter {
 public:
  using DialectPrinter::DialectPrinter;

  void preselect(int tool) override { put(fmt::format("T{}", tool)); }
  void spindle(int direction, double rpm) override {
    const std::string S = fixed_text(rpm, 3);
    std::string text = S != S_ ? "S" + S : "";
    S_ = S;
    if (direction != direction_) {
      text += text.empty() ? "" : " ";
      text += direction > 0 ? "M3" : direction < 0 ? "M4" : "M5";
    }
    direction_ = direction;
    if (!text.empty()) put(text);
  }
  void coolant(int code) override { put(fmt::format("M{}", code)); }
  void stop(int code) override { put(fmt::format("M{}", code)); }
  void end() override { put("M30"); }

 protected:
  // G0 or G1, feed mode, positions, feed; of these what is not in force.
  std::string motion_text(const DialectMotion& motion, std::string_view prefix) {
    std::string text;
    const auto add = [&](std::string_view word) {
      text += text.empty() ? "" : " ";
      text += word;
    };
    if (!prefix.empty()) add(prefix);
    if (!motion.is_rapid) {
      const std::string mode = motion.is_inverse ? "G93" : "G94";
      if (mode != mode_) {
        add(mode);
        F_.clear();
      }
      mode_ = mode;
    }
    const std::string code = motion.is_rapid ? "G0" : "G1";
    if (code != code_) add(code);
    code_ = code;
    for (const auto& [axis, value] : motion.words) {
      add(fmt::format("{}{}", letter(axis), number(fixed_text(value, decimals()))));
    }
    if (!motion.is_rapid) {
      const std::string F = number(significant(motion.feed));
      if (F != F_ || motion.is_inverse) add("F" + F);
      F_ = F;
    }
    return text;
  }
  virtual std::string number(std::string text) const { return text; }
  void forget_motion() { code_.clear(); }

 private:
  std::string code_, mode_ = "G94", F_, S_ = "0";
  int direction_ = 0;
};

// ------------------------------------------------------------------------------------------ Fanuc

class Fanuc final : public IsoCodes {
 public:
  using IsoCodes::IsoCodes;

  int decimals() const override { return 4; }

  void begin(const std::string& name, const std::vector<std::string>& header) override {
    put(fmt::format("O0001 ({})", plain(name, true)));
    for (const std::string& line : header) comment(line);
    put("G21 G17 G40 G49 G80 G90 G94");
  }
  void put_comment(std::string_view text) override { put(fmt::format("({})", plain(text, true))); }

  void motion(const DialectMotion& motion) override {
    if (motion.is_place) {
      if (!motion.is_rapid) throw Unsayable{"feeds in machine coordinates; G53 is a rapid"};
      put(motion_text(motion, "G53"));
      return;
    }
    put(motion_text(motion, pending_));
    pending_.clear();
  }
  void work_system(int system) override {
    if (system > 6) throw Unsayable{"selects G59.1 ... G59.3"};
    put(fmt::format("G{}", 53 + system));
  }
  // With the next block: by itself it may move the axis.
  void tool_length(int offset, int) override {
    pending_ = offset == 0 ? "G49" : fmt::format("G43 H{}", offset);
  }
  void path_mode(PathMode mode, double tolerance) override {
    if (mode == PathMode::exact_path) throw Unsayable{"asks for G61 as LinuxCNC means it"};
    if (tolerance > 0.0) throw Unsayable{"gives a tolerance (G64 P)"};
    put(mode == PathMode::exact_stop ? "G61" : "G64");
  }
  void tool(int number, double) override { put(fmt::format("T{} M6", number)); }
  void dwell(double seconds) override { put("G4 X" + number(significant(seconds))); }

  std::string text(const std::string&) const override {
    constexpr std::size_t kMostNumbers = 99999;
    std::string out = "%\n";
    std::size_t n = 0;
    for (const std::string& line : lines_) {
      const bool is_numbered = line.front() != 'O' && line.front() != '(';
      if (is_numbered) out += fmt::format("N{} ", n++ % kMostNumbers + 1);
      out += line + "\n";
    }
    return out + "%\n";
  }

 private:
  // A number without point counts in increments.
  std::string number(std::string text) const override {
    return text.find('.') == std::string::npos ? text + "." : text;
  }
  std::string pending_;
};

// ---------------------------------------------------------------------------------------- Siemens

class Siemens final : public IsoCodes {
 public:
  using IsoCodes::IsoCodes;

  int decimals() const override { return 5; }

  void begin(const std::string& name, const std::vector<std::string>& header) override {
    comment(name);
    for (const std::string& line : header) comment(line);
    put("G710 G17 G40 G90 G94");
  }
  void put_comment(std::string_view text) override { put("; " + plain(text, false)); }
  void message(std::string_view text) override {
    put(fmt::format("MSG(\"{}\")", plain(text, false)));
  }

  void motion(const DialectMotion& motion) override {
    if (motion.is_place) {
      put(motion_text(motion, "SUPA D0"));
      pending_ = edge_ == 0 ? "" : "D1";
      return;
    }
    put(motion_text(motion, pending_));
    pending_.clear();
  }
  void work_system(int system) override {
    put(system <= 4 ? fmt::format("G{}", 53 + system) : fmt::format("G{}", 500 + system));
  }
  void tool_length(int offset, int tool) override {
    if (offset != 0 && offset != tool) {
      throw Unsayable{
          fmt::format("moves with the length of tool {} while tool {} is in the "
                      "spindle; D1 is that of the tool",
                      offset, tool)};
    }
    edge_ = offset == 0 ? 0 : 1;
    pending_ = fmt::format("D{}", edge_);
  }
  void path_mode(PathMode mode, double tolerance) override {
    if (mode == PathMode::exact_path) throw Unsayable{"asks for G61 as LinuxCNC means it"};
    if (mode == PathMode::exact_stop) return put("G60");
    put(tolerance > 0.0 ? fmt::format("G642 CTOL={}", fixed_text(tolerance / mm, decimals()))
                        : "G64");
  }
  void tool(int number, double) override {
    put(fmt::format("T{}", number));
    put("M6");
  }
  void dwell(double seconds) override { put("G4 F" + significant(seconds)); }

  std::string text(const std::string&) const override {
    std::string out;
    std::size_t n = 0;
    for (const std::string& line : lines_) {
      if (line.front() != ';') out += fmt::format("N{} ", 10 * ++n);
      out += line + "\n";
    }
    return out;
  }

 private:
  std::string pending_;
  int edge_ = 0;
};

}  // namespace

void DialectPrinter::comment(std::string_view text) {
  while (text.size() > kLongestComment) {
    const std::size_t blank = text.rfind(' ', kLongestComment);
    const bool has_blank = blank != std::string_view::npos && blank > 0;
    const std::size_t cut = has_blank ? blank : kLongestComment;
    put_comment(text.substr(0, cut));
    text.remove_prefix(has_blank ? cut + 1 : cut);
  }
  put_comment(text);
}

std::unique_ptr<DialectPrinter> make_dialect(Dialect dialect, std::vector<std::string>& lines) {
  switch (dialect) {
    case Dialect::heidenhain:
      return std::make_unique<Heidenhain>(lines);
    case Dialect::fanuc:
      return std::make_unique<Fanuc>(lines);
    case Dialect::siemens:
      return std::make_unique<Siemens>(lines);
    case Dialect::linuxcnc:
      break;
  }
  assert(false);
  return nullptr;
}

}  // namespace servomill::sim
