/// Common part of all fuzz targets. A target is a function of bytes that must neither crash
/// nor hang nor break one of the laws that it checks; whatever is wrong with the bytes ends as an
/// `InputError` with a place inside them.
///
/// A target is built twice: with clang and libFuzzer, which looks for such bytes (`tools/fuzz`),
/// and as an ordinary test that runs the bytes known so far (replay.cpp): its seeds and everything
/// that was ever found, in tests/fuzz/corpus.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "plant/vocabulary/input_error.h"

namespace servomill::fuzz {

/// Longest input; what comes behind it is left out, as libFuzzer does.
inline constexpr std::size_t kMaxBytes = 65536;

/// Law of all targets: no input takes more time of the processor than this.
inline constexpr int kMaxSeconds = 1;
/// Instrumented programs, with both sanitizers and hardly optimised, take so many times longer.
inline constexpr int kInstrumentedFactor = 60;

/// A target: each of fuzz_*.cpp defines it.
void run(std::string_view input);

/// run() within the time allowed; what takes longer is aborted.
void run_in_time(std::string_view input);

/// Prints the law and the details and aborts if the law does not hold.
void require(bool holds, std::string_view law, std::string_view details = {});

/// Law: every fault has a message and names the file; line and column, where it has them, are in
/// the text. (What is missing in a file has neither.)
/// @param file  name of the text
void require_places(std::span<const Fault> faults, std::string_view text, std::string_view file);

}  // namespace servomill::fuzz
