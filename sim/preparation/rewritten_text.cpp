#include "sim/preparation/rewritten_text.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "controllers/gcode/interpreter.h"
#include "controllers/gcode/printer.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::sim::preparation {
namespace {

constexpr double kPrinted = 1e-8;   // m, rad: what printing may change of a position
constexpr double kDigits = 1e-9;    // relative: what it may change of other numbers
constexpr double kShortTime = 2.0;  // of kPrinted: what a position may change of the way

/// A motion, dwell, tool change, stop or end, with what spindle and coolant do then.
struct Action {
  const Move* move = nullptr;
  AxisWords begin = AxisWords::Zero();
  int direction = 0, coolant = 0;
  double speed = 0.0;  // rad/s

  // s; that of the path of the original for rewritten moves
  double time() const {
    const AxisWords moved = move->end_machine - begin;
    const double turned = moved.tail<3>().norm();
    double length = move->s_end - move->s_begin;
    if (length <= 0.0) length = turned > 0.0 ? turned : moved.head<3>().norm();
    return length / move->feed;
  }
};

/// State of spindle, coolant and axes between one move and the next.
class ActionState {
 public:
  explicit ActionState(const AxisWords& start) { now_.begin = start; }

  /// The action that a move is, or none: then it only sets what goes with the next ones.
  std::optional<Action> take(const Move& move) {
    if (move.kind == MoveKind::message) return std::nullopt;
    if (move.kind == MoveKind::coolant) {
      now_.coolant = move.number;
      return std::nullopt;
    }
    if (move.kind == MoveKind::spindle) {
      now_.direction = move.direction;
      now_.speed = move.value;
      return std::nullopt;
    }
    Action out = now_;
    out.move = &move;
    if (is_motion(move.kind)) now_.begin = move.end_machine;
    return out;
  }

 private:
  Action now_;
};

/// The actions of a program one after the other, each valid until the next one; none behind its
/// end.
class Actions {
 public:
  Actions(const MoveList& moves, const AxisWords& start) : at_(moves.begin()), state_(start) {}

  std::optional<Action> next() {
    if (is_taken_) ++at_;
    is_taken_ = true;
    for (; at_ != std::default_sentinel; ++at_) {
      if (auto action = state_.take(*at_)) return action;
    }
    return std::nullopt;
  }

 private:
  MoveList::Iterator at_;
  bool is_taken_ = false;  // the move at_
  ActionState state_;
};

bool is_close(double a, double b) {
  return std::abs(a - b) <= kDigits * std::max(std::abs(a), std::abs(b));
}

// An arc so short that its ends print alike becomes a line.
bool is_same_kind(MoveKind wanted, MoveKind read) {
  return wanted == read || (wanted == MoveKind::arc && read == MoveKind::feed);
}

bool is_same_feed(const Action& wanted, const Action& read) {
  const Move &a = *wanted.move, &b = *read.move;
  const bool stands = (a.end_machine - wanted.begin).cwiseAbs().maxCoeff() <= kPrinted;
  if (a.kind == MoveKind::rapid || (stands && a.kind == MoveKind::feed)) return true;
  // blocks that are too slow for G93 are written under G94
  const bool is_slow =
      a.feed_mode == FeedMode::inverse_time && b.feed_mode == FeedMode::units_per_minute;
  if (a.feed_mode != b.feed_mode && !is_slow) return false;
  if (a.feed_mode == FeedMode::units_per_revolution) return is_close(a.value, b.value);
  if (a.feed_mode == FeedMode::units_per_minute) return is_close(a.feed, b.feed);
  const double rounding = kShortTime * kPrinted / a.feed;
  return std::abs(wanted.time() - read.time()) <= kDigits * wanted.time() + rounding;
}

// Difference between motions, apart from their end points.
std::optional<std::string_view> difference_of_motions(const Action& wanted, const Action& read) {
  const Move &a = *wanted.move, &b = *read.move;
  if (!is_same_feed(wanted, read)) return "another feed";
  if (a.path_mode != b.path_mode || !is_close(a.path_tolerance, b.path_tolerance)) {
    return "another path mode";
  }
  if (a.work_offset != b.work_offset) return "another work system";
  if (a.tool_offset != b.tool_offset) return "another tool length";
  return std::nullopt;
}

std::optional<std::string_view> difference(const Action& wanted, const Action& read) {
  const Move &a = *wanted.move, &b = *read.move;
  if (!is_same_kind(a.kind, b.kind)) return "another action";
  const bool is_running = wanted.direction != 0;
  if (wanted.direction != read.direction || (is_running && !is_close(wanted.speed, read.speed))) {
    return "the spindle does something else";
  }
  if (wanted.coolant != read.coolant) return "another coolant";
  if (is_motion(a.kind)) return difference_of_motions(wanted, read);
  if (a.kind == MoveKind::dwell && !is_close(a.value, b.value)) return "another dwell";
  if (a.kind != MoveKind::dwell && a.kind != MoveKind::end && a.number != b.number) {
    return "another number";
  }
  return std::nullopt;
}

/// Compares actions of the text with those of the rewritten program as they come.
class ReadBack {
 public:
  ReadBack(const MoveList& rewritten, const RewrittenTextRequest& request)
      : request_(request),
        rewritten_(rewritten),
        wanted_(rewritten, request.setup.start),
        state_(request.setup.start) {}

