// SPDX-License-Identifier: Apache-2.0
// Bytes that differ from the saved ones are refused, without reads beyond their end.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "build_paths.h"
#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "session_chain.h"
#include "support/nightly.h"

namespace slew::testing {
namespace damaged_state_test {

using wire::Role;

constexpr std::size_t kHeader = 32, kLength = 16, kCheck = 24;  // offsets in the layout of core/state_bytes.h

class DamagedState : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    chain.start();
    chain.run_to(30);
    saved = chain.save();
  }
  // a copy with its own end: a sanitizer detects reads beyond
  [[nodiscard]] Status load(Role part, std::span<const std::byte> bytes) {
    const std::vector<std::byte> copy(bytes.begin(), bytes.end());
    return chain.part(part)->load(copy, chain.sample(part));
  }
  [[nodiscard]] std::vector<Role> parts() const {
    std::vector<Role> present;
    for (const Role part : {Role::mechanics, Role::hydraulics, Role::flex}) {
      if (chain.part(part) != nullptr) present.push_back(part);
    }
    return present;
  }

  const scene::Scene scene = scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/scenes/" + GetParam());
  const Drive drive{.changes = small_changes(scene)};
  SessionChain chain{scene, drive};
  SavedParts saved;
};

TEST_P(DamagedState, IsRefusedWhereverItIsCut) {
  for (const Role part : parts()) {
    const std::span<const std::byte> bytes(saved[part]);
    const std::size_t stride = rounds<std::size_t>(bytes.size() / 60 + 1, 1);
    for (std::size_t length = 0; length < bytes.size(); length += length < kHeader ? 1 : stride) {
      const Status status = load(part, bytes.first(length));
      ASSERT_EQ(status.code, ExitCode::bad_input) << length;
      ASSERT_NE(status.text.find("is cut"), std::string::npos) << status.text;
    }
    EXPECT_TRUE(load(part, bytes).is_ok());
    std::vector<std::byte> longer(bytes.begin(), bytes.end());
    longer.push_back({});
    EXPECT_EQ(load(part, longer).code, ExitCode::bad_input);
  }
}

TEST_P(DamagedState, IsRefusedWithAnyFlippedBit) {
  std::mt19937_64 random(1);
  for (const Role part : parts()) {
    for (int i = 0; i < rounds(60, 3000); ++i) {
      std::vector<std::byte> bytes = saved[part];
      const std::size_t at = random() % bytes.size();
      bytes[at] ^= std::byte{1} << random() % 8;
      ASSERT_EQ(load(part, bytes).code, ExitCode::bad_input) << at;
    }
  }
}

// with a matching checksum: any values may be loaded, and values that do not fit the model are refused
TEST_P(DamagedState, NeverLeadsOutOfTheModel) {
  std::mt19937_64 random(2);
  for (const Role part : parts()) {
    for (int i = 0; i < rounds(60, 3000); ++i) {
      std::vector<std::byte> bytes = saved[part];
      if (random() % 4 == 0) bytes.resize(kHeader + random() % (bytes.size() - kHeader + 1));
      const std::size_t length = bytes.size() - kHeader;
      for (std::size_t flips = 1 + random() % 8; flips > 0 && length > 0; --flips) {
        bytes[kHeader + random() % length] = static_cast<std::byte>(random());
      }
      StateHash check;
      check.add_bytes(bytes.data() + kHeader, length);
      const std::uint64_t digest = check.digest(), size = length;
      std::memcpy(bytes.data() + kCheck, &digest, sizeof digest);
      std::memcpy(bytes.data() + kLength, &size, sizeof size);
      const Status status = load(part, bytes);
      if (!status.is_ok()) {
        ASSERT_EQ(status.code, ExitCode::bad_input);
        continue;
      }
      // the loaded state can be stepped and observed
      SessionChain other(scene, drive);
      other.start();
      other.run_to(3);
      ASSERT_TRUE(other.part(part)->load(bytes, other.sample(part)).is_ok());
      other.run_to(8);
      std::vector<double> values(other.part(part)->variables().size());
      other.part(part)->read_variables(values);
    }
  }
}

TEST_P(DamagedState, LeavesTheSubsystemAsAfterReset) {
  SessionChain fresh(scene, drive);
  fresh.start();
  for (const Role part : parts()) {
    ASSERT_FALSE(load(part, std::span(saved[part]).first(saved[part].size() / 2)).is_ok());
  }
  SessionChain again(scene, drive);
  for (const Role part : parts()) {
    std::vector<std::byte> bytes = saved[part];
    bytes.back() ^= std::byte{1};
    ASSERT_FALSE(again.part(part)->load(bytes, again.sample(part)).is_ok());
  }
  again.start();
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(again.is_same_as(fresh));
    again.step();
    fresh.step();
  }
}

TEST_P(DamagedState, OfAnotherLayoutIsRefusedWithBothNumbers) {
  for (const Role part : parts()) {
    std::vector<std::byte> bytes = saved[part];
    bytes[4] = std::byte{99};
    const Status status = load(part, bytes);
    EXPECT_NE(status.text.find("has layout 99, this build reads layout "), std::string::npos) << status.text;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, DamagedState,
                         ::testing::Values("single_cylinder.yaml", "truck_crane.yaml", "forces/tyres.yaml"),
                         [](const auto& test) {
                           const std::string file = test.param;
                           const std::size_t slash = file.find('/') + 1;
                           return file.substr(slash, file.find('.') - slash);
                         });

TEST(StateOfAnotherScene, IsRefusedByEveryPart) {
  const auto load = [](const char* file, const std::vector<std::string>& overrides = {}) {
    return scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/scenes/" + file, overrides);
  };
  const scene::Scene crane = load("truck_crane.yaml");
  const Drive drive;
  SessionChain chain(crane, drive);
  chain.start();
  const SavedParts saved = chain.save();
  for (const scene::Scene& scene :
       {load("two_dof_crane.yaml"), load("truck_crane.yaml", {"session.step=2 ms"}), load("truck_crane_flexible.yaml"),
        load("truck_crane.yaml", {"session.exchange_every=2"})}) {
    SessionChain other(scene, drive);
    for (const Role part : {Role::mechanics, Role::hydraulics}) {
      // the flexible crane has the same circuit
      if (scene.has_modes() && part == Role::hydraulics) continue;
      const Status status = other.part(part)->load(saved.at(part), other.sample(part));
      EXPECT_EQ(status.code, ExitCode::bad_input);
      EXPECT_NE(status.text.find("is of another scene"), std::string::npos) << status.text;
    }
  }
  // one part's for another's
  EXPECT_FALSE(chain.part(Role::mechanics)->load(saved.at(Role::hydraulics), chain.sample(Role::mechanics)).is_ok());
}

}  // namespace damaged_state_test
}  // namespace slew::testing
