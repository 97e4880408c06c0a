// What the nodes themselves say of a program that takes part in their session in the wrong way.
#include <dds/dds.h>
#include <gtest/gtest.h>

#include "build_paths.h"
#include "session.h"
#include "slewring.h"

namespace slew::testing {
namespace {

TEST(Misfit, ABestEffortControllerIsNamedByIo) {
  Session session({"--pace", "real", "--duration", "0", "--no-record"});
  for (const wire::Role role : {wire::Role::io, wire::Role::mechanics, wire::Role::hydraulics}) session.start(role);
  ASSERT_TRUE(session.observer().wait_for_step(10)) << session.said();
  const dds_entity_t participant = dds_create_participant(session.domain(), nullptr, nullptr);
  ASSERT_GT(participant, 0);
  dds_qos_t* qos = dds_create_qos();
  dds_qset_partition1(qos, ("slewring/" + session.observer().name()).c_str());
  dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
  const dds_entity_t topic =
      dds_create_topic(participant, &slewring_ControllerInput_desc, "slewring/controller_input", nullptr, nullptr);
  ASSERT_GT(topic, 0);
  ASSERT_GT(dds_create_writer(participant, topic, qos, nullptr), 0);
  EXPECT_TRUE(session.observer().wait_until([&] {
    return session.node(wire::Role::io)
               .err()
               .find(
                   "writes topic 'slewring/controller_input' with reliability best "
                   "effort, and reliable is asked for; it is not heard") != std::string::npos;
  })) << session.said();
  dds_delete_qos(qos);
  dds_delete(participant);
  EXPECT_TRUE(session.observer().request(wire::ControlAction::stop).is_accepted);
  for (const auto& [role, code] : session.wait_all()) EXPECT_EQ(code, 0) << session.said();
}

}  // namespace
}  // namespace slew::testing
