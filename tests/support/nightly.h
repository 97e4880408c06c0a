// SPDX-License-Identifier: Apache-2.0
// The gate (`launch_scripts/test`) runs these tests in part, `--nightly`, which sets SLEWRING_NIGHTLY, in full: rounds,
// simulated time and seeds. A test with Nightly in its name is run by `--nightly` alone (cmake/SlewringBuild.cmake).
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <initializer_list>
#include <string>
#include <vector>

namespace slew::testing {

[[nodiscard]] inline bool is_nightly() {
  return std::getenv("SLEWRING_NIGHTLY") != nullptr;
}

template <typename Count>
[[nodiscard]] Count rounds(Count usual, Count nightly) {
  return is_nightly() ? nightly : usual;
}

struct SeedRange {
  std::uint32_t first = 1, count = 0;
};

// Seeds of a random test: of each range the first `gate` in the gate and all nightly. SLEWRING_SEED=n: that one alone.
[[nodiscard]] inline std::vector<std::uint32_t> seeds(std::initializer_list<SeedRange> ranges, std::uint32_t gate = 8) {
  if (const char* alone = std::getenv("SLEWRING_SEED")) {
    return {static_cast<std::uint32_t>(std::strtoul(alone, nullptr, 10))};
  }
  std::vector<std::uint32_t> all;
  for (const SeedRange& range : ranges) {
    const std::uint32_t count = is_nightly() ? range.count : std::min(gate, range.count);
    for (std::uint32_t i = 0; i < count; ++i) all.push_back(range.first + i);
  }
  return all;
}

// For SCOPED_TRACE: how a failing seed is run alone.
[[nodiscard]] inline std::string seed_text(std::uint32_t seed) {
  const ::testing::TestInfo* test = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string program;
  std::getline(std::ifstream("/proc/self/cmdline"), program, '\0');
  return "seed " + std::to_string(seed) + "; alone: SLEWRING_SEED=" + std::to_string(seed) + " " + program +
         " --gtest_filter=" + test->test_suite_name() + "." + test->name();
}

// A claim of each seed. An assertion that ends it for one seed leaves the others.
template <typename Claim>
void for_each_seed(const std::vector<std::uint32_t>& seeds, Claim claim) {
  for (const std::uint32_t seed : seeds) {
    SCOPED_TRACE(seed_text(seed));
    claim(seed);
  }
}

}  // namespace slew::testing
