/// The true path of the cutters through the part, from the recording of a case.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plant/cutting/cutter.h"
#include "plant/cutting/removed_volume.h"
#include "plant/cutting/stock.h"
#include "plant/geometry/volumetric.h"
#include "sim/engine/program_path.h"
#include "sim/model/work_frame.h"
#include "sim/records/series.h"

namespace servomill::sim::model {
struct HeatSettings;  // sim/model/heat.h
}  // namespace servomill::sim::model

namespace servomill::sim::evaluation {

/// Inputs from a case: moves and cutters of its part.
struct PartSource {
  const std::string& case_name;
  const records::Series& servo;
  const engine::ProgramPath& path;
  const std::map<int, plant::Cutter>& cutters;      // by number of the tool
  const std::map<int, Eigen::Vector3d>& tips;       // p_ST (m), by number of the tool offset
  const plant::MachineChain& chain;                 // the ideal machine
  AxisWords work_offset = AxisWords::Zero();        // m, rad, machine coordinates
  const plant::VolumetricModel* imposed = nullptr;  // or none
  const plant::Stock* stock = nullptr;              // the stock; none: it is everywhere
  const model::HeatSettings* heat = nullptr;        // the part may grow with it
  bool vibrates = false;                            // teeth have left marks of a vibration
};

const plant::Cutter* cutter_of(const PartSource& source, const engine::ProgramPath::Piece& piece);

/// Passes of cutters in the work frame, and the first feed of each, which says what turned in the
/// spindle.
struct CutterPasses {
  std::vector<plant::CutterPass> passes;
  std::vector<const engine::ProgramPath::Piece*> feeds;  // of each pass; nullptr: only rapid
  std::vector<std::vector<double>> angles;               // rad, of the spindle at each position, of
                                                         // each pass; empty: not recorded

  /// The pass that a position (counted through all of them) belongs to, and its place in it;
  /// pass == passes.size(): none.
  struct Place {
    std::size_t pass, position;
  };
  Place place_of(std::size_t position) const;
  /// Its first feed.
  const engine::ProgramPath::Piece* feed_at(std::size_t position) const;
};

/// One pass from each change of the tool to the next: every recorded row, rapid moves included.
/// Between rows they are straight; what is lost is chord_error(). Rows of tools without a cutting
/// part are left out. The recording is read; held are the boxes of its blocks.
class CutterPath {
 public:
  using Box = Eigen::AlignedBox3d;

  /// @param source  must outlive it
  explicit CutterPath(const PartSource& source);

  std::size_t positions() const { return positions_; }
  const model::PartFrame& frame() const { return frame_; }

  /// Everything, a pass of the program in one.
  CutterPasses all() const;

  /// The parts of the passes in which a cutter comes into one of the boxes, and somewhat more.
  CutterPasses near(std::span<const Box> boxes) const;
  /// The positions of near() for this box.
  std::size_t positions_near(const Box& box) const;

 private:
  static constexpr std::size_t kBlock = 256;

  struct Pass {
    const plant::Cutter* cutter = nullptr;
    std::optional<engine::ProgramPath::Piece> feed;
    std::size_t first = 0, end = 0;  // rows
  };
  // Consecutive rows of a pass, and what the cutter sweeps from the row before them to the last.
  struct Block {
    Eigen::AlignedBox3f box;
    std::size_t pass = 0;
    std::size_t first = 0, end = 0;  // rows
  };

  plant::CutterPosition at(std::size_t row) const;
  void add_blocks(std::size_t pass);
  Eigen::AlignedBox3f swept_box(const Pass& pass, std::size_t first, std::size_t end) const;
  void add(std::size_t pass, std::size_t first, std::size_t end, CutterPasses& out) const;
  double strain_at(std::size_t row) const;
  void add_at_one_strain(std::size_t pass, std::size_t first, std::size_t end, double strain,
                         CutterPasses& out) const;

  const records::Series& servo_;
  model::PartFrame frame_;
  std::size_t position_column_, axis_column_;
  std::optional<std::size_t> angle_column_, temperature_column_;
  double expansion_ = 0.0, reference_ = 0.0;  // 1/K, degC
  std::size_t positions_ = 0;
  std::vector<Pass> passes_;
  std::vector<Block> blocks_;
};

}  // namespace servomill::sim::evaluation
