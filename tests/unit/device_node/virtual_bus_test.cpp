// SPDX-License-Identifier: Apache-2.0
// Devices on a CAN interface of the kernel, with programs of others on it. They need an interface, which few machines
// have: SLEWRING_TEST_CAN=vcan0 names one; without it they skip.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "core/time.h"
#include "device_node/input_device.h"
#include "memory_bus.h"

namespace slew::device_node {
namespace virtual_bus_test {

using namespace testing_can;

constexpr std::int64_t kDeadlineNs = 240'000'000'000;
constexpr int kNoProgram = 127;

// Another program; killed at the end.
class Peer {
 public:
  explicit Peer(std::vector<std::string> arguments) {
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ != 0) return;
    execvp(argv[0], argv.data());
    _exit(kNoProgram);
  }
  ~Peer() {
    if (has_ended()) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  bool has_ended() {
    int status = 0;
    if (code_ < 0 && waitpid(pid_, &status, WNOHANG) == pid_) code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 1;
    return code_ >= 0;
  }
  [[nodiscard]] int code() const { return code_; }  // below 0: it runs

 private:
  pid_t pid_ = -1;
  int code_ = -1;
};

class VirtualBus : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const name = std::getenv("SLEWRING_TEST_CAN");
    if (name == nullptr) GTEST_SKIP() << "SLEWRING_TEST_CAN names no CAN interface, as vcan0";
    interface_ = name;
    std::string reason;
    bus_ = open_can(interface_, reason);
    ASSERT_NE(bus_, nullptr) << reason;
  }

  // Until the condition holds; `turn` is called meanwhile. False: not before the deadline.
  static bool wait_for(
      const std::function<bool()>& condition, const std::function<void()>& turn = [] {}) {
    for (const std::int64_t end_ns = monotonic_ns() + kDeadlineNs; monotonic_ns() < end_ns;) {
      turn();
      if (condition()) return true;
      std::this_thread::yield();
    }
    return false;
  }
  // Frames that have come to the test's own socket.
  void collect() {
    CanFrame frame;
    while (bus_->take(0, frame) == CanBus::Taken::frame) seen_.push_back(frame);
  }

  std::string interface_;
  std::unique_ptr<CanBus> bus_;
  std::vector<CanFrame> seen_;
};

TEST_F(VirtualBus, FramesArriveAsTheyWereSent) {
  std::string reason;
  const auto other = open_can(interface_, reason);
  ASSERT_NE(other, nullptr) << reason;
  const std::vector<CanFrame> sent = {frame_of(0x7FF, {}), frame_of(0x705, {0x05}),
                                      frame_of(0x18EEFF27, {1, 2, 3, 4, 5, 6, 7, 8}, true),
                                      frame_of(0x123, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12})};
  for (const CanFrame& frame : sent) EXPECT_TRUE(other->send(frame));
  ASSERT_TRUE(wait_for([&] { return seen_.size() == sent.size(); }, [&] { collect(); }));
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(seen_[i].id, sent[i].id);
    EXPECT_EQ(seen_[i].is_extended, sent[i].is_extended);
    EXPECT_EQ(seen_[i].size, sent[i].size);
    EXPECT_EQ(seen_[i].bytes, sent[i].bytes);
  }
  CanFrame own;
  EXPECT_EQ(other->take(0, own), CanBus::Taken::nothing);
}

// j1939acd of can-utils claims on the kernel's J1939 sockets
TEST_F(VirtualBus, AUnitOnTheKernelsJ1939ContestsTheAddress) {
  for (const bool is_smaller : {false, true}) {
    scene::CanOutDef def;
    def.name = "Engine";
    def.every = 0.001;
    def.bus.interface = interface_;
    def.bus.protocol = scene::CanProtocol::j1939;
    def.bus.definition = "BO_ 2364540158 EEC1: 8 X\n SG_ EngineSpeed : 24|16@1+ (0.125,0) [0|8031.875] \"rpm\" X\n";
    def.bus.signals = {{.signal = "EEC1.EngineSpeed", .variable = "Load.force"}};
    def.bus.unit = {.address = 0x80, .identity = 77, .function = 200};
    Peer rival({"j1939acd", "-r", "128", "-c", "/dev/null", is_smaller ? "1" : "7FFFFFFFFFFFFFFF", interface_});
    const auto has_seen = [&](std::uint32_t id, const CanFrame& like) {
      return std::any_of(seen_.begin(), seen_.end(),
                         [&](const CanFrame& frame) { return frame.id == id && frame.bytes == like.bytes; });
    };
    const CanFrame rivals_claim = is_smaller ? frame_of(0, {1}) : frame_of(0, {255, 255, 255, 255, 255, 255, 255, 127});
    const auto has_rival = [&] { return has_seen(0x18EEFF80, rivals_claim) || rival.has_ended(); };
    ASSERT_TRUE(wait_for(has_rival, [&] { collect(); }));
    if (rival.has_ended() && rival.code() == kNoProgram) GTEST_SKIP() << "there is no j1939acd (can-utils)";
    ForceSender engine(def, open_can);
    const auto turn = [&] {
      engine.device->look_after(monotonic_ns());
      collect();
    };
    const auto phase = [&] { return engine.device->counts().at("address").at("phase").text(); };
    ASSERT_TRUE(wait_for([&] { return phase() == (is_smaller ? "lost" : "claimed"); }, turn)) << phase();
    // the claim, or Cannot Claim, by its NAME
    const CanFrame claim = frame_of(0, {77, 0, 0, 0, 0, 200, 0, 0});
    EXPECT_TRUE(wait_for([&] { return has_seen(is_smaller ? 0x18EEFFFE : 0x18EEFF80, claim); }, turn));
    // 1000 rpm from the address, unless it is lost
    engine.publish(1000);
    const CanFrame speed = frame_of(0, {0xFF, 0xFF, 0xFF, 0x40, 0x1F, 0xFF, 0xFF, 0xFF});
    if (!is_smaller) EXPECT_TRUE(wait_for([&] { return has_seen(0x0CF00480, speed); }, turn));
    if (is_smaller) EXPECT_EQ(engine.device->counts().at("held_back").integer(), 1);
    seen_.clear();
  }
}

}  // namespace virtual_bus_test
}  // namespace slew::device_node
