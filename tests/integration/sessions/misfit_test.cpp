// What the nodes themselves say of a program that takes part in their session in the wrong way.
#include <dds/dds.h>
#include <gtest/gtest.h>

#include "build_paths.h"
#include "session.h"
#include "slewring.h"

namespace slew::testing {
namespace {

// every node looks for misfits behind each tenth of its health messages; one may come just behind such a look
constexpr std::uint64_t kHealthsUntilNamed = 20;

// A program that writes or reads a topic beside a session, in its partition unless a test says otherwise.
class Misfit : public ::testing::Test {
 protected:
  Misfit() : qos_(dds_create_qos()) {
    for (const wire::Role role : {wire::Role::io, wire::Role::mechanics, wire::Role::hydraulics}) session_.start(role);
    dds_qset_reliability(qos_, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_partition1(qos_, "slewring/s");
  }
  ~Misfit() override { dds_delete_qos(qos_); }

  enum class What : std::uint8_t { writer, reader };

  // by io, at its second look at the latest
  void expect_named(What what, const dds_topic_descriptor_t& type, const std::string& name,
                    const std::string& problem) {
    Observer& observer = session_.observer();
    ASSERT_TRUE(observer.wait_for_step(10)) << session_.said();
    const dds_entity_t participant = dds_create_participant(session_.domain(), nullptr, nullptr);
    ASSERT_GT(participant, 0);
    const dds_entity_t topic = dds_create_topic(participant, &type, name.c_str(), nullptr, nullptr);
    ASSERT_GT(topic, 0);
    const std::uint64_t before = observer.healths(wire::Role::io);
    const dds_entity_t endpoint = what == What::writer ? dds_create_writer(participant, topic, qos_, nullptr)
                                                       : dds_create_reader(participant, topic, qos_, nullptr);
    ASSERT_GT(endpoint, 0);
    const std::string told = std::string(what == What::writer ? "writes" : "reads") + " topic '" + name + "' with " +
                             problem + (what == What::writer ? "; it is not heard" : "; it hears nothing");
    const auto is_named = [&] { return session_.node(wire::Role::io).err().find(told) != std::string::npos; };
    const auto has_looked_twice = [&] { return observer.healths(wire::Role::io) > before + kHealthsUntilNamed; };
    ASSERT_TRUE(observer.wait_until([&] { return is_named() || has_looked_twice(); })) << session_.said();
    EXPECT_TRUE(is_named()) << session_.said();
    dds_delete(participant);
    EXPECT_TRUE(observer.request(wire::ControlAction::stop).is_accepted);
    for (const auto& [role, code] : session_.wait_all()) EXPECT_EQ(code, 0) << session_.said();
  }
  void expect_controller_named(const std::string& problem) {
    expect_named(What::writer, slewring_ControllerInput_desc, "slewring/controller_input", problem);
  }

  Session session_{{"--pace", "real", "--duration", "0", "--no-record"}};
  dds_qos_t* qos_;
};

TEST_F(Misfit, ABestEffortControllerIsNamedByIo) {
  dds_qset_reliability(qos_, DDS_RELIABILITY_BEST_EFFORT, 0);
  expect_controller_named("reliability best effort, and reliable is asked for");
}

TEST_F(Misfit, AControllerOutsideOfTheSessionsPartitionIsNamedByIo) {
  dds_qset_partition(qos_, 0, nullptr);
  expect_controller_named("partition '', where 'slewring/s' is expected");
}

TEST_F(Misfit, AControllerOfAnotherTypeIsNamedByIo) {
  expect_named(What::writer, slewring_NodeStatus_desc, "slewring/controller_input",
               "type slewring::NodeStatus, which is slewring::ControllerInput here");
}

TEST_F(Misfit, AControllerWithOtherFieldsIsNamedByIo) {
  dds_topic_descriptor_t type = slewring_ControlReply_desc;
  type.m_typename = "slewring::ControllerInput";
  expect_named(What::writer, type, "slewring/controller_input",
               "type slewring::ControllerInput of another layout (built from another idl/slewring.idl)");
}

TEST_F(Misfit, AReaderThatAsksForWhatWasSaidBeforeItIsNamedByIo) {
  dds_qset_durability(qos_, DDS_DURABILITY_TRANSIENT_LOCAL);
  expect_named(What::reader, slewring_Tick_desc, "slewring/tick",
               "a durability above the one that is offered (volatile)");
}

}  // namespace
}  // namespace slew::testing
