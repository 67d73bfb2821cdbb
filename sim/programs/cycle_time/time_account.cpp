#include "sim/programs/cycle_time/time_account.h"

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/arc_sweep.h"

namespace servomill::sim::programs {

using controllers::LimitKind;
using controllers::MotionStretch;

namespace {

// Column of a joint; the first is of none.
std::size_t column(int joint) { return joint < 0 ? 0 : static_cast<std::size_t>(joint) + 1; }

}  // namespace

void LimitTimes::add(const MotionStretch& stretch) {
  by_[static_cast<std::size_t>(stretch.kind)][column(stretch.joint)] += stretch.time;
}

void LimitTimes::add(const LimitTimes& other) {
  for (std::size_t k = 0; k < by_.size(); ++k) {
    for (std::size_t j = 0; j < by_[k].size(); ++j) by_[k][j] += other.by_[k][j];
  }
}

double LimitTimes::of(LimitKind kind, int joint) const {
  return by_[static_cast<std::size_t>(kind)][column(joint)];
}

double LimitTimes::of(LimitKind kind) const {
  double sum = 0.0;
  for (const double time : by_[static_cast<std::size_t>(kind)]) sum += time;
  return sum;
}

namespace {

// The limit that bounds one move for longest.
MotionStretch longest_of(const LimitTimes& limits) {
  MotionStretch out;
  for (std::size_t k = 0; k < controllers::kLimitKinds; ++k) {
    for (int j = -1; j < kJoints; ++j) {
      const auto kind = static_cast<LimitKind>(k);
      if (limits.of(kind, j) > out.time) out = {0, limits.of(kind, j), kind, j};
    }
  }
  return out;
}

// Keeps the limit of the longest move of a line.
void book_limit(const MotionStretch& longest, LineTime& line) {
  const bool is_same = line.limit == longest.kind && line.joint == longest.joint;
  const auto time = static_cast<float>(longest.time);
  if (is_same) line.limit_time += time;
  if (is_same || !(time > line.limit_time)) return;
  line.limit = longest.kind;
  line.joint = static_cast<std::int8_t>(longest.joint);
  line.limit_time = time;
}

}  // namespace

// Stretches of one part, gathered move by move.
class TimeAccountant::Part {
 public:
  Part(TimeAccountant& to, const PlannedPart& part)
      : to_(to), part_(part), next_(part.moves.begin()) {}

  void add(const MotionStretch& stretch) {
    if (stretch.move >= index_) {
      close_move();
      go_to(stretch.move);
    }
    time_ += stretch.time;
    if (kind_ != MoveKind::dwell) limits_.add(stretch);
  }

  void finish() {
    close_move();
    go_to(part_.moves.size());
  }

 private:
  // Books the records between two moves that take time.
  void go_to(std::size_t index) {
    for (; index_ < part_.moves.size() && index_ <= index; ++index_, ++next_) {
      const Move& move = *next_;
      if (is_motion(move.kind)) {
        to_.book_travel(move, part_.files[index_]);
      } else {
        to_.note(move);
      }
      if (index_ != index) continue;
      kind_ = move.kind;
      line_ = &to_.line_of(move, part_.files[index_]);
      shares_ = {&to_.out_.total, &to_.out_.tools[to_.tool_],
                 &to_.out_.sections[to_.section_].second};
    }
  }

  void close_move() {
    if (line_ == nullptr) return;
    for (TimeShare* share : shares_) {
      double& time = kind_ == MoveKind::dwell   ? share->dwell
                     : kind_ == MoveKind::rapid ? share->rapid
                                                : share->feed;
      time += time_;
      share->limits.add(limits_);
    }
    line_->time += time_;
    if (kind_ == MoveKind::feed || kind_ == MoveKind::arc) line_->feed_time += time_;
    book_limit(longest_of(limits_), *line_);
    line_ = nullptr;
    time_ = 0.0;
    limits_ = {};
  }

