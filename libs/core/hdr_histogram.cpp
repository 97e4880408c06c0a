// SPDX-License-Identifier: Apache-2.0
#include "core/hdr_histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace slew {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;

// one writer: no read-modify-write of the bus is needed
template <typename T>
void add(std::atomic<T>& to, T what) noexcept {
  to.store(to.load(kRelaxed) + what, kRelaxed);
}

}  // namespace

std::size_t HdrHistogram::bucket_of(std::int64_t ns) noexcept {
  constexpr std::uint64_t kSubBuckets = 1u << kSubBucketBits;
  const std::uint64_t units = static_cast<std::uint64_t>(std::max<std::int64_t>(0, ns)) >> kUnitBits;
  if (units < kSubBuckets) return static_cast<std::size_t>(units);
  // the leading bit gives the doubling, the next seven bits the place in it
  const int doubling = std::bit_width(units) - kSubBucketBits;  // 1, 2, ...
  if (doubling > kDoublings) return kBuckets - 1;
  const std::uint64_t place = (units >> (doubling - 1)) - kSubBuckets;
  return (static_cast<std::size_t>(doubling) << kSubBucketBits) + static_cast<std::size_t>(place);
}

std::int64_t HdrHistogram::upper_bound(std::size_t bucket) noexcept {
  const std::size_t doubling = bucket >> kSubBucketBits;
  const std::size_t place = bucket & ((1u << kSubBucketBits) - 1);
  if (doubling == 0) return static_cast<std::int64_t>((place + 1) << kUnitBits) - 1;
  const std::uint64_t units = (place + (1u << kSubBucketBits) + 1) << (doubling - 1);
  return static_cast<std::int64_t>(units << kUnitBits) - 1;
}

void HdrHistogram::record(std::int64_t ns) noexcept {
  const std::int64_t value = std::max<std::int64_t>(0, ns);
  add<std::uint64_t>(counts_[bucket_of(value)], 1);
  widen(value, value);
  add<std::uint64_t>(count_, 1);
}

void HdrHistogram::record_falling(std::int64_t largest_ns, std::int64_t apart_ns, std::uint64_t count) noexcept {
  std::int64_t value = largest_ns;
  for (std::uint64_t left = count; left > 0;) {
    const std::size_t bucket = bucket_of(value);
    const std::int64_t least_here = bucket == 0 ? 0 : upper_bound(bucket - 1) + 1;
    const std::uint64_t here = std::min(left, static_cast<std::uint64_t>((value - least_here) / apart_ns) + 1);
    add(counts_[bucket], here);
    left -= here;
    value -= static_cast<std::int64_t>(here) * apart_ns;
  }
  widen(value + apart_ns, largest_ns);
  add(count_, count);
}

void HdrHistogram::widen(std::int64_t least_ns, std::int64_t largest_ns) noexcept {
  if (least_ns < min_.load(kRelaxed)) min_.store(least_ns, kRelaxed);
  if (largest_ns > max_.load(kRelaxed)) max_.store(largest_ns, kRelaxed);
}

std::int64_t HdrHistogram::min() const noexcept {
  return count() == 0 ? 0 : min_.load(kRelaxed);
}

std::int64_t HdrHistogram::percentile(double share) const noexcept {
  std::int64_t value = 0;
  percentiles({&share, 1}, {&value, 1});
  return value;
}

void HdrHistogram::percentiles(std::span<const double> shares, std::span<std::int64_t> values) const noexcept {
  const std::uint64_t n = count();
  std::fill(values.begin(), values.end(), n == 0 ? 0 : max());
  std::uint64_t seen = 0;
  std::size_t next = 0;
  for (std::size_t i = 0; n > 0 && i < kBuckets && next < shares.size(); ++i) {
    seen += counts_[i].load(kRelaxed);
    for (; next < shares.size(); ++next) {
      const double wanted = std::ceil(std::clamp(shares[next], 0.0, 1.0) * static_cast<double>(n));
      if (seen < std::max<std::uint64_t>(1, static_cast<std::uint64_t>(wanted))) break;
      values[next] = std::clamp(upper_bound(i), min(), max());
    }
  }
}

}  // namespace slew
