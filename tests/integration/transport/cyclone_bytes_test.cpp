// SPDX-License-Identifier: Apache-2.0
// Our encoder and decoder against Cyclone's own serialisation of the generated types: two independent ways to the same
// bytes.
#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/integration/transport/generated_types.h"
#include "tests/integration/transport/same_fields.h"
#include "tests/support/random_message.h"
#include "tests/support/test_domain.h"
#include "transport/cdr/codec.h"
#include "transport/cyclone/cyclone_domain.h"
#include "transport/topics.h"

namespace slew::transport {
namespace cyclone_bytes_test {

// Cyclone's serialiser for one generated type: that of a typed reader's samples.
template <typename P>
class Serialiser {
 public:
  Serialiser() {
    EXPECT_TRUE(CycloneDomain::open({domain_number_.number(), "lo", {}}, domain_).is_ok());
    participant_ = dds_create_participant(domain_number_.number(), nullptr, nullptr);
    const dds_entity_t topic = dds_create_topic(participant_, P::kDescriptor, "bytes", nullptr, nullptr);
    const dds_entity_t reader = dds_create_reader(participant_, topic, nullptr, nullptr);
    const dds_entity_t writer = dds_create_writer(participant_, topic, nullptr, nullptr);
    typename P::Generated sample{};
    fill_pointers(sample);
    EXPECT_EQ(dds_write(writer, &sample), DDS_RETCODE_OK);
    dds_sample_info_t about{};
    EXPECT_EQ(dds_takecdr(reader, &first_, 1, &about, DDS_ANY_STATE), 1);
  }
  ~Serialiser() {
    ddsi_serdata_unref(first_);
    dds_delete(participant_);
  }

  // false when Cyclone refuses the bytes
  [[nodiscard]] bool decode_into(Bytes bytes, typename P::Generated& sample) const {
    const ddsrt_iovec_t part{const_cast<std::byte*>(bytes.data()), bytes.size()};
    ddsi_serdata* data = ddsi_serdata_from_ser_iov(first_->type, SDK_DATA, 1, &part, bytes.size());
    if (data == nullptr) return false;
    const bool is_good = ddsi_serdata_to_sample(data, &sample, nullptr, nullptr);
    ddsi_serdata_unref(data);
    return is_good;
  }

  [[nodiscard]] ByteBuffer encoded(const typename P::Generated& sample) const {
    ddsi_serdata* data = ddsi_serdata_from_sample(first_->type, SDK_DATA, &sample);
    ByteBuffer bytes(ddsi_serdata_size(data));
    ddsi_serdata_to_ser(data, 0, bytes.size(), bytes.data());
    ddsi_serdata_unref(data);
    return bytes;
  }

  void release(typename P::Generated& sample) const { dds_sample_free(&sample, P::kDescriptor, DDS_FREE_CONTENTS); }

 private:
  static void fill_pointers(slewring_SessionDescription& sample) { sample.scene_text = empty_text_; }
  template <typename G>
  static void fill_pointers(G&) {}