  /// A move of the text, with what the text cannot say.
  Move take(Move move) {
    const auto read = state_.take(move);
    if (!read) return move;
    const auto wanted = wanted_.next();
    if (!wanted) {
      const Move last = rewritten_[rewritten_.size() - 1];
      if (move.kind == MoveKind::end) return placed(move, last);
      refuse(last, "the text of the rewritten program continues after its end");
    }
    if (const auto why = difference(*wanted, *read)) refuse_text(*wanted->move, *why);
    // dwells and the end of the program, too: in the text their place is one along its own path
    move = placed(std::move(move), *wanted->move);
    if (!is_motion(move.kind)) return move;
    if ((move.end_machine - wanted->move->end_machine).cwiseAbs().maxCoeff() > kPrinted) {
      refuse(*wanted->move,
             "cannot be rewritten in work coordinates that the program tilts, rotates or shifts "
             "(G52, G92, G10)");
    }
    return move;
  }

  void end() {
    if (const auto wanted = wanted_.next()) refuse_text(*wanted->move, "the text ends");
  }

 private:
  static Move placed(Move move, const Move& wanted) {
    move.line = wanted.line;
    move.s_begin = is_motion(move.kind) ? wanted.s_begin : wanted.s_end;
    move.s_end = wanted.s_end;
    return move;
  }
  [[noreturn]] void refuse(const Move& move, std::string_view why) const {
    throw InputError({request_.program_file, move.line},
                     fmt::format("case {}: {}", request_.case_name, why));
  }
  [[noreturn]] void refuse_text(const Move& move, std::string_view why) const {
    refuse(move,
           fmt::format("the text of the rewritten program differs from the rewritten program: {}",
                       why));
  }

  const RewrittenTextRequest& request_;
  const MoveList& rewritten_;
  Actions wanted_;
  ActionState state_;
};

controllers::PrintOptions print_options(const RewrittenTextRequest& request) {
  controllers::PrintOptions options;
  options.axes.clear();
  options.start = request.setup.start;
  for (const auto& axis : request.layout.axis) {
    if (axis) options.axes += letter(*axis);
  }
  return options;
}

// Prints moves as they come, and keeps them.
StoredText printed(const std::function<void(const PutMove&)>& rewrite,
                   const RewrittenTextRequest& request, MoveList& moves) {
  StoredText out;
  controllers::ProgramPrinter printer(print_options(request), request.header,
                                      [&](std::string_view line) {
                                        out.append(line);
                                        out.append("\n");
                                      });
  rewrite([&](const Move& move) {
    printer.print(move);
    moves.push_back(move);
  });
  printer.finish();
  return out;
}

}  // namespace

RewrittenText through_text(const std::function<void(const PutMove&)>& rewrite,
                           const RewrittenTextRequest& request) {
  MoveList rewritten;
  RewrittenText out;
  out.text = std::make_shared<const StoredText>(printed(rewrite, request, rewritten));
  controllers::Interpreter interpreter(
      controllers::ProgramText::of_shared_text(
          out.text,
          fmt::format("{} as rewritten for case {}", request.program_file, request.case_name)),
      request.setup);
  assert(!rewritten.empty());
  ReadBack read_back(rewritten, request);
  while (const Move* next = interpreter.next()) out.moves.push_back(read_back.take(*next));
  read_back.end();
  return out;
}

}  // namespace servomill::sim::preparation
