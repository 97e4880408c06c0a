// SPDX-License-Identifier: Apache-2.0
#include "math/block_inverse.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "core/index.h"
#include "math/block_lanes.h"

namespace slew::math {
namespace {

using Bits = std::int64_t __attribute__((vector_size(32)));

Lanes both(const Lanes& x, const Bits& mask) noexcept {
  return std::bit_cast<Lanes>(std::bit_cast<Bits>(x) & mask);
}

double largest_of(const Lanes& x) noexcept {
  return std::max(std::max(x[0], x[1]), std::max(x[2], x[3]));
}

// 2^-(e/2) for 2^(e-1) <= x < 2^e; 1 for zero and values that are not finite
double inverse_root(double x) noexcept {
  if (!(x > 0) || !std::isfinite(x)) return 1;
  if (x < std::numeric_limits<double>::min()) return std::ldexp(1.0, -std::ilogb(x) / 2);
  constexpr int kMantissa = 52, kBias = 1023;
  const int exponent = static_cast<int>(std::bit_cast<std::uint64_t>(x) >> kMantissa) - kBias + 1;
  return std::bit_cast<double>(static_cast<std::uint64_t>(kBias - exponent / 2) << kMantissa);
}

// A block of rows of N lanes.
template <std::size_t N>
class Scratch {
 public:
  Scratch(const double* block, int size) noexcept : size_(size) { std::copy_n(block, size * kStride, a_.begin()); }

  [[nodiscard]] double operator()(int r, int c) const noexcept { return a_[at(r * kStride + c)]; }
  [[nodiscard]] double scale(int r) const noexcept { return scale_[at(r)]; }

  // a := S a S with powers of two, so that the largest entry of every row is near one; two rounds are enough
  void equilibrate() noexcept {
    std::fill_n(scale_.begin(), size_, 1.0);
    for (int round = 0; round < 2; ++round) {
      std::array<double, at(kMaxBlock)> factor{};
      for (int r = 0; r < size_; ++r) factor[at(r)] = inverse_root(largest_in(row(r), kAll));
      for (int r = 0; r < size_; ++r) {
        scale_[at(r)] *= factor[at(r)];
        LanesRow<N> scaled = row(r);
        for (std::size_t i = 0; i < N; ++i) scaled[i] *= factor[at(r)] * load_lanes(factor.data() + i * kLanes);
        put(r, scaled);
      }
    }
  }

  // Gauss and Jordan with complete pivoting; false when a pivot is lost in rounding
  [[nodiscard]] bool invert() noexcept {
    constexpr double kLost = 1e-14;
    std::array<int, at(kMaxBlock)> pivot_row{}, pivot_column{};
    MaskRow left = kAll;
    for (int r = 0; r < size_; ++r) largest_[at(r)] = largest_in(row(r), left);
    for (int step = 0; step < size_; ++step) {
      // the first of the largest entries of the rows and columns that are left
      const int first =
          static_cast<int>(std::max_element(largest_.begin(), largest_.begin() + size_) - largest_.begin());
      const double largest = largest_[at(first)];
      if (!(largest > kLost)) return false;
      int pivot = 0;
      while (largest_[at(pivot)] < 0 || std::fabs((*this)(first, pivot)) != largest) ++pivot;
      // it moves to the diagonal
      const LanesRow<N> kept = row(first);
      put(first, row(pivot));
      put(pivot, kept);
      largest_[at(first)] = largest_[at(pivot)];
      const MaskRow others = all_but(pivot);
      for (std::size_t i = 0; i < N; ++i) left[i] &= others[i];
      eliminate(pivot, others, left);
      pivot_row[at(step)] = first;
      pivot_column[at(step)] = pivot;
    }
    for (int step = size_; step-- > 0;) {
      const int first = pivot_row[at(step)], pivot = pivot_column[at(step)];
      for (int r = 0; r < size_; ++r) std::swap(a_[at(r * kStride + first)], a_[at(r * kStride + pivot)]);
    }
    return true;
  }

 private:
  static constexpr int kStride = static_cast<int>(N) * kLanes;
  using MaskRow = std::array<Bits, N>;  // by column: all bits or none
  static constexpr MaskRow kAll = [] {
    MaskRow all{};
    for (Bits& bits : all) bits = ~bits;
    return all;
  }();

  // g++ 12 leaves these loops as they are
  [[nodiscard]] LanesRow<N> row(int r) const noexcept {
    LanesRow<N> lanes;
#pragma GCC unroll 3
    for (std::size_t i = 0; i < N; ++i) lanes[i] = load_lanes(a_.data() + at(r * kStride) + i * kLanes);
    return lanes;
  }
  void put(int r, const LanesRow<N>& lanes) noexcept {
#pragma GCC unroll 3
    for (std::size_t i = 0; i < N; ++i) store_lanes(lanes[i], a_.data() + at(r * kStride) + i * kLanes);
  }

