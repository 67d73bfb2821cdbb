/// Text with the position of each character in its file, and the base class of readers of CL data.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controllers/gcode/cl_data.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

struct Spot {
  int line = 0, column = 0;
};

/// A text and the position of each of its characters in the file.
struct PlacedText {
  std::string text;
  std::vector<Spot> spots;  // one for each character

  void add(char c, int line, int column) {
    text += c;
    spots.push_back({line, column});
  }
  void clear() {
    text.clear();
    spots.clear();
  }
  /// The characters in [from, to), without blanks at the ends.
  PlacedText trimmed(std::size_t from, std::size_t to) const;
  Spot spot() const { return spots.empty() ? Spot{} : spots.front(); }
};

/// The parts between the separators `at`, trimmed, starting at `from`.
std::vector<PlacedText> split(const PlacedText& whole, std::size_t from, char at);

std::string in_capitals(std::string text);

/// The text as a number; nullopt if it is not a finite number.
std::optional<double> signed_number_in(std::string_view text);

/// Base class of the readers of both forms of CL data: collects the result, the warnings and the
/// faults of one file.
class ClReader {
 public:
  ClReader(const std::string& file, std::vector<Warning>* of_refused)
      : file_(file), of_refused_(of_refused) {}

 protected:
  static constexpr std::size_t kMaxFaults = 100;  // a file of another format has one per line

  Place place(Spot spot) const { return {file_, spot.line, spot.column}; }
  [[noreturn]] void fail(Spot spot, std::string message) const {
    throw InputError(place(spot), std::move(message));
  }
  void warn(Spot spot, std::string message) {
    out_.warnings.push_back({place(spot), std::move(message)});
  }

  double number(const PlacedText& word) const;
  /// The unit vector along k; warns if the length of k is not 1.
  Eigen::Vector3d unit_axis(const Eigen::Vector3d& k, Spot spot);

  /// Reads one statement; if it is refused, its faults are stored and reading continues after it.
  template <class Read>
  void guarded(Read read) {
    try {
      read();
    } catch (const InputError& error) {
      faults_.insert(faults_.end(), error.faults().begin(), error.faults().end());
    }
  }

  /// The data read from the file. @throws InputError with all faults
  ClData finish();

  const std::string& file_;
  std::vector<Warning>* of_refused_;
  ClData out_;
  std::vector<Fault> faults_;
};

}  // namespace servomill::controllers
