// SPDX-License-Identifier: Apache-2.0
// A process without keys that sends packets in the names of processes with keys: it has no effect on them.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include "command.h"
#include "stranger.h"
#include "tests/integration/transport/child_process.h"
#include "tests/integration/transport/waiting.h"
#include "tests/support/test_domain.h"
#include "transport/cdr/codec.h"
#include "transport/cyclone/cyclone_transport.h"
#include "transport/protection.h"

namespace slew::testing {
namespace stranger_test {

namespace fs = std::filesystem;
using transport::CycloneTransport;
using wire::Topic;

constexpr std::uint32_t kAhead = 50;              // samples that are forged
constexpr std::int64_t kPause = 5'000'000;        // ns between two genuine ones
constexpr std::int64_t kStopped = 5'000'000'000;  // ns without a sample: no more come

std::unique_ptr<CycloneTransport> open(std::uint32_t domain, const std::string& store, const char* identity,
                                       transport::TopicSet writes, transport::TopicSet reads) {
  transport::Network network{domain, "lo", {}};
  std::unique_ptr<CycloneTransport> opened;
  if (!transport::protect(network, {store, identity}).is_ok()) return nullptr;
  if (!CycloneTransport::open(network, {"s", identity, writes, reads}, opened).is_ok()) return nullptr;
  return opened;
}

// writes 0, 1, 2, ... until it is ended
bool write_numbers(std::uint32_t domain, const std::string& store, const std::string& channel = "Input") {
  const auto transport = open(domain, store, "controller", {Topic::controller_input}, {});
  if (transport == nullptr) return false;
  transport::ByteBuffer bytes;
  for (std::uint64_t number = 0;; ++number) {
    wire::ControllerInput input{"s", "controller", channel, wire::ControllerAction::write, 0, number, -1};
    if (!transport::encode(input, bytes) || !transport->publish(Topic::controller_input, bytes).is_ok()) return false;
    sleep_until_monotonic(monotonic_ns() + kPause);
  }
}

class AStranger : public ::testing::TestWithParam<Forgery> {
 protected:
  void SetUp() override { ASSERT_EQ(run("slewring", {"keys", "create", "plant"}, work_.path()).code, 0); }
  // the governance of before anything but the data was protected
  void sign_nothing() {
    std::ifstream file(store() / "governance.xml");
    std::string text{std::istreambuf_iterator<char>(file), {}};
    const std::string kind = "SIGN_WITH_ORIGIN_AUTHENTICATION";
    text.replace(text.find(kind), kind.size(), "NONE");
    std::ofstream(store() / "governance.xml") << text;
    const CommandResult made =
        run("/usr/bin/openssl",
            {"smime", "-sign", "-in", store() / "governance.xml", "-text", "-out", store() / "governance.p7s",
             "-signer", store() / "permissions_ca.pem", "-inkey", store() / "permissions_ca.key"},
            work_.path());
    ASSERT_EQ(made.code, 0) << made.err;
  }
  // Numbers that a reader takes from when the forged packets have been sent; fewer when they stop coming.
  std::vector<std::uint64_t> read_numbers(Forgery forgery, std::size_t count) {
    ChildProcess writer([&] { return write_numbers(domain_.number(), store()); });
    Stranger stranger(domain_.number());
    std::vector<std::uint64_t> numbers;
    skip_reason_ = stranger.problem();
    if (!skip_reason_.empty()) return numbers;
    const auto reader = open(domain_.number(), store(), "io", {}, {Topic::controller_input});
    EXPECT_NE(reader, nullptr);
    transport::Received message;
    while (!stranger.has_received(20)) {
      if (!next(*reader, message)) return numbers;
    }
    stranger.forge(forgery, kAhead);
    wire::ControllerInput input;
    while (numbers.size() < count && next(*reader, message, kStopped)) {
      if (transport::decode(message.bytes, input)) numbers.push_back(input.sequence);
    }
    return numbers;
  }
  static bool are_in_order(const std::vector<std::uint64_t>& numbers) {
    return std::ranges::adjacent_find(numbers, [](auto a, auto b) { return b != a + 1; }) == numbers.end();
  }
  [[nodiscard]] fs::path store() const { return work_.path() / "plant"; }

