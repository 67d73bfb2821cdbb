#include "sim/metrology/location_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "plant/geometry/volumetric.h"
#include "sim/numerics/decompositions.h"
#include "sim/numerics/dense_solver.h"

namespace servomill::sim::metrology {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using plant::ErrorName;

constexpr double kUnitError = 1e-6;  // m, rad; effects are proportional to it

bool is_turn(const ErrorName& name) { return !is_linear(name.direction); }

// Effect of every unknown on every reading: set-up first, then the errors.
struct Effects {
  MatrixXd A;  // readings x unknowns
  int set_up_unknowns = 0;
};

int number_of_set_ups(const std::vector<SensorReading>& readings) {
  int most = 0;
  for (const SensorReading& reading : readings) most = std::max(most, reading.set_up);
  return most + 1;
}

Effects effects_of(const plant::MachineChain& chain, const std::vector<SensorReading>& readings,
                   const RTestSetUp& set_up, const std::vector<ErrorName>& names) {
  std::vector<plant::VolumetricModel> single;
  for (const ErrorName& name : names) {
    plant::ErrorModel errors;
    errors.location(name) = kUnitError;
    single.emplace_back(chain, errors);
  }
  const int per_set_up = set_up.length_is_unknown ? 4 : 3;
  const int tip = per_set_up * number_of_set_ups(readings);
  Effects out;
  out.set_up_unknowns = tip + (set_up.tcp_is_unknown ? 3 : 0);
  out.A = MatrixXd::Zero(static_cast<Eigen::Index>(readings.size()),
                         out.set_up_unknowns + static_cast<int>(names.size()));
  for (Eigen::Index row = 0; row < out.A.rows(); ++row) {
    const SensorReading& reading = readings[static_cast<std::size_t>(row)];
    const int own = per_set_up * reading.set_up;
    out.A.block<1, 3>(row, own) = -reading.n_W.transpose();
    if (set_up.length_is_unknown) out.A(row, own + 3) = -1.0;
    if (set_up.tcp_is_unknown) {
      out.A.block<1, 3>(row, tip) = reading.n_W.transpose() * R_WS(chain, reading.Q);
    }
    for (std::size_t i = 0; i < single.size(); ++i) {
      const Vector3d dp = single[i].first_order_error(reading.Q, reading.p_ST).dp_W;
      out.A(row, out.set_up_unknowns + static_cast<Eigen::Index>(i)) =
          reading.n_W.dot(dp) / kUnitError;
    }
  }
  return out;
}

// Columns chosen one after the other, each only if enough of it is new.
struct Basis {
  std::vector<Eigen::Index> columns;
  MatrixXd orthonormal;  // as many columns, the rest unused

  explicit Basis(Eigen::Index rows, Eigen::Index most) : orthonormal(rows, most) {}

  bool add(const MatrixXd& A, Eigen::Index column) {
    VectorXd own = A.col(column);
    const double before = own.norm();
    const auto known = orthonormal.leftCols(static_cast<Eigen::Index>(columns.size()));
    for (int twice = 0; twice < 2; ++twice) own -= known * (known.transpose() * own).eval();
    if (!(own.norm() > kOwnShare * before)) return false;
    orthonormal.col(known.cols()) = own.normalized();
    columns.push_back(column);
    return true;
  }
};

// Columns of length 1, or 0 for those that do nothing.
MatrixXd normalized(const MatrixXd& A, VectorXd& length) {
  length = A.colwise().norm();
  MatrixXd out = A;
  for (Eigen::Index j = 0; j < A.cols(); ++j) {
    if (length[j] > 0.0) out.col(j) /= length[j];
  }
  return out;
}

// Least squares in some columns of a square matrix.
struct Solved {
  VectorXd length;  // of the columns, 0 for those left out
  MatrixXd scaled;
  numerics::SingularValues svd;
  Eigen::Index rank;

  Solved(const MatrixXd& A, const std::vector<Eigen::Index>& columns) {
    MatrixXd kept = MatrixXd::Zero(A.rows(), A.cols());
    for (const Eigen::Index j : columns) kept.col(j) = A.col(j);
    scaled = normalized(kept, length);
    svd = numerics::singular_values(scaled);
    rank = svd.rank(kOwnShare * kOwnShare);
  }
  double condition() const { return svd.s[0] / svd.s[rank - 1]; }
  VectorXd solve(const VectorXd& b) const { return svd.solve(b, rank); }
  // diagonal of (A^T A)^-1, root
  double spread(Eigen::Index column) const {
    const VectorXd v = svd.V.row(column).head(rank).transpose();
    return v.cwiseQuotient(svd.s.head(rank)).norm() / length[column];
  }
};

int rank_of(const MatrixXd& A) {
  VectorXd length;
  return static_cast<int>(
      numerics::singular_values(normalized(A, length)).rank(kOwnShare * kOwnShare));
}

// Finds the unknowns kept that have the same effect as one left out.
void explain(LocationEstimate& estimate, const VectorXd& effect, const Solved& solved,
             const Basis& basis, int set_up_unknowns, const std::vector<ErrorName>& names) {
  const VectorXd share = solved.solve(effect);  // each of the size of what it does
  for (const Eigen::Index column : basis.columns) {
    if (!(std::abs(share[column]) > kOwnShare * effect.norm())) continue;
    if (column < set_up_unknowns) {
      estimate.is_like_set_up = true;
    } else {
      const auto name = static_cast<std::size_t>(column - set_up_unknowns);
      estimate.like.push_back({names[name], share[column] / solved.length[column]});
    }
  }
}

LocationFit fit(const plant::MachineChain& chain, const std::vector<SensorReading>& readings,
                const RTestSetUp& set_up, bool with_values) {
  assert(!readings.empty());
  const std::vector<ErrorName> names = location_errors(chain);
  const Effects effects = effects_of(chain, readings, set_up, names);
  const int first = effects.set_up_unknowns;

  // from here on as many equations as unknowns, and a last one that no unknown can meet
  const Eigen::Index unknowns = effects.A.cols();
  MatrixXd Ab = MatrixXd::Zero(std::max(effects.A.rows(), unknowns + 1), unknowns + 1);
  Ab.topLeftCorner(effects.A.rows(), unknowns) = effects.A;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    Ab(static_cast<Eigen::Index>(i), unknowns) = readings[i].d;
  }
  const MatrixXd R = numerics::triangular_factor(Ab);
  const MatrixXd A = R.topLeftCorner(unknowns, unknowns);
  const VectorXd b = R.col(unknowns).head(unknowns);
  const double beyond = R(unknowns, unknowns);

