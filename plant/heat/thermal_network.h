/// Heat in a machine: lumped bodies that store it, conduct it to each other and to their
/// surroundings.
///
///     C_i dT_i/dt = P_i(t) + sum over j of G_ij (T_j - T_i) + sum over k of G_ik (T_k(t) - T_i)
///
/// i, j bodies, k surroundings (room, coolant), whose temperatures are given.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace servomill::plant {

struct ThermalBody {
  std::string name;
  double capacity = 1.0;  // C, J/K
};

/// Heat flows from the warmer to the colder end.
struct ThermalLink {
  int from = 0, to = 0;      // bodies; `to` of a link to surroundings is one of those
  double conductance = 0.0;  // G, W/K
};

/// Temperature that the machine does not change: T(t) = mean + amplitude cos(2 pi (t - t_max)/T_p).
struct Surroundings {
  std::string name;
  double mean = 293.15;     // K
  double amplitude = 0.0;   // K
  double period = 86400.0;  // s
  double warmest_at = 0.0;  // t_max, s

  double temperature(double t) const;  ///< K at t (s)
};

struct ThermalParams {
  std::vector<ThermalBody> bodies;
  std::vector<Surroundings> surroundings;
  std::vector<ThermalLink> links;          // between bodies
  std::vector<ThermalLink> surface_links;  // from bodies to surroundings
};

/// Rules of physics that the network breaks, each as "NAME RULE": capacities above 0, conductances
/// not below 0 (passive), every body connected with surroundings, directly or through others.
std::vector<std::string> implausible(const ThermalParams& params);

/// The network and its temperatures. Steps are exact for powers that are constant and temperatures
/// of surroundings that are linear within each: decay along the eigenvectors of
/// C^-1/2 G C^-1/2, which is symmetric.
class ThermalNetwork {
 public:
  /// @pre implausible(params) is empty
  explicit ThermalNetwork(ThermalParams params);

  const ThermalParams& params() const { return params_; }

  /// Temperature of each body (K).
  const Eigen::VectorXd& temperatures() const { return T_; }
  /// @param T  of each body (K)
  void start(const Eigen::VectorXd& T) { T_ = T; }
  /// Temperatures (K) at time t (s) long after powers (W) have been constant: the mean rise and the
  /// oscillation with the surroundings.
  Eigen::VectorXd settled(const Eigen::VectorXd& power, double t) const;

  /// From time t to t + h (s), h > 0. Does not allocate.
  /// @param power  W, mean of each body over the step
  void advance(double t, double h, const Eigen::VectorXd& power);

  /// Heat stored above 0 K (J): sum of C T.
  double stored() const { return C_.dot(T_); }
  /// Heat flow from the surroundings into the bodies (W) at time t (s).
  double inflow(double t) const;

  /// Slowest time constant (s).
  double slowest() const { return 1.0 / decay_.minCoeff(); }

 private:
  void set_surroundings(double t, Eigen::VectorXd& out) const;

  ThermalParams params_;
  Eigen::VectorXd T_, C_;
  Eigen::MatrixXd surface_;        // G to each of the surroundings, W/K
  Eigen::VectorXd decay_;          // 1/s, of each eigenvector
  Eigen::MatrixXd to_modes_;       // eigenvectors^T C^1/2
  Eigen::MatrixXd from_modes_;     // C^-1/2 eigenvectors
  Eigen::MatrixXd heat_to_modes_;  // eigenvectors^T C^-1/2
  Eigen::VectorXd modes_, heat_, change_, outside_, outside_after_;  // within a step
};

}  // namespace servomill::plant