  WorkFolder work_;
  TestDomain domain_;
  std::string skip_reason_;
};

constexpr std::size_t kEnough = 3 * kAhead;

class StrangerWith : public AStranger {};

TEST_P(StrangerWith, IsIgnored) {
  const std::vector<std::uint64_t> numbers = read_numbers(GetParam(), kEnough);
  if (!skip_reason_.empty()) GTEST_SKIP() << "packets cannot be captured here: " << skip_reason_;
  EXPECT_EQ(numbers.size(), kEnough);
  EXPECT_TRUE(are_in_order(numbers));
}

// or the test above would show nothing
class UnsignedStrangerWith : public AStranger {};

TEST_P(UnsignedStrangerWith, WouldBeReceivedIfNothingWereSigned) {
  sign_nothing();
  const CommandResult checked = run("slewring", {"keys", "check", "plant"}, work_.path());
  EXPECT_EQ(checked.code, 1);
  EXPECT_NE(checked.out.find("is of another version and has other protection rules"), std::string::npos) << checked.out;
  const std::vector<std::uint64_t> numbers = read_numbers(GetParam(), kEnough);
  if (!skip_reason_.empty()) GTEST_SKIP() << "packets cannot be captured here: " << skip_reason_;
  EXPECT_FALSE(numbers.size() == kEnough && are_in_order(numbers));
}

// From when two processes meet until samples go between them; `keys`: the store, or none.
std::unique_ptr<Stranger> capture_a_start(std::uint32_t domain, const std::string& keys, const std::string& word) {
  auto stranger = std::make_unique<Stranger>(domain);
  if (!stranger->problem().empty()) return stranger;
  ChildProcess writer([&] { return write_numbers(domain, keys, word); });
  const auto reader = open(domain, keys, "io", {}, {Topic::controller_input});
  EXPECT_NE(reader, nullptr);
  transport::Received message;
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(next(*reader, message));
  // the last packets may still be on their way to the listening process
  EXPECT_TRUE(wait_until([&] { return stranger->has_received(20); }));
  return stranger;
}

class AnOnlooker : public AStranger {};

TEST_F(AnOnlooker, SeesOfAStartWithKeysNeitherProcessesNorValues) {
  const std::string word = "a_value_that_is_sent";
  const std::vector<std::string> secrets = {"test_cli_programs", "__ProcessName", "__Hostname", "__Pid", word};
  const auto keyed = capture_a_start(domain_.number(), store(), word);
  if (!keyed->problem().empty()) GTEST_SKIP() << "packets cannot be captured here: " << keyed->problem();
  for (const std::string& secret : secrets) EXPECT_FALSE(keyed->has_seen(secret)) << secret;
  // the parts that docs/security.md lists as visible are visible
  std::array<char, 256> host{};
  ASSERT_EQ(gethostname(host.data(), host.size() - 1), 0);
  for (const std::string& seen : {host.data() + std::string("/"), std::string("slewring/controller_input")}) {
    EXPECT_TRUE(keyed->has_seen(seen)) << seen;
  }
  // or it would show nothing
  const TestDomain plain;
  const auto unkeyed = capture_a_start(plain.number(), "", word);
  for (const std::string& secret : secrets) EXPECT_TRUE(unkeyed->has_seen(secret)) << secret;
}

class AHolderOfKeys : public AStranger {};

TEST_F(AHolderOfKeys, SpeaksOnTheTopicsOfItsRoleAlone) {
  const auto may_write = [&](const std::string& identity, Topic topic) {
    return open(domain_.number(), store(), identity.c_str(), {topic}, {}) != nullptr;
  };
  // END is a tick, or a description that is taken back
  for (const Topic topic : {Topic::session, Topic::tick, Topic::mechanism, Topic::actuators, Topic::variable_directory,
                            Topic::variables, Topic::node_status, Topic::health}) {
    for (const std::string identity : {"controller", "observer", "viewer"}) {
      EXPECT_FALSE(may_write(identity, topic)) << identity << " " << static_cast<int>(topic);
    }
  }
  for (const Topic topic : {Topic::session, Topic::tick, Topic::mechanism, Topic::variable_directory}) {
    EXPECT_FALSE(may_write("recorder", topic)) << static_cast<int>(topic);
  }
  for (const Topic topic : {Topic::session, Topic::tick, Topic::actuators}) {
    EXPECT_FALSE(may_write("mechanics", topic)) << static_cast<int>(topic);
  }
  EXPECT_TRUE(may_write("io", Topic::tick));
  EXPECT_TRUE(may_write("mechanics", Topic::variable_directory));
  EXPECT_TRUE(may_write("controller", Topic::controller_input));
}

std::string name_of(const ::testing::TestParamInfo<Forgery>& forgery) {
  switch (forgery.param) {
    case Forgery::newer:
      return "NewerSamples";
    case Forgery::newer_unsigned:
      return "NewerSamplesUnsigned";
    case Forgery::gap:
      return "Gap";
    case Forgery::heartbeat:
      return "Heartbeat";
  }
  return "";
}

INSTANTIATE_TEST_SUITE_P(Forged, StrangerWith,
                         ::testing::Values(Forgery::newer, Forgery::newer_unsigned, Forgery::gap, Forgery::heartbeat),
                         name_of);

INSTANTIATE_TEST_SUITE_P(Forged, UnsignedStrangerWith, ::testing::Values(Forgery::newer), name_of);
INSTANTIATE_TEST_SUITE_P(NightlyForged, UnsignedStrangerWith,
                         ::testing::Values(Forgery::newer_unsigned, Forgery::gap, Forgery::heartbeat), name_of);

}  // namespace stranger_test
}  // namespace slew::testing
