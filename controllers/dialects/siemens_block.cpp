#include "controllers/dialects/siemens_block.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {
namespace {

struct CodeEntry {
  std::string_view name;
  SiemensGroup group;
};

// G505 ... G599 are work offsets, too.
constexpr CodeEntry kCodes[] = {
    {"G0", SiemensGroup::motion},
    {"G1", SiemensGroup::motion},
    {"G2", SiemensGroup::motion},
    {"G3", SiemensGroup::motion},
    {"CIP", SiemensGroup::motion},
    {"G4", SiemensGroup::dwell},
    {"TRANS", SiemensGroup::frame},
    {"ROT", SiemensGroup::frame},
    {"SCALE", SiemensGroup::frame},
    {"MIRROR", SiemensGroup::frame},
    {"G17", SiemensGroup::plane},
    {"G18", SiemensGroup::plane},
    {"G19", SiemensGroup::plane},
    {"G40", SiemensGroup::cutter},
    {"G500", SiemensGroup::work_offset},
    {"G54", SiemensGroup::work_offset},
    {"G55", SiemensGroup::work_offset},
    {"G56", SiemensGroup::work_offset},
    {"G57", SiemensGroup::work_offset},
    {"SUPA", SiemensGroup::suppression},
    {"G153", SiemensGroup::suppression},
    {"G60", SiemensGroup::path},
    {"G64", SiemensGroup::path},
    {"G641", SiemensGroup::path},
    {"G642", SiemensGroup::path},
    {"G9", SiemensGroup::exact_stop},
    {"G70", SiemensGroup::units},
    {"G71", SiemensGroup::units},
    {"G700", SiemensGroup::units},
    {"G710", SiemensGroup::units},
    {"G90", SiemensGroup::distance},
    {"G91", SiemensGroup::distance},
    {"G93", SiemensGroup::feed},
    {"G94", SiemensGroup::feed},
    {"G95", SiemensGroup::feed},
    {"RTLION", SiemensGroup::rapid},
    {"RTLIOF", SiemensGroup::rapid},
    {"TRAFOOF", SiemensGroup::transformation},
    {"G601", SiemensGroup::without_effect},
    {"G602", SiemensGroup::without_effect},
    {"G603", SiemensGroup::without_effect},
    {"BRISK", SiemensGroup::without_effect},
    {"SOFT", SiemensGroup::without_effect},
    {"DRIVE", SiemensGroup::without_effect},
    {"FFWON", SiemensGroup::without_effect},
    {"FFWOF", SiemensGroup::without_effect},
    {"COMPOF", SiemensGroup::without_effect},
    {"DYNNORM", SiemensGroup::without_effect},
    {"DYNPOS", SiemensGroup::without_effect},
    {"DYNROUGH", SiemensGroup::without_effect},
    {"DYNSEMIFIN", SiemensGroup::without_effect},
    {"DYNFINISH", SiemensGroup::without_effect},
    {"DIAMOF", SiemensGroup::without_effect},
    {"STOPRE", SiemensGroup::without_effect},
};

// Words of the language that the reader does not support, with their function.
constexpr std::pair<std::string_view, std::string_view> kNotRead[] = {
    {"G41", "activates cutter radius compensation"},
    {"G42", "activates cutter radius compensation"},
    {"G53", "leaves the basic frame active, which is unknown here; use SUPA to suppress it"},
    {"G58", "is an axial offset of the programmable frame, not a work offset"},
    {"G59", "is an axial offset of the programmable frame, not a work offset"},
    {"G74", "moves to the reference point"},
    {"G75", "moves to a fixed point of the machine builder"},
    {"G961", "sets a constant cutting speed"},
    {"G96", "sets a constant cutting speed"},
    {"TRAORI", "activates a transformation with unknown parameters"},
    {"CYCLE800", "swivels the plane by data of the machine builder"},
    {"ATRANS", "shifts the programmable frame"},
    {"AROT", "rotates the programmable frame"},
    {"ASCALE", "scales the programmable frame"},
    {"AMIRROR", "mirrors the programmable frame"},
    {"G110", "sets a pole for polar coordinates"},
    {"G111", "sets a pole for polar coordinates"},
    {"G112", "sets a pole for polar coordinates"},
    {"AP", "is a polar angle"},
    {"RP", "is a polar radius"},
    {"CT", "is an arc tangential to the preceding element"},
    {"AR", "is the angle of an arc"},
    {"DIAMON", "activates diameter programming"},
    {"DIAM90", "activates diameter programming"},
    {"COMPON", "replaces lines by splines"},
    {"COMPCAD", "replaces lines by splines"},
    {"COMPCURV", "replaces lines by splines"},
    {"COMPSURF", "replaces lines by splines"},
    {"G643", "smooths corners with axis tolerances"},
    {"G644", "smooths corners with axis tolerances"},
    {"G645", "smooths corners with axis tolerances"},
    {"FGROUP", "redefines the axes that F refers to"},
    {"RET", "ends a subprogram"},
    {"CALL", "calls a subprogram"},
    {"MCALL", "calls a subprogram"},
    {"DEF", "defines a variable"},
    {"IF", "branches"},
    {"FOR", "loops"},
    {"WHILE", "loops"},
    {"LOOP", "loops"},
    {"REPEAT", "repeats blocks"},
    {"GOTO", "jumps"},
    {"GOTOF", "jumps"},
    {"GOTOB", "jumps"},
};

constexpr int kMFunctions[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 17, 30};

class BlockBuilder {
 public:
  BlockBuilder(int line, const std::string& file) : file_(file) { block_.line = line; }

