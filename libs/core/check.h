// SPDX-License-Identifier: Apache-2.0
// Pre-conditions. SLEW_ASSERT is off in optimised builds, SLEW_CHECK is always on and cheap.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace slew::detail {

[[noreturn]] inline void check_failed(const char* condition, const char* file, int line) noexcept {
  std::fprintf(stderr, "slewring: internal error: %s does not hold (%s:%d); please report it\n", condition, file, line);
  std::abort();
}

}  // namespace slew::detail

#define SLEW_CHECK(condition) \
  ((condition) ? static_cast<void>(0) : ::slew::detail::check_failed(#condition, __FILE__, __LINE__))

#ifdef NDEBUG
#define SLEW_ASSERT(condition) static_cast<void>(0)
#else
#define SLEW_ASSERT(condition) SLEW_CHECK(condition)
#endif
