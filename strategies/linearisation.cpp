#include "strategies/linearisation.h"

#include <array>

#include "plant/vocabulary/interrupt.h"

namespace servomill::strategies {
namespace {

constexpr std::array<std::string_view, 2> kDefinitions = {"joint_interpolation",
                                                          "post_processed_location"};

constexpr std::array<std::string_view, 2> kFrames = {"machine", "workpiece"};

const std::array<ParameterSpec, 4>& specs() {
  static const std::array<ParameterSpec, 4> kSpecs = {{
      {.name = "definition",
       .help = "error of the TCP under linear joint interpolation, or of post-processed "
               "intermediate locations against the joint line",
       .default_text = "joint_interpolation",
       .is_number = false,
       .words = kDefinitions},
      {.name = "amplitude",
       .help = "frame in which the error at mid-move gives the amplitude of the model; machine: as "
               "published",
       .default_text = "machine",
       .is_number = false,
       .words = kFrames},
      {.name = "tolerance_um",
       .help = "moves with a smaller modelled error are left unchanged",
       .unit = "um",
       .default_text = "1",
       .min = 1e-3},
      {.name = "spacing_mm",
       .help = "spacing of the inserted points along the TCP path",
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
  Inserter(const IdentifiedMachine& identified, const PointsOfLine& points_of, const PutMove& put)
      : identified_(identified), points_of_(points_of), put_(put) {}

  void run(const MoveRange& moves) {
    at_ = identified_.layout.words(identified_.reference);
    for (const Move& move : moves) {
      throw_if_interrupted();
      if (move.kind == MoveKind::arc && turns(at_, move)) {
        throw InputError({{}, move.line, 0},
                         "an arc with rotary axis motion cannot be linearised; write it as lines");
      }
      if (move.kind == MoveKind::feed && turns(at_, move) && shifts(at_, move)) {
        insert(move);
      } else {
        put_(move);
      }
      if (is_motion(move.kind)) at_ = move.end_machine;
    }
  }

 private:
  void insert(const Move& move) {
    const JointLayout& layout = identified_.layout;
    double s = move.s_begin;
    for (const plant::PathPoint& point : points(layout.joints(at_), move)) {
      throw_if_interrupted();
      Move block = move;
      if (point.t < 1.0) {
        block.end_machine = layout.words(point.Q);
        block.end += block.end_machine - move.end_machine;
        block.s_end = move.s_begin + point.t * (move.s_end - move.s_begin);
      }
      block.s_begin = s;
      s = block.s_end;
      put_(block);
    }
  }

  std::vector<plant::PathPoint> points(const Joints& Q_0, const Move& move) const {
    try {
      return points_of_(Q_0, identified_.layout.joints(move.end_machine));
    } catch (const InputError& error) {  // knows no line
      throw InputError({{}, move.line, 0}, error.faults().front().message);
    }
  }

  const IdentifiedMachine& identified_;
  const PointsOfLine& points_of_;
  const PutMove& put_;
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
  ErrorModelStrategy(const IdentifiedMachine& identified, const ErrorModelParams& params)
      : identified_(identified), params_(params), inverse_(nominal_inverse(identified)) {}

  bool rewrites() const override { return true; }

  void rewrite(const MoveRange& moves, const PutMove& put) const override {
    const auto points_of = [&](const Joints& Q_0, const Joints& Q_1) {
      const plant::PostProcessedSegment segment(inverse_, identified_.p_ST, Q_0, Q_1);
      auto points = segment.compensated_points(params_.definition, params_.shape, params_.tolerance,
                                               params_.spacing, params_.frame);
      if (!points) throw InputError(Place{}, "the axes cannot reach an intermediate location");
      return *std::move(points);
    };
    put_with_points(moves, identified_, points_of, put);
  }

 private:
  IdentifiedMachine identified_;
  ErrorModelParams params_;
  plant::InverseKinematics inverse_;
};

}  // namespace

void put_with_points(const MoveRange& moves, const IdentifiedMachine& identified,
                     const PointsOfLine& points_of, const PutMove& put) {
  Inserter(identified, points_of, put).run(moves);
}

plant::InverseKinematics nominal_inverse(const IdentifiedMachine& identified) {
  plant::InverseSettings settings;
  settings.lower = identified.lower;
  settings.upper = identified.upper;
  return plant::InverseKinematics(identified.model.chain(), settings);
}

std::span<const ParameterSpec> error_model_specs() { return specs(); }

std::unique_ptr<Strategy> make_error_model(plant::ErrorShape shape, const Parameters& p,
                                           const IdentifiedMachine& identified) {
  ErrorModelParams params;
  params.shape = shape;
  params.definition = p.word("definition") == kDefinitions[0]
                          ? plant::NonlinearError::joint_interpolation
                          : plant::NonlinearError::post_processed_location;
  params.frame =
      p.word("amplitude") == kFrames[0] ? plant::ErrorFrame::machine : plant::ErrorFrame::workpiece;
  if (params.frame == plant::ErrorFrame::workpiece &&
      params.definition == plant::NonlinearError::post_processed_location) {
    throw InputError({},
                     "amplitude = \"workpiece\" needs definition = \"joint_interpolation\": "
                     "post-processed locations are compared in the machine");
  }
  params.tolerance = p.number("tolerance_um");
  params.spacing = p.number("spacing_mm");
  return std::make_unique<ErrorModelStrategy>(identified, params);
}

}  // namespace servomill::strategies
