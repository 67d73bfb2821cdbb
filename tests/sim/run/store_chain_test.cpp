#include "sim/run/store_chain.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <random>

#include "plant/vocabulary/units.h"
#include "sim/records/input_file.h"
#include "sim/records/output_file.h"

namespace servomill::sim::run::store_chain_test {
namespace {

plant::MachineChain chain_of(const char* structure) {
  return plant::make_chain(plant::parse_structure(structure));
}

// The pose of the tool from the attributes alone.
ToolPose pose(const records::InputFile& file, const plant::MachineChain& chain, const Joints& Q,
              const Eigen::Vector3d& p_ST) {
  const std::string letters = file.text("/case", "chain_axes");
  const std::vector<double> directions = file.numbers("/case", "chain_directions"),
                            points = file.numbers("/case", "chain_points_mm");
  Eigen::Isometry3d H = Eigen::Isometry3d::Identity();
  for (std::size_t k = 0; k < letters.size(); ++k) {
    const Eigen::Vector3d direction(&directions[3 * k]);
    const Eigen::Vector3d point = Eigen::Vector3d(&points[3 * k]) * mm;
    const double q = Q[chain.axes[k].joint];
    if (letters[k] < 'X') {
      H.translate(point);
      H.rotate(Eigen::AngleAxisd(q, direction));
      H.translate(-point);
    } else {
      H.translate(q * direction);
    }
  }
  return {H * p_ST, H.linear().col(2)};
}

TEST(StoredChain, MovesTheToolAsTheMachineDoes) {
  std::vector<plant::MachineChain> chains = {chain_of("[w C' B' X b Y Z (C1) t]"),
                                             chain_of("[w b Z X Y A B (C1) t]"),
                                             chain_of("[w Y' b X Z (C1) t]")};
  for (plant::ChainAxis& axis : chains[0].axes) {
    axis.centre = {30 * mm, -20 * mm, 110 * mm};
    if (axis.axis == Axis::B) plant::incline(axis, {0.0, 1.0, 1.0});
    if (axis.axis == Axis::C) axis.sense = plant::Sense::table;
  }
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  for (const plant::MachineChain& chain : chains) {
    const std::string path = ::testing::TempDir() + "store_chain_test.h5";
    records::OutputFile out(path, true);
    records::Hdf5Group group = out.root().group("case");
    write_chain(group, chain);
    out.commit();
    const records::InputFile file(path);
    const std::vector<double> carries = file.numbers("/case", "chain_carries_workpiece");
    for (std::size_t k = 0; k < chain.axes.size(); ++k) {
      EXPECT_EQ(carries[k], chain.axes[k].side == plant::Side::workpiece ? 1.0 : 0.0);
    }
    for (int n = 0; n < 20; ++n) {
      Joints Q = Joints::Zero();
      for (const plant::ChainAxis& axis : chain.axes) Q[axis.joint] = 0.5 * share(random);
      const Eigen::Vector3d p_ST(0.01, -0.02, -0.12);
      const ToolPose known = plant::forward(chain, Q, p_ST), found = pose(file, chain, Q, p_ST);
      EXPECT_LT((known.p_WT - found.p_WT).norm(), 1e-12);
      EXPECT_LT((known.k_W - found.k_W).norm(), 1e-12);
    }
  }
}

}  // namespace
}  // namespace servomill::sim::run::store_chain_test
