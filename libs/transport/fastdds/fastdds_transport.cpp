// SPDX-License-Identifier: Apache-2.0
#include "transport/fastdds/fastdds_transport.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <exception>
#include <utility>

#include "transport/fastdds/open_fastdds.h"
#include "transport/host_network.h"

namespace slew::transport {

static_assert(wire::kTopics < 31);

Status FastTransport::open(const Network& network) {
  if (Status status = check(endpoint_); !status.is_ok()) return status;
  if (Status status = open_participant(network, endpoint_.role, discovery_, participant_); !status.is_ok()) {
    return status;
  }
  const RepairTimes times = repair_times(network);
  try {
    for (std::size_t i = 0; i < wire::kTopics; ++i) {
      const auto topic = static_cast<wire::Topic>(i);
      if (endpoint_.writes.contains(topic)) {
        writers_[i] = std::make_unique<TopicWriter>(*participant_, traits(topic), endpoint_, times);
      }
      if (endpoint_.reads.contains(topic)) {
        readers_[i] = std::make_unique<TopicReader>(*participant_, traits(topic), endpoint_, times, doorbell_, 1u << i);
      }
    }
  } catch (const std::exception& error) {
    if (network.security) {
      return Status::error(
          ExitCode::bad_input,
          fmt::format("the keys of this process do not allow it the DDS {} of this session; nothing was "
                      "started; 'slewring keys check' checks them; keys for other sessions and roles "
                      "are made with 'slewring keys add'{}",
                      error.what(), last_message()));
    }
    return Status::error(ExitCode::resources, fmt::format("cannot create the DDS {}{}", error.what(), last_message()));
  }
  return Status::ok();
}

FastTransport::~FastTransport() {
  if (taken_ != nullptr) SamplePool::give_back(taken_);
  // the last messages should arrive, but a partner that has died must not delay the end
  const std::int64_t deadline = monotonic_ns() + kFarewell.ns;
  for (const auto& writer : writers_) {
    if (writer != nullptr) {
      writer->wait_for_acknowledgements({std::max<std::int64_t>(0, deadline - monotonic_ns())});
    }
  }
}

Status FastTransport::publish(wire::Topic topic, std::span<const std::byte> bytes) noexcept {
  const auto& writer = writers_[static_cast<std::size_t>(topic)];
  if (writer == nullptr) {
    return Status::error(ExitCode::failed, fmt::format("internal error: {} publishes on the undeclared topic {}",
                                                       endpoint_.role, traits(topic).name));
  }
  if (writer->write(bytes)) return Status::ok();
  return Status::error(ExitCode::failed,
                       fmt::format("message on {} not sent within {} ms; the network or a reader is stuck",
                                   traits(topic).name, kMaxBlocking.ns / 1'000'000));
}

// lowest topic first
bool FastTransport::take(Received& message) {
  if (taken_ != nullptr) SamplePool::give_back(std::exchange(taken_, nullptr));
  pending_ |= doorbell_.collect();
  while (pending_ != 0) {
    const int topic = std::countr_zero(pending_);
    ReceivedSample sample;
    if (readers_[static_cast<std::size_t>(topic)]->take(sample)) {
      taken_ = sample.bytes;
      const bool is_input = static_cast<wire::Topic>(topic) == wire::Topic::controller_input;
      message = {
          static_cast<wire::Topic>(topic), {sample.bytes, sample.size}, sample.source_ns, is_input ? sample.writer : 0};
      return true;
    }
    pending_ &= ~(1u << topic);
  }
  return false;
}

WriterSight FastTransport::see_writer(wire::Topic topic, std::uint64_t writer) {
  return discovery_.see_writer(topic, writer);
}

void FastTransport::wait_until(std::int64_t monotonic_deadline_ns) {
  if (pending_ == 0) doorbell_.wait_until(monotonic_deadline_ns);
  pending_ |= doorbell_.collect();
}

std::vector<std::string> FastTransport::discovered_writers(wire::Topic topic) {
  return discovery_.writers(topic, endpoint_.session);
}

std::vector<std::string> FastTransport::misfits() {
  return discovery_.misfits(endpoint_);
}

std::size_t FastTransport::matched_readers(wire::Topic topic) const {
  const auto& writer = writers_[static_cast<std::size_t>(topic)];
  return writer == nullptr ? 0 : discovery_.fitting(writer->matched_readers(), endpoint_);
}

}  // namespace slew::transport

extern "C" __attribute__((visibility("default"))) void slewring_open_fastdds(
    const slew::transport::Network& network, const slew::transport::Endpoint& endpoint,
    std::unique_ptr<slew::transport::Transport>& transport, slew::Status& status) {
  auto opened = std::make_unique<slew::transport::FastTransport>(endpoint);
  status = opened->open(network);
  if (status.is_ok()) transport = std::move(opened);
}
