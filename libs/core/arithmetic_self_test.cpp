// SPDX-License-Identifier: Apache-2.0
#include "core/arithmetic_self_test.h"

#include <xmmintrin.h>

#include <cfenv>
#include <cmath>

#include "core/state_hash.h"

namespace slew {

std::uint64_t arithmetic_self_test() noexcept {
  StateHash hash;
  // volatile keeps the compiler from folding the calls at build time
  volatile double seed = 0.3141592653589793;
  double x = seed;
  for (int i = 0; i < 64; ++i) {
    x = 3.9 * x * (1.0 - x);
    const double scaled = 20.0 * (x - 0.5);
    hash.add(std::sin(scaled));
    hash.add(std::cos(scaled));
    hash.add(std::exp(scaled));
    hash.add(std::log(x));
    hash.add(std::pow(x, 1.2));
    hash.add(std::sqrt(x));
    hash.add(std::atan2(x, scaled));
    hash.add(std::tanh(scaled));
  }
  return hash.digest();
}

bool processor_fits(const char*& missing) noexcept {
  __builtin_cpu_init();
#ifdef __AVX2__
  if (!__builtin_cpu_supports("avx2")) {
    missing = "avx2";
    return false;
  }
#endif
#ifdef __BMI2__
  if (!__builtin_cpu_supports("bmi2")) {
    missing = "bmi2";
    return false;
  }
#endif
  missing = nullptr;
  return true;
}

void set_floating_point_mode() noexcept {
  std::fesetround(FE_TONEAREST);
  constexpr unsigned kFlushToZero = 0x8000;
  constexpr unsigned kDenormalsAreZero = 0x0040;
  _mm_setcsr(_mm_getcsr() & ~(kFlushToZero | kDenormalsAreZero));
}

}  // namespace slew
