#include "sim/responses/two_mass_fit.h"

#include <ceres/ceres.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/progress.h"
#include "sim/responses/response_misfit.h"

namespace servomill::sim::responses {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr std::size_t kDeadTime = 6;

using Parameters = std::array<double, TwoMass::kParameters>;

// Positive parameters as logarithms, the dead time in milliseconds.
TwoMass model_of(const double* x) {
  TwoMass model;
  for (std::size_t k = 0; k < TwoMass::kParameters; ++k) {
    model.value[k] = k == kDeadTime ? 1e-3 * x[k] : std::exp(x[k]);
  }
  return model;
}

double scale_of(const TwoMass& model, std::size_t k) {
  return k == kDeadTime ? 1e-3 : model.value[k];
}

struct Residuals {
  const MeasuredResponse& response;
  const std::vector<double>& weight;  // 1/deviation of each line

  bool operator()(double const* const* x, double* residual) const {
    const TwoMass model = model_of(x[0]);
    for (std::size_t n = 0; n < response.lines.size(); ++n) {
      const ResponseLine& line = response.lines[n];
      const Complex miss = (model.at(line.frequency) - line.value) * weight[n];
      residual[2 * n] = miss.real();
      residual[2 * n + 1] = miss.imag();
    }
    return true;
  }
};

struct Solved {
  std::vector<double> x;
  Eigen::MatrixXd covariance;  // of x, for weights that are right
  double cost = 0.0;           // sum of squares
};

Solved solve(const MeasuredResponse& response, const std::vector<double>& weight,
             std::vector<double> x) {
  const Residuals residuals{response, weight};
  auto* cost = new ceres::DynamicNumericDiffCostFunction<const Residuals, ceres::CENTRAL>(
      &residuals, ceres::DO_NOT_TAKE_OWNERSHIP);
  cost->AddParameterBlock(static_cast<int>(x.size()));
  const int rows = static_cast<int>(2 * response.lines.size());
  cost->SetNumResiduals(rows);
  ceres::Problem problem;
  problem.AddResidualBlock(cost, nullptr, x.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 300;
  options.function_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  Solved out{x, {}, 2.0 * summary.final_cost};
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> J(
      rows, static_cast<Eigen::Index>(x.size()));
  std::vector<double> values(static_cast<std::size_t>(rows));
  const double* at[] = {out.x.data()};
  double* jacobian[] = {J.data()};
  cost->Evaluate(at, values.data(), jacobian);
  // a parameter at its end (no friction) leaves no column: the pseudo-inverse leaves it out
  out.covariance = (J.transpose() * J).completeOrthogonalDecomposition().pseudoInverse();
  return out;
}

// Antiresonance with the resonance above it, by the extremes of the response.
std::vector<double> start_of(const MeasuredResponse& response, const std::string& name) {
  const std::vector<Extreme> found = extremes(response);
  const auto first = [&](bool is_maximum, double above) {
    for (const Extreme& one : found) {
      if (one.is_maximum == is_maximum && one.frequency > above) return one.frequency;
    }
    return 0.0;
  };
  const double fa = first(false, 0.0), fr = first(true, fa);
  if (!(fa > 0.0 && fr > fa)) {
    throw InputError(
        {name},
        "shows no antiresonance followed by a resonance: a two-mass model cannot be fitted");
  }
  const double ratio = std::pow(fr / fa, 2) - 1.0;  // J_l/J_m
  TwoMass model;
  model.value = {1.0, fa, ratio, kTurn * fa * 0.05, 1.0, 1.0, 0.0};
  double logs = 0.0;
  for (const ResponseLine& line : response.lines) {
    logs += std::log(std::abs(line.value) / std::abs(model.at(line.frequency)));
  }
  model.value[0] = std::exp(logs / static_cast<double>(response.lines.size()));
  // an angle that counts the other way
  std::vector<double> x;
  for (std::size_t k = 0; k < TwoMass::kParameters; ++k) {
    x.push_back(k == kDeadTime ? 0.0 : std::log(model.value[k]));
  }
  return x;
}

std::vector<Complex> at_lines(const MeasuredResponse& response, const TwoMass& model) {
  std::vector<Complex> out;
  for (const ResponseLine& line : response.lines) out.push_back(model.at(line.frequency));
  return out;
}

}  // namespace

Complex TwoMass::at(double f) const {
  const Complex s(0.0, kTurn * f);
  const double wa = kTurn * value[1], ratio = value[2];
  const Complex load = s * s + value[5] * s;    // of J_l, over J_l
  const Complex link = wa * wa + value[3] * s;  // (k + c s) / J_l
  const Complex motor = s * s + value[4] * s;   // of J_m, over J_m
  const Complex response = (load + link) / (motor * (load + link) + ratio * link * load);
  return value[0] * response * std::exp(-s * value[6]);
}

double TwoMass::resonance() const { return value[1] * std::sqrt(1.0 + value[2]); }

double TwoMassFit::standard(std::size_t parameter) const {
  const auto p = static_cast<Eigen::Index>(parameter);
  return std::sqrt(std::max(covariance(p, p), 0.0));
}

TwoMassFit fit_two_mass(const MeasuredResponse& response, const std::string& name) {
  MeasuredResponse positive = response;
  std::vector<double> x = start_of(response, name);
  // an angle that counts the other way has the other sign at every line
  double along = 0.0;
  for (const ResponseLine& line : response.lines) {
    along += (std::conj(model_of(x.data()).at(line.frequency)) * line.value).real() /
             std::norm(line.value);
  }
  if (along < 0.0) {
    for (ResponseLine& line : positive.lines) line.value = -line.value;
  }
  const auto rows = static_cast<double>(2 * response.lines.size() - TwoMass::kParameters);
  TwoMassFit out;
  // all lines alike first, then as exactly as they are measured
  double floor = 1.0;
  Solved solved;
  constexpr int kRounds = 4;
  Stage rounds("rounds", kRounds, Steps::unlike);
  for (int round = 0; round < kRounds; ++round) {
    rounds.reach(round);
    solved = solve(positive, line_weights(positive, floor), x);
    x = solved.x;
    floor = median_misfit(positive, at_lines(positive, model_of(x.data())));
  }
  out.noise_ratio =
      noise_ratio(positive, at_lines(positive, model_of(x.data())), TwoMass::kParameters);
  if (!out.has_model_error()) {
    solved = solve(positive, line_weights(positive, 0.0), x);
    x = solved.x;
  }
  out.model = model_of(x.data());
  out.noise_ratio = noise_ratio(positive, at_lines(positive, out.model), TwoMass::kParameters);
  out.median_misfit = median_misfit(positive, at_lines(positive, out.model));
  out.covariance =
      solved.covariance * std::max(solved.cost / rows, 1.0) * response.lines_per_estimate;
  for (std::size_t a = 0; a < TwoMass::kParameters; ++a) {
    for (std::size_t b = 0; b < TwoMass::kParameters; ++b) {
      out.covariance(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) *=
          scale_of(out.model, a) * scale_of(out.model, b);
    }
  }
  if (along < 0.0) out.model.value[0] = -out.model.value[0];
  return out;
}

}  // namespace servomill::sim::responses