  // length of an effect that is rounding
  const double nothing = kOwnShare * kOwnShare * A.colwise().norm().maxCoeff();
  Basis basis(A.rows(), unknowns);
  std::vector<bool> is_kept(static_cast<std::size_t>(unknowns), false);
  for (Eigen::Index j = 0; j < unknowns; ++j) {
    is_kept[static_cast<std::size_t>(j)] = A.col(j).norm() > nothing && basis.add(A, j);
  }
  const Solved solved(A, basis.columns);
  const VectorXd effect = solved.solve(b);

  LocationFit out;
  out.rank = rank_of(A);
  out.condition = solved.condition();
  const double squares = (b - solved.scaled * effect).squaredNorm() + beyond * beyond;
  const auto n = static_cast<double>(readings.size());
  const double spare = n - static_cast<double>(basis.columns.size());
  const double sigma = with_values && spare > 0.0 ? std::sqrt(squares / spare) : 0.0;
  out.left = std::sqrt(squares / n);
  for (std::size_t i = 0; i < names.size(); ++i) {
    LocationEstimate estimate;
    estimate.name = names[i];
    const Eigen::Index column = first + static_cast<Eigen::Index>(i);
    if (is_kept[static_cast<std::size_t>(column)]) {
      estimate.value = with_values ? effect[column] / solved.length[column] : 0.0;
      estimate.uncertainty = sigma * solved.spread(column);
    } else if (A.col(column).norm() > nothing) {
      explain(estimate, A.col(column), solved, basis, first, names);
    }
    out.errors.push_back(std::move(estimate));
  }
  return out;
}

// "-0.05 um/urad EX0C"
std::string term(const ErrorName& of, const Likeness& like) {
  const double size = std::abs(like.factor);
  const bool same_kind = is_turn(of) == is_turn(like.name);
  std::string out = like.factor < 0.0 ? "-" : "";
  if (!same_kind || std::abs(size - 1.0) > kOwnShare) out += fmt::format("{:.3g} ", size);
  if (!same_kind) out += is_turn(of) ? "um/urad " : "urad/um ";
  return out + plant::to_string(like.name);
}

}  // namespace

std::string LocationEstimate::why_not() const {
  if (value) return "";
  if (like.empty() && !is_like_set_up) return "has no effect";
  std::vector<std::string> terms;
  for (const Likeness& one : like) terms.push_back(term(name, one));
  if (is_like_set_up) terms.emplace_back("set-up");
  const std::string last = terms.back();
  terms.pop_back();
  return fmt::format("confounded with {}{}{}", fmt::join(terms, ", "), terms.empty() ? "" : " and ",
                     last);
}

const LocationEstimate* LocationFit::find(const ErrorName& name) const {
  const auto found = std::find_if(errors.begin(), errors.end(),
                                  [&](const LocationEstimate& one) { return one.name == name; });
  return found == errors.end() ? nullptr : &*found;
}

int LocationFit::number_identified() const {
  return static_cast<int>(
      std::count_if(errors.begin(), errors.end(),
                    [](const LocationEstimate& one) { return one.value.has_value(); }));
}

Eigen::Matrix3d R_WS(const plant::MachineChain& chain, const Joints& Q) {
  const Vector3d origin = plant::forward(chain, Q, Vector3d::Zero()).p_WT;
  Eigen::Matrix3d R;
  for (int i = 0; i < 3; ++i) {
    R.col(i) = plant::forward(chain, Q, Vector3d::Unit(i)).p_WT - origin;
  }
  return R;
}

std::vector<ErrorName> location_errors(const plant::MachineChain& chain) {
  std::vector<ErrorName> out;
  const auto add = [&](Axis direction, Axis axis) {
    const ErrorName name{direction, axis, true};
    if (chain.layout.joint_of(axis) && !plant::why_meaningless(name, chain.layout)) {
      out.push_back(name);
    }
  };
  add(Axis::C, Axis::Y);
  add(Axis::A, Axis::Z);
  add(Axis::B, Axis::Z);
  for (const bool turn : {true, false}) {
    for (const plant::ChainAxis& axis : chain.axes) {
      if (is_linear(axis.axis)) continue;
      for (const Axis direction : kAllAxes) {
        if (is_linear(direction) != turn) add(direction, axis.axis);
      }
    }
  }
  add(Axis::A, Axis::Y);
  add(Axis::B, Axis::X);
  add(Axis::C, Axis::X);
  return out;
}

LocationFit identify_locations(const plant::MachineChain& chain,
                               const std::vector<SensorReading>& readings,
                               const RTestSetUp& set_up) {
  return fit(chain, readings, set_up, true);
}

LocationFit observable_locations(const plant::MachineChain& chain,
                                 const std::vector<SensorReading>& readings,
                                 const RTestSetUp& set_up) {
  return fit(chain, readings, set_up, false);
}

}  // namespace servomill::sim::metrology