  // magnitude in the columns of the mask
  [[nodiscard]] static double largest_in(const LanesRow<N>& row, const MaskRow& mask) noexcept {
    constexpr std::int64_t kAllButSign = std::numeric_limits<std::int64_t>::max();
    Lanes largest{};
    for (std::size_t i = 0; i < N; ++i) {
      const Lanes size = both(row[i], mask[i] & kAllButSign);
      largest = size > largest ? size : largest;
    }
    return largest_of(largest);
  }

  [[nodiscard]] static MaskRow all_but(int column) noexcept {
    MaskRow others;
    for (std::size_t i = 0; i < N; ++i) {
      const Bits columns = Bits{0, 1, 2, 3} + static_cast<std::int64_t>(i) * kLanes;
      others[i] = columns != static_cast<std::int64_t>(column);
    }
    return others;
  }

  // one column of Gauss and Jordan, the pivot on the diagonal; left: columns that have had none
  void eliminate(int pivot, const MaskRow& others, const MaskRow& left) noexcept {
    const double inverse = 1 / (*this)(pivot, pivot);
    LanesRow<N> pivots = row(pivot);
    for (std::size_t i = 0; i < N; ++i) pivots[i] = others[i] ? pivots[i] * inverse : Lanes{} + inverse;
    put(pivot, pivots);
    largest_[at(pivot)] = -1;
    for (int r = 0; r < size_; ++r) {
      if (r == pivot) continue;
      const double factor = (*this)(r, pivot);
      LanesRow<N> changed = row(r);
      for (std::size_t i = 0; i < N; ++i) changed[i] = both(changed[i], others[i]) - factor * pivots[i];
      put(r, changed);
      if (largest_[at(r)] >= 0) largest_[at(r)] = largest_in(changed, left);
    }
  }

  int size_;
  std::array<double, at(kMaxBlock) * at(kStride)> a_;
  std::array<double, at(kMaxBlock)> scale_{};
  std::array<double, at(kMaxBlock)> largest_{};  // by row, in the columns that are left; -1: it has had its pivot
};

// One step of Gauss and Jordan on a symmetric matrix; swept over all its rows it is the negative inverse.
void sweep(double* a, int size, int pivot) noexcept {
  const int stride = stride_of(size);
  const double inverse = 1 / a[pivot * stride + pivot];
  for (int r = 0; r < size; ++r) {
    if (r == pivot) continue;
    const double factor = a[r * stride + pivot] * inverse;
    for (int c = 0; c < size; ++c) {
      if (c != pivot) a[r * stride + c] -= factor * a[pivot * stride + c];
    }
  }
  for (int r = 0; r < size; ++r) {
    if (r == pivot) continue;
    a[r * stride + pivot] *= inverse;
    a[pivot * stride + r] *= inverse;
  }
  a[pivot * stride + pivot] = -inverse;
}

}  // namespace

bool invert_block(const double* block, int size, double* inverse) noexcept {
  return with_lanes(size, [&](auto n) {
    Scratch<n> a(block, size);
    a.equilibrate();
    const bool is_whole = a.invert();
    const int stride = stride_of(size);
    for (int r = 0; r < size; ++r) {
      for (int c = 0; c <= r; ++c) {
        inverse[r * stride + c] = inverse[c * stride + r] = 0.5 * (a(r, c) + a(c, r)) * a.scale(r) * a.scale(c);
      }
    }
    return is_whole;
  });
}

double invert_independent(const double* block, int size, const double* scale, double tolerance, double* transposed,
                          std::uint8_t* is_dependent) noexcept {
  const int stride = stride_of(size);
  std::array<double, at(kMaxBlock) * at(kMaxBlock)> a;
  std::copy_n(block, size * stride, a.begin());
  std::array<bool, at(kMaxBlock)> is_swept{};
  double smallest = 1;
  for (int step = 0; step < size; ++step) {
    int pivot = -1;
    double largest = tolerance, largest_left = 0;
    for (int r = 0; r < size; ++r) {
      const double value = -a[at(r * stride + r)] / scale[r];
      if (!is_swept[at(r)]) largest_left = std::max(largest_left, value);
      if (!is_swept[at(r)] && value > largest) {
        largest = value;
        pivot = r;
      }
    }
    smallest = std::min(smallest, largest_left);
    if (pivot < 0) break;
    sweep(a.data(), size, pivot);
    is_swept[at(pivot)] = true;
  }
  for (int r = 0; r < size; ++r) {
    is_dependent[r] = is_swept[at(r)] ? 0 : 1;
    for (int c = 0; c < size; ++c) {
      transposed[c * stride + r] = is_swept[at(r)] && is_swept[at(c)] ? -a[at(r * stride + c)] : 0.0;
    }
  }
  return smallest;
}

}  // namespace slew::math
