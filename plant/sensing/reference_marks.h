/// Distance-coded reference marks, and what a displaced reading does to the count between them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace servomill::plant {

/// Constant description of the reference track of a linear scale (m) or a rotary encoder (rad).
/// A fixed mark stands every N signal periods, a coded one between each two of them; i counts the
/// intervals of N from mark 0 on:
///
///     fixed i           coded i              fixed i+1
///       |-- N/2 + i + 1 --|-- N/2 - (i + 1) --|          in signal periods
///
/// so that every distance between neighbours occurs once. N = 1000, 20 um: LS 486C, marks every
/// 10 mm more or less, and two of them are met within 20.02 mm of travel.
struct MarkParams {
  double period = 0.0;  // m or rad, of the signal
  int N = 1000;         // signal periods between fixed marks, even
  int intervals = 0;    // of N periods on the scale or once around, < N / 2
  double first = 0.0;   // m or rad, coordinate of fixed mark 0
  bool closed = false;  // once around: behind the last interval comes the first
  bool operator==(const MarkParams&) const = default;
};

/// Marks of a scale that covers [lower, upper] (m); fixed mark 0 is at lower.
MarkParams marks_of_scale(double period, int N, double lower, double upper);

/// Marks of a rotary encoder (RON 785C: 18 000 periods, N = 1000); fixed mark 0 is at angle 0.
MarkParams marks_of_revolution(int periods, int N);

/// Rules that the values break, each as "KEY RULE". Empty for a possible track.
std::vector<std::string> implausible(const MarkParams& params);

/// The marks as integers: mark 2 i is fixed mark i, mark 2 i + 1 the coded one behind it; on a
/// closed track the numbers go on around, negative ones too.
class ReferenceMarks {
 public:
  /// @pre implausible(params) is empty
  explicit ReferenceMarks(const MarkParams& params);

  const MarkParams& params() const { return params_; }
  /// True if there is such a mark: 0 <= mark <= 2 intervals, always on a closed track.
  bool has(std::int64_t mark) const;
  /// Signal periods from fixed mark 0 to a mark.
  std::int64_t periods(std::int64_t mark) const;
  /// Coordinate of a mark (m or rad), +-infinity for those beyond the ends of an open track.
  double position(std::int64_t mark) const;
  /// Lowest mark with position > x; on an open track at most 2 intervals + 1, which is none.
  std::int64_t above(double x) const;

  /// Place of the mark that was passed first, from the signal periods between it and its neighbour:
  ///
  ///     B = 2 |M| - N,   P1 = (|B| - sgn B - 1) N/2 + (sgn B - sgn D) |M|/2
  ///
  /// @param M  signal periods counted between the two marks; its sign does not matter
  /// @param D  direction of travel, > 0 towards larger coordinates
  /// @return signal periods from fixed mark 0, or nullopt if no two neighbours are M apart. On a
  ///         scale of many intervals a wrong count is often the right one of another place.
  /// Source: encoder maker's formula; it is the inverse of the track above.
  std::optional<std::int64_t> decode(std::int64_t M, int D) const;

 private:
  MarkParams params_;
};

/// The count between two marks was not what the scale has there.
struct MarkFault {
  double from = 0.0, to = 0.0;  // m or rad, coordinates of the two marks, in order of travel
  std::int64_t counted = 0;     // signal periods, negative towards smaller coordinates
  std::int64_t expected = 0;    // the same
  bool operator==(const MarkFault&) const = default;
};

/// Watches the marks as a NC does that reads a displaced signal. The marks sit on the scale, so
/// their pulses come at true positions x; the periods are counted in the signal the NC gets, whose
/// reading is y = x + d. From mark a to mark b it counts
///
///     round((y_b - y_a) / period) = periods from a to b + round((d_b - d_a) / period),
///
/// which is wrong as soon as the displacement has changed by more than half a period. The same
/// holds for a mark that is passed again after a reversal (expected: 0). x and y run linearly
/// between samples. Does not allocate.
class MarkMonitor {
 public:
  /// @param allowed  periods by which the count may be wrong
  explicit MarkMonitor(const ReferenceMarks& marks, int allowed = 0);

  /// Begins at true position x with reading y (m or rad); no mark has been passed yet.
  void start(double x, double y);

  /// Moves on to x, y. Of several faults in one step the first is reported.
  /// @pre start() came before; both are finite and continuous, y is not wrapped
  std::optional<MarkFault> advance(double x, double y) {
    if (x >= below_ && x < above_) {
      x_ = x;
      y_ = y;
      return std::nullopt;
    }
    return pass_marks(x, y);
  }

  /// Calls visit(span) with each part of what it remembers: values without pointers and gaps.
  template <class Visit>
  void each_part(Visit visit) {
    for (double* one : {&x_, &y_, &below_, &above_, &y_last_}) visit(std::span(one, 1));
    visit(std::span(&next_, 1));
    bool any = last_.has_value();
    std::int64_t last = last_.value_or(0);
    visit(std::span(&any, 1));
    visit(std::span(&last, 1));
    last_ = any ? std::optional(last) : std::nullopt;
  }

 private:
  std::optional<MarkFault> pass_marks(double x, double y);
  std::optional<MarkFault> pass(std::int64_t mark, double y);
  void settle_before(std::int64_t next);

  ReferenceMarks marks_;
  int allowed_;
  double x_ = 0.0, y_ = 0.0;          // last sample
  std::int64_t next_ = 0;             // lowest mark above x_
  double below_ = 0.0, above_ = 0.0;  // coordinates of marks next_ - 1 and next_
  std::optional<std::int64_t> last_;  // mark passed last,
  double y_last_ = 0.0;               // and the reading there
};

}  // namespace servomill::plant
