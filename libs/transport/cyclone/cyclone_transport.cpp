// SPDX-License-Identifier: Apache-2.0
#include "transport/cyclone/cyclone_transport.h"

#include <dds/dds.h>
#include <fmt/format.h>
#include <slewring.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "transport/cyclone/cyclone_qos.h"
#include "transport/cyclone/cyclone_sertype.h"
#include "transport/discovered_endpoint.h"
#include "transport/host_network.h"

namespace slew::transport {
namespace {

static_assert(wire::kTopics < 31);

// in the order of wire::Topic
constexpr std::array<const dds_topic_descriptor_t*, wire::kTopics> kDescriptors = {
    &slewring_SessionDescription_desc,
    &slewring_NodeStatus_desc,
    &slewring_Tick_desc,
    &slewring_MechanismMessage_desc,
    &slewring_ActuatorMessage_desc,
    &slewring_FlexibleMessage_desc,
    &slewring_ElasticMessage_desc,
    &slewring_VariableDirectory_desc,
    &slewring_VariableBlock_desc,
    &slewring_ControllerInput_desc,
    &slewring_ControllerLease_desc,
    &slewring_ControlRequest_desc,
    &slewring_ControlReply_desc,
    &slewring_Health_desc,
    &slewring_ResendRequest_desc,
    &slewring_StatePart_desc,
    &slewring_StatePart_desc,
    &slewring_PoseMessage_desc,
    &slewring_SensorMessage_desc,
};

[[nodiscard]] Qos partition_qos(const std::string& session) {
  Qos qos(dds_create_qos());
  const std::string partition = partition_of(session);
  const char* names[] = {partition.c_str()};
  dds_qset_partition(qos.get(), 1, names);
  return qos;
}

[[nodiscard]] Qos endpoint_qos(const TopicTraits& topic) {
  const std::int32_t kept = kept_by_writer(topic);
  Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, kMaxBlocking.ns);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, topic.depth);
  if (kept > 0) {
    dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, kept, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED);
  }
  dds_qset_writer_data_lifecycle(qos.get(), /*autodispose=*/false);
  dds_qset_ignorelocal(qos.get(), DDS_IGNORELOCAL_PARTICIPANT);
  const dds_data_representation_id_t representation = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(qos.get(), 1, &representation);
  return qos;
}

constexpr std::int64_t kClockLook = 50'000'000;  // between two checks of the wall clock [ns]
constexpr std::int64_t kClockStep =
    20'000'000;  // the clock was set back when it is behind by more; slewing is far slower

// Cyclone announces name and number of each process in the whole domain, before keys are agreed on. A participant's own
// properties replace them, and empty ones are not sent.
[[nodiscard]] Qos participant_qos(bool is_secured) {
  Qos qos(dds_create_qos());
  if (!is_secured) return qos;
  for (const char* property : {"__ProcessName", "__Pid", "__Hostname"}) dds_qset_prop(qos.get(), property, "");
  return qos;
}

// "; " and Cyclone's last message, if there is one
[[nodiscard]] std::string last_message(CycloneDomain& domain) {
  const std::string line = domain.log().last_line();
  return line.empty() ? line : "; " + line;
}

[[nodiscard]] Status creation_error(const char* what, dds_return_t code, CycloneDomain& domain) {
  if (code == DDS_RETCODE_NOT_ALLOWED_BY_SECURITY) {
    return Status::error(ExitCode::bad_input,
                         fmt::format("the keys of this process do not allow it the DDS {} of this session; nothing was "
                                     "started; 'slewring keys check' checks them; keys for other "
                                     "sessions and roles are made with 'slewring keys add'{}",
                                     what, last_message(domain)));
  }
  return Status::error(ExitCode::resources,
                       fmt::format("cannot create the DDS {}: {}{}", what, dds_strretcode(code), last_message(domain)));
}

// on Cyclone's receiving thread
void on_data_available(dds_entity_t, void* bell) {
  const TopicBell& topic = *static_cast<const TopicBell*>(bell);
  topic.doorbell->ring(topic.bit);
}

}  // namespace

