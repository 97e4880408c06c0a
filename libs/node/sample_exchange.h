// The samples of one physics node: those of its partners by step, as long as they are needed, and its own, kept for
// those that missed one.
//
//   role         reads                                          writes
//   mechanics    actuators, elastic                             mechanism, flexible
//   hydraulics   mechanism                                      actuators
//   flex         flexible                                       elastic
// Mechanics and hydraulics may exchange at every k-th step only: in between they are handed the sample of the last
// exchange again, with its age. Of a free-running session the newest sample is handed over, however old.
// A node with several partners waits for all of them. Flexible bodies whose elastic forces were stated once are waited
// for at the start only; samples for them and of them then come at every k-th step, those of the variables.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "coupling/subsystem.h"
#include "node/sent_cache.h"
#include "node/session_member.h"
#include "node/step_ring.h"

namespace slew::node {

// ticks come up to the window (64 at most) ahead, samples one step ahead; a node that nobody waits for lags by the
// window of kFollowerWindow at most
inline constexpr std::size_t kRingDepth = 128;

// steps that a node may be behind although nobody waits for its samples: io's ticks wait for it then
inline constexpr StepIndex kFollowerWindow = 64;

// How the flexible bodies of a session take part.
struct FlexibleTraffic {
  coupling::ElasticExchange exchange = coupling::ElasticExchange::once;
  std::uint32_t every = 1;  // steps between two samples for and of them
};

// How mechanics and hydraulics of a session exchange.
struct PortTraffic {
  std::uint32_t every = 1;       // steps between two exchanges
  bool is_free_running = false;  // nobody waits longer than the budget
  SimDuration wait_budget;       // of a free-running node
};

// Samples of one partner.
template <typename Message>
class Inbox {
 public:
  Inbox(wire::Role from, wire::Topic on) : writer(from), topic(on) {}

  // Takes a message of a step that is still needed, once. n: the next step to do.
  void keep(std::span<const std::byte> bytes, StepIndex step, StepIndex n, Refusals& refusals) {
    if (step % every != 0) return;
    const StepIndex place = step / every;
    // a node that took a state over between two exchanges needs the last one
    const StepIndex first = takes_late ? n - static_cast<StepIndex>(kRingDepth) + 1 : n - n % every;
    if (place >= n / every + static_cast<StepIndex>(kRingDepth)) {
      ++refusals.too_far_ahead;
    } else if (step < first || ring_.find(place) != nullptr) {
      ++refusals.duplicate;
    } else if (!transport::decode(bytes, ring_.put(place))) {
      ring_.remove(place);
      ++refusals.undecodable;
    }
  }
  void keep_init(std::span<const std::byte> bytes, Refusals& refusals) {
    has_init_ = transport::decode(bytes, init_);
    if (!has_init_) ++refusals.undecodable;
  }
  // The session has this partner. every: steps between two of its messages.
  void need(StepIndex steps) {
    is_needed = true;
    every = steps;
    ring_ = StepRing<Message>(kRingDepth);
  }
  void clear() noexcept {
    ring_.clear();
    has_init_ = false;
  }
  // Of the step, or of the last one before it that brings a message.
  [[nodiscard]] const Message* find(StepIndex step) const noexcept { return ring_.find(step / every); }
  // The newest up to the step; null when there is none in reach.
  [[nodiscard]] const Message* find_newest(StepIndex step) const noexcept {
    for (std::size_t back = 0; back < kRingDepth; ++back) {
      const Message* found = ring_.find(step - static_cast<StepIndex>(back));
      if (found != nullptr) return found;
    }
    return nullptr;
  }
  [[nodiscard]] const Message* init() const noexcept { return has_init_ ? &init_ : nullptr; }

  const wire::Role writer;
  const wire::Topic topic;
  bool is_needed = false;
  bool is_needed_each_step = true;  // beyond the start
  bool takes_late = false;          // also messages of steps that are done
  StepIndex every = 1;

 private:
  StepRing<Message> ring_{1};
  Message init_;
  bool has_init_ = false;
};

class SampleExchange {
 public:
  explicit SampleExchange(wire::Role own);

