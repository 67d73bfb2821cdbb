#include "sim/evaluation/cutter_path.h"

#include <algorithm>
#include <cmath>

#include "plant/cutting/swept_cutter.h"
#include "plant/heat/temperature.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/vector_at.h"
#include "sim/model/heat.h"

namespace servomill::sim::evaluation {
namespace {

using Eigen::Vector3d;

constexpr double kSameStrain = 1e-6;     // 10 nm of a radius of 10 mm
constexpr double kSameS = 1e-8;          // m; recorded arc lengths are rounded
constexpr double kBoxMargin = 1.0 * um;  // more than the rounding of boxes

// The piece of the program that a recorded row belongs to; rows are asked for in order.
class PieceOfRow {
 public:
  PieceOfRow(const records::Series& series, const engine::ProgramPath& path)
      : series_(series), path_(path), s_(*series.column("s")), line_(*series.column("line")) {}

  engine::ProgramPath::Piece at(std::size_t row) {
    const double s = series_.at(row, s_) * mm;
    const int line = static_cast<int>(series_.at(row, line_));
    while (piece_ + 1 < path_.size() && is_behind(s, line)) ++piece_;
    return path_.piece(piece_);
  }

 private:
  bool is_behind(double s, int line) const {
    const double s_end = path_.s_end(piece_);
    return s > s_end + kSameS || (line != path_.line(piece_) && s >= s_end - kSameS);
  }

