#include "sim/recordings/sinumerik_trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <pugixml.hpp>
#include <utility>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "sim/recordings/checked_rows.h"
#include "sim/recordings/xml_document.h"

namespace servomill::sim::recordings {
namespace {

// The bits of an infinity, read as a whole number: the control's mark for no value.
constexpr double kNoValue = 9218868437227405312.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class TraceFile {
 public:
  TraceFile(std::string_view text, const std::string& file) : document_(text, file) {
    out_.file = file;
    out_.format = "Sinumerik trace";
  }

  Recording read() {
    for (const pugi::xml_node trace : document_.all("traceData")) {
      for (const pugi::xml_node frame : trace.children("dataFrame")) read_frame(frame);
    }
    name_signals();
    return std::move(out_);
  }

 private:
  struct Names {
    std::string description, name, label;
  };

  void read_frame(pugi::xml_node frame) {
    const std::size_t first = out_.channels.size(), index = out_.bases.size();
    for (const pugi::xml_node signal : frame.children("dataSignal")) {
      const std::size_t number = out_.channels.size() - first + 1;
      names_.push_back({as_utf8(signal.attribute("description").value()),
                        as_utf8(signal.attribute("name").value()), fmt::format("f{}", number)});
      out_.channels.push_back({"", as_utf8(signal.attribute("unitsType").value()), {}, index});
    }
    if (out_.channels.size() == first) document_.fail(frame, "has no dataSignal");
    Base base;
    base.name = index == 0 ? "time" : fmt::format("time {}", index + 1);
    std::vector<double> values(out_.channels.size() - first, kNan);
    Stage stage("records", 0.0);
    for (const pugi::xml_node record : frame.children("rec")) {
      throw_if_interrupted();
      stage.advance();
      read_time(record, base);
      read_values(record, values);
      for (std::size_t i = 0; i < values.size(); ++i) {
        out_.channels[first + i].samples.push_back(values[i]);
      }
    }
    if (base.values.empty()) document_.fail(frame, "has no rec");
    out_.bases.push_back(std::move(base));
  }

  double number(pugi::xml_node record, pugi::xml_attribute attribute) const {
    const auto value = parse_number(attribute.value(), '.');
    if (value && std::isfinite(*value)) return *value;
    document_.fail(record, fmt::format("'{}' is '{}', which is not a number",
                                       as_utf8(attribute.name()), as_utf8(attribute.value())));
  }

  void read_time(pugi::xml_node record, Base& base) const {
    const pugi::xml_attribute attribute = record.attribute("time");
    if (!attribute) document_.fail(record, "has no time");
    const double time = number(record, attribute);
    if (!base.values.empty() && !(time > base.values.back())) {
      const double last = base.values.back();
      document_.fail(record, time < last
                                 ? fmt::format("time runs backwards: {} s after {} s", time, last)
                                 : fmt::format("time {} s appears twice", time));
    }
    base.values.push_back(time);
  }

  // Values of f1, f2, ...; those that are not there stay.
  void read_values(pugi::xml_node record, std::vector<double>& values) const {
    for (const pugi::xml_attribute attribute : record.attributes()) {
      const std::string_view name = attribute.name();
      if (name.size() < 2 || name[0] != 'f') continue;
      std::size_t index = 0;
      const auto [end, fault] = std::from_chars(name.data() + 1, name.data() + name.size(), index);
      if (fault != std::errc() || end != name.data() + name.size()) continue;
      if (index < 1 || index > values.size()) {
        document_.fail(record, fmt::format("'{}' in a frame of {} signals", name, values.size()));
      }
      const double value = number(record, attribute);
      if (value < kNoValue) values[index - 1] = value;
    }
  }

  void name_signals() {
    std::map<std::string, int> uses;
    for (const Names& one : names_) ++uses[one.description];
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const Names& one = names_[i];
      const bool is_unique = !one.description.empty() && uses[one.description] == 1;
      out_.channels[i].name = is_unique           ? one.description
                              : !one.name.empty() ? one.name
                                                  : one.label;
    }
  }

  XmlDocument document_;
  Recording out_;
  std::vector<Names> names_;
};

}  // namespace

bool is_sinumerik_trace(std::string_view text) {
  constexpr std::size_t kHead = 65536;
  return is_xml(text) && text.substr(0, kHead).find("<traceData") != std::string_view::npos;
}

Recording parse_sinumerik_trace(std::string_view text, const std::string& file) {
  Recording out = TraceFile(text, file).read();
  check(out);
  return out;
}

}  // namespace servomill::sim::recordings
