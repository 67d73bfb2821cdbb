/// The programmed path: what every case of a scenario is compared along.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "controllers/path/tool_centre_point.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/move_curve.h"
#include "plant/vocabulary/move_list.h"
#include "plant/vocabulary/stored_values.h"

namespace servomill::sim::engine {

/// The motion of the original program in machine coordinates, by arc length s (m). Where the
/// program controls the tip, that is the tip in the workpiece, and s the length of its way. A
/// straight block takes 48 bytes, 72 where rotary axes move; those of a long program are on the
/// disk.
class ProgramPath {
 public:
  /// @param moves  canonical moves with s_begin, s_end
  /// @param start  where the machine stands before the first (6; m, rad)
  /// @param machine, tips  for moves under tool control: the ideal machine, and p_ST (3; m) by
  /// number
  ///               of tool offset
  /// @param most_in_memory  bytes of blocks, and of positions of the rotary axes
  /// @throws SystemError if the disk is full
  ProgramPath(const MoveRange& moves, const AxisWords& start,
              std::shared_ptr<const controllers::ToolCentrePoint> machine = nullptr,
              const std::map<int, Eigen::Vector3d>& tips = {},
              std::size_t most_in_memory = MoveList::kMaxInMemory);

  struct Piece {
    MoveCurve curve;
    AxisWords end = AxisWords::Zero();
    double s_begin = 0.0, s_end = 0.0;  // m
    int line = 0;
    int tool_offset = 0;
    int tool = 0;  // in the spindle; before the first change that of the tool offset
    bool rapid = false;
    int section = 0;                                 // index into sections()
    bool is_tip = false;                             // X Y Z are those of the tip in the workpiece
    Eigen::Vector3d p_ST = Eigen::Vector3d::Zero();  // m, then
    AxisWords begin = AxisWords::Zero();
    // the tool axis turns on a great circle from k_begin to k_end
    bool is_great_circle = false;
    Eigen::Vector3d k_begin = Eigen::Vector3d::UnitZ(), k_end = Eigen::Vector3d::UnitZ();
  };

  using Indices = std::vector<std::uint32_t>;  // of pieces

  /// Index of the piece that each of these moves belongs to.
  /// @param moves  those of the program, or what a strategy made of them: lines and arc lengths
  ///               carried over, in order. What moves nothing belongs to the piece before
  Indices pieces_of(const MoveRange& moves) const;

  Piece piece(std::size_t index) const;
  int line(std::size_t index) const { return pieces_[index].line; }
  double s_end(std::size_t index) const { return pieces_[index].s_end; }  // m
  int tool_offset(std::size_t index) const { return setting_of(pieces_[index]).tool_offset; }
  bool is_rapid(std::size_t index) const { return setting_of(pieces_[index]).rapid; }
  int section(std::size_t index) const { return setting_of(pieces_[index]).section; }
  bool is_tip(std::size_t index) const { return setting_of(pieces_[index]).is_tip; }
  /// True of a piece in which s stands.
  bool stands(std::size_t index) const { return pieces_[index].s_end == s_begin_of(index); }
  std::size_t size() const { return pieces_.size(); }

  /// Programmed position at arc length s within that piece (6; m, rad).
  AxisWords at(std::size_t index, double s) const;

  /// Joints of the ideal machine at the programmed place (5; m, rad): rotary axes as programmed,
  /// or such that the tool axis is as programmed.
  /// @param Q_near  joints at that time (5; m, rad). Where s stands while rotary axes turn, the
  ///                place is the one of the programmed turn that is nearest to them
  Joints joints(std::size_t index, double s, const JointLayout& layout, const Joints& Q_near) const;

  double length() const { return pieces_.empty() ? 0.0 : pieces_.back().s_end; }

  /// Distance (m) of the point p (3; m, in the coordinates of the piece) to the path near the given
  /// piece, as far as it has such coordinates.
  double distance(const Eigen::Vector3d& p, std::size_t index) const;

  /// Names of the program's sections: a comment (MSG, name) begins one; the first is "".
  const std::vector<std::string>& sections() const { return sections_; }
  /// Indices of the pieces before which a comment begins a section, anew or again; rising.
  const std::vector<std::size_t>& section_begins() const { return section_begins_; }

 private:
  // Blocks that follow each other mostly have these in common.
  struct Setting {
    int tool_offset = 0, tool = 0;
    bool rapid = false, is_tip = false;
    int section = 0;
    Eigen::Vector3d p_ST = Eigen::Vector3d::Zero();
    bool operator==(const Setting&) const = default;
  };
  // All that a piece is if it does not go straight on from the end of the piece before.
  struct Curved {
    MoveCurve curve;
    AxisWords begin = AxisWords::Zero();
    double s_begin = 0.0;  // m
    bool is_great_circle = false;
    Eigen::Vector3d k_begin = Eigen::Vector3d::UnitZ(), k_end = Eigen::Vector3d::UnitZ();
    Eigen::Vector3d middle = curve.at(0.5).head<3>();  // of a ball that holds the curve
    double reach = kReach * curve.length();            // m, its radius
  };
  static constexpr double kReach = 0.6;  // half, and more than the halves of a spiral differ by
  static constexpr std::uint32_t kStraight = 0xffffffff;
  struct Held {           // a piece
    Eigen::Vector3d end;  // X Y Z
    double s_end = 0.0;   // m
    int line = 0;
    std::uint32_t rotary_end = 0;      // index into rotary_ends_
    std::uint32_t setting = 0;         // index into settings_
    std::uint32_t curved = kStraight;  // index into curved_
  };

  void hold(const Piece& piece, const Move* move);
  void release_behind() const;
  std::uint32_t index_of(const Setting& setting);
  std::uint32_t index_of_rotary(const Eigen::Vector3d& end);
  AxisWords end_of(const Held& held) const;
  double s_begin_of(std::size_t index) const;
  const Setting& setting_of(const Held& held) const { return settings_[held.setting]; }
  MoveCurve curve_of(std::size_t index) const;
  double distance(const Eigen::Vector3d& p, std::size_t index, double least, double& length) const;
  AxisWords begin_of(const Piece& piece, const Piece* before, AxisWords at) const;
  void set_tool_axes(Piece& piece, const Move& move) const;
  double fraction(const Piece& piece, double s, const JointLayout& layout,
                  const Joints& Q_near) const;

  std::shared_ptr<const controllers::ToolCentrePoint> machine_;
  StoredValues<Held> pieces_;
  StoredValues<Eigen::Vector3d> rotary_ends_;  // A B C; blocks in a row mostly have the same
  std::vector<Setting> settings_;
  std::vector<Curved> curved_;
  std::vector<std::string> sections_ = {""};
  std::vector<std::size_t> section_begins_;
};

}  // namespace servomill::sim::engine
