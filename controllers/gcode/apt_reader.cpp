#include "controllers/gcode/apt_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "controllers/gcode/cl_reader.h"
#include "controllers/gcode/modal_state.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr double kRevolution = 2.0 * std::numbers::pi;

class AptReader : ClReader {
 public:
  using ClReader::ClReader;

  ClData read(std::string_view text) {
    PlacedText statement;
    int line = 0;
    while (!text.empty() && faults_.size() < kMaxFaults) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      const bool goes_on = add_line(text.substr(0, end), ++line, statement);
      text.remove_prefix(std::min(end + 1, text.size()));
      if (goes_on && !text.empty()) continue;
      if (goes_on) {
        guarded([&] {
          fail({line, 0}, "the last line ends with the continuation '$', but no line follows");
        });
      }
      guarded([&] { run(statement.trimmed(0, statement.text.size())); });
      statement.clear();
    }
    for (const auto& [word, skipped] : skipped_) {
      const int more = skipped.times - 1;
      warn(skipped.first,
           fmt::format("{} is ignored{}", word,
                       more == 0   ? ""
                       : more == 1 ? ", here and in one other line"
                                   : fmt::format(", here and in {} other lines", more)));
    }
    return finish();
  }

 private:
  using Words = std::vector<PlacedText>;
  struct Major {
    std::string_view name;
    void (AptReader::*run)(Spot at, const Words& words);
  };
  struct Skipped {
    Spot first;
    int times = 0;
  };

  // Adds a line without its comment; true if the statement goes on in the next one.
  bool add_line(std::string_view text, int line, PlacedText& statement) {
    for (std::size_t i = 0; i < text.size(); ++i) {
      const char c = text[i];
      const int column = static_cast<int>(i) + 1;
      if (static_cast<unsigned char>(c) < 0x20 && !is_blank(c)) {
        guarded([&] {
          fail({line, column}, fmt::format("byte 0x{:02X} is not allowed", static_cast<int>(c)));
        });
        statement.clear();
        return false;
      }
      if (c == '$') return text.substr(i, 2) != "$$";
      statement.add(c, line, column);
    }
    return false;
  }

  // Words of APT are the same in upper and lower case; messages show them as written.
  static bool is(const PlacedText& word, std::string_view name) {
    return in_capitals(word.text) == name;
  }

  void run(const PlacedText& statement) {
    if (statement.text.empty()) return;
    const Spot at = statement.spot();
    if (ended_) {
      if (!warned_of_end_) warn(at, "text after FINI is ignored");
      warned_of_end_ = true;
      return;
    }
    if (takes_text(statement, at)) return;
    const std::size_t slash = std::min(statement.text.find('/'), statement.text.size());
    const std::string name = in_capitals(statement.trimmed(0, slash).text);
    Words words;
    if (slash < statement.text.size()) words = split(statement, slash + 1, ',');
    if (name.empty()) fail(at, "a word is missing before '/'");
    const auto major = std::find_if(kMajors.begin(), kMajors.end(),
                                    [&](const Major& one) { return one.name == name; });
    if (major != kMajors.end()) {
      (this->*major->run)(at, words);
    } else {
      unknown(at, name);
    }
  }

  // PARTNO and PPRINT are followed by free text.
  bool takes_text(const PlacedText& statement, Spot at) {
    for (const std::string_view name : {"PARTNO", "PPRINT"}) {
      if (!in_capitals(statement.text.substr(0, name.size())).starts_with(name)) continue;
      const std::string_view behind = std::string_view(statement.text).substr(name.size());
      if (!behind.empty() && !is_blank(behind.front()) && behind.front() != '/') continue;
      const std::string text =
          statement.trimmed(name.size() + (behind.starts_with('/') ? 1 : 0), statement.text.size())
              .text;
      if (name == "PARTNO") {
        out_.part = text;
      } else {
        add(MoveKind::message, at).text = text;
      }
      return true;
    }
    return false;
  }

  [[noreturn]] void refuse_other_way(Spot at, std::string_view name) const {
    fail(at,
         fmt::format("{} changes the tool path and is not supported; output GOTO locations instead",
                     name));
  }

  void unknown(Spot at, const std::string& name) {
    static constexpr std::array<std::string_view, 26> kChangeTheWay = {
        "CIRCLE", "COPY",   "CUTCOM", "GOBACK", "GODLTA", "GODOWN", "GOFWD",  "GOHOME", "GOLFT",
        "GORGT",  "GOUP",   "INDEX",  "MODE",   "MOVARC", "MSYS",   "OFSTNO", "ORIGIN", "ROTABL",
        "ROTATE", "ROTHED", "TLLFT",  "TLON",   "TLRGT",  "TMARK",  "TRACUT", "TRANS"};
    static constexpr std::array<std::string_view, 10> kDescribe = {
        "CUTTER", "END-OF-PATH", "FROM",   "INTOL",     "MACHIN",
        "OUTTOL", "PAINT",       "TLDATA", "TOOL PATH", "TOLER"};
    if (std::find(kChangeTheWay.begin(), kChangeTheWay.end(), name) != kChangeTheWay.end()) {
      refuse_other_way(at, name);
    }
    const bool describes = std::find(kDescribe.begin(), kDescribe.end(), name) != kDescribe.end();
    // what follows a word without '/' is no part of it
    const std::string letters =
        name.substr(0, name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ"));
    const std::string_view near = describes ? "" : nearest_known(letters);
    if (near == letters && !letters.empty()) {
      fail(at, fmt::format("{} must be followed by '/' or the end of the line", letters));
    }
    if (!near.empty()) fail(at, fmt::format("unknown word '{}'; did you mean '{}'?", name, near));
    Skipped& skipped = skipped_[name];
    if (skipped.times++ == 0) skipped.first = at;
  }

  // The known word that one looks like, or is.
  static std::string_view nearest_known(const std::string& word) {
    static constexpr auto kKnown = [] {
      std::array<std::string_view, kMajors.size() + 2> names{"PARTNO", "PPRINT"};
      for (std::size_t i = 0; i < kMajors.size(); ++i) names[i + 2] = kMajors[i].name;
      return names;
    }();
    return nearest_name(word, kKnown);
  }

  ClRecord& add(MoveKind kind, Spot at) {
    ClRecord& record = out_.records.emplace_back();
    record.kind = kind;
    record.line = at.line;
    return record;
  }

  void need(Spot at, bool right, std::string_view rule) const {
    if (!right) fail(at, std::string(rule));
  }

  void unknown_minor(std::string_view major, const PlacedText& word) {
    warn(word.spot(), fmt::format("'{}' of {} is ignored", word.text, major));
  }

  void go_to(Spot at, const Words& words) {
    need(at, words.size() == 3 || words.size() == 6, "GOTO requires x,y,z or x,y,z,i,j,k");
    std::array<double, 6> values{};
    for (std::size_t i = 0; i < words.size(); ++i) values[i] = number(words[i]);
    if (words.size() == 6) axis_ = unit_axis({values[3], values[4], values[5]}, words[3].spot());
    const double feed = rapid_ ? 0.0 : feed_at(at);
    ClRecord& record = add(rapid_ ? MoveKind::rapid : MoveKind::feed, at);
    record.P.p_WT = unit_ * Eigen::Vector3d(values[0], values[1], values[2]);
    record.P.k_W = axis_;
    record.feed = feed;
    rapid_ = false;
  }

  double feed_at(Spot at) const {
    if (!per_revolution_) return feed_;
    need(at, spindle_ > 0.0, "a feed per revolution requires a spindle speed (SPINDL)");
    return feed_ * spindle_;
  }

  void feed_rate(Spot at, const Words& words) {
    struct Unit {
      std::string_view name;
      double length;  // m
      bool per_revolution;
    };
    static constexpr std::array<Unit, 6> kUnits = {{{"MMPM", mm, false},
                                                    {"IPM", inch, false},
                                                    {"MMPR", mm, true},
                                                    {"IPR", inch, true},
                                                    {"PERMIN", 0.0, false},
                                                    {"PERREV", 0.0, true}}};
    std::optional<double> value;
    Unit unit{"", unit_, false};
    for (const PlacedText& word : words) {
      const auto known = std::find_if(kUnits.begin(), kUnits.end(),
                                      [&](const Unit& one) { return is(word, one.name); });
      if (known != kUnits.end()) {
        unit = *known;
        if (unit.length == 0.0) unit.length = unit_;
      } else if (!value) {
        value = number(word);
        need(word.spot(), *value > 0.0, "the feed rate must be > 0");
      } else {
        std::array<std::string_view, kUnits.size()> names;
        std::transform(kUnits.begin(), kUnits.end(), names.begin(),
                       [](const Unit& one) { return one.name; });
        fail(word.spot(), fmt::format("unknown unit '{}' of FEDRAT; must be one of {}", word.text,
                                      fmt::join(names, ", ")));
      }
    }
    need(at, value.has_value(), "FEDRAT requires a number");
    per_revolution_ = unit.per_revolution;
    feed_ = *value * unit.length / (per_revolution_ ? kRevolution : minute);
  }

  void rapid(Spot at, const Words& words) {
    need(at, words.empty(), "RAPID does not accept parameters");
    rapid_ = true;
  }

  void units(Spot at, const Words& words) {
    const std::string name = words.size() == 1 ? in_capitals(words[0].text) : "";
    if (name == "MM") {
      unit_ = mm;
    } else if (name == "INCH" || name == "INCHES") {
      unit_ = inch;
    } else {
      fail(at, "UNITS requires MM or INCH");
    }
  }

  void spindle(Spot at, const Words& words) {
    need(at, !words.empty(), "SPINDL requires a speed, ON or OFF");
    int direction = direction_;
    for (const PlacedText& word : words) {
      if (is(word, "OFF")) {
        direction = 0;
      } else if (is(word, "CLW") || is(word, "CCLW")) {
        direction = is(word, "CLW") ? 1 : -1;
        direction_ = direction;
      } else if (is(word, "SFM") || is(word, "SMM")) {
        fail(word.spot(),
             "a cutting speed (SFM, SMM) is not supported; program the spindle speed in RPM");
      } else if (const auto value = signed_number_in(word.text)) {
        need(word.spot(), *value > 0.0, "the spindle speed must be > 0");
        spindle_ = *value * rpm;
      } else if (!is(word, "ON") && !is(word, "RPM")) {
        unknown_minor("SPINDL", word);
      }
    }
    need(at, direction == 0 || spindle_ > 0.0, "SPINDL requires a speed");
    ClRecord& record = add(MoveKind::spindle, at);
    record.value = spindle_;
    record.direction = direction;
  }

  void coolant(Spot at, const Words& words) {
    need(at, !words.empty(), "COOLNT requires ON, FLOOD, MIST or OFF");
    for (const PlacedText& word : words) {
      int number = 0;
      if (is(word, "ON") || is(word, "FLOOD")) {
        number = kFlood;
      } else if (is(word, "MIST")) {
        number = kMist;
      } else if (!is(word, "OFF")) {
        unknown_minor("COOLNT", word);
        continue;
      }
      add(MoveKind::coolant, at).number = number;
    }
  }

  void load_tool(Spot at, const Words& words) {
    constexpr double kMaxTools = 99999.0;
    need(at, !words.empty(), "LOADTL requires a tool number");
    const double tool = number(words[0]);
    need(words[0].spot(), tool == std::floor(tool) && tool >= 1.0 && tool <= kMaxTools,
         "the tool number must be an integer >= 1 and <= 99999");
    for (std::size_t i = 1; i < words.size(); ++i) unknown_minor("LOADTL", words[i]);
    add(MoveKind::tool, at).number = static_cast<int>(tool);
  }

  void delay(Spot at, const Words& words) {
    need(at, words.size() == 1, "DELAY requires a time in seconds");
    const double time = number(words[0]);
    need(words[0].spot(), time >= 0.0, "DELAY must be >= 0");
    add(MoveKind::dwell, at).value = time;
  }

  void stop(Spot at, const Words&) { add(MoveKind::stop, at).number = 0; }
  void optional_stop(Spot at, const Words&) { add(MoveKind::stop, at).number = 1; }
  void end(Spot, const Words&) { ended_ = true; }

  void cycle(Spot at, const Words& words) {
    if (words.size() == 1 && is(words[0], "OFF")) return;
    refuse_other_way(at, "CYCLE");
  }

  // whether GOTO has an axis is seen from its numbers
  void multi_axis(Spot, const Words&) {}

  static constexpr std::array<Major, 13> kMajors = {{
      {"COOLNT", &AptReader::coolant},
      {"CYCLE", &AptReader::cycle},
      {"DELAY", &AptReader::delay},
      {"FEDRAT", &AptReader::feed_rate},
      {"FINI", &AptReader::end},
      {"GOTO", &AptReader::go_to},
      {"LOADTL", &AptReader::load_tool},
      {"MULTAX", &AptReader::multi_axis},
      {"OPSTOP", &AptReader::optional_stop},
      {"RAPID", &AptReader::rapid},
      {"SPINDL", &AptReader::spindle},
      {"STOP", &AptReader::stop},
      {"UNITS", &AptReader::units},
  }};

  double unit_ = mm;  // m
  Eigen::Vector3d axis_ = Eigen::Vector3d::UnitZ();
  double feed_ = 0.0;  // m/s, or m/rad of the spindle
  bool per_revolution_ = false;
  bool rapid_ = false;
  double spindle_ = 0.0;  // rad/s
  int direction_ = 1;
  bool ended_ = false, warned_of_end_ = false;
  std::map<std::string, Skipped> skipped_;
};

}  // namespace

ClData read_apt(std::string_view text, const std::string& file, std::vector<Warning>* of_refused) {
  return AptReader(file, of_refused).read(text);
}

}  // namespace servomill::controllers
