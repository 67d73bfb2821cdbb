// Words of positioning blocks and the end points that follow from them.
#include <fmt/format.h>

#include <cmath>

#include "controllers/conversational/translator.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::conversational {
namespace {

char letter_of(std::size_t axis) { return letter(kAllAxes[axis]); }

// Index of the axis of an address such as X, IX; nullopt: none.
std::optional<std::size_t> axis_of_address(std::string_view address, bool& is_increment) {
  is_increment = address.size() == 2 && address.front() == 'I';
  if (is_increment) address.remove_prefix(1);
  if (address.size() != 1) return std::nullopt;
  const auto axis = servomill::axis_of(address.front());
  if (!axis) return std::nullopt;
  return static_cast<std::size_t>(index_of(*axis));
}

}  // namespace

Positioning::Target Translator::target_of(const Operand& operand, bool is_increment) {
  return {operand, is_increment};
}

Positioning Translator::read_positioning(Words& words, std::string_view block) {
  Positioning p;
  while (words.peek() != nullptr && read_word(words, p, block)) {
  }
  return p;
}

// False for a word of the block that calls.
bool Translator::read_word(Words& words, Positioning& p, std::string_view block) {
  const HeidenhainWord& word = *words.peek();
  const std::string text = word.text, address = word.address;
  const Place place = word.place;
  if (read_target(words, p) || read_side(words, p)) return true;
  if (address == "PR" || address == "IPR") {
    p.polar_radius = target_of(*words.take_number(address), address.front() == 'I');
  } else if (address == "PA" || address == "IPA") {
    p.polar_angle = target_of(*words.take_number(address), address.front() == 'I');
  } else if ((address == "M" && !word.rest.empty()) || text == "STOP") {
    read_function(words, p);
  } else if (!address.empty() && address.front() == 'F') {
    read_feed(words, p);
  } else {
    const bool is_parallel = address == "U" || address == "V" || address == "W";
    if (block == "L" && is_parallel) {
      fail(place, fmt::format("'{}': axes U, V and W are not supported", text));
    }
    return false;
  }
  return true;
}

bool Translator::read_target(Words& words, Positioning& p) {
  const HeidenhainWord& word = *words.peek();
  bool is_increment = false;
  const auto axis = axis_of_address(word.address, is_increment);
  if (!axis) return false;
  auto& target = p.target[*axis];
  if (target) {
    fail(word.place,
         fmt::format("'{}': {} appears twice in the block", word.text, letter_of(*axis)));
  }
  target = target_of(*words.take_number(std::string(word.address)), is_increment);
  return true;
}

// R0, RL, RR, DR+, DR-.
bool Translator::read_side(Words& words, Positioning& p) {
  const HeidenhainWord& word = *words.peek();
  const std::string text = word.text;
  if (text == "R+" || text == "R-") {
    fail(word.place,
         fmt::format("'{}': paraxial compensation is not supported; program the position with R0",
                     text));
  }
  const bool is_side = text == "R0" || text == "RL" || text == "RR";
  const bool is_direction = text == "DR+" || text == "DR-";
  if (!is_side && !is_direction) return false;
  if (is_side && p.side)
    fail(word.place, fmt::format("'{}': radius compensation appears twice in the block", text));
  if (is_side) p.side = text == "R0" ? 0 : text == "RL" ? 1 : -1;
  if (is_direction) p.direction = text.back() == '+' ? 1 : -1;
  words.take(text);
  return true;
}

bool Translator::read_function(Words& words, Positioning& p) {
  const HeidenhainWord* word = words.take_next();
  const Place place = word->place;
  if (word->text == "STOP") {
    p.functions.emplace_back(0, place);
    return true;
  }
  const int m = whole(value(operand_of(word->rest, place)), 999, place, "M");
  p.functions.emplace_back(m, place);
  if (m == 140) {
    p.is_retract_to_limit = words.take("MBMAX") != nullptr ||
                            (words.take("MB") != nullptr && words.take("MAX") != nullptr);
    if (p.is_retract_to_limit) return true;
    const auto retract = words.take_number("MB");
    if (!retract) fail(place, "M140 requires MB with a number");
    p.retract = length(*retract);
  }
  return true;
}

