#pragma once
// A plane of square cells in tiles that are made where something is written. Not a map: what a cell means is its user's.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace slamd {

/// Cell (0, 0) reaches from the origin to (cell_m, cell_m). Memory of tiles is kept by clear() and used again.
template <class Cell>
class TileGrid {
 public:
  static constexpr int kShift = 4;
  static constexpr int kSide = 1 << kShift;

  explicit TileGrid(double cell_m) : cell_m_{cell_m} {}

  double cell_m() const { return cell_m_; }
  std::size_t tiles() const { return used_; }
  bool is_empty() const { return used_ == 0; }
  Eigen::Vector2i cell_of(const Eigen::Vector2d& p) const {
    return {static_cast<int>(std::floor(p.x() / cell_m_)), static_cast<int>(std::floor(p.y() / cell_m_))};
  }
  Eigen::Vector2d centre(int x, int y) const { return {(x + 0.5) * cell_m_, (y + 0.5) * cell_m_}; }

  /// Null where nothing was ever written near by.
  const Cell* find(int x, int y) const {
    const int column = (x >> kShift) - low_.x();
    const int row = (y >> kShift) - low_.y();
    if (column < 0 || row < 0 || column >= size_.x() || row >= size_.y()) return nullptr;
    const std::int32_t tile = directory_[static_cast<std::size_t>(row * size_.x() + column)];
    return tile < 0 ? nullptr : &cells_[offset(tile, x, y)];
  }
  Cell value(int x, int y) const {
    const Cell* cell = find(x, y);
    return cell == nullptr ? Cell{} : *cell;
  }
  /// Makes the tile when there is none. A reference holds until the next call.
  Cell& at(int x, int y) {
    const Eigen::Vector2i tile{x >> kShift, y >> kShift};
    reach(tile);
    std::int32_t& slot = directory_[static_cast<std::size_t>((tile.y() - low_.y()) * size_.x() + tile.x() - low_.x())];
    if (slot < 0) slot = make_tile();
    return cells_[offset(slot, x, y)];
  }

  void clear() {
    std::ranges::fill(directory_, -1);
    used_ = 0;
  }

  /// Lowest cell of all tiles, and cells in each direction, tiles complete. Zero when empty.
  Eigen::Vector2i low() const { return low_ * kSide; }
  Eigen::Vector2i extent() const { return is_empty() ? Eigen::Vector2i{0, 0} : Eigen::Vector2i{size_ * kSide}; }

  /// f(x, y, cell) for every cell of every tile, row by row of the directory: always in the same order.
  template <class F>
  void for_each(F f) const {
    for (std::size_t i = 0; i < directory_.size(); ++i) {
      if (directory_[i] < 0) continue;
      const int x0 = (low_.x() + static_cast<int>(i) % size_.x()) * kSide;
      const int y0 = (low_.y() + static_cast<int>(i) / size_.x()) * kSide;
      for (int y = y0; y < y0 + kSide; ++y) {
        for (int x = x0; x < x0 + kSide; ++x) f(x, y, cells_[offset(directory_[i], x, y)]);
      }
    }
  }

 private:
  static constexpr int kMargin = 4;  // tiles by which the directory grows beyond what is needed

  static std::size_t offset(std::int32_t tile, int x, int y) {
    return (static_cast<std::size_t>(tile) << (2 * kShift)) +
           static_cast<std::size_t>(((y & (kSide - 1)) << kShift) + (x & (kSide - 1)));
  }
  std::int32_t make_tile() {
    const std::size_t begin = used_ << (2 * kShift);
    const std::size_t end = (used_ + 1) << (2 * kShift);
    if (cells_.size() < end) cells_.resize(end);
    std::fill(cells_.begin() + static_cast<std::ptrdiff_t>(begin), cells_.begin() + static_cast<std::ptrdiff_t>(end), Cell{});
    return static_cast<std::int32_t>(used_++);
  }
  void reach(const Eigen::Vector2i& tile) {
    const Eigen::Vector2i high = low_ + size_;
    if ((tile.array() >= low_.array()).all() && (tile.array() < high.array()).all()) return;
    const Eigen::Vector2i margin = Eigen::Vector2i::Constant(kMargin);
    const bool first = directory_.empty();
    const Eigen::Vector2i new_low = first ? Eigen::Vector2i{tile - margin} : Eigen::Vector2i{low_.cwiseMin(tile - margin)};
    const Eigen::Vector2i new_high =
        first ? Eigen::Vector2i{tile + margin} : Eigen::Vector2i{high.cwiseMax(tile + margin + Eigen::Vector2i::Ones())};
    const Eigen::Vector2i new_size = new_high - new_low;
    std::vector<std::int32_t> directory(static_cast<std::size_t>(new_size.x()) * static_cast<std::size_t>(new_size.y()), -1);
    for (int y = 0; y < size_.y(); ++y) {
      for (int x = 0; x < size_.x(); ++x) {
        const int column = x + low_.x() - new_low.x();
        const int row = y + low_.y() - new_low.y();
        directory[static_cast<std::size_t>(row * new_size.x() + column)] =
            directory_[static_cast<std::size_t>(y * size_.x() + x)];
      }
    }
    directory_ = std::move(directory);
    low_ = new_low;
    size_ = new_size;
  }

  double cell_m_;
  Eigen::Vector2i low_ = Eigen::Vector2i::Zero();   // of the directory, in tiles
  Eigen::Vector2i size_ = Eigen::Vector2i::Zero();
  std::vector<std::int32_t> directory_;             // row by row; -1: no tile
  std::vector<Cell> cells_;                         // tile by tile
  std::size_t used_ = 0;
};

}  // namespace slamd