  static inline char empty_text_[1] = "";
  testing::TestDomain domain_number_;
  std::shared_ptr<CycloneDomain> domain_;
  dds_entity_t participant_ = 0;
  ddsi_serdata* first_ = nullptr;
};

template <typename P>
class BytesOf : public ::testing::Test {};

using Pairs = ::testing::Types<testing::SessionDescriptionPair, testing::NodeStatusPair, testing::TickPair,
                               testing::MechanismPair, testing::ActuatorPair, testing::FlexiblePair,
                               testing::ElasticPair, testing::PosePair, testing::SensorPair, testing::DirectoryPair,
                               testing::BlockPair, testing::InputPair, testing::LeasePair, testing::RequestPair,
                               testing::ReplyPair, testing::HealthPair, testing::ResendPair, testing::StatePair>;
TYPED_TEST_SUITE(BytesOf, Pairs);

TYPED_TEST(BytesOf, ArriveFieldByFieldInTheGeneratedTypeAndComeBackTheSame) {
  using Message = typename TypeParam::Message;
  const Serialiser<TypeParam> cyclone;
  std::mt19937_64 random(11);
  ByteBuffer bytes;
  for (std::size_t i = 0; i < 300; ++i) {
    const auto message = testing::random_message<Message>(random, i < 280 ? i % 40 : 5000);
    ASSERT_TRUE(encode(message, bytes));
    typename TypeParam::Generated generated{};
    ASSERT_TRUE(cyclone.decode_into(bytes, generated));
    EXPECT_TRUE(testing::same(generated, message));
    EXPECT_EQ(cyclone.encoded(generated), bytes);
    cyclone.release(generated);
  }
}

// a difference between the two decoders would be a hole in the contract
TYPED_TEST(BytesOf, WhatWeAcceptCycloneAcceptsToo) {
  using Message = typename TypeParam::Message;
  const Serialiser<TypeParam> cyclone;
  std::mt19937_64 random(12);
  ByteBuffer bytes;
  Message received;
  int accepted = 0;
  for (int i = 0; i < 2000; ++i) {
    ASSERT_TRUE(encode(testing::random_message<Message>(random, 6), bytes));
    bytes[4 + random() % (bytes.size() - 4)] = static_cast<std::byte>(random());
    if (!decode(bytes, received)) continue;
    ++accepted;
    typename TypeParam::Generated generated{};
    ASSERT_TRUE(cyclone.decode_into(bytes, generated));
    EXPECT_TRUE(testing::same(generated, received) || !(received == received));
    cyclone.release(generated);
  }
  EXPECT_GT(accepted, 0);
}

TEST(IdlCaps, AreTheConstantsOfTheMessages) {
  EXPECT_EQ(slewring_kProtocolVersion, wire::kProtocolVersion);
  EXPECT_EQ(slewring_kMaxPorts, coupling::kMaxPorts);
  EXPECT_EQ(slewring_kMaxPortPairs, coupling::PortMatrix::capacity());
  EXPECT_EQ(slewring_kMaxPoseNumbers, coupling::kMaxSensedBodies * coupling::kPoseNumbers);
  EXPECT_EQ(slewring_kMaxSensorEvents, coupling::kMaxSensorEvents);
  EXPECT_EQ(slewring_kMaxChannels, wire::kMaxChannels);
  EXPECT_EQ(slewring_kMaxCommandsPerTick, wire::kMaxCommandsPerTick);
  EXPECT_EQ(slewring_kMaxVariablesPerBlock, wire::kMaxVariablesPerBlock);
  EXPECT_EQ(slewring_kMaxVariables, wire::kMaxVariables);
  EXPECT_EQ(slewring_kMaxHeard, wire::kMaxHeard);
  EXPECT_EQ(slewring_kMaxAssets, wire::kMaxAssets);
  EXPECT_EQ(slewring_kMaxNameLength, wire::kMaxNameLength);
  EXPECT_EQ(slewring_kMaxReasonLength, wire::kMaxReasonLength);
  EXPECT_EQ(slewring_kMaxSceneBytes, wire::kMaxSceneBytes);
  EXPECT_EQ(slewring_kTickEnd, static_cast<unsigned>(wire::TickFlag::end));
  EXPECT_EQ(slewring_kTickFault, static_cast<unsigned>(wire::TickFlag::fault));
  EXPECT_EQ(slewring_kTickShedView, static_cast<unsigned>(wire::TickFlag::shed_view));
  EXPECT_EQ(slewring_kTickShedVariables, static_cast<unsigned>(wire::TickFlag::shed_variables));
}

TYPED_TEST(BytesOf, TheTopicHasTheTypeOfTheIdl) {
  EXPECT_STREQ(traits(kTopicOf<typename TypeParam::Message>).type_name, TypeParam::kDescriptor->m_typename);
}

}  // namespace cyclone_bytes_test
}  // namespace slew::transport
