/// The volumetric error in lanes: against 4x4 matrices in long double, against itself for one pose
/// and on each instruction set.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "plant/geometry/volumetric.h"
#include "plant/geometry/volumetric_evaluation.h"
#include "tests/plant/geometry/random_errors.h"

namespace servomill::plant::volumetric_lanes_test {
namespace {

using Eigen::Vector3d;

constexpr double kRounding = 2e-15;  // m or 1: some tens of operations on numbers below 2

// --- homogeneous matrices in long double --------------------------------------------------------

using Row = std::array<long double, 4>;
using Matrix = std::array<Row, 4>;

Matrix identity() { return {Row{1, 0, 0, 0}, Row{0, 1, 0, 0}, Row{0, 0, 1, 0}, Row{0, 0, 0, 1}}; }

Matrix operator*(const Matrix& A, const Matrix& B) {
  Matrix C{};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      for (std::size_t k = 0; k < 4; ++k) C[i][j] += A[i][k] * B[k][j];
    }
  }
  return C;
}

Matrix shift(long double x, long double y, long double z) {
  Matrix H = identity();
  H[0][3] = x;
  H[1][3] = y;
  H[2][3] = z;
  return H;
}
Matrix shift(const Vector3d& v, long double sign = 1) {
  return shift(sign * v.x(), sign * v.y(), sign * v.z());
}

// The exponential of [e]x by its power series.
Matrix turn(long double ex, long double ey, long double ez) {
  const Matrix E = {Row{0, -ez, ey, 0}, Row{ez, 0, -ex, 0}, Row{-ey, ex, 0, 0}, Row{0, 0, 0, 0}};
  Matrix term = identity(), sum = identity();
  for (int n = 1; n < 40; ++n) {
    term = term * E;
    for (Row& row : term) {
      for (long double& x : row) x /= n;
    }
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) sum[i][j] += term[i][j];
    }
  }
  return sum;
}

// As plant/geometry/error_model.h writes it.
Matrix axis_matrix(const ChainAxis& a, const ErrorModel& errors, double q, const AxisWords& all) {
  std::array<long double, 6> e, l;
  for (const Axis d : kAllAxes) {
    const auto i = static_cast<std::size_t>(index_of(d));
    e[i] = errors.component({d, a.axis, false}).value(q, all);
    l[i] = errors.location({d, a.axis, true});
  }
  const Matrix E = shift(e[0], e[1], e[2]) * turn(e[3], e[4], e[5]);
  const Matrix L = turn(l[3], l[4], l[5]) * shift(l[0], l[1], l[2]);
  const Matrix L_back = shift(-l[0], -l[1], -l[2]) * turn(-l[3], -l[4], -l[5]);
  const int k = index_of(a.axis) % 3;
  const long double s = a.sense == Sense::table && !is_linear(a.axis) ? -q : q;
  const long double x = k == 0 ? s : 0, y = k == 1 ? s : 0, z = k == 2 ? s : 0;
  const Matrix J = is_linear(a.axis) ? shift(x, y, z) : turn(x, y, z);
  const Matrix H = a.side == Side::tool ? L * J * L_back * E : E * L * J * L_back;
  return shift(a.centre) * H * shift(a.centre, -1);
}

ToolPose pose_by_matrices(const MachineChain& chain, const ErrorModel& errors, const Joints& Q,
                          const Vector3d& p_ST) {
  Matrix H = identity();
  const AxisWords q = chain.layout.words(Q);
  for (const ChainAxis& a : chain.axes) H = H * axis_matrix(a, errors, Q[a.joint], q);
  H = H * shift(p_ST);
  ToolPose P;
  for (std::size_t i = 0; i < 3; ++i) {
    P.p_WT[static_cast<int>(i)] = static_cast<double>(H[i][3]);
    P.k_W[static_cast<int>(i)] = static_cast<double>(H[i][2]);
  }
  return P;
}

// --- machines and errors that take all ways -----------------------------------------------------

const char* const kMachines[] = {
    "[w b X Y Z t]",    "[w C' B' b X Y Z t]",  "[w X b Y Z t]",        "[w b X Y Z C B t]",
    "[w C' X b B Z t]", "[w Y' A' X' b Z C t]", "[w X' Y' Z' b C A t]", "[w b Z Y X t]",
    "[w C' b X Y t]",   "[w Y' b X Z A t]",     "[w b Z X Y t]",        "[w Y' Z' X' b t]"};

