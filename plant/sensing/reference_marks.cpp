#include "plant/sensing/reference_marks.h"

#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace servomill::plant {
namespace {

constexpr double kRounding = 1e-9;  // of an interval or revolution, by the period given

std::int64_t floor_of_half(std::int64_t n) { return n >= 0 ? n / 2 : -((1 - n) / 2); }

std::int64_t modulo(std::int64_t n, std::int64_t m) { return (n % m + m) % m; }

int sign(std::int64_t n) { return n > 0 ? 1 : n < 0 ? -1 : 0; }

}  // namespace

MarkParams marks_of_scale(double period, int N, double lower, double upper) {
  const double intervals = std::ceil((upper - lower) / (N * period) - kRounding);
  return {period, N, static_cast<int>(intervals), lower, false};
}

MarkParams marks_of_revolution(int periods, int N) {
  return {2.0 * std::numbers::pi / periods, N, periods / N, 0.0, true};
}

std::vector<std::string> implausible(const MarkParams& p) {
  std::vector<std::string> faults;
  const auto demand = [&](bool holds, const char* rule) {
    if (!holds) faults.emplace_back(rule);
  };
  demand(p.period > 0.0, "period must be > 0");
  demand(p.N > 0 && p.N % 2 == 0, "increment must be even and > 0");
  demand(p.intervals >= 1, "intervals must be >= 1");
  demand(p.intervals < p.N / 2, "intervals must be < N / 2, or the code repeats");
  if (p.closed) {
    const double turns = p.period * p.N * p.intervals / (2.0 * std::numbers::pi);
    demand(std::abs(turns - 1.0) <= kRounding, "increment must divide the periods of a revolution");
  }
  return faults;
}

ReferenceMarks::ReferenceMarks(const MarkParams& params) : params_(params) {
  assert(implausible(params).empty());
}

bool ReferenceMarks::has(std::int64_t mark) const {
  return params_.closed || (mark >= 0 && mark <= 2 * params_.intervals);
}

std::int64_t ReferenceMarks::periods(std::int64_t mark) const {
  const std::int64_t interval = floor_of_half(mark);
  const bool coded = mark != 2 * interval;
  const std::int64_t code = modulo(interval, params_.intervals) + 1;
  return interval * params_.N + (coded ? params_.N / 2 + code : 0);
}

double ReferenceMarks::position(std::int64_t mark) const {
  if (!has(mark))
    return std::copysign(std::numeric_limits<double>::infinity(), mark < 0 ? -1.0 : 1.0);
  return params_.first + static_cast<double>(periods(mark)) * params_.period;
}

std::int64_t ReferenceMarks::above(double x) const {
  double interval = std::floor((x - params_.first) / (params_.N * params_.period));
  if (!params_.closed) interval = std::fmin(std::fmax(interval, 0.0), params_.intervals);
  auto mark = 2 * static_cast<std::int64_t>(interval);
  while (position(mark) <= x) ++mark;
  while (position(mark - 1) > x) --mark;  // the quotient was rounded up
  return mark;
}

std::optional<std::int64_t> ReferenceMarks::decode(std::int64_t M, int D) const {
  assert(D != 0);
  M = std::abs(M);
  const std::int64_t B = 2 * M - params_.N;
  if (B == 0 || std::abs(B) > 2 * params_.intervals) return std::nullopt;
  return (std::abs(B) - sign(B) - 1) * params_.N / 2 + (sign(B) - sign(D)) * M / 2;
}

MarkMonitor::MarkMonitor(const ReferenceMarks& marks, int allowed)
    : marks_(marks), allowed_(allowed) {}

void MarkMonitor::start(double x, double y) {
  x_ = x;
  y_ = y;
  last_.reset();
  settle_before(marks_.above(x));
}

void MarkMonitor::settle_before(std::int64_t next) {
  next_ = next;
  below_ = marks_.position(next - 1);
  above_ = marks_.position(next);
}

std::optional<MarkFault> MarkMonitor::pass_marks(double x, double y) {
  const double slope = (y - y_) / (x - x_);
  const auto reading_at = [&](double mark) { return y_ + slope * (mark - x_); };
  std::optional<MarkFault> first;
  const auto note = [&](const std::optional<MarkFault>& fault) {
    if (!first) first = fault;
  };
  while (x >= above_) {
    note(pass(next_, reading_at(above_)));
    settle_before(next_ + 1);
  }
  while (x < below_) {
    note(pass(next_ - 1, reading_at(below_)));
    settle_before(next_ - 1);
  }
  x_ = x;
  y_ = y;
  return first;
}

std::optional<MarkFault> MarkMonitor::pass(std::int64_t mark, double y) {
  std::optional<MarkFault> fault;
  if (last_) {
    const std::int64_t expected = marks_.periods(mark) - marks_.periods(*last_);
    const std::int64_t counted = std::llround((y - y_last_) / marks_.params().period);
    if (std::abs(counted - expected) > allowed_) {
      fault = {marks_.position(*last_), marks_.position(mark), counted, expected};
    }
  }
  last_ = mark;
  y_last_ = y;
  return fault;
}

}  // namespace servomill::plant
