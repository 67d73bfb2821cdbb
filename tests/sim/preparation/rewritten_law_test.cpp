// The law of rewritten programs: the text that leaves the simulation does what the strategy has
// made of the program, and what the program asks for where no errors are identified. Random
// programs of every class, every strategy that rewrites.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <random>

#include "controllers/gcode/interpreter.h"
#include "plant/vocabulary/move_curve.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/case_program.h"
#include "sim/preparation/prepared_case.h"
#include "sim/preparation/rewritten_text.h"
#include "tests/number_of.h"
#include "tests/pattern.h"
#include "tests/sim/five_axis_program.h"
#include "tests/sim/programs/verification/random_program.h"
#include "tests/strategies/identified_machines.h"

namespace servomill::sim::preparation::rewritten_law_test {
namespace {

constexpr int kShown = 3;  // programs that differ, in full

// How many programs a strategy, and the seed of the first.
int program_count() { return number_of("SERVOMILL_REPLAY_PROGRAMS", 200); }
int first_seed() { return number_of("SERVOMILL_REPLAY_SEED", 0); }

constexpr double kPrinted = 1e-8;  // m, rad
constexpr double kChord = 1.5e-7;  // m: the default chord tolerance, and digits

const std::string kFile = "random.ngc";

/// A five-axis machine with two tools and all work systems set.
struct Shop {
  model::Scenario scenario = trunnion_scenario("M30\n", "[[case]]\nname = \"none\"\n");
  const model::MachineSettings& machine = scenario.machine;
  controllers::ProgramSetup setup;

  Shop() {
    setup.tools = scenario.program.tools;
    setup.machine = tool_centre_point(machine);
    setup.start[2] = 200.0 * mm;
    for (std::size_t i = 0; i < setup.work_offset.size(); ++i) {
      const double d = static_cast<double>(i) * mm;
      setup.work_offset[i].head<3>() << 3.0 * d, -5.0 * d, -90.0 * mm + 2.0 * d;
    }
  }

  strategies::IdentifiedMachine identified(bool has_errors) const {
    const plant::MachineChain& chain = machine.chain;
    strategies::IdentifiedMachine out{
        chain.layout,
        {chain, has_errors ? scenario.errors.at("machine") : plant::ErrorModel{}},
        {0.0, 0.0, -120.0 * mm},
        machine.nc.lower,
        machine.nc.upper,
        chain.layout.joints(setup.start)};
    out.lower.head<3>().setConstant(-200.0 * mm);  // a table has few enough points
    out.upper.head<3>().setConstant(200.0 * mm);
    out.Kv.setConstant(80.0);
    return out;
  }
};

const Shop& shop() {
  static const Shop kShop;
  return kShop;
}

/// A strategy with its identified model.
struct Rewriting {
  std::unique_ptr<strategies::Strategy> strategy;
  bool has_errors = false;
  bool keeps_way = true;  // of the axes, but for errors
};

/// Outcomes of many programs.
struct Outcomes {
  int verified = 0, refused = 0, differing = 0;
  std::map<std::string, int> reasons;