  const records::Series& series_;
  const engine::ProgramPath& path_;
  std::size_t s_, line_;
  std::size_t piece_ = 0;
};

// The cutter as a part has it that has shrunk by a strain since it was cut.
plant::Cutter shrunk(plant::Cutter cutter, double strain) {
  const double factor = 1.0 / (1.0 + strain);
  cutter.radius *= factor;
  cutter.corner_radius *= factor;
  cutter.length *= factor;
  return cutter;
}

}  // namespace

const plant::Cutter* cutter_of(const PartSource& source, const engine::ProgramPath::Piece& piece) {
  const auto found = source.cutters.find(piece.tool);
  return found == source.cutters.end() ? nullptr : &found->second;
}

CutterPasses::Place CutterPasses::place_of(std::size_t position) const {
  for (std::size_t i = 0; i < passes.size(); ++i) {
    if (position < passes[i].positions.size()) return {i, position};
    position -= passes[i].positions.size();
  }
  return {passes.size(), 0};
}

const engine::ProgramPath::Piece* CutterPasses::feed_at(std::size_t position) const {
  const std::size_t pass = place_of(position).pass;
  return pass < passes.size() ? feeds[pass] : nullptr;
}

CutterPath::CutterPath(const PartSource& source)
    : servo_(source.servo),
      frame_(model::work_frame(source.chain, source.work_offset)),
      position_column_(*source.servo.column("tool_position_true", 'X')),
      axis_column_(*source.servo.column("tool_axis_true", 'I')),
      angle_column_(source.servo.column("spindle_angle")) {
  if (source.heat != nullptr && source.heat->part) {
    const model::PartExpansion& part = *source.heat->part;
    const auto body = static_cast<std::size_t>(part.body);
    temperature_column_ = servo_.column("temperature_" + source.heat->network.bodies[body].name);
    expansion_ = part.expansion;
    reference_ = celsius(source.heat->reference);
  }
  PieceOfRow pieces(servo_, source.path);
  const plant::Cutter* cutting = nullptr;
  for (std::size_t row = 0; row < servo_.rows(); ++row) {
    const engine::ProgramPath::Piece piece = pieces.at(row);
    const plant::Cutter* cutter = cutter_of(source, piece);
    if (cutter != nullptr && cutter != cutting) passes_.push_back({cutter, {}, row, row});
    cutting = cutter;
    if (cutter == nullptr) continue;
    Pass& pass = passes_.back();
    if (!pass.feed && !piece.rapid) pass.feed = piece;
    pass.end = row + 1;
    ++positions_;
  }
  for (std::size_t pass = 0; pass < passes_.size(); ++pass) add_blocks(pass);
}

plant::CutterPosition CutterPath::at(std::size_t row) const {
  return {frame_.point(vector_at(servo_, row, position_column_) * mm),
          frame_.direction(vector_at(servo_, row, axis_column_)).normalized()};
}

void CutterPath::add_blocks(std::size_t pass) {
  const Pass& of = passes_[pass];
  for (std::size_t first = of.first; first < of.end; first += kBlock) {
    throw_if_interrupted();
    const std::size_t end = std::min(first + kBlock, of.end);
    blocks_.push_back({swept_box(of, first, end), pass, first, end});
  }
}

// Tips and upper ends of the flutes, and a radius around them.
Eigen::AlignedBox3f CutterPath::swept_box(const Pass& pass, std::size_t first,
                                          std::size_t end) const {
  const plant::Envelope body = plant::envelope(*pass.cutter);
  Box box;
  double bent = 0.0, grown = 0.0;  // m; the cutter in a part that was colder than it is measured
  plant::CutterPosition before = at(first > pass.first ? first - 1 : first);
  for (std::size_t row = first > pass.first ? first - 1 : first; row < end; ++row) {
    const plant::CutterPosition position = at(row);
    box.extend(position.tip);
    box.extend(Vector3d(position.tip + body.top * position.axis));
    bent = std::max(bent, plant::turn_deviation(before, position, body.reach()));
    grown = std::max(grown, -strain_at(row) / (1.0 + strain_at(row)) * body.reach());
    before = position;
  }
  const Vector3d around = Vector3d::Constant(body.radius() + bent + grown + kBoxMargin);
  return Box(box.min() - around, box.max() + around).cast<float>();
}

void CutterPath::add(std::size_t pass, std::size_t first, std::size_t end,
                     CutterPasses& out) const {
  // positions are those on the cold part: a cutter in a warm one is smaller there
  for (std::size_t from = first; from + 1 < end || from == first;) {
    const double strain = strain_at(from);
    std::size_t to = from + 1;
    while (to < end && std::abs(strain_at(to) - strain) <= kSameStrain) ++to;
    to = std::max(to, std::min(from + 2, end));
    add_at_one_strain(pass, from, to, strain, out);
    if (to == end) return;
    from = to - 1;  // straight on from the last position
  }
}

double CutterPath::strain_at(std::size_t row) const {
  if (!temperature_column_) return 0.0;
  return expansion_ * (servo_.at(row, *temperature_column_) - reference_);
}

void CutterPath::add_at_one_strain(std::size_t pass, std::size_t first, std::size_t end,
                                   double strain, CutterPasses& out) const {
  const Pass& of = passes_[pass];
  out.passes.push_back({strain == 0.0 ? *of.cutter : shrunk(*of.cutter, strain), {}});
  out.feeds.push_back(of.feed ? &*of.feed : nullptr);
  std::vector<plant::CutterPosition>& positions = out.passes.back().positions;
  positions.reserve(end - first);
  for (std::size_t row = first; row < end; ++row) positions.push_back(at(row));
  std::vector<double>& angles = out.angles.emplace_back();
  if (!angle_column_) return;
  angles.reserve(end - first);
  for (std::size_t row = first; row < end; ++row) {
    angles.push_back(servo_.at(row, *angle_column_) * deg);
  }
}

CutterPasses CutterPath::all() const {
  CutterPasses out;
  for (std::size_t pass = 0; pass < passes_.size(); ++pass) {
    add(pass, passes_[pass].first, passes_[pass].end, out);
  }
  return out;
}

CutterPasses CutterPath::near(std::span<const Box> boxes) const {
  const auto is_near = [&](const Block& block) {
    return std::any_of(boxes.begin(), boxes.end(),
                       [&](const Box& box) { return block.box.intersects(box.cast<float>()); });
  };
  CutterPasses out;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (!is_near(blocks_[i])) continue;
    const std::size_t first = i, pass = blocks_[i].pass;
    while (i + 1 < blocks_.size() && blocks_[i + 1].pass == pass && is_near(blocks_[i + 1])) ++i;
    const std::size_t row = blocks_[first].first;
    add(pass, row > passes_[pass].first ? row - 1 : row, blocks_[i].end, out);
  }
  return out;
}

std::size_t CutterPath::positions_near(const Box& box) const {
  std::size_t count = 0;
  for (const Block& block : blocks_) {
    if (block.box.intersects(box.cast<float>())) count += block.end - block.first + 1;
  }
  return count;
}

}  // namespace servomill::sim::evaluation
