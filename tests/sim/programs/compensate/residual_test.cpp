// A corrected program on a machine with the identified errors: the tool goes where the program
// wants it, within the tolerance.
#include <random>

#include "sim/input/read_machine.h"

#include "sim/input/read_scenario.h"
#include "tests/sim/programs/compensate/trial.h"

namespace servomill::sim::programs::residual_test {
namespace {

using Eigen::Vector3d;

/// The machine of the trial: true errors and tool.
class Truth {
 public:
  Truth(const CompensateRequest& request, const Vector3d& p_ST)
      : machine_(input::read_machine_file(request.machine_file)), p_ST_(p_ST) {
    const auto models = read_models(request);
    model_.emplace(machine_.chain, models.begin()->second);
  }
  Vector3d tip(const AxisWords& at) const {
    return model_->forward(machine_.chain.layout.joints(at), p_ST_).p_WT;
  }
  Vector3d ideal_tip(const AxisWords& at) const {
    return plant::forward(machine_.chain, machine_.chain.layout.joints(at), p_ST_).p_WT;
  }

 private:
  std::map<std::string, plant::ErrorModel> read_models(const CompensateRequest& request) const {
    const std::string file = request.error_file.empty() ? request.machine_file : request.error_file;
    if (!request.error_file.empty()) return input::read_error_file(file, machine_.chain.layout);
    const config::Document document = config::Document::from_file(file);
    config::Reader root(document);
    std::map<std::string, plant::ErrorModel> models;
    input::read_machine(root, &models);
    root.finish();
    return models;
  }
  model::MachineSettings machine_;
  std::optional<plant::VolumetricModel> model_;
  Vector3d p_ST_;
};

// Programmed ways of X, Y, Z: on the ideal machine with three axes the tip goes along them.
std::vector<MoveCurve> programmed_ways(const std::vector<Move>& moves) {
  std::vector<MoveCurve> out;
  AxisWords at = AxisWords::Zero();
  for (const Move& move : moves) {
    if (!is_motion(move.kind)) continue;
    out.emplace_back(at, move);
    at = move.end_machine;
  }
  return out;
}

double distance(const Vector3d& p, const std::vector<MoveCurve>& ways) {
  double best = 1e9;
  for (const MoveCurve& way : ways) {
    best = std::min(best, (p - way.at(way.closest(p)).head<3>()).norm());
  }
  return best;
}

// The largest distance of the true tip from the ideal way on feed moves. Rapids end where the axes
// that do not move still have their old corrections; a short feed then leads to the path.
double residual(const std::string& program, const std::string& corrected, const Trial& trial,
                const Truth& truth) {
  const auto ways = programmed_ways(moves_of(program, trial.request));
  const Vector3d p_ST = truth.ideal_tip(AxisWords::Zero());
  constexpr double kLongestLead = 0.3e-3;  // m
  double worst = 0.0;
  AxisWords at = AxisWords::Zero();
  bool is_behind_rapid = true;
  for (const Move& move : moves_of(corrected, trial.request)) {
    if (!is_motion(move.kind)) continue;
    const MoveCurve curve(at, move);
    constexpr int kLooks = 4;
    const bool is_rapid = move.kind == MoveKind::rapid;
    const bool leads = is_behind_rapid && move.s_end - move.s_begin < kLongestLead;
    for (int i = leads ? kLooks : 1; i <= kLooks && !is_rapid; ++i) {
      const Vector3d tip = truth.tip(curve.at(static_cast<double>(i) / kLooks));
      worst = std::max(worst, distance(tip - p_ST, ways));
    }
    is_behind_rapid = is_rapid;
    at = move.end_machine;
  }
  return worst;
}

// Random programs: lines, arcs in three planes, helices, inches, increments, offsets.
class Generator {
 public:
  explicit Generator(unsigned seed) : random_(seed) {}

