#include "strategies/straightening.h"

#include <array>

#include "plant/vocabulary/interrupt.h"

namespace servomill::strategies {
namespace {

constexpr std::array<std::string_view, 2> kDefinitions = {"joint_interpolation", "posted_location"};

constexpr std::array<std::string_view, 2> kFrames = {"machine", "workpiece"};

const std::array<ParameterSpec, 4>& specs() {
  static const std::array<ParameterSpec, 4> kSpecs = {{
      {.name = "definition",
       .help = "error of the tip while joints go linearly, or of posts of locations between "
               "against the line of the joints",
       .default_text = "joint_interpolation",
       .is_number = false,
       .words = kDefinitions},
      {.name = "amplitude",
       .help = "frame in which the error halfway gives the amplitude of the model; the machine as "
               "published",
       .default_text = "machine",
       .is_number = false,
       .words = kFrames},
      {.name = "tolerance_um",
       .help = "lines whose error is smaller by the model are left as they are",
       .unit = "um",
       .default_text = "1",
       .min = 1e-3},
      {.name = "spacing_mm",
       .help = "of the points that are put in, along the way of the tip",
       .unit = "mm",
       .default_text = "0.1",
       .min = 1e-3,
       .shortcoming = Shortcoming::block_length},
  }};
  return kSpecs;
}

bool turns(const AxisWords& from, const Move& move) {
  return (move.end_machine - from).tail<3>().any();
}

bool shifts(const AxisWords& from, const Move& move) {
  return (move.end_machine - from).head<3>().any();
}

// Puts points into moves and hands out their lines, arc lengths and times.
class Inserter {
 public:
  Inserter(const Belief& belief, const PointsOfLine& points_of)
      : belief_(belief), points_of_(points_of) {}

  std::vector<Move> run(const std::vector<Move>& moves) {
    at_ = belief_.layout.words(belief_.reference);
    for (const Move& move : moves) {
      throw_if_interrupted();
      if (move.kind == MoveKind::arc && turns(at_, move)) {
        throw InputError({{}, move.line, 0},
                         "an arc on which rotary axes turn cannot be made straight; write it as "
                         "lines");
      }
      if (move.kind == MoveKind::feed && turns(at_, move) && shifts(at_, move)) {
        insert(move);
      } else {
        out_.push_back(move);
      }
      if (is_motion(move.kind)) at_ = move.end_machine;
    }
    return std::move(out_);
  }

 private:
  void insert(const Move& move) {
    const JointLayout& layout = belief_.layout;
    double t = 0.0;
    for (const plant::PathPoint& point : points(layout.joints(at_), move)) {
      throw_if_interrupted();
      Move block = move;
      if (point.t < 1.0) {
        block.end_machine = layout.words(point.Q);
        block.end += block.end_machine - move.end_machine;
        block.s_end = move.s_begin + point.t * (move.s_end - move.s_begin);
      }
      block.s_begin = t > 0.0 ? out_.back().s_end : move.s_begin;
      t = point.t;
      out_.push_back(block);
    }
  }

  std::vector<plant::PathPoint> points(const Joints& Q_0, const Move& move) const {
    try {
      return points_of_(Q_0, belief_.layout.joints(move.end_machine));
    } catch (const InputError& error) {  // knows no line
      throw InputError({{}, move.line, 0}, error.faults().front().message);
    }
  }

  const Belief& belief_;
  const PointsOfLine& points_of_;
  std::vector<Move> out_;
  AxisWords at_ = AxisWords::Zero();
};

struct ErrorModelParams {
  plant::ErrorShape shape = plant::ErrorShape::harmonic;
  plant::NonlinearError definition = plant::NonlinearError::joint_interpolation;
  plant::ErrorFrame frame = plant::ErrorFrame::machine;
  double tolerance = 0.0;  // m
  double spacing = 0.0;    // m
};

class ErrorModelStrategy final : public Strategy {
 public:
  ErrorModelStrategy(const Belief& belief, const ErrorModelParams& params)
      : belief_(belief), params_(params), inverse_(nominal_inverse(belief)) {}

  bool rewrites() const override { return true; }

  std::vector<Move> rewrite(const std::vector<Move>& moves) const override {
    return with_points(moves, belief_, [&](const Joints& Q_0, const Joints& Q_1) {
      const plant::PostedSegment segment(inverse_, belief_.p_ST, Q_0, Q_1);
      auto points = segment.compensated_points(params_.definition, params_.shape, params_.tolerance,
                                               params_.spacing, params_.frame);
      if (!points) throw InputError(Place{}, "the axes cannot reach a location on the way");
      return *std::move(points);
    });
  }

 private:
  Belief belief_;
  ErrorModelParams params_;
  plant::InverseKinematics inverse_;
};

}  // namespace

std::vector<Move> with_points(const std::vector<Move>& moves, const Belief& belief,
                              const PointsOfLine& points_of) {
  return Inserter(belief, points_of).run(moves);
}

plant::InverseKinematics nominal_inverse(const Belief& belief) {
  plant::InverseSettings settings;
  settings.lower = belief.lower;
  settings.upper = belief.upper;
  return plant::InverseKinematics(belief.model.chain(), settings);
}

std::span<const ParameterSpec> error_model_specs() { return specs(); }

std::unique_ptr<Strategy> make_error_model(plant::ErrorShape shape, const Parameters& p,
                                           const Belief& belief) {
  ErrorModelParams params;
  params.shape = shape;
  params.definition = p.word("definition") == kDefinitions[0]
                          ? plant::NonlinearError::joint_interpolation
                          : plant::NonlinearError::posted_location;
  params.frame =
      p.word("amplitude") == kFrames[0] ? plant::ErrorFrame::machine : plant::ErrorFrame::workpiece;
  if (params.frame == plant::ErrorFrame::workpiece &&
      params.definition == plant::NonlinearError::posted_location) {
    throw InputError({},
                     "amplitude = \"workpiece\" needs definition = \"joint_interpolation\": "
                     "posted locations are compared in the machine");
  }
  params.tolerance = p.number("tolerance_um");
  params.spacing = p.number("spacing_mm");
  return std::make_unique<ErrorModelStrategy>(belief, params);
}

}  // namespace servomill::strategies
