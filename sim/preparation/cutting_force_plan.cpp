#include "sim/preparation/cutting_force_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/cutting/cutting_force.h"
#include "plant/cutting/engagement.h"
#include "plant/cutting/removed_volume.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/engine/depth_of_cut.h"
#include "sim/engine/engaged_teeth.h"
#include "sim/model/machine.h"
#include "sim/preparation/chatter_check.h"
#include "sim/preparation/tool_passes.h"

namespace servomill::sim::preparation {
namespace {

using Eigen::Vector3d;

constexpr double kCoarse = 2 * mm, kFinest = 0.25 * mm;  // between rows of the table
constexpr double kRubbed = 20 * um;     // of material that a tool rubs, thickness not reported
constexpr double kTangent = 1 * um;     // over which the direction of feed is taken
constexpr double kForceShare = 0.02;    // of the larger force, by which linear may be wrong,
constexpr double kForceTol = 0.5;       // N, at least
constexpr double kUsualChip = 50 * um;  // feed per tooth at which forces are compared
constexpr std::size_t kMaxWarnings = 5;

// Deepest cut of a tool beyond its flutes, and its place.
struct Shank {
  int line = 0;
  double flutes = 0.0, depth = 0.0;  // m; depth 0: nowhere
};

class Planner {
 public:
  explicit Planner(const CuttingPlanInputs& in)
      : in_(in), path_(in.program->path), passes_(in), stages_(passes_.stages()) {}

  PlannedCutting plan() {
    const plant::RemovedVolume removed = passes_.remove();
    removed_ = &removed;
    for (const Stage& stage : stages_) add_rows(stage);
    if (!touches_) refuse_untouched();
    warn_of_shanks();
    for (Fault& warning : chatter_.warnings(in_.file)) plan_.warnings.push_back(std::move(warning));
    if (rapids_ > kMaxWarnings) {
      plan_.warnings.push_back(
          {{in_.file},
           fmt::format("{} more rapid moves through material", rapids_ - kMaxWarnings)});
    }
    plan_.program = in_.program;
    plan_.table = engine::CuttingTable(std::move(rows_));
    if (in_.displaced) {
      plan_.displaced =
          std::make_shared<const std::vector<engine::DisplacedCut>>(std::move(displaced_));
    }
    if (in_.teeth) plan_.teeth = std::make_shared<const engine::EngagedTeeth>(std::move(teeth_));
    return std::move(plan_);
  }

 private:
  void add_rows(const Stage& stage) {
    const engine::ProgramPath::Piece p = path_.piece(stage.piece);
    const double length = p.s_end - p.s_begin;
    if (length <= 0.0) return;
    const double step =
        stage.cutter != nullptr ? std::min(kCoarse, 0.5 * stage.cutter->radius) : kCoarse;
    const int parts = may_meet(stage) ? static_cast<int>(std::ceil(length / step)) : 1;
    engine::CuttingTable::Row a = row(stage, 0.0);
    push(stage, a);
    for (int n = 1; n <= parts; ++n) {
      throw_if_interrupted();
      const engine::CuttingTable::Row b = row(stage, static_cast<double>(n) / parts);
      refine(stage, a, b);
      a = b;
    }
    if (stage.cutter != nullptr && meets_ && p.rapid) warn_of_rapid(p.line);
    meets_ = false;
    rapid_depth_ = 0.0;
  }

  // Rows between a, which is in the table, and b, and b.
  void refine(const Stage& stage, const engine::CuttingTable::Row& a,
              const engine::CuttingTable::Row& b) {
    const engine::ProgramPath::Piece p = path_.piece(stage.piece);
    const auto force = [](const engine::CuttingTable::Row& r) {
      return Vector3d(r.edge + kUsualChip * r.shear);
    };
    const Vector3d F_a = force(a), F_b = force(b);
    if (b.s - a.s > kFinest && may_meet(stage)) {
      const double share = (0.5 * (a.s + b.s) - p.s_begin) / (p.s_end - p.s_begin);
      const engine::CuttingTable::Row middle = row(stage, share);
      const Vector3d F = force(middle);
      const double most = std::max({F_a.norm(), F_b.norm(), F.norm()});
      const bool begins = F_a.isZero(0.0) != F_b.isZero(0.0);
      const bool is_linear =
          (F - 0.5 * (F_a + F_b)).norm() <= std::max(kForceTol, kForceShare * most);
      if (begins || !is_linear) {
        refine(stage, a, middle);
        refine(stage, middle, b);
        return;
      }
    }
    push(stage, b);
  }

