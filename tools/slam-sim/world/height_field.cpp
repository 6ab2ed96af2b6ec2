#include "tools/slam-sim/world/height_field.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::sim {
namespace {

constexpr int kBlock = 16;

/// Calls visit(ix, iy, enter, leave) for the cells of a grid along the ray from t0 to t1; stops when visit returns
/// true. Source: Amanatides and Woo 1987.
template <class Visit>
bool walk_grid(const Ray& ray, const Eigen::Vector2d& low, double cell, double t0, double t1, const Visit& visit) {
  int index[2], step[2];
  double next[2], delta[2];
  for (int i = 0; i < 2; ++i) {
    const double at = (ray.origin[i] + ray.direction[i] * (t0 + 1e-9) - low[i]) / cell;
    index[i] = static_cast<int>(std::floor(at));
    step[i] = ray.direction[i] >= 0.0 ? 1 : -1;
    delta[i] = cell * std::abs(ray.inverse[i]);
    const double border = low[i] + cell * (index[i] + (step[i] > 0 ? 1 : 0));
    next[i] = ray.direction[i] == 0.0 ? 1e300 : (border - ray.origin[i]) * ray.inverse[i];
  }
  for (double t = t0; t < t1;) {
    const int axis = next[0] < next[1] ? 0 : 1;
    const double leave = std::min(next[axis], t1);
    if (visit(index[0], index[1], t, leave)) return true;
    t = leave;
    next[axis] += delta[axis];
    index[axis] += step[axis];
  }
  return false;
}

}  // namespace

HeightField::HeightField(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double cell_m, const HeightAt& height)
    : low_{low}, cell_m_{cell_m} {
  const auto blocks = [&](double extent) { return static_cast<int>(std::ceil(extent / (cell_m * kBlock))); };
  block_nx_ = blocks(high.x() - low.x());
  block_ny_ = blocks(high.y() - low.y());
  nx_ = block_nx_ * kBlock;
  ny_ = block_ny_ * kBlock;
  heights_.reserve(static_cast<std::size_t>((nx_ + 1) * (ny_ + 1)));
  for (int iy = 0; iy <= ny_; ++iy) {
    for (int ix = 0; ix <= nx_; ++ix) heights_.push_back(height(low.x() + ix * cell_m, low.y() + iy * cell_m));
  }
  materials_.assign(static_cast<std::size_t>(nx_ * ny_), materials::kGrass);
  find_block_tops();
}

void HeightField::find_block_tops() {
  for (int by = 0; by < block_ny_; ++by) {
    for (int bx = 0; bx < block_nx_; ++bx) {
      double top = -1e300;
      for (int iy = by * kBlock; iy <= (by + 1) * kBlock; ++iy) {
        for (int ix = bx * kBlock; ix <= (bx + 1) * kBlock; ++ix) top = std::max(top, node(ix, iy));
      }
      block_top_.push_back(top);
    }
  }
}

double HeightField::height(double x, double y) const {
  const double gx = std::clamp((x - low_.x()) / cell_m_, 0.0, nx_ - 1e-9);
  const double gy = std::clamp((y - low_.y()) / cell_m_, 0.0, ny_ - 1e-9);
  const int ix = static_cast<int>(gx);
  const int iy = static_cast<int>(gy);
  const double u = gx - ix;
  const double v = gy - iy;
  if (u + v <= 1.0) return node(ix, iy) + u * (node(ix + 1, iy) - node(ix, iy)) + v * (node(ix, iy + 1) - node(ix, iy));
  const double corner = node(ix + 1, iy + 1);
  return corner + (1.0 - u) * (node(ix, iy + 1) - corner) + (1.0 - v) * (node(ix + 1, iy) - corner);
}

void HeightField::paint(Material material, const std::function<bool(double x, double y)>& inside) {
  for (int iy = 0; iy < ny_; ++iy) {
    for (int ix = 0; ix < nx_; ++ix) {
      if (inside(low_.x() + (ix + 0.5) * cell_m_, low_.y() + (iy + 0.5) * cell_m_)) {
        materials_[static_cast<std::size_t>(iy * nx_ + ix)] = material;
      }
    }
  }
}

bool HeightField::cast_cell(const Ray& ray, Cell cell, double enter, double leave, Hit& hit) const {
  const double h00 = node(cell.ix, cell.iy), h10 = node(cell.ix + 1, cell.iy);
  const double h01 = node(cell.ix, cell.iy + 1), h11 = node(cell.ix + 1, cell.iy + 1);
  const double low_z = ray.origin.z() + ray.direction.z() * (ray.direction.z() < 0.0 ? leave : enter);
  if (low_z > std::max({h00, h10, h01, h11})) return false;
  const double u0 = (ray.origin.x() - low_.x()) / cell_m_ - cell.ix;
  const double v0 = (ray.origin.y() - low_.y()) / cell_m_ - cell.iy;
  const double du = ray.direction.x() / cell_m_, dv = ray.direction.y() / cell_m_;
  for (const bool upper : {false, true}) {
    // Plane h = base + a u + b v of this triangle; the ray's height above it is linear in t.
    const double a = upper ? h11 - h01 : h10 - h00;
    const double b = upper ? h11 - h10 : h01 - h00;
    const double base = upper ? h11 - a - b : h00;
    const double above = ray.origin.z() - (base + a * u0 + b * v0);
    const double rate = ray.direction.z() - (a * du + b * dv);
    if (rate >= 0.0) continue;  // leaves the ground: a ray from below passes
    const double t = -above / rate;
    const double diagonal = (u0 + v0) + t * (du + dv) - 1.0;
    if (t < enter - 1e-9 || t > leave + 1e-9 || (upper ? diagonal < -1e-12 : diagonal > 1e-12)) continue;
    if (t <= 0.0 || t >= hit.range || t > ray.max_range) continue;
    hit = {t, Eigen::Vector3d(-a / cell_m_, -b / cell_m_, 1.0).normalized(),
           materials_[static_cast<std::size_t>(cell.iy * nx_ + cell.ix)]};
    return true;
  }
  return false;
}

bool HeightField::cast_block(const Ray& ray, Cell block, double enter, double leave, Hit& hit) const {
  if (block.ix < 0 || block.iy < 0 || block.ix >= block_nx_ || block.iy >= block_ny_) return false;
  const double low_z = ray.origin.z() + ray.direction.z() * (ray.direction.z() < 0.0 ? leave : enter);
  if (low_z > block_top_[static_cast<std::size_t>(block.iy * block_nx_ + block.ix)]) return false;
  return walk_grid(ray, low_, cell_m_, enter, leave, [&](int ix, int iy, double t0, double t1) {
    return ix >= 0 && iy >= 0 && ix < nx_ && iy < ny_ && cast_cell(ray, {ix, iy}, t0, t1, hit);
  });
}

void HeightField::cast(const Ray& ray, Hit& hit) const {
  const double limit = std::min(hit.range, ray.max_range);
  walk_grid(ray, low_, cell_m_ * kBlock, 0.0, limit, [&](int bx, int by, double t0, double t1) {
    return cast_block(ray, {bx, by}, t0, t1, hit);
  });
}

}  // namespace slamd::sim