  [[nodiscard]] static std::span<const wire::Topic> topics_written(wire::Role role) noexcept;
  [[nodiscard]] static bool is_sample(wire::Topic topic) noexcept;

  // Who takes part in the session. flexible: of a session with a flex node.
  void configure(const SessionMember& member, const PortTraffic& ports, const FlexibleTraffic& flexible);
  void clear() noexcept;
  [[nodiscard]] bool has_partner() const noexcept;
  // Steps from one of this node's samples to the next.
  [[nodiscard]] StepIndex stride() const noexcept { return own_ == wire::Role::flex ? flexible_every_ : 1; }

  // A partner's message, of this session and epoch. n: the next step to do.
  void receive(std::span<const std::byte> bytes, const wire::Header& header, wire::Topic topic, StepIndex n,
               Refusals& refusals);

  // False while a needed sample is missing. Start: mechanics from the others' INIT or sample 0, hydraulics from the
  // mechanics' INIT, flexible bodies from the mechanics' sample 0.
  [[nodiscard]] bool find_start(coupling::PartnerSamples& partners) const noexcept;
  [[nodiscard]] bool find(StepIndex step, coupling::PartnerSamples& partners) const noexcept;
  // The newest samples up to the step. Pre-condition: the session is free-running.
  void find_newest(StepIndex step, coupling::PartnerSamples& partners) const noexcept;

  // What is missing, for a request: visit(role, topic, step).
  template <typename Visit>
  void for_each_missing_at_start(Visit visit) const {
    if (actuators_.is_needed && actuators_.find(0) == nullptr) visit(actuators_.writer, actuators_.topic, StepIndex{0});
    if (elastic_.is_needed && elastic_.init() == nullptr) visit(elastic_.writer, elastic_.topic, kJoinStep);
    if (mechanism_.is_needed && mechanism_.init() == nullptr) visit(mechanism_.writer, mechanism_.topic, kJoinStep);
    if (flexible_.is_needed && flexible_.find(0) == nullptr) visit(flexible_.writer, flexible_.topic, StepIndex{0});
  }
  template <typename Visit>
  void for_each_missing(StepIndex step, Visit visit) const {
    const auto look = [&](const auto& inbox) {
      if (inbox.is_needed && inbox.is_needed_each_step && inbox.find(step) == nullptr) {
        visit(inbox.writer, inbox.topic, step - step % inbox.every);
      }
    };
    look(actuators_);
    look(elastic_);
    look(mechanism_);
    look(flexible_);
  }

  // Step -1 on every topic of this node that somebody has not heard yet.
  void probe(SessionMember& member);
  // Sends the sample of a step and keeps it.
  void publish(SessionMember& member, wire::Phase phase, StepIndex step, const wire::SampleState& state,
               const coupling::OwnSample& own);
  // Answers a request for this node's samples; the number of messages sent.
  std::size_t answer(SessionMember& member, const wire::ResendRequest& request);

 private:
  struct Outbox {
    wire::Topic topic;
    SentCache sent;
  };
  template <typename Message>
  void send(SessionMember& member, Outbox& outbox, StepIndex step, const Message& message);

  wire::Role own_;
  StepIndex flexible_every_ = 1;
  bool has_flexible_ = false;
  Inbox<wire::ActuatorMessage> actuators_{wire::Role::hydraulics, wire::Topic::actuators};
  Inbox<wire::ElasticMessage> elastic_{wire::Role::flex, wire::Topic::elastic};
  Inbox<wire::MechanismMessage> mechanism_{wire::Role::mechanics, wire::Topic::mechanism};
  Inbox<wire::FlexibleMessage> flexible_{wire::Role::mechanics, wire::Topic::flexible};
  wire::MechanismMessage mechanism_out_;
  wire::ActuatorMessage actuators_out_;
  wire::FlexibleMessage flexible_out_;
  wire::ElasticMessage elastic_out_;
  std::vector<Outbox> outboxes_;  // by topics_written()
  std::vector<std::byte> buffer_;
};

}  // namespace slew::node
