/// Samples of the unit cube for the designs of a sweep, each computed from its number alone.
#pragma once

#include <cstdint>
#include <vector>

namespace servomill::sim::model {

enum class Sampling : std::uint8_t {
  random,           // independent, from the uniform distribution
  latin_hypercube,  // in each dimension one sample in each of `count` equal intervals
  sobol,            // the sequence of Sobol with the direction numbers of Joe and Kuo, 2008
};

/// `count` samples; another seed gives other ones.
struct SampleSettings {
  Sampling sampling = Sampling::random;
  std::uint64_t count = 0;
  std::uint64_t seed = 1;
  bool operator==(const SampleSettings&) const = default;
};

/// Most dimensions: what the tables of Boost's Sobol sequence reach.
inline constexpr std::size_t kMaxDimensions = 3667;

/// Sample `index` of `settings.count`, a number in (0, 1) for each dimension.
///
/// (1) Equal arguments give equal numbers, whatever was asked before.
/// (2) latin_hypercube: floor(count * x) takes each value 0 ... count-1 once in each dimension.
/// (3) sobol: of the first 2^k samples one lies in each interval [j, j+1) / 2^k of each dimension.
///     The seed turns over digits of all samples alike (a digital shift), which keeps (3) and
///     spares the first one the corner.
/// (4) latin_hypercube, random: the dimensions are independent of each other and of how many
///     there are.
/// @pre index < settings.count, 0 < dimensions <= kMaxDimensions
/// Source of (2): McKay, Beckman, Conover, "A comparison of three methods for selecting values of
/// input variables", Technometrics 21 (1979); the permutations are Feistel networks (Luby, Rackoff,
/// 1988) that walk until they are within the count, so that none is kept in memory.
std::vector<double> unit_sample(const SampleSettings& settings, std::uint64_t index,
                                std::size_t dimensions);

/// Permutation number `key` of 0 ... count-1, at `index`.
/// @pre index < count
std::uint64_t permuted(std::uint64_t index, std::uint64_t count, std::uint64_t key);

/// The value below which a standard normal variable stays with the probability u.
/// @pre 0 < u < 1
double normal_quantile(double u);

}  // namespace servomill::sim::model
