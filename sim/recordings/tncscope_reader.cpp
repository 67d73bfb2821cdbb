#include "sim/recordings/tncscope_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <utility>

#include "plant/vocabulary/progress.h"
#include "sim/recordings/checked_rows.h"
#include "sim/recordings/csv_reader.h"
#include "sim/system/counted.h"

namespace servomill::sim::recordings {
namespace {

constexpr std::size_t kHead = 4096;  // bytes that hold the first section
constexpr double kMicrosecond = 1e-6;

// A curve while it is read: the keys of its section, and its samples.
struct Curve {
  int line = 0;                             // of the section
  std::map<std::string, std::string> keys;  // "CYCLETIME" -> "3000"
  std::vector<double> samples;              // NaN where its field is empty
  std::string key(const std::string& name) const {
    const auto found = keys.find(name);
    return found == keys.end() ? "" : found->second;
  }
};

class ScopeFile {
 public:
  ScopeFile(std::string_view text, const std::string& file) : lines_(text_lines(text)) {
    out_.file = file;
    out_.format = "TNCscope";
  }

  Recording read() {
    std::size_t i = 0;
    for (; i < lines_.size() && !is_section(lines_[i], "DATA"); ++i) read_head(lines_[i]);
    if (i == lines_.size()) {
      throw InputError({out_.file}, "has no section %[DATA]: it is truncated or of another kind");
    }
    Stage stage("lines", static_cast<double>(lines_.size()));
    for (++i; i < lines_.size(); ++i) {
      stage.reach(static_cast<double>(i));
      if (!lines_[i].text.starts_with('%')) read_row(lines_[i], i + 1 == lines_.size());
    }
    for (Curve& curve : curves_) finish(curve);
    return std::move(out_);
  }

 private:
  static bool is_section(const TextLine& line, std::string_view name) {
    return line.text.starts_with("%[") && line.text.substr(2).starts_with(name);
  }

  void read_head(const TextLine& line) {
    if (line.text.starts_with("%[")) {
      in_curve_ = is_section(line, "CURVE");
      if (in_curve_) curves_.emplace_back().line = line.number;
      return;
    }
    const auto equals = line.text.find('=');
    if (!in_curve_ || !line.text.starts_with('%') || equals == std::string_view::npos) return;
    const Heading value = parse_heading(line.text.substr(equals + 1));
    curves_.back().keys[as_utf8(line.text.substr(1, equals - 1))] =
        value.unit.empty() ? value.name : value.name + " (" + value.unit + ")";
  }

  void read_row(const TextLine& line, bool is_last) {
    auto fields = split_fields(line.text, ';');
    const Place place{out_.file, line.number};
    const std::size_t wanted = curves_.size() + 1;
    if (fields.size() == wanted + 1 && fields.back().text.empty()) fields.pop_back();
    if (fields.size() != wanted) {
      const std::string message =
          fmt::format("{} for a time and {}", system::counted(fields.size(), "field"),
                      system::counted(curves_.size(), "curve"));
      const bool is_cut = is_last && fields.size() < wanted;
      throw InputError(place,
                       is_cut ? message + ", and the file ends here: it is truncated" : message);
    }
    for (const Field& field : fields) {
      if (decimal_ == '.') decimal_ = decimal_of(field.text);
    }
    append_time(time_, checked_number(fields[0], decimal_, place) * kMicrosecond, place);
    for (std::size_t c = 0; c < curves_.size(); ++c) {
      curves_[c].samples.push_back(checked_number(fields[c + 1], decimal_, place));
    }
  }

  // The number of a key of a curve; NaN if the key is not there.
  double number(const Curve& curve, const char* key) const {
    const std::string text = curve.key(key);
    const auto value = parse_number(text, decimal_of(text));
    if (value && !std::isinf(*value)) return *value;
    throw InputError({out_.file, curve.line},
                     fmt::format("%{} is '{}', which is not a number", key, text));
  }