  TimeAccountant& to_;
  const PlannedPart& part_;
  MoveList::Iterator next_;
  std::size_t index_ = 0;  // of the next move
  MoveKind kind_ = MoveKind::rapid;
  LineTime* line_ = nullptr;  // of the move that is being gathered
  std::array<TimeShare*, 3> shares_{};
  double time_ = 0.0;
  LimitTimes limits_;
};

TimeAccountant::TimeAccountant(const JointLayout& layout, const controllers::JointLimits& limits,
                               const controllers::PathOptions& options)
    : layout_(layout), limits_(limits), options_(options) {
  out_.sections.emplace_back();
}

void TimeAccountant::add(const PlannedPart& part) {
  at_ = layout_.words(part.start);
  controls_tip_ = false;
  Part booked(*this, part);
  controllers::for_each_stretch(part.moves, part.trajectory, limits_, options_,
                                [&](const MotionStretch& stretch) { booked.add(stretch); });
  booked.finish();
}

void TimeAccountant::note(const Move& move) {
  switch (move.kind) {
    case MoveKind::tool:
      if (move.number != tool_) ++out_.tool_changes;
      tool_ = move.number;
      break;
    case MoveKind::stop:
      ++out_.stops;
      break;
    case MoveKind::spindle: {
      const std::pair now(move.direction, move.direction == 0 ? 0.0 : std::abs(move.value));
      if (std::exchange(spindle_, now) != now) ++out_.spindle_changes;
      break;
    }
    case MoveKind::message: {
      const auto is_it = [&](const auto& section) { return section.first == move.text; };
      const auto known = std::find_if(out_.sections.begin(), out_.sections.end(), is_it);
      section_ = static_cast<std::size_t>(known - out_.sections.begin());
      if (known == out_.sections.end()) out_.sections.emplace_back(move.text, TimeShare{});
      break;
    }
    default:
      break;
  }
}

// Path of the tool in m, of rotary joints alone in rad; under TCP control that of the tip.
double TimeAccountant::length_of(const Move& move) const {
  const bool controls_tip = move.tool_control != ToolControl::none;
  const double programmed = move.s_end - move.s_begin;
  double length = programmed;
  if (!controls_tip && !controls_tip_) {
    length = move.kind == MoveKind::arc ? arc_sweep(move, at_.head<3>()).length()
                                        : (move.end_machine - at_).head<3>().norm();
  }
  return length > 0.0 ? length : (move.end_machine - at_).tail<3>().norm();
}

void TimeAccountant::book_travel(const Move& move, std::uint16_t file) {
  const double length = length_of(move);
  const bool is_linear = move.s_end > move.s_begin;
  const double travel = is_linear ? length : 0.0;
  const bool is_rapid = move.kind == MoveKind::rapid;
  const bool is_synchronised = move.synchronised != Synchronised::no;
  const double feed = move.feed * (is_synchronised ? 1.0 : options_.feed_override);
  const double at_feed = is_rapid || !(feed > 0.0) ? 0.0 : length / feed;
  if (move.kind == MoveKind::feed && move.number >= 2) ++out_.probings;
  if (is_synchronised) ++out_.synchronised;
  for (TimeShare* share : {&out_.total, &out_.tools[tool_], &out_.sections[section_].second}) {
    (is_rapid ? share->rapid_travel : share->feed_travel) += travel;
    share->at_feed += at_feed;
  }
  LineTime& line = line_of(move, file);
  line.travel += travel;
  line.at_feed += at_feed;
  line.tool = static_cast<std::uint32_t>(std::max(tool_, 0));
  line.section = static_cast<std::uint32_t>(section_);
  at_ = move.end_machine;
  controls_tip_ = move.tool_control != ToolControl::none;
}

LineTime& TimeAccountant::line_of(const Move& move, std::uint16_t file) {
  if (out_.lines.size() <= file) out_.lines.resize(file + 1U);
  std::vector<LineTime>& lines = out_.lines[file];
  const auto line = static_cast<std::size_t>(std::max(move.line, 0));
  if (lines.size() <= line) lines.resize(line + 1);
  return lines[line];
}

}  // namespace servomill::sim::programs