CycloneTransport::CycloneTransport(std::shared_ptr<CycloneDomain> domain, Endpoint options)
    : domain_(std::move(domain)), options_(std::move(options)) {}

Status CycloneTransport::open(const Network& network, const Endpoint& options,
                              std::unique_ptr<CycloneTransport>& transport) {
  std::shared_ptr<CycloneDomain> domain;
  if (Status status = CycloneDomain::open(network, domain); !status.is_ok()) return status;
  return open(std::move(domain), options, transport);
}

Status CycloneTransport::open(std::shared_ptr<CycloneDomain> domain, const Endpoint& options,
                              std::unique_ptr<CycloneTransport>& transport) {
  if (Status status = check(options); !status.is_ok()) return status;
  std::unique_ptr<CycloneTransport> opened(new CycloneTransport(std::move(domain), options));
  if (Status status = opened->create(); !status.is_ok()) return status;
  transport = std::move(opened);
  return Status::ok();
}

Status CycloneTransport::create() {
  const Qos described = participant_qos(domain_->is_secured());
  participant_ = dds_create_participant(domain_->number(), described.get(), nullptr);
  if (participant_ < 0 && domain_->is_secured()) {
    return Status::error(
        ExitCode::bad_input,
        fmt::format("the keys of this process are not valid; nothing was started; 'slewring keys check' "
                    "lists their problems{}",
                    last_message(*domain_)));
  }
  if (participant_ < 0) return creation_error("participant", participant_, *domain_);
  const Qos partition = partition_qos(options_.session);
  const dds_entity_t publisher = dds_create_publisher(participant_, partition.get(), nullptr);
  if (publisher < 0) return creation_error("publisher", publisher, *domain_);
  const dds_entity_t subscriber = dds_create_subscriber(participant_, partition.get(), nullptr);
  if (subscriber < 0) return creation_error("subscriber", subscriber, *domain_);
  for (std::size_t i = 0; i < wire::kTopics; ++i) {
    const auto topic = static_cast<wire::Topic>(i);
    if (!options_.writes.contains(topic) && !options_.reads.contains(topic)) continue;
    if (Status status = create_endpoints(topic, publisher, subscriber); !status.is_ok()) return status;
  }
  return Status::ok();
}

Status CycloneTransport::create_endpoints(wire::Topic topic, std::int32_t publisher, std::int32_t subscriber) {
  const auto i = static_cast<std::size_t>(topic);
  const std::size_t room =
      kInFlight + (options_.writes.contains(topic) ? static_cast<std::size_t>(traits(topic).depth) : 0);
  const dds_entity_t handle = create_raw_topic(participant_, *kDescriptors[i], traits(topic).name, room, types_[i]);
  if (handle < 0) return creation_error(traits(topic).name, handle, *domain_);
  const Qos qos = endpoint_qos(traits(topic));
  if (options_.writes.contains(topic)) {
    const std::string user_data = own_user_data(options_.role);
    dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
    writers_[i] = dds_create_writer(publisher, handle, qos.get(), nullptr);
    if (writers_[i] < 0) return creation_error(traits(topic).name, writers_[i], *domain_);
  }
  if (options_.reads.contains(topic)) {
    bells_[i] = {&doorbell_, 1u << i};
    dds_listener_t* listener = dds_create_listener(nullptr);
    dds_lset_data_available_arg(listener, on_data_available, &bells_[i], /*reset_on_invoke=*/true);
    // without keys a reader's depth is that of all its writers together
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, depth_of_reader(traits(topic)));
    if (!receives_kept(options_, traits(topic))) dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
    readers_[i] = dds_create_reader(subscriber, handle, qos.get(), listener);
    dds_delete_listener(listener);
    if (readers_[i] < 0) return creation_error(traits(topic).name, readers_[i], *domain_);
  }
  return Status::ok();
}

