// The lock-step loop around the step: taking messages, stepping, encoding and publishing use no heap either once the
// caches have been filled, over the bus of one process.
#include <gtest/gtest.h>

#include <array>

#include "cli_support/carrier.h"
#include "cli_support/subsystem_factory.h"
#include "core/allocation_guard.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "io_node/scene_config.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "node/physics_node.h"
#include "support/crane_pair.h"
#include "transport/in_process_bus.h"

namespace slew::testing {
namespace {

using wire::Role;

// beyond the depth of the caches of sent messages
constexpr StepIndex kWarmUp = static_cast<StepIndex>(node::kSentDepth) + 200;

std::unique_ptr<coupling::Subsystem> make(Role role, const scene::Scene& scene) {
  if (role == Role::mechanics) return mechanics::make_mechanics_subsystem(scene);
  return hydraulic_node::make_hydraulics_subsystem(scene);
}

class LockStep {
 public:
  LockStep() {
    io::IoConfig config = io::make_config(scene_, {"loop", io::Operator::script, io::Recording::none});
    config.name_check = {};
    config.pace = wire::Pace::free;
    config.steps = kWarmUp + 1000;
    io_.emplace(*ends_[0], std::move(config));
    for (const Role role : {Role::mechanics, Role::hydraulics}) {
      const auto factory = cli_support::subsystem_factory([role](const scene::Scene& s) { return make(role, s); }, ".");
      physics_.push_back(std::make_unique<node::PhysicsNode>(role, *ends_[physics_.size() + 1], factory));
    }
  }

  // Runs to this step; heap calls of the physics nodes' polls.
  std::uint64_t run_to(StepIndex step) {
    std::uint64_t calls = 0;
    while (io_->next_step() < step && !io_->is_finished()) {
      io_->poll(monotonic_ns());
      for (auto& node : physics_) {
        const AllocationGuard guard;
        node->poll(monotonic_ns());
        calls += guard.allocations();
      }
    }
    return calls;
  }
  [[nodiscard]] StepIndex step() const { return io_->next_step(); }

 private:
  const scene::Scene scene_ = CranePair::load();
  transport::InProcessBus bus_;
  std::array<std::unique_ptr<transport::Transport>, 3> ends_ = {cli_support::open_carrier(Role::io, bus_),
                                                                cli_support::open_carrier(Role::mechanics, bus_),
                                                                cli_support::open_carrier(Role::hydraulics, bus_)};
  std::optional<io::IoNode> io_;
  std::vector<std::unique_ptr<node::PhysicsNode>> physics_;
};

TEST(PhysicsNodeLoop, DoesNotAllocateOnceItsCachesAreFull) {
  if (!AllocationGuard::kCounts) GTEST_SKIP() << "a sanitizer is in front of malloc";
  LockStep session;
  EXPECT_GT(session.run_to(kWarmUp), 0u);
  ASSERT_GE(session.step(), kWarmUp);
  EXPECT_EQ(session.run_to(kWarmUp + 900), 0u);
}

}  // namespace
}  // namespace slew::testing
