#include "estimator/graph/robust_loss.hpp"

namespace slamd {

void DcsLoss::Evaluate(double s, double rho[3]) const {
  if (s <= phi_) {
    rho[0] = s;
    rho[1] = 1.0;
    rho[2] = 0.0;
    return;
  }
  const double sum = phi_ + s;
  rho[0] = (3.0 * phi_ * s - phi_ * phi_) / sum;
  rho[1] = 4.0 * phi_ * phi_ / (sum * sum);
  rho[2] = -2.0 * rho[1] / sum;
}

void WeightLoss::Evaluate(double s, double rho[3]) const {
  rho[0] = *weight_ * s;
  rho[1] = *weight_;
  rho[2] = 0.0;
}

}  // namespace slamd
