// SPDX-License-Identifier: Apache-2.0
// The nodes' messages about a program that takes part in their session in the wrong way.
#include <dds/dds.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "build_paths.h"
#include "session.h"
#include "slewring.h"

namespace slew::testing {
namespace misfit_test {

// every node looks for misfits behind each tenth of its health messages; one may come just behind such a look
constexpr std::uint64_t kHealthsUntilNamed = 20;

// A program that writes or reads a topic beside a session, in its partition unless a test changes that.
class Endpoint {
 public:
  enum class What : std::uint8_t { writer, reader };

  // problem: as a node reports it.
  Endpoint(What what, const dds_topic_descriptor_t& type, const std::string& name, const std::string& problem)
      : what_(what),
        type_(type),
        name_(name),
        sentence_(std::string(what == What::writer ? "writes" : "reads") + " topic '" + name + "' with " + problem +
                  (what == What::writer ? "; it is ignored" : "; it receives nothing")),
        qos_(dds_create_qos()) {
    dds_qset_reliability(qos_, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_partition1(qos_, "slewring/s");
  }
  ~Endpoint() {
    if (participant_ > 0) dds_delete(participant_);
    dds_delete_qos(qos_);
  }
  Endpoint(const Endpoint&) = delete;
  Endpoint& operator=(const Endpoint&) = delete;

  // A participant of its own, as each such program has.
  void create(std::uint32_t domain) {
    participant_ = dds_create_participant(domain, nullptr, nullptr);
    ASSERT_GT(participant_, 0);
    const dds_entity_t topic = dds_create_topic(participant_, &type_, name_.c_str(), nullptr, nullptr);
    ASSERT_GT(topic, 0);
    ASSERT_GT(what_ == What::writer ? dds_create_writer(participant_, topic, qos_, nullptr)
                                    : dds_create_reader(participant_, topic, qos_, nullptr),
              0);
  }
  [[nodiscard]] dds_qos_t* qos() noexcept { return qos_; }
  [[nodiscard]] const std::string& sentence() const noexcept { return sentence_; }

 private:
  What what_;
  dds_topic_descriptor_t type_;
  std::string name_;
  std::string sentence_;
  dds_qos_t* qos_;
  dds_entity_t participant_ = 0;
};

TEST(Misfits, AreNamedByIoAtItsSecondLookAtTheLatest) {
  using What = Endpoint::What;
  const std::string input = "slewring/controller_input";
  dds_topic_descriptor_t other_fields = slewring_ControlReply_desc;
  other_fields.m_typename = "slewring::ControllerInput";
  Endpoint best_effort(What::writer, slewring_ControllerInput_desc, input,
                       "reliability best effort, and the reader requests reliable");
  dds_qset_reliability(best_effort.qos(), DDS_RELIABILITY_BEST_EFFORT, 0);
  Endpoint outside(What::writer, slewring_ControllerInput_desc, input, "partition '', where 'slewring/s' is expected");
  dds_qset_partition(outside.qos(), 0, nullptr);
  Endpoint other_type(What::writer, slewring_NodeStatus_desc, input,
                      "type slewring::NodeStatus, which is slewring::ControllerInput here");
  Endpoint other_layout(What::writer, other_fields, input,
                        "type slewring::ControllerInput of another layout (built from another idl/slewring.idl)");
  Endpoint durable_reader(What::reader, slewring_Tick_desc, "slewring/tick",
                          "a durability above the one that the writer offers (volatile)");
  dds_qset_durability(durable_reader.qos(), DDS_DURABILITY_TRANSIENT_LOCAL);

  Session session({"--pace", "real", "--duration", "0", "--no-record"});
  for (const wire::Role role : {wire::Role::io, wire::Role::mechanics, wire::Role::hydraulics}) session.start(role);
  Observer& observer = session.observer();
  ASSERT_TRUE(observer.wait_for_step(10)) << session.errors();
  const std::uint64_t before = observer.healths(wire::Role::io);
  const auto endpoints = {&best_effort, &outside, &other_type, &other_layout, &durable_reader};
  for (Endpoint* endpoint : endpoints) ASSERT_NO_FATAL_FAILURE(endpoint->create(session.domain()));
  const auto is_named = [&](const Endpoint* endpoint) {
    return session.node(wire::Role::io).err().find(endpoint->sentence()) != std::string::npos;
  };
  const auto has_looked_twice = [&] { return observer.healths(wire::Role::io) > before + kHealthsUntilNamed; };
  ASSERT_TRUE(observer.wait_until([&] {
    return has_looked_twice() || std::all_of(endpoints.begin(), endpoints.end(), is_named);
  })) << session.errors();
  for (const Endpoint* endpoint : endpoints) {
    EXPECT_TRUE(is_named(endpoint)) << endpoint->sentence() << "\n" << session.errors();
  }
  EXPECT_TRUE(observer.request(wire::ControlAction::stop).is_accepted);
  for (const auto& [role, code] : session.wait_all()) EXPECT_EQ(code, 0) << session.errors();
}

}  // namespace misfit_test
}  // namespace slew::testing