  SiemensBlock build(const SiemensLine& line) {
    if (!line.words.empty()) block_.column = line.words.front().column;
    for (const SiemensWord& word : line.words) put(word);
    return std::move(block_);
  }

 private:
  [[noreturn]] void fail(int column, std::string message) const {
    throw InputError(Place{file_, block_.line, column}, std::move(message));
  }

  void put(const SiemensWord& word) {
    if (word.form == SiemensForm::call && word.name == "MSG") return;
    ++block_.words;
    if (word.form == SiemensForm::call) return put_call(word);
    if (word.name == "G" && word.form == SiemensForm::number) {
      return put_code(word, fmt::format("G{}", whole(word, 0, 999)));
    }
    if (word.form == SiemensForm::bare) return put_code(word, word.name);
    if (word.name == "T") return put_tool(word);
    if (word.form == SiemensForm::text) {
      fail(word.column, fmt::format("{}=\"...\": only T accepts a name", word.name));
    }
    if (word.name == "M") return put_M(word);
    put_address(word);
  }

  void put_code(const SiemensWord& word, const std::string& name) {
    const auto* entry = std::find_if(std::begin(kCodes), std::end(kCodes),
                                     [&](const CodeEntry& code) { return code.name == name; });
    std::optional<SiemensGroup> group;
    if (entry != std::end(kCodes)) group = entry->group;
    const int number = word.name == "G" ? static_cast<int>(word.value) : 0;
    if (number >= 505 && number <= 599) group = SiemensGroup::work_offset;
    if (!group) refuse(word, name);
    std::optional<SiemensCode>& place = block_.codes[static_cast<std::size_t>(*group)];
    const std::string_view shown = entry != std::end(kCodes) ? entry->name : "G505...G599";
    if (place && *group != SiemensGroup::without_effect) {
      fail(word.column, fmt::format("{} and {} in one block (same G group)", place->name, name));
    }
    place = SiemensCode{shown, number, word.column};
  }