// mm/min; in programs in INCH tenths of an inch per minute (TNC 7 user's manual, Cutting data).
double Translator::feed_per_minute(const Operand& operand) const {
  const double F = value(operand);
  if (!(F > 0.0)) fail(operand.place, fmt::format("F{:g}: the feed rate must be > 0", F));
  return F * (is_inch_ ? 2.54 : 1.0);
}

bool Translator::read_feed(Words& words, Positioning& p) {
  const HeidenhainWord* word = words.peek();
  const Place place = word->place;
  const std::string text = word->text, address = word->address;
  if (p.feed) fail(place, fmt::format("'{}': the feed rate appears twice in the block", text));
  if (text == "FMAX") {
    words.take_next();
    p.feed = Feed{};
  } else if (text == "FAUTO") {
    words.take_next();
    if (!tool_call_feed_) fail(place, "FAUTO: the last TOOL CALL has no F");
    p.feed = Feed{Feed::Kind::per_minute, *tool_call_feed_};
  } else if (address == "F") {
    p.feed = Feed{Feed::Kind::per_minute, feed_per_minute(*words.take_number("F"))};
  } else if (address == "FT") {
    const double time = value(*words.take_number("FT"));
    if (!(time > 0.0)) fail(place, fmt::format("'{}': the time must be > 0", text));
    p.feed = Feed{Feed::Kind::time, time};
  } else if (address == "FU") {
    if (!speed_) fail(place, "FU requires S; none programmed since the last TOOL CALL");
    p.feed = Feed{Feed::Kind::per_minute, length(*words.take_number("FU")) * *speed_};
  } else {
    fail(place,
         fmt::format("'{}': this type of feed rate is not supported; program F in mm/min", text));
  }
  return true;
}

// From here on a survey knows no feeds.
void Translator::forget_feeds(const std::string& why) {
  warn_once("feeds " + why, why + "; the cycle time is unknown");
  are_feeds_unknown_ = true;
}

Feed Translator::modal_feed() {
  const std::string why = "no feed rate is active; program F";
  if (!feed_ && !setup_.accepts_unknown_feeds) fail(why);
  if (!feed_) {
    warn_once("feed", why + "; the cycle time is unknown");
    return {Feed::Kind::unknown};
  }
  return {Feed::Kind::per_minute, *feed_};
}

Feed Translator::feed_of(const Positioning& p) {
  if (p.feed && p.feed->kind == Feed::Kind::per_minute) feed_ = p.feed->value;
  Feed feed = p.feed ? *p.feed : modal_feed();
  was_rapid_ = feed.kind == Feed::Kind::rapid;
  return feed;
}

// ------------------------------------------------------------------------------------- coordinates

std::optional<Point> Translator::work_point(int normal) const {
  const auto axes = plane_axes(normal);
  if (!work_[axes[0]] || !work_[axes[1]]) return std::nullopt;
  return Point(*work_[axes[0]], *work_[axes[1]]);
}

std::optional<Point> Translator::program_point(int normal) const {
  const auto work = work_point(normal);
  if (!work) return std::nullopt;
  if (normal == 2) return frame_.to_program(*work);
  const auto axes = plane_axes(normal);
  if (frame_.couples_plane())
    fail("a circle in a plane with Z is not supported while cycle 10 is active");
  return Point(frame_.to_program(axes[0], work->x()), frame_.to_program(axes[1], work->y()));
}

// Sets both coordinates of the plane as if they had been programmed.
void Translator::set_program_point(Positioning& p, int normal, const Point& point) const {
  const auto axes = plane_axes(normal);
  for (std::size_t i = 0; i < 2; ++i) {
    Operand operand;
    operand.number = point[static_cast<Eigen::Index>(i)] / unit();
    operand.place = place_;
    p.target[axes[i]] = target_of(operand, false);
  }
}

