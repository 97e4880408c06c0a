// SPDX-License-Identifier: Apache-2.0
// The lock-step loop around the step: taking messages, stepping, encoding and publishing use no heap either once the
// caches have been filled, over the bus of one process.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/allocation_guard.h"
#include "io_node/io_node.h"
#include "io_node/scene_config.h"
#include "node/open_transport.h"
#include "node/physics_node.h"
#include "node/subsystem_factory.h"
#include "session/monolithic_session.h"
#include "support/crane_pair.h"
#include "transport/cdr/codec.h"
#include "transport/in_process/in_process_bus.h"
#include "transport/roles.h"

namespace slew::testing {
namespace node_allocation_test {

using wire::Role;

// beyond the depth of the caches of sent messages
constexpr StepIndex kWarmUp = static_cast<StepIndex>(node::kSentDepth) + 200;

class LockStep {
 public:
  LockStep(scene::Scene scene, StepIndex warm_up) : scene_(std::move(scene)) {
    io_node::IoConfig config = io_node::make_config(scene_, kSession, io_node::Recording::none);
    config.name_check = {};
    config.session.pace = Pace::free;
    config.session.duration = static_cast<double>(warm_up + 1000) * config.session.step;
    const std::uint32_t roles = config.required_roles;
    io_.emplace(endpoint(Role::io), std::move(config));
    for (const Role role : transport::physics_roles()) {
      if ((roles & bit(role)) == 0) continue;
      const auto factory =
          node::subsystem_factory([role](const scene::Scene& s) { return session::SubsystemFamily().make(role, s); },
                                  SLEWRING_SOURCE_DIR "/scenes");
      physics_.push_back(std::make_unique<node::PhysicsNode>(role, endpoint(role), factory));
    }
  }

  // Runs to this step; heap calls of the physics nodes' polls.
  std::uint64_t run_to(StepIndex step) {
    std::uint64_t calls = 0;
    while (io_->next_step() < step && !io_->is_finished()) {
      steer();
      const AllocationGuard of_io;
      io_->poll(now_ns_ += kBetweenPolls);
      io_calls_ += of_io.allocations();
      for (auto& node : physics_) {
        const AllocationGuard guard;
        node->poll(now_ns_ += kBetweenPolls);
        calls += guard.allocations();
      }
    }
    return calls;
  }
  // Heap calls of io's polls since the last call.
  std::uint64_t io_calls() { return std::exchange(io_calls_, 0); }
  [[nodiscard]] StepIndex step() const { return io_->next_step(); }
  // Why the session ended, by every node.
  [[nodiscard]] std::string reasons() {
    std::string reasons = "io: " + io_->member().reason();
    for (const auto& node : physics_) {
      reasons += "; " + std::string(node::to_text(node->member().role())) + ": " + node->member().reason();
    }
    return reasons;
  }
  [[nodiscard]] std::size_t nodes() const { return physics_.size(); }

 private:
  // a clock of its own: on a busy machine nodes would request samples that are on their way
  static constexpr std::int64_t kBetweenPolls = 10'000;

  // a controller with long names, that writes a value in every step
  void steer() {
    for (transport::Received received; controller_.take(received);) {
    }
    if (io_->next_step() == steered_) return;
    steered_ = io_->next_step();
    const auto action = steered_ <= 1 ? wire::ControllerAction::acquire : wire::ControllerAction::write;
    const double value = action == wire::ControllerAction::write ? 0.1 : 0;
    const wire::ControllerInput input{kSession, "controller_of_the_lift_cylinder", "Input_Lift", action, value, 0,
                                      steered_};
    std::vector<std::byte> bytes;
    ASSERT_TRUE(transport::encode(input, bytes));
    ASSERT_TRUE(controller_.publish(wire::Topic::controller_input, bytes).is_ok());
  }

  static constexpr const char* kSession = "session_of_the_allocation_test";

  transport::Transport& endpoint(Role role) { return *ends_.emplace_back(node::open_transport(role, bus_)); }

  std::int64_t now_ns_ = 1'000'000'000;
  const scene::Scene scene_;
  transport::InProcessBus bus_;
  std::vector<std::unique_ptr<transport::Transport>> ends_;
  std::optional<io_node::IoNode> io_;
  std::vector<std::unique_ptr<node::PhysicsNode>> physics_;
  transport::Transport& controller_ = endpoint(Role::controller);
  StepIndex steered_ = kJoinStep;
  std::uint64_t io_calls_ = 0;
};

TEST(NodeLoop, DoesNotAllocateOnceItsCachesAreFull) {
  if (!AllocationGuard::kCounts) GTEST_SKIP() << "a sanitizer is in front of malloc";
  LockStep session(CranePair::load(), kWarmUp);
  EXPECT_GT(session.run_to(kWarmUp), 0u);
  ASSERT_GE(session.step(), kWarmUp);
  session.io_calls();
  EXPECT_EQ(session.run_to(kWarmUp + 900), 0u);
  EXPECT_EQ(session.io_calls(), 0u);
}

TEST(NodeLoop, DoesNotAllocateWithAFlexNode) {
  if (!AllocationGuard::kCounts) GTEST_SKIP() << "a sanitizer is in front of malloc";
  for (const std::string exchange : {"once", "every_step"}) {
    // samples of flexible bodies come every tenth step and fill their caches that much later
    const StepIndex warm_up = exchange == "once" ? 10 * kWarmUp : kWarmUp;
    LockStep session(
        scene::load_file(SLEWRING_SOURCE_DIR "/scenes/truck_crane_flexible.yaml", {"session.flexible=" + exchange}),
        warm_up);
    ASSERT_EQ(session.nodes(), 3u);
    EXPECT_GT(session.run_to(warm_up), 0u);
    ASSERT_GE(session.step(), warm_up) << session.reasons();
    EXPECT_EQ(session.run_to(warm_up + 900), 0u) << exchange;
  }
}

}  // namespace node_allocation_test
}  // namespace slew::testing