  // Words with '=' or a number come here, too: "AP=30" is known, but not read.
  [[noreturn]] void refuse(const SiemensWord& word, const std::string& name) const {
    for (const auto& [known, does] : kNotRead) {
      if (known == name) fail(word.column, fmt::format("{} {}; it is not supported", name, does));
    }
    if (word.name == "G") fail(word.column, fmt::format("{} is not supported", name));
    std::vector<std::string_view> names;
    for (const CodeEntry& code : kCodes) names.push_back(code.name);
    for (const auto& entry : kNotRead) names.push_back(entry.first);
    for (const std::string_view more :
         {"MSG", "CYCLE832", "CR", "TURN", "ADIS", "ADISPOS", "CTOL"}) {
      names.push_back(more);
    }
    const std::string_view near = word.name.size() > 1 ? nearest_name(name, names) : "";
    if (near == name) fail(word.column, fmt::format("{} does not have this form", name));
    fail(word.column, fmt::format("{} is not supported{}", name,
                                  near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
  }

  int whole(const SiemensWord& word, int least, int most) const {
    if (word.value != std::round(word.value) || word.value < least || word.value > most) {
      fail(word.column, fmt::format("{} = {}; must be an integer from {} to {}", word.name,
                                    word.value, least, most));
    }
    return static_cast<int>(word.value);
  }

  void put_tool(const SiemensWord& word) {
    if (block_.T) fail(word.column, "T appears twice");
    if (word.form == SiemensForm::number) {
      block_.T = SiemensTool{whole(word, 0, 32000), word.column};
      return;
    }
    int number = -1;
    const char* end = word.text.data() + word.text.size();
    const auto result = std::from_chars(word.text.data(), end, number);
    if (word.form != SiemensForm::text || result.ec != std::errc() || result.ptr != end ||
        number < 0 || number > 32000) {
      fail(word.column, fmt::format("T=\"{}\": only numeric tool names are supported", word.text));
    }
    block_.T = SiemensTool{number, word.column};
  }

  void put_M(const SiemensWord& word) {
    if (word.form != SiemensForm::number) fail(word.column, "M requires a number");
    const int number = whole(word, 0, 999);
    if (std::find(std::begin(kMFunctions), std::end(kMFunctions), number) ==
        std::end(kMFunctions)) {
      fail(word.column, fmt::format("M{} is not supported", number));
    }
    block_.M.push_back({word.value, word.form, word.column});
  }

  void put_once(const SiemensWord& word, std::optional<SiemensNumber>& place) const {
    if (place) fail(word.column, fmt::format("{} appears twice", word.name));
    place = SiemensNumber{word.value, word.form, word.column};
  }

  void put_address(const SiemensWord& word) {
    if (word.name.size() == 1) {
      if (const auto axis = axis_of(word.name[0])) {
        return put_once(word, block_.axes[static_cast<std::size_t>(index_of(*axis))]);
      }
      const std::size_t centre = std::string_view("IJK").find(word.name[0]);
      if (centre != std::string_view::npos) return put_once(word, block_.centre[centre]);
    }
    const bool is_through = word.name.size() == 2 && word.name[1] == '1' &&
                            std::string_view("IJK").find(word.name[0]) != std::string_view::npos;
    if (is_through) {
      return put_once(word, block_.through[static_cast<std::size_t>(word.name[0] - 'I')]);
    }
    if (word.form != SiemensForm::number) {
      fail(word.column,
           fmt::format("{}: AC(...) and IC(...) are allowed for axes and I J K only", word.name));
    }
    const std::pair<std::string_view, std::optional<SiemensNumber>*> numbers[] = {
        {"F", &block_.F},       {"S", &block_.S},       {"CR", &block_.CR},
        {"ADIS", &block_.ADIS}, {"CTOL", &block_.CTOL}, {"ADISPOS", &block_.ADISPOS},
        {"MEAS", &block_.MEAS},
    };
    for (const auto& [name, place] : numbers) {
      if (name == word.name) return put_once(word, *place);
    }
    if (word.name == "D") {
      whole(word, 0, 32000);
      return put_once(word, block_.D);
    }
    if (word.name == "TURN") {
      whole(word, 0, 999);
      return put_once(word, block_.TURN);
    }
    refuse(word, word.name);
  }

  void put_call(const SiemensWord& word) {
    if (word.name != "CYCLE832") refuse(word, word.name);
    if (block_.smoothing) fail(word.column, "CYCLE832 appears twice");
    block_.smoothing = SiemensSmoothing{smoothing_tolerance(word), word.column};
  }

  // CYCLE832(tolerance, kind, orientation tolerance): units of `kind` 0 deselects, tens 1 says that
  // the third number is one; other digits switch transformations in older versions. [P] p. 1108
  std::optional<double> smoothing_tolerance(const SiemensWord& word) const {
    std::vector<double> numbers;
    std::string_view rest = word.text;
    while (!rest.empty()) {
      const std::size_t comma = std::min(rest.find(','), rest.size());
      std::string_view text = rest.substr(0, comma);
      while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
      while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
      double value = 0.0;
      const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
      if (result.ec != std::errc() || result.ptr != text.data() + text.size() ||
          !std::isfinite(value)) {
        fail(word.column, fmt::format("CYCLE832({}): the parameters must be numbers", word.text));
      }
      numbers.push_back(value);
      rest.remove_prefix(std::min(comma + 1, rest.size()));
    }
    if (numbers.empty()) return std::nullopt;
    if (numbers.size() != 3) {
      fail(word.column,
           fmt::format("CYCLE832({}): tolerance, type and orientation tolerance are required",
                       word.text));
    }
    constexpr double kKinds[] = {0, 1, 2, 3, 4, 10, 11, 12, 13, 14};
    if (std::find(std::begin(kKinds), std::end(kKinds), numbers[1]) == std::end(kKinds)) {
      fail(word.column,
           fmt::format("CYCLE832({}): types 0 to 4 and 10 to 14 are supported", word.text));
    }
    if (numbers[1] == 0.0 || numbers[1] == 10.0) return std::nullopt;
    if (!(numbers[0] > 0.0)) {
      fail(word.column, fmt::format("CYCLE832({}): the tolerance must be > 0", word.text));
    }
    return numbers[0];
  }

  const std::string& file_;
  SiemensBlock block_;
};

}  // namespace

bool SiemensBlock::has_axes() const {
  return std::any_of(axes.begin(), axes.end(), [](const auto& axis) { return axis.has_value(); });
}

bool SiemensBlock::has_centre() const {
  return std::any_of(centre.begin(), centre.end(), [](const auto& c) { return c.has_value(); });
}

bool SiemensBlock::has_through() const {
  return std::any_of(through.begin(), through.end(), [](const auto& c) { return c.has_value(); });
}

SiemensBlock siemens_block(const SiemensLine& line, int number, const std::string& file) {
  return BlockBuilder(number, file).build(line);
}

}  // namespace servomill::controllers
