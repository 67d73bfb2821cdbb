/// Estimates of the time, memory and file size of a run, made before it begins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/system/memory_limit.h"

namespace servomill::sim::model {
struct Scenario;
}  // namespace servomill::sim::model

namespace servomill::sim::preparation {

class PreparedCase;

/// Estimate for all cases together.
struct RunEstimate {
  double motion = 0.0;      // s, simulated
  double rows = 0.0;        // at the record period
  double size = 0.0;        // bytes of their signals
  bool is_thinned = false;  // so many are too many: rows are left out (records/row_thinning.h)
  double file = 0.0;        // bytes of the result file: about, or at most if it is thinned
  double memory = 0.0;      // bytes, about: what is held now, a plan included, and what comes
  double temporary = 0.0;   // bytes of temporary files (TMPDIR): moves and plans of long programs
  double computing = 0.0;   // s, on so many threads; by the speed of one core of a desktop computer
  int trial_runs = 0;       // part of that: of the program, from which strategies have yet to learn
  double lockstep = 0.0;    // s, part of computing that runs of several points do together
  int lanes = 0;            // runs that have it: cases under the cascade
};

/// @param motions  of the cases, s
/// @param threads  that share the cases; 0: one a core
/// @param recorded  what is recorded of each motion, s; empty: all
RunEstimate estimate(const model::Scenario& scenario, std::span<const double> motions,
                     unsigned threads, std::span<const double> recorded = {});
RunEstimate estimate(const model::Scenario& scenario, std::span<const PreparedCase> cases,
                     unsigned threads);

/// Estimate for points of a sweep that are like one: on each thread up to eight runs, of cases and
/// points, advance in lockstep (sim/README.md) in the time of one.
/// @param of_point  of one point, on one thread
RunEstimate estimate_of_points(RunEstimate of_point, std::uint64_t points, unsigned threads);

/// "373 s of motion, 3.7e+05 rows, 0.2 GB of signals in a file of 0.04 GB, 0.1 GB of memory, about
/// 4 s of computing"
std::string to_string(const RunEstimate& estimate);

/// Says that rows are left out, what the file takes then, and how to have every row.
/// @pre is_thinned
std::string thinning_message(const RunEstimate& estimate);

/// Sections of which every row is kept: those that quantities of circles and balls look at.
/// @param sections  names of all of the program
std::vector<bool> sections_kept_whole(const model::Scenario& scenario,
                                      const std::vector<std::string>& sections);

/// True above a minute or a gigabyte, so that the user should know before the work begins.
bool is_worth_telling(const RunEstimate& estimate);

/// @param memory  bytes that this process may use
/// @throws InputError if the signals are larger than the scenario allows, or if the run takes more
///     than four fifths of the memory
void refuse_too_large(const model::Scenario& scenario, const RunEstimate& estimate,
                      double memory = system::memory_of_process());

/// How often the recordings of a run are on the disk at the same time: what was recorded goes to
/// the result file when a case ends, and stays until all are compared.
inline constexpr double kCopiesOfRun = 2.0;

/// @param folder     of the result file, and of recordings until they are compared
/// @param copies     of the recordings
/// @param available  bytes that are free there; none: the system says how many
/// @throws InputError if there is not so much room
void refuse_full_disk(const model::Scenario& scenario, const RunEstimate& estimate,
                      const std::string& folder, double copies = kCopiesOfRun,
                      std::optional<double> available = {});

/// To be called before a motion is planned, whose moves are on the disk by then.
/// @param moves      of the motion
/// @param available  bytes that are free in the folder of temporary files; none: the system says
/// @throws InputError if there is not so much room for the planned motion
void refuse_full_temporary_folder(const model::Scenario& scenario, std::size_t moves,
                                  std::optional<double> available = {});

/// To be called before a program is rewritten.
/// @param moves  of the original; a strategy may make more of them, but not fewer
/// @throws InputError if the folder has less room than the text and its moves need
void refuse_full_temporary_folder_of_rewritten(const model::Scenario& scenario, std::size_t moves,
                                               std::optional<double> available = {});

}  // namespace servomill::sim::preparation
