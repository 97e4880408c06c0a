// SPDX-License-Identifier: Apache-2.0
// The samples of one physics node: those of its partners by step, as long as they are needed, and its own, kept to be
// resent. node/exchange.h defines the samples that a role uses in each step.
//
// Between two exchanges a step uses the sample of the last exchange, with its age; in a free-running session the newest
// sample, whatever its age. A node with several partners waits for all of them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "coupling/subsystem.h"
#include "node/exchange.h"
#include "node/received_ring.h"
#include "node/sent_cache.h"
#include "node/session_member.h"
#include "transport/message_object.h"
#include "transport/roles.h"

namespace slew::node {

// Ticks arrive up to the window (64 at most) ahead, samples one step ahead. A follower lags by kFollowerWindow at most,
// but for sensors in pace `real`, which request again what was further ahead.
inline constexpr std::size_t kRingDepth = 128;

// Steps that a follower may lag: no node waits for its samples, but io's ticks then wait for it.
inline constexpr StepIndex kFollowerWindow = 64;

// Samples of one partner.
template <typename Message>
class Inbox {
 public:
  explicit Inbox(const Reading& of) : reading(of) {}

  // Takes a message of a step that is still needed, once. n: the next step to do.
  void keep(const transport::Received& received, StepIndex step, StepIndex n, Refusals& refusals) {
    if (step % every != 0) return;
    const StepIndex place = step / every;
    // a node that took a state over between two exchanges needs the last one
    const StepIndex first = takes_late ? n - static_cast<StepIndex>(kRingDepth) + 1 : n - n % every;
    ring_.drop_before(first / every);
    if (place >= n / every + static_cast<StepIndex>(kRingDepth)) {
      ++(reading.reader == wire::Role::sensor ? refusals.early : refusals.too_far_ahead);
    } else if (step < first || ring_.find(place) != nullptr) {
      ++refusals.duplicate;
    } else if (!ring_.put(received, place)) {
      ++refusals.undecodable;
    }
  }
  void keep_init(const transport::Received& received, Refusals& refusals) {
    has_init_ = init_.put(received, 0);
    if (!has_init_) ++refusals.undecodable;
  }
  // The session has this partner.
  void need(const ExchangeRules& rules) {
    is_needed = true;
    is_needed_each_step = rules.is_used_in_steps(reading.sample);
    every = is_needed_each_step ? rules.every(reading.sample) : 1;
    ring_ = ReceivedRing<Message>(kRingDepth);
  }
  void clear() noexcept {
    ring_.clear();
    has_init_ = false;
  }
  // The message of the step, or of the last step before it that has one.
  [[nodiscard]] const Message* find(StepIndex step) const noexcept { return ring_.find(step / every); }
  // The newest message up to the step; null: the ring has none.
  [[nodiscard]] const Message* find_newest(StepIndex step) const noexcept {
    for (std::size_t back = 0; back < kRingDepth; ++back) {
      const Message* found = ring_.find(step - static_cast<StepIndex>(back));
      if (found != nullptr) return found;
    }
    return nullptr;
  }
  // The message that the reader starts from.
  [[nodiscard]] const Message* find_start() const noexcept {
    if (reading.start == StartSample::first) return find(0);
    return has_init_ ? init_.find(0) : nullptr;
  }

  const Reading reading;
  bool is_needed = false;
  bool is_needed_each_step = true;  // not at the start only
  bool takes_late = false;          // keeps messages of steps that are done too
  StepIndex every = 1;

 private:
  ReceivedRing<Message> ring_{1};
  ReceivedRing<Message> init_{1};  // as that of step 0
  bool has_init_ = false;
};

class SampleExchange {
 public:
  explicit SampleExchange(wire::Role own);

  // Topics of the samples that a role publishes; those that its partners need come before those for display.
  [[nodiscard]] static std::vector<wire::Topic> topics_written(wire::Role role);

