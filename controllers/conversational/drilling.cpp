// Drilling cycles as their moves. Sources: iTNC 530 cycle programming (the sequence of each cycle);
// page numbers are from memory where none is given.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/conversational/translator.h"

namespace servomill::controllers::conversational {
namespace {

constexpr int kMaxPecks = 10000;

}  // namespace

/// Heights of a hole, in coordinates of the program (mm).
struct Translator::Hole {
  double surface = 0.0, bottom = 0.0, clearance = 0.0, second = 0.0;
};

double Translator::q(int number) const { return parameters_.get({'Q', number}, place_); }

Feed Translator::cycle_feed(double per_minute) const {
  if (!(per_minute > 0.0))
    fail(fmt::format("feed rate of the cycle F{:g}; must be > 0", per_minute));
  if (per_minute >= 99999.0) return {};  // FMAX
  return {Feed::Kind::per_minute, per_minute * (is_inch_ ? 2.54 : 1.0)};
}

void Translator::cycle_move(const Feed& feed, double Z) {
  Motion motion;
  motion.place = place_;
  motion.feed = feed;
  motion.words[2] = frame_.to_work(2, Z);
  add(std::move(motion));
}

void Translator::cycle_dwell(double seconds) {
  if (seconds < 0.0) fail(fmt::format("dwell time {:g} s; must be >= 0", seconds));
  if (seconds > 0.0) note("G4 " + word('P', seconds));
}

// Q200 set-up clearance, Q201 depth, Q203 coordinate of the surface, Q204 second clearance. The
// sign of the depth is the direction of work; upwards is for tools that are not here.
Translator::Hole Translator::hole() const {
  Hole out;
  const double depth = q(201) * unit();
  if (q(200) < 0.0) fail("Q200 must be >= 0");
  if (depth > 0.0)
    fail("Q201 > 0: MP7441 determines whether the control rejects it; program a negative depth");
  out.surface = q(203) * unit();
  out.clearance = out.surface + q(200) * unit();
  out.bottom = out.surface + depth;
  const auto second = parameters_.find({'Q', 204});
  out.second = std::max(out.clearance, out.surface + second.value_or(0.0) * unit());
  return out;
}

void Translator::leave_hole(const Hole& hole) {
  if (hole.second > hole.clearance) cycle_move({}, hole.second);
}

void Translator::drill() {
  if (!cycle_ || cycle_->number == 247 || cycle_->number == 32) fail("no cycle is defined");
  if (cycle_->values.size() != cycle_->value_count) {
    fail(fmt::format("cycle {0} is incomplete; CYCL DEF {0}.1 to {0}.{1} are required",
                     cycle_->number, cycle_->value_count));
  }
  require_no_compensation("a drilling cycle");
  if (is_tcp_) fail("a drilling cycle is not allowed with M128; cancel it with M129");
  if (!cycle_->why_unknown.empty()) {
    return leave_positions_unknown(fmt::format("CYCL DEF {}", cycle_->number), cycle_->why_unknown);
  }
  if (frame_.scale != 1.0) fail("a drilling cycle is not supported while cycle 11 is active");
  last_element_.reset();
  run_drilling_cycle();
  was_rapid_ = true;
}

// The line holds the place of moves that a survey does not know.
void Translator::leave_moves_out(const std::string& whose, std::string line) {
  path_.note({std::move(line), place_, {false, false, whose}});
}

// The call of a cycle that a survey cannot follow. Surveys take the second home of G30 for a
// position that is not known.
void Translator::leave_positions_unknown(const std::string& whose, const std::string& why) {
  warn_once(whose, fmt::format("{}: {}; extent and cycle time exclude its moves", whose, why));
  leave_moves_out(whose, "G91 G30 X0 Y0 Z0");
  note("G90");
  forget_linear_positions();
}

void Translator::run_drilling_cycle() {
  switch (cycle_->number) {
    case 1:
      drill_old();
      break;
    case 2:
    case 17:
      tap_old(cycle_->number == 17);
      break;
    case 200:
      drill_200();
      break;
    case 201:
      ream_201();
      break;
    case 202:
      bore_202();
      break;
    case 203:
      drill_203();
      break;
    case 205:
      peck_205();
      break;
    case 206:
    case 207:
      tap(cycle_->number == 207);
      break;
    case 209:
      tap_209();
      break;
    default:
      centre_240();
  }
}

// Pecking: values are set-up clearance, depth, pecking depth, dwell, F. It begins where the tool
// is. It returns to t above the depth before: 0.6 mm up to 30 mm of depth, else 1/50 of it, 7 mm at
// most. [407] p. 8-5
void Translator::drill_old() {
  if (!work_[2]) fail("cycle 1 starts at the current Z, which is unknown here; program Z first");
  const double start = frame_.to_program(2, *work_[2]);
  const double clearance = std::abs(cycle_->values[0]) * unit(), depth = cycle_->values[1] * unit();
  const double peck = std::abs(cycle_->values[2]) * unit(), dwell = cycle_->values[3];
  const Feed feed = cycle_feed(cycle_->values[4]);
  if (depth >= 0.0 || peck == 0.0) fail("cycle 1: depth and pecking depth must be negative");
  const double surface = start - clearance;
  const double total = -depth;
  const double stop = total <= 30.0 ? 0.6 : std::min(total / 50.0, 7.0);
  double done = std::min(peck, total);
  cycle_move(feed, surface - done);
  for (int i = 0; done < total; ++i) {
    if (i == kMaxPecks) fail("cycle 1: too many pecks");
    cycle_move({}, start);
    if (stop < done) cycle_move({}, surface - done + stop);
    done = std::min(done + peck, total);
    cycle_move(feed, surface - done);
  }
  cycle_dwell(dwell);
  cycle_move({}, start);
}

// Tapping, which begins where the tool is. Cycle 2, with a floating holder: set-up clearance,
// depth, dwell, F; at the depth the spindle reverses, the tool returns after the dwell, and there
// the spindle reverses again: [407] p. 8-7. Cycle 17, rigid: set-up clearance, depth, pitch, whose
// sign is the hand of the thread; the spindle stops at the start (from memory).
void Translator::tap_old(bool is_rigid) {
  const int number = is_rigid ? 17 : 2;
  if (!work_[2]) {
    fail(fmt::format("cycle {} starts at the current Z, which is unknown here; program Z first",
                     number));
  }
  if (!speed_ || *speed_ == 0.0)
    fail("tapping requires S; none programmed since the last TOOL CALL");
  if (!is_rigid && spindle_ == 0) fail("cycle 2 requires M3 or M4");
  const std::vector<double>& values = cycle_->values;
  const double start = frame_.to_program(2, *work_[2]);
  const double depth = values[1] * unit();
  if (depth >= 0.0) fail(fmt::format("cycle {}: the depth must be negative", number));
  const double pitch = is_rigid ? values[2] * unit() : 0.0;
  if (is_rigid && pitch == 0.0) fail("cycle 17: the pitch must not be 0");
  const bool is_left = is_rigid ? pitch < 0.0 : spindle_ < 0;
  const Feed feed =
      is_rigid ? Feed{Feed::Kind::per_minute, std::abs(pitch) * *speed_} : cycle_feed(values[3]);
  if (is_rigid) note(is_left ? "M4" : "M3");
  cycle_move(feed, start - std::abs(values[0]) * unit() + depth);
  note(is_left ? "M3" : "M4");
  if (!is_rigid) cycle_dwell(values[2]);
  cycle_move(feed, start);
  if (is_rigid) {
    note("M5");
    spindle_ = 0;
  } else {
    note(is_left ? "M4" : "M3");
  }
}

// To the set-up clearance at rapid; infeeds of Q202 at Q206, between them to the set-up clearance
// at rapid, dwell Q210, and at rapid to the set-up clearance above the depth before; dwell Q211;
// out at rapid.
void Translator::drill_200() {
  const Hole h = hole();
  const Feed feed = cycle_feed(q(206));
  const double peck = q(202) * unit(), dwell_above = parameters_.find({'Q', 210}).value_or(0.0);
  if (!(peck > 0.0)) fail("Q202 must be > 0");
  cycle_move({}, h.clearance);
  double at = std::max(h.surface - peck, h.bottom);
  cycle_move(feed, at);
  for (int i = 0; at > h.bottom; ++i) {
    if (i == kMaxPecks) fail("cycle 200: too many infeeds");
    cycle_move({}, h.clearance);
    cycle_dwell(dwell_above);
    cycle_move({}, std::min(at + (h.clearance - h.surface), h.clearance));
    at = std::max(at - peck, h.bottom);
    cycle_move(feed, at);
  }
  cycle_dwell(parameters_.find({'Q', 211}).value_or(0.0));
  cycle_move({}, h.clearance);
  leave_hole(h);
}

// In at Q206, dwell Q211, out at Q208; Q208 = 0: at Q206.
void Translator::ream_201() {
  const Hole h = hole();
  cycle_move({}, h.clearance);
  cycle_move(cycle_feed(q(206)), h.bottom);
  cycle_dwell(q(211));
  cycle_move(cycle_feed(q(208) > 0.0 ? q(208) : q(206)), h.clearance);
  leave_hole(h);
}

// As 201; the spindle stops in an orientation, and Q214 frees the tool from the wall.
void Translator::bore_202() {
  if (q(214) != 0.0) {
    const std::string why =
        "cycle 202 with Q214: the feed rate of the disengaging move is unknown; set Q214=0, or "
        "program the moves";
    if (!setup_.accepts_unknown_positions) fail(why);
    warn_once("Q214", why + "; extent and cycle time exclude it");
    leave_moves_out("CYCL DEF 202", "G90");
  }
  warn_once("cycle 202",
            "CYCL DEF 202: the spindle orientation at the bottom is ignored; no effect on motion");
  ream_201();
}

// As 200 with a pecking depth that shrinks by Q212 down to Q205, with Q213 chip breaks by Q256, and
// out at Q208 (0: Q206).
void Translator::drill_203() {
  const Hole h = hole();
  const Feed feed = cycle_feed(q(206));
  const Feed out = cycle_feed(q(208) > 0.0 ? q(208) : q(206));
  double peck = q(202) * unit();
  const double smaller = q(212) * unit(), smallest = q(205) * unit();
  const double breaks = q(213);
  if (!(peck > 0.0)) fail("Q202 must be > 0");
  if (breaks > 0.0 && !parameters_.find({'Q', 256})) {
    fail(
        "cycle 203 with Q213 requires Q256: without it older controls retract by 0.2 mm, newer "
        "ones by Q256");
  }
  const double back = breaks > 0.0 ? q(256) * unit() : 0.0;
  cycle_move({}, h.clearance);
  double at = std::max(h.surface - peck, h.bottom);
  cycle_move(feed, at);
  double left = breaks;
  for (int i = 0; at > h.bottom; ++i) {
    if (i == kMaxPecks) fail("cycle 203: too many infeeds");
    if (left > 0.0) {
      --left;
      cycle_move(out, at + back);
    } else {
      left = breaks;
      cycle_move(out, h.clearance);
      cycle_dwell(q(210));
      cycle_move({}, std::min(at + (h.clearance - h.surface), h.clearance));
    }
    if (smaller > 0.0) peck = std::max(peck - smaller, std::max(smallest, 1e-3));
    at = std::max(at - peck, h.bottom);
    cycle_move(feed, at);
  }
  cycle_dwell(q(211));
  cycle_move(out, h.clearance);
  leave_hole(h);
}

// Full retracts between infeeds, back to Q258 above the depth before; chip breaks of Q256 after
// every Q257.
void Translator::peck_205() {
  const Hole h = hole();
  const Feed feed = cycle_feed(q(206));
  double peck = q(202) * unit();
  if (!(peck > 0.0)) fail("Q202 must be > 0");
  if (q(258) != q(259))
    fail("cycle 205: Q258 and Q259 must be equal: the transition between them is undocumented");
  if (parameters_.find({'Q', 379}).value_or(0.0) != 0.0)
    fail("cycle 205 with Q379 (recessed starting point) is not supported");
  const double above = q(258) * unit(), step = q(257) * unit(), back = q(256) * unit();
  const double smaller = q(212) * unit(), smallest = q(205) * unit();
  cycle_move({}, h.clearance);
  double at = h.surface;
  for (int i = 0; at > h.bottom; ++i) {
    if (i == kMaxPecks) fail("cycle 205: too many infeeds");
    const double to = std::max(at - peck, h.bottom);
    while (step > 0.0 && at - step > to) {
      at -= step;
      cycle_move(feed, at);
      cycle_move(feed, at + back);
    }
    at = to;
    cycle_move(feed, at);
    if (at > h.bottom) {
      cycle_move({}, h.clearance);
      cycle_move({}, std::min(at + above, h.clearance));
    }
    if (smaller > 0.0) peck = std::max(peck - smaller, std::max(smallest, 1e-3));
  }
  cycle_dwell(q(211));
  cycle_move({}, h.clearance);
  leave_hole(h);
}

// Tapping: the spindle turns back at the depth. 206 with a floating holder at Q206, 207 rigid with
// the pitch Q239.
void Translator::tap(bool is_rigid) {
  const Hole h = hole();
  if (!speed_ || *speed_ == 0.0)
    fail("tapping requires S; none programmed since the last TOOL CALL");
  const double pitch = is_rigid ? q(239) * unit() : 0.0;
  if (is_rigid && pitch == 0.0) fail("Q239 must not be 0");
  const bool is_left = is_rigid ? pitch < 0.0 : spindle_ < 0;
  if (!is_rigid && spindle_ == 0) fail("cycle 206 requires M3 or M4");
  const Feed feed =
      is_rigid ? Feed{Feed::Kind::per_minute, std::abs(pitch) * *speed_} : cycle_feed(q(206));
  cycle_move({}, h.clearance);
  if (is_rigid) note(is_left ? "M4" : "M3");
  cycle_move(feed, h.bottom);
  if (!is_rigid) cycle_dwell(q(211));
  note(is_left ? "M3" : "M4");
  cycle_move(feed, h.clearance);
  if (is_rigid) {
    note("M5");
    spindle_ = 0;
  } else {
    note(is_left ? "M4" : "M3");
  }
  leave_hole(h);
}

// Rigid tapping in steps of Q257; to break the chip the tool goes back by Q256 pitches, and to the
// set-up clearance with Q256 = 0. TNC 640 cycle programming (34059x-01) p. 102; the order of the
// moves from memory.
void Translator::tap_209() {
  const Hole h = hole();
  if (!speed_ || *speed_ == 0.0)
    fail("tapping requires S; none programmed since the last TOOL CALL");
  const double pitch = q(239) * unit(), step = q(257) * unit(), back = q(256) * std::abs(pitch);
  if (pitch == 0.0) fail("Q239 must not be 0");
  if (step < 0.0 || back < 0.0) fail("Q257 and Q256 must be >= 0");
  if (parameters_.find({'Q', 403}).value_or(1.0) != 1.0) {
    fail("cycle 209 with Q403 (different retraction speed) is not supported; set Q403=1");
  }
  const std::string in = pitch < 0.0 ? "M4" : "M3", out = pitch < 0.0 ? "M3" : "M4";
  const Feed feed{Feed::Kind::per_minute, std::abs(pitch) * *speed_};
  cycle_move({}, h.clearance);
  note(in);
  double at = h.surface;
  for (int i = 0; at > h.bottom; ++i) {
    if (i == kMaxPecks) fail("cycle 209: too many infeeds");
    at = step > 0.0 ? std::max(at - step, h.bottom) : h.bottom;
    cycle_move(feed, at);
    if (at <= h.bottom) break;
    note(out);
    cycle_move(feed, back > 0.0 ? std::min(at + back, h.clearance) : h.clearance);
    note(in);
  }
  note(out);
  cycle_move(feed, h.clearance);
  note("M5");
  spindle_ = 0;
  leave_hole(h);
}

// Q343 = 1 centres to a diameter, which needs the point angle of the tool.
void Translator::centre_240() {
  if (q(343) != 0.0)
    fail("cycle 240 with Q343=1: the point angle of the tool is unknown; set Q343=0 and Q201");
  const Hole h = hole();
  cycle_move({}, h.clearance);
  cycle_move(cycle_feed(q(206)), h.bottom);
  cycle_dwell(q(211));
  cycle_move({}, h.clearance);
  leave_hole(h);
}

}  // namespace servomill::controllers::conversational
