// Random and repeated tests do more of the same when SLEWRING_NIGHTLY is set, as `launch_scripts/test --nightly` does.
// Seeds count up, so that a nightly run begins with the usual ones.
#pragma once

#include <cstdlib>

namespace slew::testing {

template <typename Count>
[[nodiscard]] Count rounds(Count usual, Count nightly) {
  return std::getenv("SLEWRING_NIGHTLY") == nullptr ? usual : nightly;
}

}  // namespace slew::testing