  std::string program() {
    text_ = "G21 G90 G17 G54\nT1 M6\nG43 H1\n";
    std::fill(std::begin(at_), std::end(at_), 0.0);
    text_ += "G0 X0 Y0 Z5\nF1000\n";
    at_[2] = 5.0;
    for (int i = 0; i < 25; ++i) step();
    return text_ + "M30\n";
  }

 private:
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) / 4294967296.0;
  }
  bool one_in(unsigned n) { return random_() % n == 0; }
  std::string number(double mm_value) const {
    return fmt_number(is_inch_ ? mm_value / 25.4 : mm_value);
  }
  static std::string fmt_number(double x) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.5f", x);
    return buffer;
  }

  std::string axis(int i, double to) {
    const double from = at_[i];
    at_[i] = to;
    return std::string(" ") + "XYZ"[i] + number(is_incremental_ ? to - from : to);
  }

  void step() {
    if (one_in(8)) {
      is_inch_ = !is_inch_;
      text_ += is_inch_ ? "G20 F40\n" : "G21 F1000\n";
    }
    if (one_in(8)) {
      is_incremental_ = !is_incremental_;
      text_ += is_incremental_ ? "G91\n" : "G90\n";
    }
    if (one_in(4)) return arc();
    text_ += one_in(5) ? "G0" : "G1";
    bool any = false;
    for (int i = 0; i < 3; ++i) {
      if (one_in(3) && (any || i < 2)) continue;
      any = true;
      text_ += axis(i, i == 2 ? uniform(-5.0, 20.0) : uniform(-100.0, 250.0));
    }
    text_ += "\n";
  }

  void arc() {
    const int normal = one_in(2) ? 2 : static_cast<int>(random_() % 3);
    const int a = (normal + 1) % 3, b = (normal + 2) % 3;
    const double r = normal == 2 ? uniform(3.0, 60.0) : uniform(3.0, 8.0);
    const double from = uniform(0.0, 6.28), sweep = uniform(0.3, 6.0);
    const bool ccw = one_in(2), full = one_in(4);
    const double to = from + (ccw ? sweep : -sweep);
    const double centre_a = at_[a] - r * std::cos(from), centre_b = at_[b] - r * std::sin(from);
    text_ += std::string(normal == 2 ? "G17" : normal == 1 ? "G18" : "G19") + (ccw ? " G3" : " G2");
    const double start_a = at_[a], start_b = at_[b];
    std::string words;
    if (!full) {
      words += axis(a, centre_a + r * std::cos(to)) + axis(b, centre_b + r * std::sin(to));
    }
    if (one_in(3)) words += axis(normal, at_[normal] + uniform(-1.0, 1.0));
    if (words.empty()) words = axis(a, start_a) + axis(b, start_b);
    text_ += words;
    text_ += std::string(" ") + "IJK"[a] + number(centre_a - start_a);
    text_ += std::string(" ") + "IJK"[b] + number(centre_b - start_b);
    text_ += "\n";
  }

  std::mt19937 random_;
  std::string text_;
  double at_[3] = {};
  bool is_inch_ = false, is_incremental_ = false;
};

TEST(CompensateResidual, OfAPerfectIdentificationIsBelowTheTolerance) {
  double worst = 0.0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const std::string program = Generator(seed).program();
    Trial trial(program, "random.ngc");
    trial.request.inputs.reader = "linuxcnc";
    for (const double tolerance : {1.0 * um, 5.0 * um}) {
      trial.request.tolerance = tolerance;
      const Compensated done = trial.run();
      const Truth truth(trial.request, {0.0, 0.0, -40.0 * mm});
      const double left = residual(program, done.program, trial, truth);
      EXPECT_LE(left, tolerance) << "seed " << seed << "\n" << program << "\n" << done.program;
      worst = std::max(worst, left / tolerance);
      EXPECT_GT(residual(program, program, trial, truth), 20.0 * um);
    }
  }
  RecordProperty("worst_share_of_tolerance", std::to_string(worst));
  EXPECT_GT(worst, 0.3);  // blocks are as long as they may be
}

}  // namespace
}  // namespace servomill::sim::programs::residual_test