ErrorModel cubics(Uniform& random, double size) {
  ErrorModel errors;
  for (auto& axis : errors.components) {
    for (ErrorFunction& f : axis) {
      f = polynomial({size * random(), size * random(), size * random(), size * random()});
    }
  }
  for (AxisWords& axis : errors.locations) {
    for (double& e : axis) e = size * random();
  }
  return errors;
}

ErrorModel of_linear_axes(ErrorModel errors) {
  for (std::size_t axis = 3; axis < kAxisWords; ++axis) {
    errors.components[axis] = {};
    errors.locations[axis].setZero();
  }
  return errors;
}

struct ErrorCase {
  const char* name;
  ErrorModel errors;
};

// Each axis has errors over itself and others, over two others, and over all.
ErrorModel grids(const MachineChain& chain, Uniform& random, double size) {
  std::vector<Axis> axes;
  for (const ChainAxis& a : chain.axes) axes.push_back(a.axis);
  ErrorModel errors = cubics(random, size);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto next = [&](std::size_t k) { return axes[(i + k) % axes.size()]; };
    const auto add = [&](Axis direction, std::vector<Axis> over, GridInterpolation form) {
      ErrorFunction& f = errors.component({direction, axes[i], false});
      f = f + random_grid(random, size, std::move(over), form);
    };
    add(Axis::X, {next(0)}, GridInterpolation::cubic);
    add(Axis::Y, {next(1), next(0)}, GridInterpolation::cubic);
    add(Axis::Z, {next(1), next(2)}, GridInterpolation::linear);
    add(Axis::C, axes, GridInterpolation::linear);
  }
  return errors;
}

std::vector<ErrorCase> error_cases(const MachineChain& chain, Uniform& random) {
  std::vector<ErrorCase> all;
  all.push_back({"cubic", cubics(random, 1e-5)});
  // some lanes turn by less than kSmallTurn, some by more; the same of kSeriesTurn
  all.push_back({"large turns", cubics(random, 1.5e-4)});
  all.push_back({"larger turns", cubics(random, 4e-3)});
  ErrorModel mixed = random_errors(random, 1e-5);
  for (std::size_t axis = 0; axis < kAxisWords; ++axis) {
    ErrorFunction& f = mixed.components[axis][axis];
    const LinearTable t = random_table(random, 1e-5, 12);
    f = f + linear_table(t.s, t.error) + polynomial({0, 0, 0, 0, 1e-5, -1e-5, 2e-5});
  }
  all.push_back({"mixed", mixed});
  ErrorModel straightness;  // no angles but squareness
  straightness.component("EYX"_err) = harmonic(1e-5, 0.06, 0.2);
  straightness.location("EC0Y"_err) = 1e-5;
  all.push_back({"straightness", straightness});
  // those of linear axes only: cubics, some turns too large for small ones, and all terms
  all.push_back({"linear axes, cubic", of_linear_axes(cubics(random, 1e-5))});
  all.push_back({"linear axes, large turns", of_linear_axes(cubics(random, 1.5e-4))});
  all.push_back({"linear axes, larger turns", of_linear_axes(cubics(random, 4e-3))});
  all.push_back({"linear axes, mixed", of_linear_axes(mixed)});
  all.push_back({"linear axes, mixed and large turns", of_linear_axes(scaled(mixed, 60.0))});
  ErrorModel harmonics;  // more waves than a register holds
  for (int n = 1; n < 12; ++n) {
    auto& f = harmonics.component({kAllAxes[n % 6U], kAllAxes[n % 3U], false});
    f = f + harmonic(1e-5 * random(), 0.05 * n);
  }
  all.push_back({"linear axes, harmonics", harmonics});
  all.push_back({"grids", grids(chain, random, 1e-5)});
  all.push_back({"linear axes, grids", of_linear_axes(grids(chain, random, 1e-5))});
  all.push_back({"none", {}});
  return all;
}

MachineChain machine(const char* text, Uniform& random, bool with_centres) {
  const Structure structure = parse_structure(text);
  return with_centres ? random_chain(structure, random) : make_chain(structure);
}