  void push(const Stage& stage, engine::CuttingTable::Row row) {
    const bool cuts = !row.edge.isZero(0.0);
    if (!rows_.empty()) {
      const engine::CuttingTable::Row& before = rows_.back();
      const double share = 0.5 * (static_cast<double>(cuts) + static_cast<double>(cut_before_));
      const bool rapid = path_.is_rapid(stage.piece);
      row.cut = before.cut + (rapid ? 0.0 : share * (row.s - before.s));
    }
    cut_before_ = cuts;
    rows_.push_back(row);
  }

  bool may_meet(const Stage& stage) const {
    const double reach =
        stage.cutter != nullptr ? stage.cutter->length + stage.cutter->radius : 0.0;
    Eigen::AlignedBox3d box = stage.tips;
    box.min().array() -= reach;
    box.max().array() += reach;
    return box.intersects(in_.stock.bounds());
  }

  engine::CuttingTable::Row row(const Stage& stage, double share) {
    const engine::ProgramPath::Piece p = path_.piece(stage.piece);
    const double length = p.s_end - p.s_begin;
    engine::CuttingTable::Row row{.s = share < 1.0 ? p.s_begin + share * length : p.s_end};
    row.turns = stage.clockwise ? stage.turns : -stage.turns;
    if (!may_meet(stage)) return row;
    const double at = std::max(share, std::min(0.5, kBehind / length));
    const double ahead = std::min(1.0, at + kTangent / length);
    const double behind = std::max(0.0, at - kTangent / length);
    const plant::CutterPosition here = passes_.position(stage, at);
    const Vector3d tangent =
        (passes_.position(stage, ahead).tip - passes_.position(stage, behind).tip) /
        ((ahead - behind) * length);
    const std::size_t n = passes_.positions_before(stage, at);
    const plant::IsMaterial is_material = [&](const Vector3d& x) {
      return in_.stock.contains(x) && !removed_->contains(x, n);
    };
    if (stage.cutter == nullptr) {
      if (is_material(here.tip)) refuse_unknown(stage);
      return row;
    }
    if (tangent.norm() < 1e-9) return row;  // the tip stands
    const plant::CutterMotion motion{here, tangent.normalized(), stage.clockwise};
    look_at_shank(stage, motion, is_material);
    const auto arcs = plant::engagement(*stage.cutter, motion, is_material, in_.stock.bounds());
    if (arcs.empty()) return row;
    if (stage.turns <= 0.0) refuse_standing(stage);
    if (p.rapid) {
      rapid_depth_ =
          std::max({rapid_depth_, plant::engaged_height(arcs), depth_of_rapid(stage, motion)});
    }
    const plant::CutterFrame frame = plant::frame_of(motion);
    const plant::CuttingForce force =
        plant::average_force(in_.coefficients, stage.cutter->teeth, frame.feed, arcs);
    row.chip = tangent.norm() / (stage.turns * stage.cutter->teeth);
    row.shear = passes_.frame().R_WG * frame.axes * force.shear;
    row.edge = passes_.frame().R_WG * frame.axes * force.edge;
    const plant::CuttingTorque torque =
        plant::average_torque(in_.coefficients, stage.cutter->teeth, frame.feed, arcs);
    row.torque_shear = torque.shear;
    row.torque_edge = torque.edge;
    if (in_.teeth) {
      const plant::CutterFrame in_W{passes_.frame().R_WG * frame.axes, frame.feed};
      row.teeth = teeth_.add(stage.tool, *stage.cutter, in_W, arcs, row.turns);
    }
    if (in_.displaced) row.displaced = add_displaced(stage, motion, row.turns, is_material);
    if (!p.rapid) {
      const Eigen::Matrix3d axes = passes_.frame().R_WG * frame.axes;
      chatter_.add(p.line, stage.tool, *stage.cutter, {axes, frame.feed}, arcs, stage.turns,
                   passes_.joints());
    }
    touches_ = meets_ = true;
    return row;
  }

