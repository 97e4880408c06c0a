// SPDX-License-Identifier: Apache-2.0
// No heap in a step: 1,000 steps of each subsystem of the crane after a warm-up, under the allocation guard.
#include <gtest/gtest.h>

#include <string>

#include "core/allocation_guard.h"
#include "support/crane_pair.h"
#include "support/mechanics_alone.h"

namespace slew::testing {
namespace subsystem_allocation_test {

constexpr StepIndex kWarmUp = 50;
constexpr StepIndex kSteps = 1000;

struct HeapUse {
  std::uint64_t allocations = 0;
  std::uint64_t frees = 0;
};

// counts of kSteps steps; `before` is called in front of each, inside the guard
template <typename Before>
HeapUse heap_use(CranePair& crane, Before before) {
  for (StepIndex i = 0; i < kWarmUp; ++i) crane.step(CranePair::levers(crane.n));
  const AllocationGuard guard;
  for (StepIndex i = 0; i < kSteps; ++i) {
    before(i);
    crane.step(CranePair::levers(crane.n));
  }
  return {guard.allocations(), guard.frees()};
}

class SubsystemStep : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!AllocationGuard::kCounts) GTEST_SKIP() << "a sanitizer is in front of malloc";
    crane.start();
  }
  const scene::Scene scene = CranePair::load();
  CranePair crane{scene};
};

TEST_F(SubsystemStep, DoesNotAllocateInAThousandSteps) {
  const HeapUse use = heap_use(crane, [](StepIndex) {});
  EXPECT_EQ(use.allocations, 0u);
  EXPECT_EQ(use.frees, 0u);
  // the machine was at work
  EXPECT_GT(std::abs(crane.mechanics_now.mechanism.v[1]) + std::abs(crane.mechanics_now.mechanism.v[2]), 1e-4);
}

TEST_F(SubsystemStep, DoesNotAllocateInBodyCoordinates) {
  for (const char* formulation : {"lagrange", "augmented", "penalty"}) {
    const scene::Scene other = CranePair::load({std::string("mechanics.formulation=") + formulation});
    CranePair bodies(other);
    bodies.start();
    const HeapUse use = heap_use(bodies, [](StepIndex) {});
    EXPECT_EQ(use.allocations, 0u) << formulation;
    EXPECT_EQ(use.frees, 0u) << formulation;
  }
}

TEST_F(SubsystemStep, DoesNotAllocateWhileTheBagKnocksOnTheFloor) {
  for (const char* formulation : {"recursive", "lagrange"}) {
    const scene::Scene on_floor =
        CranePair::load({"Ground_Mesh.position=[0, 0.936 m, 0]", std::string("mechanics.formulation=") + formulation});
    CranePair standing(on_floor);
    standing.start();
    std::size_t points = 0;
    const HeapUse use =
        heap_use(standing, [&](StepIndex) { points += standing.mechanics->state().contacts.states().size(); });
    EXPECT_EQ(use.allocations, 0u);
    EXPECT_EQ(use.frees, 0u);
    EXPECT_GT(points, 100u);
  }
}

// cylinders and convex meshes have no drawing: their search must not allocate either
TEST(MechanicsStep, DoesNotAllocateWithAnyShapeInContact) {
  if (!AllocationGuard::kCounts) GTEST_SKIP() << "a sanitizer is in front of malloc";
  for (const char* formulation : {"recursive", "lagrange"}) {
    MechanicsAlone mechanics("scenes/contact/shapes.yaml", {std::string("mechanics.formulation=") + formulation});
    std::vector<double> values(mechanics.subsystem.variables().size());
    for (StepIndex i = 0; i < kWarmUp / 10; ++i) mechanics.step();
    const AllocationGuard guard;
    for (StepIndex i = 0; i < kSteps / 10; ++i) {
      mechanics.step();
      mechanics.subsystem.read_variables(values);
    }
    EXPECT_EQ(guard.allocations(), 0u) << formulation;
    EXPECT_EQ(guard.frees(), 0u) << formulation;
    for (const char* pair : {"Drum_Table", "Hull_Drum", "Ball_Hull", "Roll_Table", "Crate_Hills"}) {
      EXPECT_GT(mechanics.value(std::string(pair) + ".contacts"), 0) << pair;
    }
  }
}