CycloneTransport::~CycloneTransport() {
  if (taken_ != nullptr) ddsi_serdata_unref(taken_);
  for (; batch_next_ < batch_count_; ++batch_next_) ddsi_serdata_unref(batch_[batch_next_]);
  // the last messages should arrive, but a partner that has died must not delay the end
  const std::int64_t deadline = monotonic_ns() + kFarewell.ns;
  for (const dds_entity_t writer : writers_) {
    if (writer > 0) dds_wait_for_acks(writer, std::max<std::int64_t>(0, deadline - monotonic_ns()));
  }
  if (participant_ > 0) dds_delete(participant_);
}

Status CycloneTransport::publish(wire::Topic topic, std::span<const std::byte> bytes) noexcept {
  const auto i = static_cast<std::size_t>(topic);
  if (writers_[i] <= 0) {
    return Status::error(ExitCode::failed, fmt::format("internal error: {} publishes on the undeclared topic {}",
                                                       options_.role, traits(topic).name));
  }
  const dds_return_t code = dds_writecdr(writers_[i], make_sample(*types_[i], bytes));
  if (code == DDS_RETCODE_OK) return Status::ok();
  return Status::error(ExitCode::failed,
                       fmt::format("message on {} not sent within {} ms: {}; the network or a reader is stuck",
                                   traits(topic).name, kMaxBlocking.ns / 1'000'000, dds_strretcode(code)));
}

bool CycloneTransport::take(Received& message) {
  if (taken_ != nullptr) ddsi_serdata_unref(std::exchange(taken_, nullptr));
  if (batch_next_ == batch_count_ && !refill()) return false;
  const std::size_t i = batch_next_++;
  taken_ = batch_[i];
  message = {batch_topic_, bytes_of(*taken_), batch_source_ns_[i], batch_writer_[i]};
  return true;
}

// takes the next messages of a topic that has rung, lowest topic first; false when there are none
bool CycloneTransport::refill() {
  look_at_the_clock();
  pending_ |= doorbell_.collect();
  while (pending_ != 0) {
    const int topic = std::countr_zero(pending_);
    std::array<ddsi_serdata*, kBatch> samples{};
    std::array<dds_sample_info_t, kBatch> about{};
    const dds_return_t n =
        dds_takecdr(readers_[static_cast<std::size_t>(topic)], samples.data(), kBatch, about.data(), DDS_ANY_STATE);
    if (n < static_cast<dds_return_t>(kBatch)) pending_ &= ~(1u << topic);
    batch_topic_ = static_cast<wire::Topic>(topic);
    batch_next_ = 0;
    batch_count_ = 0;
    for (std::size_t i = 0; n > 0 && i < static_cast<std::size_t>(n); ++i) {
      // a sample without data: a writer has left
      if (!about[i].valid_data) {
        ddsi_serdata_unref(samples[i]);
        continue;
      }
      batch_[batch_count_] = samples[i];
      batch_source_ns_[batch_count_] = about[i].source_timestamp;
      batch_writer_[batch_count_] = writer_of(batch_topic_, about[i].publication_handle);
      ++batch_count_;
    }
    if (batch_count_ > 0) return true;
  }
  return false;
}

void CycloneTransport::look_at_the_clock() noexcept {
  const std::int64_t now_ns = monotonic_ns();
  if (now_ns < next_look_ns_) return;
  next_look_ns_ = now_ns + kClockLook;
  const std::int64_t ahead_ns = wall_clock_ns() - now_ns;
  if (ahead_ns + kClockStep < wall_ahead_ns_) domain_->wake_timers();
  wall_ahead_ns_ = ahead_ns;
}

void CycloneTransport::wait_until(std::int64_t monotonic_deadline_ns) {
  if (batch_next_ < batch_count_) return;
  if (pending_ == 0) doorbell_.wait_until(monotonic_deadline_ns);
  pending_ |= doorbell_.collect();
}

std::size_t CycloneTransport::matched_readers(wire::Topic topic) const {
  dds_publication_matched_status_t status{};
  const dds_entity_t writer = writers_[static_cast<std::size_t>(topic)];
  if (writer <= 0 || dds_get_publication_matched_status(writer, &status) != DDS_RETCODE_OK) return 0;
  return status.current_count;
}

}  // namespace slew::transport