  // To be called once the session is adopted. takes_late: samples of steps that are done are kept too.
  void configure(const SessionMember& member, const ExchangeRules& rules, bool takes_late);
  void clear() noexcept;
  [[nodiscard]] bool has_partner() const noexcept;
  // Steps from one of this node's samples to the next.
  [[nodiscard]] StepIndex stride() const noexcept {
    return transport::traits(own_).is_follower ? rules_.every(transport::traits(own_).sample) : 1;
  }

  // A partner's message, of this session and epoch. n: the next step to do.
  void receive(const transport::Received& received, const wire::Header& header, StepIndex n, Refusals& refusals);

  // False while a needed sample is missing.
  [[nodiscard]] bool find_start(coupling::PartnerSamples& partners) const noexcept;
  [[nodiscard]] bool find(StepIndex step, coupling::PartnerSamples& partners) const noexcept;
  // The newest samples up to the step. Pre-condition: the session is free-running.
  void find_newest(StepIndex step, coupling::PartnerSamples& partners) const noexcept;

  // Visits each missing message, for a request: visit(role, topic, step).
  template <typename Visit>
  void for_each_missing_at_start(Visit visit) const {
    for_each_needed([&](const auto& inbox) {
      const StepIndex step = inbox.reading.start == StartSample::init ? kJoinStep : 0;
      if (inbox.find_start() == nullptr) visit(inbox.reading.writer, inbox.reading.sample, step);
    });
  }
  template <typename Visit>
  void for_each_missing(StepIndex step, Visit visit) const {
    for_each_needed([&](const auto& inbox) {
      if (!inbox.is_needed_each_step || inbox.find(step) != nullptr) return;
      visit(inbox.reading.writer, inbox.reading.sample, step - step % inbox.every);
    });
  }

  // Publishes step -1 on every topic of this node that a required reader has not acknowledged yet.
  void probe(SessionMember& member);
  // Sends the sample of a step and keeps it.
  void publish(SessionMember& member, wire::Phase phase, StepIndex step, const wire::SampleState& state,
               const coupling::OwnSample& own);
  // Answers a request for this node's samples. Returns the number of messages sent.
  std::size_t answer(SessionMember& member, const wire::ResendRequest& request);

 private:
  struct Outbox {
    wire::Topic topic;
    SentCache sent;
  };
  template <typename Message>
  void publish_probe(SessionMember& member, transport::MessagePool<Message>& pool);
  template <typename Message>
  void send(SessionMember& member, StepIndex step, const std::shared_ptr<Message>& message);
  template <typename Visit>
  void for_each_inbox(Visit visit) {
    visit(actuators_);
    visit(elastic_);
    visit(mechanism_);
    visit(flexible_);
    visit(poses_);
  }
  template <typename Visit>
  void for_each_needed(Visit visit) const {
    if (actuators_.is_needed) visit(actuators_);
    if (elastic_.is_needed) visit(elastic_);
    if (mechanism_.is_needed) visit(mechanism_);
    if (flexible_.is_needed) visit(flexible_);
    if (poses_.is_needed) visit(poses_);
  }

  wire::Role own_;
  ExchangeRules rules_;
  bool has_flexible_ = false, has_sensors_ = false;
  Inbox<wire::ActuatorMessage> actuators_{reading_of(wire::Topic::actuators)};
  Inbox<wire::ElasticMessage> elastic_{reading_of(wire::Topic::elastic)};
  Inbox<wire::MechanismMessage> mechanism_{reading_of(wire::Topic::mechanism)};
  Inbox<wire::FlexibleMessage> flexible_{reading_of(wire::Topic::flexible)};
  Inbox<wire::PoseMessage> poses_{reading_of(wire::Topic::poses)};
  transport::MessagePool<wire::MechanismMessage> mechanism_out_;
  transport::MessagePool<wire::ActuatorMessage> actuators_out_;
  transport::MessagePool<wire::FlexibleMessage> flexible_out_;
  transport::MessagePool<wire::ElasticMessage> elastic_out_;
  transport::MessagePool<wire::PoseMessage> poses_out_;
  transport::MessagePool<wire::SensorMessage> sensors_out_;
  std::vector<Outbox> outboxes_;  // by topics_written()
  std::vector<std::byte> buffer_;
};

}  // namespace slew::node
