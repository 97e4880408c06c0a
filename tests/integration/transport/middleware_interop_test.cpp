// SPDX-License-Identifier: Apache-2.0
// Programs that depend only on idl/slewring.idl and Cyclone, in a process of their own, against every middleware.
#include <dds/dds.h>
#include <gtest/gtest.h>

#include <ostream>
#include <random>
#include <tuple>

#include "tests/integration/transport/child_process.h"
#include "tests/integration/transport/generated_types.h"
#include "tests/integration/transport/middlewares.h"
#include "tests/integration/transport/same_fields.h"
#include "tests/integration/transport/waiting.h"
#include "tests/support/random_message.h"
#include "transport/cdr/codec.h"
#include "transport/cyclone/cyclone_domain.h"

namespace slew::transport {
namespace middleware_interop_test {

using testing::ChildProcess;
using testing::eventually;
using wire::Topic;

constexpr int kCount = 300;  // messages
constexpr const char* kSession = "interop";

// A participant of generated types, as another program has it.
class TypedProgram {
 public:
  // `change` gets the QoS of publisher and subscriber
  explicit TypedProgram(
      std::uint32_t domain, void (*change)(dds_qos_t*) = [](dds_qos_t*) {}) {
    static_cast<void>(CycloneDomain::open({domain, "lo", {}}, domain_));
    participant_ = dds_create_participant(domain, nullptr, nullptr);
    dds_qos_t* partition = dds_create_qos();
    const char* names[] = {"slewring/interop"};
    dds_qset_partition(partition, 1, names);
    change(partition);
    publisher_ = dds_create_publisher(participant_, partition, nullptr);
    subscriber_ = dds_create_subscriber(participant_, partition, nullptr);
    dds_delete_qos(partition);
    qos_ = dds_create_qos();
    dds_qset_reliability(qos_, DDS_RELIABILITY_RELIABLE, DDS_SECS(10));
    dds_qset_history(qos_, DDS_HISTORY_KEEP_ALL, 0);
  }
  ~TypedProgram() {
    dds_delete_qos(qos_);
    dds_delete(participant_);
  }
  TypedProgram(const TypedProgram&) = delete;
  TypedProgram& operator=(const TypedProgram&) = delete;

  [[nodiscard]] dds_qos_t* qos() const noexcept { return qos_; }
  dds_entity_t reader(const dds_topic_descriptor_t& type, const char* name) const {
    return dds_create_reader(subscriber_, dds_create_topic(participant_, &type, name, nullptr, nullptr), qos_, nullptr);
  }
  dds_entity_t writer(const dds_topic_descriptor_t& type, const char* name) const {
    return dds_create_writer(publisher_, dds_create_topic(participant_, &type, name, nullptr, nullptr), qos_, nullptr);
  }