template <class F>
void for_all_cases(unsigned seed, F f) {
  Uniform random(seed);
  for (const char* text : kMachines) {
    for (const bool with_centres : {false, true}) {
      const MachineChain chain = machine(text, random, with_centres);
      for (const ErrorCase& c : error_cases(chain, random)) {
        SCOPED_TRACE(std::string(text) + " " + c.name + (with_centres ? " with centres" : ""));
        f(chain, c.errors, random);
      }
    }
  }
}

std::vector<Joints> random_poses(const MachineChain& chain, Uniform& random, std::size_t number) {
  std::vector<Joints> Q;
  for (std::size_t n = 0; n < number; ++n) {
    Q.push_back(random_joints(chain, random));
    if (n % 3 == 1) Q[n].tail<2>() = Q[n - 1].tail<2>();  // rotary axes stand still
  }
  return Q;
}

TEST(VolumetricLanes, AgreeWithProductsOfMatrices) {
  for_all_cases(71, [](const MachineChain& chain, const ErrorModel& errors, Uniform& random) {
    const VolumetricModel model(chain, errors);
    const Vector3d p_ST = 0.2 * random.vector();
    for (const Joints& Q : random_poses(chain, random, 4)) {
      const ToolPose P = model.forward(Q, p_ST), exact = pose_by_matrices(chain, errors, Q, p_ST);
      ASSERT_LT((P.p_WT - exact.p_WT).norm(), kRounding);
      ASSERT_LT((P.k_W - exact.k_W).norm(), kRounding);
    }
  });
}

TEST(VolumetricLanes, ManyPosesHaveTheBitsOfEachAlone) {
  for_all_cases(72, [](const MachineChain& chain, const ErrorModel& errors, Uniform& random) {
    const VolumetricModel model(chain, errors);
    const Vector3d p_ST = 0.2 * random.vector();
    for (const std::size_t number : {0U, 1U, 7U, 8U, 21U, 77U}) {
      const std::vector<Joints> Q = random_poses(chain, random, number);
      std::vector<ToolPose> P(number);
      std::vector<VolumetricError> e(number);
      std::vector<Vector3d> d(number);
      model.poses(Q, p_ST, P);
      model.errors(Q, p_ST, e);
      model.joint_offsets(Q, p_ST, d);
      for (std::size_t n = 0; n < number; ++n) {
        const ToolPose alone = model.forward(Q[n], p_ST);
        ASSERT_EQ(P[n].p_WT, alone.p_WT);
        ASSERT_EQ(P[n].k_W, alone.k_W);
        const VolumetricError error = model.error(Q[n], p_ST);
        ASSERT_EQ(e[n].dp_W, error.dp_W);
        ASSERT_EQ(e[n].dk_W, error.dk_W);
        ASSERT_EQ(d[n], model.joint_offset(Q[n], p_ST));
      }
    }
  });
}

TEST(VolumetricLanes, EightPosesInLanesHaveTheBitsOfEachAlone) {
  for_all_cases(75, [](const MachineChain& chain, const ErrorModel& errors, Uniform& random) {
    const VolumetricModel model(chain, errors);
    const Vector3d p_ST = 0.2 * random.vector();
    const std::vector<Joints> Q = random_poses(chain, random, kLaneWidth);
    LaneArray in_lanes[kJoints], d[kLinearJoints];
    for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
      for (int j = 0; j < kJoints; ++j) in_lanes[j][lane] = Q[lane][j];
    }
    model.joint_offsets(in_lanes, p_ST, d);
    for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
      const Vector3d alone = model.joint_offset(Q[lane], p_ST);
      for (int i = 0; i < kLinearJoints; ++i) ASSERT_EQ(d[i][lane], alone[i]);
    }
  });
}

// Law (5) of VolumetricModel: the shift of the linear axes moves the ideal tip by the error. The
// products of matrices know nothing of the ways on which offsets are computed.
TEST(VolumetricLanes, OffsetsMoveTheIdealTipByTheErrorOfProductsOfMatrices) {
  for_all_cases(76, [](const MachineChain& chain, const ErrorModel& errors, Uniform& random) {
    if (number_of_linear_axes(chain) < kLinearJoints) return;
    const VolumetricModel model(chain, errors);
    const Vector3d p_ST = 0.2 * random.vector();
    for (const Joints& Q : random_poses(chain, random, 4)) {
      const Vector3d error = pose_by_matrices(chain, errors, Q, p_ST).p_WT -
                             pose_by_matrices(chain, ErrorModel{}, Q, p_ST).p_WT;
      const Vector3d d = model.joint_offset(Q, p_ST);
      ASSERT_LT((linear_jacobian(chain, Q) * d - error).norm(), kRounding);
    }
  });
}

