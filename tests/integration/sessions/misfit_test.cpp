// What the nodes themselves say of a program that takes part in their session in the wrong way.
#include <dds/dds.h>
#include <gtest/gtest.h>

#include "build_paths.h"
#include "session.h"
#include "slewring.h"

namespace slew::testing {
namespace {

// A program that writes controller inputs beside a session.
class Misfit : public ::testing::Test {
 protected:
  Misfit() : qos_(dds_create_qos()) {
    for (const wire::Role role : {wire::Role::io, wire::Role::mechanics, wire::Role::hydraulics}) session_.start(role);
    dds_qset_reliability(qos_, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  }
  ~Misfit() override { dds_delete_qos(qos_); }

  void expect_named(const std::string& problem) {
    ASSERT_TRUE(session_.observer().wait_for_step(10)) << session_.said();
    const dds_entity_t participant = dds_create_participant(session_.domain(), nullptr, nullptr);
    ASSERT_GT(participant, 0);
    const dds_entity_t topic =
        dds_create_topic(participant, &slewring_ControllerInput_desc, "slewring/controller_input", nullptr, nullptr);
    ASSERT_GT(topic, 0);
    ASSERT_GT(dds_create_writer(participant, topic, qos_, nullptr), 0);
    EXPECT_TRUE(session_.observer().wait_until([&] {
      return session_.node(wire::Role::io)
                 .err()
                 .find("writes topic 'slewring/controller_input' with " + problem + "; it is not heard") !=
             std::string::npos;
    })) << session_.said();
    dds_delete(participant);
    EXPECT_TRUE(session_.observer().request(wire::ControlAction::stop).is_accepted);
    for (const auto& [role, code] : session_.wait_all()) EXPECT_EQ(code, 0) << session_.said();
  }

  Session session_{{"--pace", "real", "--duration", "0", "--no-record"}};
  dds_qos_t* qos_;
};

TEST_F(Misfit, ABestEffortControllerIsNamedByIo) {
  dds_qset_partition1(qos_, "slewring/s");
  dds_qset_reliability(qos_, DDS_RELIABILITY_BEST_EFFORT, 0);
  expect_named("reliability best effort, and reliable is asked for");
}

TEST_F(Misfit, AControllerOutsideOfTheSessionsPartitionIsNamedByIo) {
  expect_named("partition '', where 'slewring/s' is expected");
}

}  // namespace
}  // namespace slew::testing
