#include "sim/identification/uncertainty.h"

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "sim/identification/identifiable_part.h"

namespace servomill::sim::identification {
namespace {

// Rows of one record in the stacked residual.
struct Rows {
  Eigen::Index begin = 0, count = 0;
  Eigen::Index counting = 0;  // that the mask lets count
};

std::vector<Rows> rows_of(const Mask& mask) {
  std::vector<Rows> out;
  Eigen::Index begin = 0;
  for (const auto& record : mask) {
    const auto count = static_cast<Eigen::Index>(record.size());
    out.push_back({begin, count, std::count(record.begin(), record.end(), char{1})});
    begin += count;
  }
  return out;
}

constexpr double kTakesPart = 0.1;  // in a direction in which nothing changes

// The residual's noise, corrected for what the fit took away.
// @param U  orthonormal columns of what can be fitted, rows of this record
// @param G  U' Sigma U over all records
AutoregressiveNoise corrected(const std::vector<double>& found, const AutoregressiveNoise& guess,
                              const Eigen::MatrixXd& U, const Eigen::MatrixXd& G,
                              std::size_t samples) {
  const std::size_t lags = found.size() - 1;
  const std::vector<double> once = cross_sums(U, coloured(guess, U), lags);
  const std::vector<double> twice = cross_sums(U, U * G, lags);
  std::vector<double> c(found.size());
  // Residual = (I - U U') noise: its autocovariances lack the terms U U' Sigma and Sigma U U'
  // (once, both ways) and have U U' Sigma U U' (twice) too much.
  const double n = static_cast<double>(samples);
  for (std::size_t lag = 0; lag <= lags; ++lag) {
    // cross_sums adds both ways, of which `twice` needs one
    c[lag] = found[lag] + (once[lag] - 0.5 * twice[lag]) / n;
  }
  return autoregressive(c, samples);
}

struct Coloured {
  std::vector<AutoregressiveNoise> noise;
  Eigen::MatrixXd G;  // U' Sigma U
};

Coloured colour_of(const Eigen::VectorXd& residual, const std::vector<Rows>& rows,
                   const Eigen::MatrixXd& U) {
  // The fit takes part of the noise out of the residual; the correction for it changes the
  // estimated spectrum, and with it the correction.
  constexpr int kRounds = 3;
  Coloured out;
  std::vector<std::vector<double>> found;
  for (const Rows& r : rows) {
    const auto n = static_cast<std::size_t>(r.counting);
    std::vector<double> c = autocovariance(residual.segment(r.begin, r.count), most_lags(n));
    const double share =
        static_cast<double>(r.count) / static_cast<double>(std::max<Eigen::Index>(r.counting, 1));
    // Samples that the mask leaves out are zeros: the sums are divided by those that count.
    for (double& one : c) one *= share;
    out.noise.push_back(autoregressive(c, n));
    found.push_back(std::move(c));
  }
  const auto update = [&] {
    out.G = Eigen::MatrixXd::Zero(U.cols(), U.cols());
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const Eigen::MatrixXd own = U.middleRows(rows[k].begin, rows[k].count);
      out.G += own.transpose() * coloured(out.noise[k], own);
    }
  };
  update();
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t k = 0; k < rows.size(); ++k) {
      out.noise[k] = corrected(found[k], out.noise[k], U.middleRows(rows[k].begin, rows[k].count),
                               out.G, static_cast<std::size_t>(rows[k].counting));
    }
    update();
  }
  return out;
}

// Parameters that take part in a direction in which nothing changes are not identifiable.
void name_directions(const IdentifiablePart& part, Eigen::Index size, Uncertainty& out) {
  for (const std::size_t p : part.parameters) out.identifiable[p] = true;
  for (Eigen::Index k = 0; k < part.nothing.cols(); ++k) {
    UnidentifiableDirection one{{}, Eigen::VectorXd::Zero(size)};
    for (Eigen::Index j = 0; j < part.nothing.rows(); ++j) {
      const std::size_t p = part.parameters[static_cast<std::size_t>(j)];
      if (std::abs(part.nothing(j, k)) < kTakesPart) continue;
      one.parameters.push_back(p);
      one.direction[static_cast<Eigen::Index>(p)] = part.nothing(j, k) / part.norm[j];
      out.identifiable[p] = false;
    }
    out.unidentifiable.push_back(std::move(one));
  }
}

}  // namespace

double student_95(double degrees_of_freedom) {
  const boost::math::students_t distribution(std::max(degrees_of_freedom, 1.0));
  return boost::math::quantile(distribution, 0.975);
}

double Uncertainty::standard(std::size_t parameter) const {
  const auto p = static_cast<Eigen::Index>(parameter);
  return std::sqrt(std::max(covariance(p, p), 0.0));
}

Uncertainty uncertainty_of(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual,
                           const Mask& mask) {
  const Eigen::Index size = jacobian.cols();
  Uncertainty out;
  out.covariance = Eigen::MatrixXd::Zero(size, size);
  out.counted.assign(static_cast<std::size_t>(size), 0.0);
  out.identifiable.assign(static_cast<std::size_t>(size), false);
  const IdentifiablePart part = identifiable_part(jacobian);
  if (part.parameters.empty()) return out;
  name_directions(part, size, out);
  const std::vector<Rows> rows = rows_of(mask);
  Coloured colour = colour_of(residual, rows, part.U);
  // (J'J)^-1 J' Sigma J (J'J)^-1 with J = U S V': only the small matrix U' Sigma U is ever formed.
  const Eigen::MatrixXd C = part.back * colour.G * part.back.transpose();
  double samples = 0.0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto n = static_cast<std::size_t>(rows[k].counting);
    samples += static_cast<double>(n);
    out.effective_samples += colour.noise[k].effective_samples(n);
  }
  const auto rank = static_cast<double>(part.U.cols());
  const double white = residual.squaredNorm() / std::max(samples - rank, 1.0);
  const Eigen::MatrixXd counted = white * part.back * part.back.transpose();
  for (std::size_t a = 0; a < part.parameters.size(); ++a) {
    const std::size_t p = part.parameters[a];
    if (!out.identifiable[p]) continue;
    const auto ia = static_cast<Eigen::Index>(a);
    out.counted[p] = std::sqrt(counted(ia, ia));
    for (std::size_t b = 0; b < part.parameters.size(); ++b) {
      const std::size_t q = part.parameters[b];
      if (!out.identifiable[q]) continue;
      out.covariance(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(q)) =
          C(ia, static_cast<Eigen::Index>(b));
    }
  }
  out.noise = std::move(colour.noise);
  // The noise itself is estimated, from as many independent samples as its colour leaves.
  out.t_95 = student_95(out.effective_samples - rank);
  return out;
}

}  // namespace servomill::sim::identification