  double shortest_cycle() const {
    double out = HUGE_VAL;
    for (const Curve& curve : curves_) out = std::fmin(out, number(curve, "CYCLETIME"));
    return out;
  }

  std::string name_of(const Curve& curve) const {
    std::string name = curve.key("CHANNELTYPE");
    if (const std::string axis = curve.key("AXISTYPE"); !axis.empty()) {
      name += (name.empty() ? "" : " ") + axis;
    }
    return name.empty() ? fmt::format("curve {}", out_.channels.size() + 1) : name;
  }

  void finish(Curve& curve) {
    Base base = time_;
    const std::string name = name_of(curve);
    if (number(curve, "CYCLETIME") > shortest_cycle()) keep_present(curve, base);
    const double count = number(curve, "COUNT");
    const auto samples = static_cast<double>(curve.samples.size());
    if (!std::isnan(count) && count != samples) {
      throw InputError({out_.file, curve.line},
                       fmt::format("channel '{}' has {}, its %COUNT is {}{}", name,
                                   system::counted(curve.samples.size(), "sample"), count,
                                   samples < count ? ": the file is truncated" : ""));
    }
    const std::size_t index = shared_base(out_, std::move(base));
    out_.channels.push_back({name, curve.key("DIMENSION"), std::move(curve.samples), index});
  }

  // Leaves out the instants at which a slower curve has no sample.
  static void keep_present(Curve& curve, Base& base) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < curve.samples.size(); ++i) {
      if (std::isnan(curve.samples[i])) continue;
      curve.samples[kept] = curve.samples[i];
      base.values[kept++] = base.values[i];
    }
    curve.samples.resize(kept);
    base.values.resize(kept);
  }

  std::vector<TextLine> lines_;
  std::vector<Curve> curves_;
  Base time_;
  bool in_curve_ = false;
  char decimal_ = '.';
  Recording out_;
};

// A heading such as "s actual X": quantity, kind of value, axis.
bool is_scope_heading(std::string_view text) {
  constexpr std::array<std::string_view, 5> kQuantities = {"s", "v", "a", "i", "j"};
  constexpr std::array<std::string_view, 12> kKinds = {"actual",  "act.", "act",  "ist",
                                                       "nominal", "nom.", "noml", "noml.",
                                                       "soll",    "dif",  "diff", "diff."};
  const auto words = split_fields(text, ' ');
  if (words.size() < 3) return false;
  std::string kind(words[1].text);
  std::transform(kind.begin(), kind.end(), kind.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kQuantities.begin(), kQuantities.end(), words[0].text) != kQuantities.end() &&
         std::find(kKinds.begin(), kKinds.end(), kind) != kKinds.end();
}

}  // namespace

bool is_tncscope(std::string_view text) {
  const std::string_view head = text.substr(0, kHead);
  return head.find("%[GLOBAL]") != std::string_view::npos ||
         head.find("%[CURVE") != std::string_view::npos;
}

Recording parse_tncscope(std::string_view text, const std::string& file) {
  Recording out = ScopeFile(text, file).read();
  check(out);
  return out;
}

bool is_tncscope_csv(std::string_view text) {
  for (const TextLine& line : text_lines(text.substr(0, kHead))) {
    for (const char separator : {';', '\t', ','}) {
      for (const Field& field : split_fields(line.text, separator)) {
        if (is_scope_heading(field.text)) return is_csv(text);
      }
    }
  }
  return false;
}

Recording parse_tncscope_csv(std::string_view text, const std::string& file) {
  Recording out = parse_csv(text, file);
  out.format = "TNCscope " + out.format;
  for (Base& base : out.bases) {
    if (base.unit_known) continue;
    for (double& value : base.values) value *= kMicrosecond;
    base.unit_known = true;
  }
  // scaling may make neighbouring times equal
  check(out);
  return out;
}

}  // namespace servomill::sim::recordings