TEST(MechanicsStep, DoesNotAllocateWithAnyForceElement) {
  if (!AllocationGuard::kCounts) GTEST_SKIP() << "a sanitizer is in front of malloc";
  for (const char* kind : {"point_force", "bushing", "beam", "rope", "tables", "tyres"}) {
    MechanicsAlone mechanics(std::string("scenes/forces/") + kind + ".yaml");
    std::vector<double> values(mechanics.subsystem.variables().size());
    for (StepIndex i = 0; i < kWarmUp; ++i) mechanics.step();
    const AllocationGuard guard;
    for (StepIndex i = 0; i < kSteps; ++i) {
      mechanics.step();
      mechanics.subsystem.read_variables(values);
    }
    EXPECT_EQ(guard.allocations(), 0u) << kind;
    EXPECT_EQ(guard.frees(), 0u) << kind;
  }
}

TEST_F(SubsystemStep, DoesNotAllocateUnderAnyIntegrator) {
  for (const std::string formulation : {"recursive", "lagrange"}) {
    for (const std::string integrator : {"semi_implicit_euler", "trapezoidal", "generalised_alpha", "sdirk2"}) {
      const scene::Scene other =
          CranePair::load({"mechanics.formulation=" + formulation, "mechanics.integrator=" + integrator});
      CranePair machine(other);
      machine.start();
      const HeapUse use = heap_use(machine, [](StepIndex) {});
      EXPECT_EQ(use.allocations, 0u) << formulation << ' ' << integrator;
      EXPECT_EQ(use.frees, 0u) << formulation << ' ' << integrator;
    }
  }
}

TEST_F(SubsystemStep, DoesNotAllocateWhileParametersChange) {
  std::uint64_t taken = 0;
  const HeapUse use = heap_use(crane, [this, &taken](StepIndex i) {
    if (i % 100 != 0) return;
    const double mass = i % 200 == 0 ? 1500 : 500;
    for (coupling::Subsystem* subsystem : {static_cast<coupling::Subsystem*>(crane.mechanics.get()),
                                           static_cast<coupling::Subsystem*>(crane.hydraulics.get())}) {
      taken += subsystem->change_parameter(crane.n, {"Bag.mass", mass, milliseconds(150)}) ? 1 : 0;
      taken += subsystem->change_parameter(crane.n, {"MainPump.set_pressure", 2e6 + 1e3 * static_cast<double>(i), {}})
                   ? 1
                   : 0;
      taken += subsystem->change_parameter(crane.n, {"Absent.key", 1, {}}) ? 1 : 0;
    }
  });
  EXPECT_EQ(use.allocations, 0u);
  EXPECT_EQ(use.frees, 0u);
  EXPECT_EQ(taken, 20u);
}

TEST_F(SubsystemStep, DoesNotAllocateWhileItIsHashedAndObserved) {
  std::vector<double> of_mechanics(crane.mechanics->variables().size());
  std::vector<double> of_hydraulics(crane.hydraulics->variables().size());
  std::uint64_t sum = 0;
  const HeapUse use = heap_use(crane, [&](StepIndex) {
    sum += crane.mechanics->state_hash() ^ crane.hydraulics->state_hash();
    crane.mechanics->read_variables(of_mechanics);
    crane.hydraulics->read_variables(of_hydraulics);
  });
  EXPECT_EQ(use.allocations, 0u);
  EXPECT_EQ(use.frees, 0u);
  EXPECT_NE(sum, 0u);
}

TEST_F(SubsystemStep, DoesNotAllocateAfterItsStateHasFailed) {
  crane.mechanics->mutable_state().u[0] = std::numeric_limits<double>::infinity();
  const HeapUse use = heap_use(crane, [](StepIndex) {});
  EXPECT_EQ(use.allocations, 0u);
  EXPECT_EQ(use.frees, 0u);
}

}  // namespace subsystem_allocation_test
}  // namespace slew::testing
