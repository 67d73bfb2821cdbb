/// Moves that follow each other without a stop, collected until they are planned.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "controllers/path/chain_speeds.h"
#include "controllers/path/polyline.h"
#include "controllers/path/trajectory.h"

namespace servomill::controllers {

/// Their vertices, programmed speeds and shares of moves.
struct CollectedMotion {
  Polyline vertices;
  ChainSpeeds speeds;
  std::vector<Trajectory::Chain::Share> shares;  // beside speeds.times

  /// Nothing but the place where it begins (5; m, scaled).
  void start_at(const Joints& u);

  std::uint32_t last_vertex() const { return static_cast<std::uint32_t>(vertices.size() - 1); }
  const Joints& last_u() const { return vertices.u(vertices.size() - 1); }

  /// A span of a move from the last vertex on.
  /// @param index  of the move
  ChainSpeeds::Span begin_span(const Move& move, std::size_t index) const;
  /// Ends a span of a part of its move at the last vertex.
  /// @param time  s, least; 0: none is given
  void end_part(ChainSpeeds::Span span, double from, double to, double time);

  /// Leads a move on to an end just behind the last vertex.
  /// @param last  span of the move if there is none yet
  void end_at(const PathVertex& end, ChainSpeeds::Span last);

  /// The chord of the second half in whose middle the path is divided at the least cost: the
  /// longest whose neighbours turn the least. None where splines leave no chord.
  std::optional<std::size_t> seam() const;

  /// Divides it in the middle of a chord, where both parts are straight: returns what lies before.
  CollectedMotion take_before(std::size_t chord);
};

}  // namespace servomill::controllers