  // Cuts of a cutter beside its path: across the feed, the first direction along e2 if it is not
  // plunging.
  std::int32_t add_displaced(const Stage& stage, const plant::CutterMotion& motion, double turns,
                             const plant::IsMaterial& is_material) {
    const Eigen::Matrix3d& R_WG = passes_.frame().R_WG;
    const plant::CutterFrame frame = plant::frame_of(motion);
    const Vector3d first = frame.axes.col(1), second = motion.feed.cross(first).normalized();
    engine::DisplacedCut cut{.across = {R_WG * first, R_WG * second}, .at = {}};
    for (std::size_t i = 0; i < cut.at.size(); ++i) {
      plant::CutterMotion beside = motion;
      beside.position.tip +=
          (i % 2 == 0 ? 1.0 : -1.0) * engine::DisplacedCut::kStep * (i < 2 ? first : second);
      const auto arcs = plant::engagement(*stage.cutter, beside, is_material, in_.stock.bounds());
      if (arcs.empty()) continue;
      const plant::CuttingForce force =
          plant::average_force(in_.coefficients, stage.cutter->teeth, frame.feed, arcs);
      cut.at[i] = {R_WG * frame.axes * force.shear, R_WG * frame.axes * force.edge};
      if (!in_.teeth) continue;
      const plant::CutterFrame in_W{R_WG * frame.axes, frame.feed};
      cut.at[i].teeth = teeth_.add(stage.tool, *stage.cutter, in_W, arcs, turns);
    }
    displaced_.push_back(cut);
    return static_cast<std::int32_t>(displaced_.size()) - 1;
  }

  // Height of the stock above the tip, along the tool.
  double stock_above(const plant::CutterPosition& at) const {
    const Eigen::AlignedBox3d bounds = in_.stock.bounds();
    const Vector3d farthest = (at.axis.array() > 0.0).select(bounds.max(), bounds.min());
    return at.axis.dot(farthest - at.tip);
  }

  // Radius of a straight piece of a tool that looks for material, inside of finished walls.
  static double body_radius(const plant::Cutter& cutter) {
    return std::max(cutter.radius - kRubbed, 0.5 * cutter.radius);
  }

  // How far up from its lower end such a piece would be in material (m).
  double height_in_material(double radius, const plant::CutterMotion& lower_end,
                            const plant::IsMaterial& is_material) const {
    const plant::Cutter body{.radius = radius, .length = stock_above(lower_end.position)};
    return plant::engaged_height(
        plant::engagement(body, lower_end, is_material, in_.stock.bounds()));
  }

  // Material beside the tool above its flutes, which they have left there.
  void look_at_shank(const Stage& stage, const plant::CutterMotion& motion,
                     const plant::IsMaterial& is_material) {
    const double flutes = stage.cutter->length;
    Shank& shank = shanks_[stage.tool];
    if (stock_above(motion.position) <= std::max(flutes, shank.depth + kRubbed)) return;
    plant::CutterMotion above = motion;
    above.position.tip += flutes * motion.position.axis;
    const double rubbed = height_in_material(body_radius(*stage.cutter), above, is_material);
    if (rubbed <= 0.0 || flutes + rubbed <= shank.depth + kRubbed) return;
    shank = {path_.line(stage.piece), flutes, flutes + rubbed};
  }