  void print(std::string_view name) const {
    fmt::print("{}: {} verified, {} refused, {} differ\n", name, verified, refused, differing);
    for (const auto& [reason, n] : reasons) fmt::print("  {:5} {}\n", n, reason);
  }
};

/// How far X, Y and Z end from the line or arc of the move, at that share of it.
double off_the_way(const AxisWords& from, const Move& move, const Move& block) {
  const double length = move.s_end - move.s_begin;
  const double share = length > 0.0 ? (block.s_end - move.s_begin) / length : 1.0;
  return (MoveCurve(from, move).at(share) - block.end_machine).head<3>().norm();
}

/// A motion, dwell, tool change, stop or end, with what spindle and coolant do then.
struct Done {
  Move move;
  int direction = 0, coolant = 0;
  double speed = 0.0;  // rad/s
};

template <class Moves>
std::vector<Done> done_by(const Moves& moves) {
  std::vector<Done> out;
  Done now;
  for (const Move& move : moves) {
    if (move.kind == MoveKind::coolant) now.coolant = move.number;
    if (move.kind == MoveKind::spindle) now.direction = move.direction;
    if (move.kind == MoveKind::spindle) now.speed = move.value;
    if (move.kind == MoveKind::coolant || move.kind == MoveKind::spindle) continue;
    if (move.kind == MoveKind::message) continue;
    now.move = move;
    out.push_back(now);
  }
  return out;
}

// An arc may become lines.
std::string difference(const Done& wanted, const Done& block) {
  const Move &a = wanted.move, &b = block.move;
  const bool is_cut = a.kind == MoveKind::arc && b.kind == MoveKind::feed;
  if (a.kind != b.kind && !is_cut) return "another kind";
  if (wanted.direction != block.direction || wanted.coolant != block.coolant) return "another M";
  if (wanted.direction != 0 && std::abs(wanted.speed - block.speed) > 1e-6) return "another S";
  const bool has_number = a.kind == MoveKind::tool || a.kind == MoveKind::stop;
  if (has_number && a.number != b.number) return "another number";
  const bool is_dwell = a.kind == MoveKind::dwell;
  return is_dwell && std::abs(a.value - b.value) > 1e-9 ? "another dwell" : "";
}

// Without errors all is done as in the original, and each motion ends where it should. Blocks of
// strategies that know errors alone lie on its way, too.
// @return why not
std::string compare(const Done& wanted, const AxisWords& from, std::span<const Done>& blocks,
                    bool keeps_way) {
  double s = wanted.move.s_begin;
  do {
    if (blocks.empty()) return "it is missing";
    const Done& block = blocks.front();
    blocks = blocks.subspan(1);
    const std::string why = difference(wanted, block);
    if (!why.empty() || !is_motion(wanted.move.kind)) return why;
    if (keeps_way && off_the_way(from, wanted.move, block.move) > kChord) return "leaves its way";
    s = block.move.s_end;
    const AxisWords off = block.move.end_machine - wanted.move.end_machine;
    if (s >= wanted.move.s_end && off.cwiseAbs().maxCoeff() > kPrinted) return "another end";
  } while (s < wanted.move.s_end);
  return "";
}

void require_same(const std::vector<Move>& original, const MoveList& read, bool keeps_way) {
  const std::vector<Done> all = done_by(read);
  std::span<const Done> blocks = all;
  AxisWords at = shop().setup.start;
  for (const Done& wanted : done_by(original)) {
    const std::string why = compare(wanted, at, blocks, keeps_way);
    if (!why.empty()) throw InputError({kFile, wanted.move.line}, "does something else: " + why);
    if (is_motion(wanted.move.kind)) at = wanted.move.end_machine;
  }
  const bool ends = blocks.empty() || blocks.front().move.kind == MoveKind::end;
  if (!ends) throw InputError({kFile}, "does something else: goes on");
}

// Line and arc length of dwells, tool changes, stops and the end: those of the original.
void require_places(const std::vector<Move>& moves, const std::vector<Move>& read) {
  const auto waits = [](const std::vector<Move>& all) {
    std::vector<Move> out;
    std::copy_if(all.begin(), all.end(), std::back_inserter(out), [](const Move& move) {
      return move.kind == MoveKind::dwell || move.kind == MoveKind::tool ||
             move.kind == MoveKind::stop || move.kind == MoveKind::end;
    });
    return out;
  };
  const std::vector<Move> wanted = waits(moves), found = waits(read);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (found.at(i).line == wanted[i].line && found[i].s_end == wanted[i].s_end) continue;
    throw InputError({kFile, wanted[i].line}, "does something else: waits at another place");
  }
}

RewrittenText text_of(const strategies::Strategy& strategy, const MoveRange& moves) {
  return through_text([&](const PutMove& put) { strategy.rewrite(moves, put); },
                      {kFile, "random", "random", shop().machine.chain.layout, shop().setup});
}

void check(const Rewriting& rewriting, const std::string& program) {
  const Shop& s = shop();
  const std::vector<Move> moves = controllers::interpret(program, kFile, s.setup);
  const RewrittenText out = text_of(*rewriting.strategy, moves);
  require_places(moves, out.moves.all());
  if (!rewriting.has_errors) require_same(moves, out.moves, rewriting.keeps_way);
}

bool is_of_verification(const std::string& message) {
  return message.find("something else") != std::string::npos ||
         message.find("cannot be verified") != std::string::npos ||
         message.find("goes on behind its end") != std::string::npos;
}

void run(Outcomes& outcomes, std::uint32_t seed, const Rewriting& rewriting) {
  const programs::RandomProgram program(seed, {.has_rotary_axes = seed % 5 == 4});
  try {
    check(rewriting, program.text());
    ++outcomes.verified;
  } catch (const InputError& error) {
    const std::string& message = error.faults().front().message;
    if (!is_of_verification(message)) {
      ++outcomes.refused;
      ++outcomes.reasons[message.substr(0, 100)];
      return;
    }
    ++outcomes.differing;
    ADD_FAILURE() << "seed " << seed << ": " << error.what() << "\n"
                  << (outcomes.differing <= kShown ? program.text() : "");
  }
}

void expect_law(const std::string& name, const Rewriting& rewriting) {
  Outcomes outcomes;
  const int programs = program_count(), first = first_seed();
  for (int i = 0; i < programs; ++i)
    run(outcomes, static_cast<std::uint32_t>(first + i), rewriting);
  outcomes.print(name);
  EXPECT_EQ(outcomes.differing, 0) << name;
  EXPECT_GT(outcomes.verified, programs / 2) << name;
}

class RewrittenLaw : public testing::TestWithParam<bool> {};

TEST_P(RewrittenLaw, HoldsForRandomPrograms) {
  const bool has_errors = GetParam();
  const strategies::IdentifiedMachine identified = shop().identified(has_errors);
  for (const strategies::Entry& entry : strategies::entries()) {
    for (const bool all_axes : {false, true}) {
      auto acting = strategies::make_acting(entry, strategies::Action::compensate, identified,
                                            all_axes, all_axes);
      const bool has_axes = strategies::default_parameters(entry).is_word("axes");
      if (!acting.strategy->rewrites() || (all_axes && !has_axes)) continue;
      expect_law(fmt::format("{}{}", entry.name, all_axes ? ", all axes" : ""),
                 {std::move(acting.strategy), has_errors, entry.reads_errors});
    }
  }
}

/// Moves of the tip: lines, arcs, rapids, rotations about a tip that stands, messages, dwells.
std::string tip_program(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  const bool is_inch = random() % 4 == 0;
  const double mm_word = is_inch ? 1.0 / 25.4 : 1.0;
  const auto angles = [&] {
    return fmt::format(" A{:.3f} C{:.3f}", uniform(5, 35), uniform(-80, 80));
  };
  const auto place = [&] {
    return fmt::format(" X{:.4f} Y{:.4f} Z{:.4f}", mm_word * uniform(-20, 20),
                       mm_word * uniform(-20, 20), mm_word * uniform(5, 25));
  };
  const std::string feed = fmt::format(" F{:.3f}\n", mm_word * uniform(100, 2000));
  std::string out = fmt::format("G{}\nT1 M6\nS3000 M3\nG43.4 H1\nG0{}{}\nG1{} F500\n",
                                is_inch ? 20 : 21, place(), angles(), place());
  for (int i = 0; i < 8; ++i) {
    const std::string moves[] = {"G1" + place() + angles() + feed,
                                 "G1" + place() + feed,
                                 "G1" + angles() + feed,
                                 "(MSG, on)\nG1" + angles() + feed,
                                 "M8\nG93 G1" + place() + angles() + " F20\nG94 F300\n",
                                 "G4 P0.5\n",
                                 "G0" + place() + "\n",
                                 fmt::format("G91 G2 X0 Y0 I{:.3f} F400\nG90\n", mm_word * 3.0),
                                 "G1 F200\n"};
    out += moves[random() % std::size(moves)];
  }
  return out + "G49\nM30\n";
}

// s, of the feeds and arcs of a line; by where the axes go (blocks) or by the path of the tip.
std::map<int, double> times_of(const std::vector<Move>& moves, const AxisWords& start,
                               bool of_axes) {
  std::map<int, double> out;
  AxisWords at = start;
  for (const Move& move : moves) {
    if (!is_motion(move.kind)) continue;
    const AxisWords moved = move.end_machine - at;
    at = move.end_machine;
    if (move.kind == MoveKind::rapid) continue;
    const double length = of_axes ? moved.head<3>().norm() : move.s_end - move.s_begin;
    const double way = length > 0.0 ? length : moved.tail<3>().norm();
    if (way > 0.0) out[move.line] += way / move.feed;
  }
  return out;
}

// Blocks of the axes take the time of the move of the tip.
// @return the text
std::string expect_times(const strategies::Strategy& strategy, const std::string& program) {
  const Shop& s = shop();
  const std::vector<Move> moves = controllers::interpret(program, kFile, s.setup);
  const RewrittenText out = text_of(strategy, moves);
  const auto wanted = times_of(moves, s.setup.start, false);
  const auto found = times_of(out.moves.all(), s.setup.start, true);
  for (const auto& [line, time] : wanted) {
    EXPECT_NEAR(found.at(line), time, 1e-4 * time) << "line " << line << "\n" << program;
  }
  return out.text->all();
}

strategies::Acting tip_correction() {
  return strategies::make_acting(*strategies::find("gcode"), strategies::Action::compensate,
                                 shop().identified(true));
}

TEST(RewrittenTipLaw, HoldsForRandomPrograms) {
  const auto acting = tip_correction();
  const int programs = program_count(), first = first_seed();
  for (int i = 0; i < programs; ++i) {
    const std::string program = tip_program(static_cast<std::uint32_t>(first + i));
    SCOPED_TRACE(fmt::format("seed {}", first + i));
    EXPECT_NO_THROW(expect_times(*acting.strategy, program)) << program;
  }
}

// X, Y and Z go 0.8 um in 0.68 s where they reverse: slower than G93 can, which runs every block at
// 0.1 mm/min or more.
TEST(RewrittenTipLaw, HoldsForBlocksThatAreTooSlowForG93) {
  const auto acting = tip_correction();
  const std::string text = expect_times(*acting.strategy,
                                        "G20\nT1 M6\nS3000 M3\nG43.4 H1\n"
                                        "G0 X0.25 Y-0.6429 Z0.6805 A26.794 C-72.668\n"
                                        "G1 A11.014 C37.562 F22.209\nM30\n");
  const Pattern slow("\nG94\nG1 X\\S+ Y\\S+ Z\\S+ A\\S+ C\\S+ F0\\.0[0-9]+\n");
  EXPECT_TRUE(slow.is_found_in(text)) << text;
}

INSTANTIATE_TEST_SUITE_P(Errors, RewrittenLaw, testing::Bool(),
                         [](const auto& one) { return one.param ? "Identified" : "None"; });

}  // namespace
}  // namespace servomill::sim::preparation::rewritten_law_test