 private:
  std::shared_ptr<CycloneDomain> domain_;
  dds_entity_t participant_ = 0;
  dds_entity_t publisher_ = 0;
  dds_entity_t subscriber_ = 0;
  dds_qos_t* qos_ = nullptr;
};

bool has_match(dds_entity_t reader) {
  dds_subscription_matched_status_t status{};
  return dds_get_subscription_matched_status(reader, &status) == DDS_RETCODE_OK && status.current_count > 0;
}

bool has_reader(dds_entity_t writer) {
  dds_publication_matched_status_t status{};
  return dds_get_publication_matched_status(writer, &status) == DDS_RETCODE_OK && status.current_count > 0;
}

class Interop : public testing::OverMiddleware {};
INSTANTIATE_TEST_SUITE_P(Over, Interop, testing::kAllMiddlewares, testing::name_of);

// other program: reports ready, then reads typed messages and compares every field
bool read_typed_mechanism_messages(std::uint32_t domain) {
  const TypedProgram program(domain);
  const dds_entity_t reader = program.reader(slewring_MechanismMessage_desc, "slewring/mechanism");
  const dds_entity_t writer = program.writer(slewring_ControlRequest_desc, "slewring/control_request");
  if (!eventually([&] { return has_match(reader) && has_reader(writer); })) return false;
  slewring_ControlRequest ready{};
  if (dds_write(writer, &ready) != DDS_RETCODE_OK) return false;
  std::mt19937_64 random(21);
  for (int i = 0; i < kCount; ++i) {
    void* sample = nullptr;
    dds_sample_info_t about{};
    if (!eventually([&] { return dds_take(reader, &sample, &about, 1, 1) == 1 && about.valid_data; })) return false;
    const auto expected = testing::random_message<wire::MechanismMessage>(random, 16);
    if (!testing::same(*static_cast<slewring_MechanismMessage*>(sample), expected)) return false;
    dds_return_loan(reader, &sample, 1);
  }
  return true;
}

TEST_P(Interop, ATypedReaderOfAnotherProgramReadsEveryFieldOfWhatWeSend) {
  ChildProcess program([&] { return read_typed_mechanism_messages(domain_.number()); });
  const auto transport = connect({kSession, "mechanics", {Topic::mechanism}, {Topic::control_request}});
  ASSERT_NE(transport, nullptr);
  Received message;
  ASSERT_TRUE(testing::next(*transport, message));
  wire::ControlRequest ready;
  EXPECT_EQ(message.topic, Topic::control_request);
  EXPECT_TRUE(decode(message.bytes, ready));
  // the two sides discover each other independently
  ASSERT_TRUE(eventually([&] { return transport->matched_readers(Topic::mechanism) == 1; }));
  std::mt19937_64 random(21);
  ByteBuffer bytes;
  for (int i = 0; i < kCount; ++i) {
    ASSERT_TRUE(encode(testing::random_message<wire::MechanismMessage>(random, 16), bytes));
    ASSERT_TRUE(transport->publish(Topic::mechanism, bytes).is_ok());
  }
  EXPECT_EQ(program.wait(), 0);
}

// other program: writes typed messages once it has discovered the reader
bool write_typed_inputs(std::uint32_t domain) {
  const TypedProgram program(domain);
  const dds_entity_t writer = program.writer(slewring_ControllerInput_desc, "slewring/controller_input");
  const dds_entity_t done = program.reader(slewring_Tick_desc, "slewring/tick");
  if (!eventually([&] { return has_reader(writer) && has_match(done); })) return false;
  for (int i = 0; i < kCount; ++i) {
    slewring_ControllerInput input{};
    std::snprintf(input.session, sizeof input.session, "%s", kSession);
    std::snprintf(input.channel, sizeof input.channel, "Input_%d", i);
    input.action = slewring_CONTROLLER_RELEASE;
    input.value = 0.25 * i;
    input.sequence_number = static_cast<std::uint64_t>(i);
    input.based_on_step = -1;
    if (dds_write(writer, &input) != DDS_RETCODE_OK) return false;
  }
  // until the test has read everything
  void* sample = nullptr;
  dds_sample_info_t about{};
  return eventually([&] { return dds_take(done, &sample, &about, 1, 1) == 1; });
}

TEST_P(Interop, WeReadWhatATypedWriterOfAnotherProgramSends) {
  ChildProcess program([&] { return write_typed_inputs(domain_.number()); });
  const auto transport = connect({kSession, "io", {Topic::tick}, {Topic::controller_input}});
  ASSERT_NE(transport, nullptr);
  Received message;
  wire::ControllerInput input;
  for (int i = 0; i < kCount; ++i) {
    ASSERT_TRUE(testing::next(*transport, message));
    ASSERT_TRUE(decode(message.bytes, input));
    const wire::ControllerInput expected{kSession,
                                         "",
                                         "Input_" + std::to_string(i),
                                         wire::ControllerAction::release,
                                         0.25 * i,
                                         static_cast<std::uint64_t>(i),
                                         -1};
    ASSERT_TRUE(input == expected) << i;
    EXPECT_NE(message.source_ns, 0);
  }
  EXPECT_EQ(transport->discovered_writers(Topic::controller_input),
            std::vector<std::string>{"a program that is not of Slewring, type slewring::ControllerInput"});
  // the two sides discover each other independently
  ASSERT_TRUE(eventually([&] { return transport->matched_readers(Topic::tick) == 1; }));
  ByteBuffer bytes;
  ASSERT_TRUE(encode(wire::Tick{}, bytes));
  ASSERT_TRUE(transport->publish(Topic::tick, bytes).is_ok());
  EXPECT_EQ(program.wait(), 0);
}

// other program: a type of the right name and other fields
bool write_another_layout(std::uint32_t domain) {
  const TypedProgram program(domain);
  dds_topic_descriptor_t type = slewring_ControlReply_desc;
  type.m_typename = "slewring::Tick";
  const dds_entity_t writer = program.writer(type, "slewring/tick");
  if (writer < 0) return false;
  pause();  // until killed
  return true;
}

TEST(CycloneInterop, AWriterOfAnotherLayoutIsNamedAsSuch) {
  const testing::TestDomain domain;
  ChildProcess program([&] { return write_another_layout(domain.number()); });
  std::unique_ptr<Transport> transport;
  const Status status = open_transport(testing::network_of(domain, Middleware::cyclone),
                                       {kSession, "mechanics", {}, {Topic::tick}}, transport);
  ASSERT_TRUE(status.is_ok()) << status.text;
  std::vector<std::string> writers;
  ASSERT_TRUE(eventually([&] {
    writers = transport->discovered_writers(Topic::tick);
    return !writers.empty();
  }));
  ASSERT_EQ(writers.size(), 1u);
  EXPECT_NE(writers[0].find("type slewring::Tick of another layout"), std::string::npos) << writers[0];
}

// other program: endpoints that can not match, and one that can
bool take_part_wrongly(std::uint32_t domain) {
  TypedProgram program(domain);
  const dds_entity_t fits = program.writer(slewring_ActuatorMessage_desc, "slewring/actuators");
  static_cast<void>(program.writer(slewring_NodeStatus_desc, "slewring/tick"));
  // reliable, but volatile where the session keeps messages for late readers
  static_cast<void>(program.writer(slewring_SessionDescription_desc, "slewring/session"));
  dds_qset_durability(program.qos(), DDS_DURABILITY_TRANSIENT_LOCAL);
  static_cast<void>(program.reader(slewring_ControlRequest_desc, "slewring/control_request"));
  dds_qset_durability(program.qos(), DDS_DURABILITY_VOLATILE);
  dds_qset_reliability(program.qos(), DDS_RELIABILITY_BEST_EFFORT, 0);
  static_cast<void>(program.writer(slewring_MechanismMessage_desc, "slewring/mechanism"));
  dds_qset_reliability(program.qos(), DDS_RELIABILITY_RELIABLE, DDS_SECS(10));
  const dds_entity_t done = program.reader(slewring_Health_desc, "slewring/health");
  if (!eventually([&] { return has_reader(fits) && has_match(done); })) return false;
  slewring_ActuatorMessage ready{};
  if (dds_write(fits, &ready) != DDS_RETCODE_OK) return false;
  void* sample = nullptr;
  dds_sample_info_t about{};
  return eventually([&] { return dds_take(done, &sample, &about, 1, 1) == 1; });
}

TEST_P(Interop, AnEndpointWithTheWrongTypeOrQosIsNamed) {
  ChildProcess program([&] { return take_part_wrongly(domain_.number()); });
  const auto transport = connect({kSession,
                                  "observer",
                                  {Topic::control_request, Topic::health},
                                  {Topic::tick, Topic::mechanism, Topic::actuators, Topic::session}});
  ASSERT_NE(transport, nullptr);
  std::vector<std::string> misfits;
  ASSERT_TRUE(eventually([&] {
    misfits = transport->misfits();
    return misfits.size() >= 4;
  }));
  const std::string program_name = "a program that is not of Slewring ";
  EXPECT_EQ(
      misfits,
      (std::vector<std::string>{
          program_name + "reads topic 'slewring/control_request' with a durability above the one that the writer "
                         "offers (volatile); "
                         "it receives nothing; see idl/README.md",
          program_name +
              "writes topic 'slewring/mechanism' with reliability best effort, and the reader requests reliable; it is "
              "ignored; see idl/README.md",
          program_name +
              "writes topic 'slewring/session' with a durability below the one that the reader requests (transient "
              "local); it is ignored; see idl/README.md",
          program_name +
              "writes topic 'slewring/tick' with type slewring::NodeStatus, which is slewring::Tick here; it is "
              "ignored; see idl/README.md"}));
  // the two sides discover each other independently
  Received ready;
  ASSERT_TRUE(testing::next(*transport, ready));
  EXPECT_EQ(ready.topic, Topic::actuators);
  ASSERT_TRUE(eventually([&] { return transport->matched_readers(Topic::health) > 0; }));
  ByteBuffer bytes;
  ASSERT_TRUE(encode(wire::Health{}, bytes));
  ASSERT_TRUE(transport->publish(Topic::health, bytes).is_ok());
  EXPECT_EQ(program.wait(), 0);
}

// A reader that requests more than our writers offer, or a writer that offers less than our readers request.
struct QosMisfit {
  const char* name;
  bool is_writer;
  void (*change)(dds_qos_t* qos);
  const char* problem;
};
// in the names of tests
void PrintTo(const QosMisfit& misfit, std::ostream* out) {
  *out << misfit.name;
}

bool take_part_with(std::uint32_t domain, const QosMisfit& misfit) {
  TypedProgram program(domain, misfit.change);
  misfit.change(program.qos());
  const dds_entity_t made = misfit.is_writer ? program.writer(slewring_Tick_desc, "slewring/tick")
                                             : program.reader(slewring_ControlRequest_desc, "slewring/control_request");
  if (made < 0) return false;
  pause();  // until killed
  return true;
}

class ForeignQos : public ::testing::TestWithParam<std::tuple<Middleware, QosMisfit>> {
 protected:
  void SetUp() override { testing::need(std::get<0>(GetParam())); }
  [[nodiscard]] static const QosMisfit& misfit() { return std::get<1>(GetParam()); }
};

TEST_P(ForeignQos, ThatDoesNotFitIsNamed) {
  const testing::TestDomain domain;
  ChildProcess program([&] { return take_part_with(domain.number(), misfit()); });
  std::unique_ptr<Transport> transport;
  const Status status = open_transport(testing::network_of(domain, std::get<0>(GetParam())),
                                       {kSession, "observer", {Topic::control_request}, {Topic::tick}}, transport);
  ASSERT_TRUE(status.is_ok()) << status.text;
  std::vector<std::string> misfits;
  EXPECT_TRUE(eventually([&] {
    misfits = transport->misfits();
    return !misfits.empty();
  }));
  const std::string does =
      misfit().is_writer ? "writes topic 'slewring/tick' with " : "reads topic 'slewring/control_request' with ";
  const std::string so = misfit().is_writer ? "; it is ignored" : "; it receives nothing";
  EXPECT_EQ(misfits, std::vector<std::string>{"a program that is not of Slewring " + does + misfit().problem + so +
                                              "; see idl/README.md"});
  EXPECT_EQ(transport->matched_readers(Topic::control_request), 0u);
}

std::string name_of(const ::testing::TestParamInfo<std::tuple<Middleware, QosMisfit>>& info) {
  return testing::text_of(std::get<0>(info.param)) + std::get<1>(info.param).name;
}

INSTANTIATE_TEST_SUITE_P(
    Of, ForeignQos,
    ::testing::Combine(
        ::testing::Values(Middleware::cyclone, Middleware::fastdds),
        ::testing::Values(
            QosMisfit{"Deadline", false, [](dds_qos_t* qos) { dds_qset_deadline(qos, DDS_MSECS(100)); },
                      "a deadline shorter than the one that the writer offers (none is expected)"},
            QosMisfit{"LatencyBudget", true, [](dds_qos_t* qos) { dds_qset_latency_budget(qos, DDS_MSECS(1)); },
                      "a latency budget above the one that the reader requests (0 is expected)"},
            QosMisfit{"LivelinessKind", false,
                      [](dds_qos_t* qos) { dds_qset_liveliness(qos, DDS_LIVELINESS_MANUAL_BY_TOPIC, DDS_INFINITY); },
                      "another kind of liveliness (automatic is expected)"},
            QosMisfit{"LivelinessLease", false,
                      [](dds_qos_t* qos) { dds_qset_liveliness(qos, DDS_LIVELINESS_AUTOMATIC, DDS_MSECS(500)); },
                      "a lease of its liveliness shorter than the one that the writer offers (none is expected)"},
            QosMisfit{"DestinationOrder", false,
                      [](dds_qos_t* qos) { dds_qset_destination_order(qos, DDS_DESTINATIONORDER_BY_SOURCE_TIMESTAMP); },
                      "another destination order (by reception timestamp is expected)"},
            QosMisfit{"PresentationScope", false,
                      [](dds_qos_t* qos) { dds_qset_presentation(qos, DDS_PRESENTATION_TOPIC, false, false); },
                      "another presentation (access scope instance, neither coherent nor ordered, is expected)"},
            QosMisfit{"PresentationOrder", false,
                      [](dds_qos_t* qos) { dds_qset_presentation(qos, DDS_PRESENTATION_INSTANCE, false, true); },
                      "another presentation (access scope instance, neither coherent nor ordered, is expected)"})),
    name_of);

}  // namespace middleware_interop_test
}  // namespace slew::transport
