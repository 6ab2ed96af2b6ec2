#pragma once
// Losses of squared, whitened errors. Which errors get one is the graph's choice.

#include <ceres/loss_function.h>

namespace slamd {

/// Dynamic covariance scaling: chi2 up to phi counts fully, beyond it the weight falls with 1 / chi2^2 and the cost ends at
/// 3 phi, so that a wrong measurement has no pull in the end. As a loss: rho = s below phi, (3 phi s - phi^2) / (phi + s)
/// above. Source: Agarwal et al. 2013, eq. (15), integrated.
class DcsLoss final : public ceres::LossFunction {
 public:
  explicit DcsLoss(double phi) : phi_{phi} {}
  /// Between two solves only.
  void set_phi(double phi) { phi_ = phi; }
  void Evaluate(double s, double rho[3]) const override;

  /// The weight of a squared error: rho'(s), 0..1.
  double weight(double s) const {
    double rho[3];
    Evaluate(s, rho);
    return rho[1];
  }

 private:
  double phi_;
};

/// A weight that lives elsewhere and may change between solves (graduated non-convexity). *weight >= 0, must outlive it.
class WeightLoss final : public ceres::LossFunction {
 public:
  explicit WeightLoss(const double* weight) : weight_{weight} {}
  void Evaluate(double s, double rho[3]) const override;

 private:
  const double* weight_;
};

}  // namespace slamd