// X and Y under a rotation.
void Translator::ends_in_plane(const Positioning& p, Values& end, bool& is_incremental) {
  if (!p.target[0] && !p.target[1]) return;
  const bool is_free =
      (!p.target[0] || p.target[0]->is_increment) && (!p.target[1] || p.target[1]->is_increment);
  const auto now = program_point(2);
  Point to = now.value_or(Point::Zero());
  bool needs_now = false;
  for (int i = 0; i < 2; ++i) {
    const auto& target = p.target[static_cast<std::size_t>(i)];
    needs_now = needs_now || !target || target->is_increment;
    if (target) to[i] = (target->is_increment ? to[i] : 0.0) + length(target->value);
  }
  if (needs_now && !now) {
    if (!is_free)
      fail("the coordinate system is rotated, and the position of X or Y is unknown here");
    is_incremental = true;
    to = frame_.to_work(to) - frame_.to_work(Point::Zero());
  } else {
    to = frame_.to_work(to);
  }
  end[0] = to.x();
  end[1] = to.y();
}

// True if all axes of the block count from positions that are unknown.
bool Translator::counts_from_unknown(const Positioning& p) const {
  std::size_t named = 0, free = 0, first_free = 0;
  for (std::size_t i = 0; i < p.target.size(); ++i) {
    if (!p.target[i]) continue;
    ++named;
    if (!p.target[i]->is_increment || work_[i]) continue;
    if (free++ == 0) first_free = i;
  }
  if (free > 0 && free < named) {
    fail(p.target[first_free]->value.place,
         fmt::format("I{0}: the position of {0} is unknown here; program an absolute position",
                     letter_of(first_free)));
  }
  return free > 0;
}

// End positions of the axes in the block. An increment from an unknown position stays an increment.
Values Translator::ends(const Positioning& p, bool& is_incremental) {
  Values end;
  is_incremental = counts_from_unknown(p);
  const bool is_coupled = frame_.couples_plane();
  if (is_coupled) ends_in_plane(p, end, is_incremental);
  for (std::size_t i = is_coupled ? 2 : 0; i < end.size(); ++i) {
    if (!p.target[i]) continue;
    const auto& target = *p.target[i];
    const double written = i < 3 ? length(target.value) : value(target.value);
    if (is_incremental) {
      end[i] = frame_.increment(i, written);
    } else if (target.is_increment) {
      end[i] = *work_[i] + frame_.increment(i, written);
    } else {
      end[i] = i < 3 ? frame_.to_work(i, written) : rotary_end(i, written, target.value.place);
    }
  }
  if (end[2] && frame_.scale != 1.0) {
    fail("Z moves while cycle 11 is active: MP7410 determines whether it is scaled; move Z first");
  }
  return end;
}

// M126 takes the shorter way of an axis without ends of travel; without M126 and M127 that is up to
// MP7682. iTNC 530 (340 420) user's manual, M126.
double Translator::rotary_end(std::size_t axis, double program, const Place& place) {
  const double target = frame_.to_work(axis, program);
  if (!work_[axis]) return target;
  const double to = target + revolutions_[axis];
  const double way = to - *work_[axis];
  constexpr double kHalfTurn = 180.0, kRounding = 1e-9;
  if (std::abs(way) < kHalfTurn - kRounding) return to;
  if (is_shorter_path_ && !*is_shorter_path_) return to;
  bool is_endless = true, is_known = false;
  if (setup_.machine) {
    if (const auto joint = setup_.machine->chain().layout.joint_of(kAllAxes[axis])) {
      is_known = true;
      const plant::InverseSettings& travel = setup_.machine->inverse().settings();
      is_endless = std::isinf(travel.lower[*joint]) || std::isinf(travel.upper[*joint]);
    }
  }
  if (is_known && !is_endless) return to;
  const double shorter = std::remainder(way, 2.0 * kHalfTurn);
  if (!is_shorter_path_ || !is_known) {
    fail(place,
         fmt::format(
             "{0} would rotate by {1:g} degrees, or by {2:g} in the shorter direction: {3}",
             letter_of(axis), way, shorter,
             is_shorter_path_
                 ? "M126 acts only on axes without travel limits; pass the machine with --machine"
                 : "the direction depends on the machine (MP7682); program M126 or M127"));
  }
  if (std::abs(std::abs(shorter) - kHalfTurn) < 1e-6) {
    fail(place, fmt::format("{} would rotate by 180 degrees: the direction is undetermined",
                            letter_of(axis)));
  }
  revolutions_[axis] = *work_[axis] + shorter - target;
  return *work_[axis] + shorter;
}

}  // namespace servomill::controllers::conversational
