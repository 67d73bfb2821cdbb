// Every program beside this file gives the records that LinuxCNC's interpreter gave (record.py).
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "controllers/gcode/canon_json.h"
#include "tests/controllers/gcode/program.h"
#include "tests/plant/vocabulary/cox_de_boor.h"

namespace servomill::controllers::conformance_test {
namespace {

constexpr double kLengthTol =
    1e-6;                          // mm and degrees: LinuxCNC prints 9 decimals, in inches at worst
constexpr double kFeedTol = 1e-6;  // relative, for the same reason

// A field of a record: numbers (one or an array), or anything else as it is written.
struct Field {
  std::vector<double> numbers;
  std::string text;
};
using Record = std::map<std::string, Field>;

// Reads a flat JSON object whose values are numbers, arrays of numbers, strings, true or false.
class RecordReader {
 public:
  explicit RecordReader(const std::string& line) : line_(line) {}

  Record read() {
    Record record;
    expect('{');
    while (peek() != '}') {
      const std::string key = string();
      expect(':');
      record[key] = value();
      if (peek() == ',') ++at_;
    }
    return record;
  }

 private:
  char peek() {
    while (line_[at_] == ' ') ++at_;
    return line_[at_];
  }
  void expect(char c) {
    if (peek() != c)
      throw std::runtime_error(fmt::format("{} expected at {} in {}", c, at_, line_));
    ++at_;
  }
  std::string string() {
    expect('"');
    std::string out;
    for (; line_[at_] != '"'; ++at_) {
      if (line_[at_] == '\\') ++at_;
      out += line_[at_];
    }
    ++at_;
    return out;
  }
  double number() {
    peek();
    double x = 0.0;
    const auto result = std::from_chars(&line_[at_], line_.data() + line_.size(), x);
    at_ = static_cast<std::size_t>(result.ptr - line_.data());
    return x;
  }
  Field value() {
    Field field;
    if (peek() == '"') {
      field.text = string();
    } else if (peek() == '[') {
      ++at_;
      while (peek() != ']') {
        field.numbers.push_back(number());
        if (peek() == ',') ++at_;
      }
      ++at_;
    } else if (std::isalpha(static_cast<unsigned char>(peek())) != 0) {
      while (std::isalpha(static_cast<unsigned char>(line_[at_])) != 0) field.text += line_[at_++];
    } else {
      field.numbers.push_back(number());
    }
    return field;
  }

  const std::string& line_;
  std::size_t at_ = 0;
};

Record record_of(const std::string& line) { return RecordReader(line).read(); }

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  EXPECT_TRUE(in) << path;
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<Record> recorded(const std::filesystem::path& path) {
  std::vector<Record> records;
  std::ifstream in(path);
  EXPECT_TRUE(in) << path;
  for (std::string line; std::getline(in, line);) records.push_back(record_of(line));
  return records;
}

std::vector<Record> interpreted(const std::filesystem::path& program) {
  ProgramSetup setup;
  const std::filesystem::path table = program.parent_path() / "tools.tbl";
  setup.tools = ToolTable::parse(read_file(table), table.string());
  setup.probed = std::make_shared<AssumedContact>();
  setup.block_delete = program.stem().string().ends_with("block_delete_on");
  setup.subroutine_file = [&](const std::string& name) -> std::optional<ProgramText> {
    const std::filesystem::path file = program.parent_path() / "subs" / (name + ".ngc");
    if (!std::filesystem::exists(file)) return std::nullopt;
    return ProgramText::of_file(file.string());
  };
  std::vector<Record> records;
  try {
    Interpreter interpreter(read_file(program), program.string(), setup);
    while (const Move* move = interpreter.next()) {
      const bool is_compared =
          move->kind != MoveKind::coolant && move->synchronised != Synchronised::tap_out;
      if (is_compared) records.push_back(record_of(canon_json(*move)));
    }
  } catch (const InputError& error) {
    records.push_back(record_of(canon_error_json("")));
    records.back()["line"].numbers = {static_cast<double>(error.faults().front().place.line)};
  }
  return records;
}

// Ends of the chords in which LinuxCNC shows a spline: 15 for each control point, of equal steps
// of the parameter; the last may have no length.
void add_chords(Record& ours, const Record& theirs) {
  const auto chords = theirs.find("chord_x");
  if (chords == theirs.end() || ours.find("order") == ours.end()) return;
  const std::vector<double>&x = ours["x"].numbers, &y = ours["y"].numbers;
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < x.size(); ++i) points.emplace_back(x[i], y[i], 0.0);
  const CoxDeBoor curve(static_cast<int>(ours["order"].numbers[0]), points,
                        ours["weights"].numbers);
  const std::size_t steps = 15 * x.size();
  for (std::size_t i = 1; i <= chords->second.numbers.size(); ++i) {
    const double share = static_cast<double>(std::min(i, steps)) / static_cast<double>(steps);
    const Eigen::Vector3d p = curve.point(share * curve.last_knot());
    ours["chord_x"].numbers.push_back(p.x());
    ours["chord_y"].numbers.push_back(p.y());
  }
}

// LinuxCNC names no rotation with S and no line with some records: what it names must agree, but
// for the file in which a subroutine stands.
std::string difference(Record ours, const Record& theirs) {
  add_chords(ours, theirs);
  for (const auto& [key, wanted] : theirs) {
    if (key == "file") continue;
    const auto found = ours.find(key);
    if (found == ours.end()) return key + " is missing";
    if (found->second.text != wanted.text) return key;
    if (found->second.numbers.size() != wanted.numbers.size()) return key;
    for (std::size_t i = 0; i < wanted.numbers.size(); ++i) {
      const double x = wanted.numbers[i];
      const double tolerance = key == "feed" ? kFeedTol * x : kLengthTol;
      if (!(std::abs(found->second.numbers[i] - x) <= tolerance)) return key;
    }
  }
  return "";
}

std::vector<std::filesystem::path> programs() {
  std::vector<std::filesystem::path> paths;
  const std::filesystem::path folder =
      std::filesystem::path(SERVOMILL_SOURCE_DIR) / "tests/conformance/programs";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".ngc") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

class Conformance : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(Conformance, AgreesWithLinuxCnc) {
  std::filesystem::path answers = GetParam();
  answers.replace_extension(".jsonl");
  const std::vector<Record> wanted = recorded(answers);
  const std::vector<Record> found = interpreted(GetParam());
  for (std::size_t i = 0; i < std::min(wanted.size(), found.size()); ++i) {
    EXPECT_EQ(difference(found[i], wanted[i]), "") << answers.filename() << ":" << i + 1;
  }
  EXPECT_EQ(found.size(), wanted.size());
}

INSTANTIATE_TEST_SUITE_P(Programs, Conformance, testing::ValuesIn(programs()),
                         [](const auto& tested) { return tested.param.stem().string(); });

}  // namespace
}  // namespace servomill::controllers::conformance_test