  void warn_of_shanks() {
    for (const auto& [tool, shank] : shanks_) {
      if (shank.depth <= 0.0) continue;
      plan_.warnings.push_back(
          {{in_.file, shank.line},
           fmt::format("tool {} cuts {:.4g} mm deep (the maximum) with flutes of {:.4g} mm: its "
                       "shank rubs, and that force is not computed",
                       tool, shank.depth / mm, shank.flutes / mm)});
    }
  }

  // How far the tip is below the top of what was there before the move: beside the tool where it
  // goes and, where it only plunges, around and below it.
  double depth_of_rapid(const Stage& stage, const plant::CutterMotion& motion) const {
    const std::size_t n = stage.counts.front();
    const plant::IsMaterial was_material = [&](const Vector3d& x) {
      return in_.stock.contains(x) && !removed_->contains(x, n);
    };
    const double radius = body_radius(*stage.cutter);
    const plant::CutterFrame frame = plant::frame_of(motion);
    if (frame.feed.across > 0.0) return height_in_material(radius, motion, was_material);
    double deepest = 0.0;
    for (const double share : {1.0, 0.5, 0.1}) {
      for (const double sense : {1.0, -1.0}) {
        plant::CutterMotion beside = motion;
        beside.feed = sense * frame.axes.col(0);
        deepest = std::max(deepest, height_in_material(share * radius, beside, was_material));
      }
    }
    return deepest;
  }

  void warn_of_rapid(int line) {
    if (++rapids_ > kMaxWarnings) return;
    plan_.warnings.push_back(
        {{in_.file, line},
         fmt::format("rapid move through material, {:.3g} mm deep", rapid_depth_ / mm)});
  }

  [[noreturn]] void refuse_standing(const Stage& stage) const {
    throw InputError({in_.file, path_.line(stage.piece)},
                     "cuts with the spindle stopped; start it (M3 S...)");
  }
  [[noreturn]] void refuse_unknown(const Stage& stage) const {
    const int line = path_.line(stage.piece);
    throw InputError({in_.file, line},
                     stage.tool == 0
                         ? std::string("is in the stock without a tool; load one (T M6)")
                         : fmt::format("tool {} is in the stock; program.tool must give it a "
                                       "diameter_mm above 0",
                                       stage.tool));
  }
  [[noreturn]] void refuse_untouched() const {
    Eigen::AlignedBox3d tips;
    for (const Stage& stage : stages_) {
      if (stage.cutter != nullptr && !path_.is_rapid(stage.piece)) tips.extend(stage.tips);
    }
    const auto box = [](const Eigen::AlignedBox3d& b) {
      const Vector3d low = b.min() / mm, high = b.max() / mm;
      return fmt::format("X{:.4g} Y{:.4g} Z{:.4g} to X{:.4g} Y{:.4g} Z{:.4g}", low.x(), low.y(),
                         low.z(), high.x(), high.y(), high.z());
    };
    const std::string where =
        tips.isEmpty()
            ? "no tool with a diameter_mm feeds"
            : fmt::format("the tools feed within {}, the stock is within {} (mm, work coordinates)",
                          box(tips), box(in_.stock.bounds()));
    throw InputError(in_.place, fmt::format("{} never touches the stock: {}", in_.file, where));
  }

  const CuttingPlanInputs& in_;
  const engine::ProgramPath& path_;
  ToolPasses passes_;
  const std::vector<Stage>& stages_;
  const plant::RemovedVolume* removed_ = nullptr;
  std::vector<engine::CuttingTable::Row> rows_;
  engine::EngagedTeeth teeth_{in_.coefficients, in_.regeneration};
  std::vector<engine::DisplacedCut> displaced_;
  bool cut_before_ = false, meets_ = false, touches_ = false;
  std::size_t rapids_ = 0;
  double rapid_depth_ = 0.0;     // m, of the present move
  std::map<int, Shank> shanks_;  // by tool
  ChatterCheck chatter_{in_.modes, in_.coefficients, in_.chain};
  PlannedCutting plan_;
};

}  // namespace

PlannedCutting plan_cutting(const CuttingPlanInputs& inputs) { return Planner(inputs).plan(); }

}  // namespace servomill::sim::preparation
