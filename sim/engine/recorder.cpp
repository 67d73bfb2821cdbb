#include "sim/engine/recorder.h"

#include <utility>

#include "sim/engine/recorded_signals.h"
#include "sim/model/machine.h"

namespace servomill::sim::engine {
namespace {

constexpr std::size_t kBlockRows = 1024;
constexpr std::size_t kFewRows = 64;  // of a block that is turned into rows at once: in the cache

}  // namespace

Recorder::Recorder(const model::MachineSettings& machine,
                   const plant::VolumetricModel& machine_errors,
                   const plant::VolumetricModel* imposed, const ProgramPath& path,
                   const std::map<int, Eigen::Vector3d>& tips, const model::RecordFormat& format,
                   bool rotary_displaced, std::vector<const strategies::Strategy*> correcting,
                   bool cuts, records::RowKeeping keeping, bool teeth, bool oriented,
                   RecordingWindows windows, const RunOutputs& outputs)
    : rows_(machine, machine_errors, imposed, path, tips, format, rotary_displaced,
            std::move(correcting), cuts, std::move(keeping), teeth, oriented, windows.limited(),
            outputs),
      path_(path),
      windows_(std::move(windows)),
      wants_axes_(wants_axis_signals(outputs)),
      makes_rows_beside_(outputs.makes_rows_beside) {
  filling_.snapshots.reserve(block_rows());
  filling_.directions.reserve(block_rows() * machine_errors.plays().size());
}

Recorder::~Recorder() = default;

void Recorder::expect(std::size_t rows) { rows_.expect(rows); }

void Recorder::record(const Snapshot& now, std::span<const double> directions) {
  if (!windows_.limited()) return add(now, directions);
  const bool inside = windows_.contains(now.piece, now.time);
  if (!inside) count_outside(now.piece);
  if (inside || was_inside_) {  // or it is the first row, or the one after a window
    if (!held_.snapshots.empty()) add_held();
    add(now, directions, inside);
  } else {
    has_gap_ |= !held_.snapshots.empty();
    held_.snapshots.assign(1, now);
    held_.directions.assign(directions.begin(), directions.end());
    held_.machine_errors = filling_.machine_errors;
    held_.temperatures = filling_.temperatures;
  }
  was_inside_ = inside;
}

void Recorder::count_outside(std::size_t piece) {
  left_out_.resize(path_.sections().size());
  if (!path_.is_rapid(piece)) ++left_out_[static_cast<std::size_t>(path_.section(piece))];
}

// Adds the row that is held, with the errors of the machine at its time.
void Recorder::add_held() {
  auto errors_now = filling_.machine_errors;
  auto temperatures_now = filling_.temperatures;
  const bool differs = held_.machine_errors != errors_now;
  if (differs) use(held_.machine_errors, held_.temperatures);
  add(held_.snapshots.front(), held_.directions, false);
  held_.snapshots.clear();
  if (differs) use(std::move(errors_now), std::move(temperatures_now));
}

void Recorder::add(const Snapshot& now, std::span<const double> directions, bool inside) {
  if (has_gap_) window_ += 1.0;
  has_gap_ = false;
  filling_.snapshots.push_back(now);
  filling_.snapshots.back().window = window_;
  filling_.snapshots.back().in_window = inside ? 1.0 : 0.0;
  filling_.directions.insert(filling_.directions.end(), directions.begin(), directions.end());
  if (filling_.snapshots.size() == block_rows()) hand_over();
}

void Recorder::use(std::shared_ptr<const plant::VolumetricModel> machine_errors,
                   std::vector<double> temperatures) {
  if (!filling_.snapshots.empty()) hand_over();
  filling_.machine_errors = std::move(machine_errors);
  filling_.temperatures = std::move(temperatures);
}

std::size_t Recorder::block_rows() const { return makes_rows_beside_ ? kBlockRows : kFewRows; }

void Recorder::hand_over() {
  if (!makes_rows_beside_) {
    make_rows(filling_);
    filling_.snapshots.clear();
    filling_.directions.clear();
    return;
  }
  background_.wait();
  std::swap(filling_, working_);
  filling_.machine_errors = working_.machine_errors;
  filling_.temperatures = working_.temperatures;
  filling_.snapshots.reserve(kBlockRows);
  filling_.snapshots.clear();
  filling_.directions.reserve(working_.directions.size());
  filling_.directions.clear();
  background_.post([this] { make_rows(working_); });
}

void Recorder::make_rows(const Block& block) {
  if (block.machine_errors) rows_.use(*block.machine_errors, block.temperatures);
  rows_.add(block.snapshots, block.directions);
}

records::Series Recorder::take() {
  if (!held_.snapshots.empty()) add_held();
  background_.wait();
  make_rows(filling_);
  filling_ = {};
  return rows_.take();
}

}  // namespace servomill::sim::engine