TEST(VolumetricLanes, MostMachinesTakeTheLinearAxisPath) {
  const auto has_linear_axes_only = [](const char* text, ErrorName name) {
    ErrorModel errors;
    if (name.is_location) {
      errors.location(name) = 1e-5;
    } else {
      errors.component(name) = constant(1e-5);
    }
    return VolumetricEvaluation(make_chain(parse_structure(text)), errors).has_linear_axes_only();
  };
  // linear axes in a row, of whatever order and side, which alone have errors
  for (const char* text : {"[w b X Y Z t]", "[w b Z X Y t]", "[w C' B' X b Y Z t]",
                           "[w Z' Y' X' b C A t]", "[w C' b Y Z X A t]"}) {
    EXPECT_TRUE(has_linear_axes_only(text, "EAX"_err)) << text;
    EXPECT_TRUE(has_linear_axes_only(text, "EC0Y"_err)) << text;
  }
  // a rotary axis between, one with errors, two linear axes
  EXPECT_FALSE(has_linear_axes_only("[w X b B Y Z t]", "EAX"_err));
  EXPECT_FALSE(has_linear_axes_only("[w C' B' X b Y Z t]", "EXC"_err));
  EXPECT_FALSE(has_linear_axes_only("[w b X Y Z C A t]", "EB0C"_err));
  EXPECT_FALSE(has_linear_axes_only("[w b X Y t]", "EAX"_err));
}

TEST(VolumetricLanes, AgreeOnAllInstructionSets) {
  for_all_cases(73, [](const MachineChain& chain, const ErrorModel& errors, Uniform& random) {
    const Vector3d p_ST = 0.2 * random.vector();
    const std::vector<Joints> Q = random_poses(chain, random, 8);
    std::vector<std::array<double, 72>> results;  // eight tools, eight offsets
    for (const SimdLevel level : simd_levels()) {
      const VolumetricEvaluation evaluation(chain, errors, level);
      auto& many = results.emplace_back();
      many.fill(0.0);
      evaluation.tools(Q, p_ST, many.data());
      for (std::size_t n = 0; n < Q.size(); ++n) {
        std::array<double, 6> alone;
        evaluation.tool(Q[n], p_ST, alone.data());
        for (std::size_t i = 0; i < 6; ++i) ASSERT_EQ(many[6 * n + i], alone[i]) << name_of(level);
      }
      if (!evaluation.has_linear_axes_only()) continue;
      evaluation.offsets(Q, p_ST, many.data() + 48);
      for (std::size_t n = 0; n < Q.size(); ++n) {
        std::array<double, 3> alone;
        evaluation.offset(Q[n], p_ST, alone.data());
        for (std::size_t i = 0; i < 3; ++i) {
          ASSERT_EQ(many[48 + 3 * n + i], alone[i]) << name_of(level);
        }
      }
    }
    for (std::size_t l = 1; l < results.size(); ++l) {
      for (std::size_t i = 0; i < 72; ++i) ASSERT_NEAR(results[l][i], results[0][i], kRounding);
      ASSERT_EQ(results[l], results[1]);  // all but the baseline round once in a b + c
    }
  });
}

TEST(HarmonicInLanes, IsTheSine) {
  // One unit in the last place of 1, twice: of our sine and of the C library's.
  const double ulp = 4.5e-16;
  for (const double period : {10.0, 1.0, 1e-2, 1e-5}) {
    ErrorModel errors;
    errors.component("EXX"_err) = harmonic(1.0, period, 0.3);
    const VolumetricModel model(make_chain(parse_structure("[w b X t]")), errors);
    for (int n = -300; n <= 300; ++n) {
      Joints Q = Joints::Zero();
      Q[0] = 0.00137 * n;
      const double e = model.error(Q, Vector3d(-Q[0], 0.0, 0.0)).dp_W.x();
      ASSERT_NEAR(e, errors.component("EXX"_err).value(Q[0]), ulp) << period << " " << Q[0];
    }
  }
}

}  // namespace
}  // namespace servomill::plant::volumetric_lanes_test
