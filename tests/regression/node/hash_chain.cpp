// SPDX-License-Identifier: Apache-2.0
// Prints the hash of both subsystems' states of the truck crane at each of 500 steps, and one of the whole chain. Two
// builds of one compiler print the same:  diff <(build/release/bin/hash_chain) <(build/dev/bin/hash_chain)
#include <cinttypes>
#include <cstdio>
#include <exception>

#include "core/arithmetic_self_test.h"
#include "core/state_hash.h"
#include "support/crane_pair.h"

int main() {
  using namespace slew;
  constexpr StepIndex kSteps = 500;
  try {
    set_floating_point_mode();
    const scene::Scene scene = testing::CranePair::load();
    testing::CranePair crane(scene);
    crane.start();
    StateHash chain;
    for (StepIndex n = 0; n <= kSteps; ++n) {
      const std::uint64_t mechanics = crane.mechanics->state_hash();
      const std::uint64_t hydraulics = crane.hydraulics->state_hash();
      chain.add(mechanics);
      chain.add(hydraulics);
      std::printf("%3" PRId64 " %016" PRIx64 " %016" PRIx64 "\n", n, mechanics, hydraulics);
      if (n == 100) crane.mechanics->change_parameter(n, {"Bag.mass", 1500, milliseconds(200)});
      crane.step(testing::CranePair::levers(n));
    }
    std::printf("chain %016" PRIx64 "\n", chain.digest());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hash_chain: %s\n", error.what());
    return 1;
  }
}
