// SPDX-License-Identifier: Apache-2.0
#include "node/sample_exchange.h"

#include <algorithm>

#include "core/check.h"

namespace slew::node {
namespace {

using wire::Phase;
using wire::Role;
using wire::Topic;

// False: a needed sample is missing.
template <typename Message, typename Sample>
bool take(const Inbox<Message>& inbox, const Message* found, const Sample*& sample) noexcept {
  if (!inbox.is_needed) return true;
  sample = found != nullptr ? &found->sample : nullptr;
  return found != nullptr;
}

template <typename Message, typename Sample>
bool take_start(const Inbox<Message>& inbox, const Sample*& sample) noexcept {
  return take(inbox, inbox.find_start(), sample);
}

template <typename Message, typename Sample>
bool take_step(const Inbox<Message>& inbox, StepIndex step, const Sample*& sample) noexcept {
  return !inbox.is_needed_each_step || take(inbox, inbox.find(step), sample);
}

}  // namespace

SampleExchange::SampleExchange(Role own) : own_(own) {
  SLEW_CHECK(!topics_written(own).empty());
  for (const Topic topic : topics_written(own)) outboxes_.push_back({topic, SentCache()});
}

std::vector<Topic> SampleExchange::topics_written(Role role) {
  std::vector<Topic> topics;
  for (std::size_t i = 0; i < wire::kTopics; ++i) {
    const auto topic = static_cast<Topic>(i);
    if (transport::is_sample(topic) && transport::traits(role).writes.contains(topic)) topics.push_back(topic);
  }
  return topics;
}

void SampleExchange::configure(const SessionMember& member, const ExchangeRules& rules, bool takes_late) {
  rules_ = rules;
  has_flexible_ = member.requires_role(Role::flex);
  has_sensors_ = member.requires_role(Role::sensor);
  for_each_inbox([&](auto& inbox) {
    if (inbox.reading.reader == own_ && member.requires_role(inbox.reading.writer)) inbox.need(rules);
  });
  actuators_.takes_late = mechanism_.takes_late = takes_late;
  const std::size_t depth = sent_depth(member.give_up_after(), {member.session().step_ns});
  for (Outbox& outbox : outboxes_) outbox.sent.set_depth(depth);
}

void SampleExchange::clear() noexcept {
  for_each_inbox([](auto& inbox) { inbox.clear(); });
  for (Outbox& outbox : outboxes_) outbox.sent.clear();
}

bool SampleExchange::has_partner() const noexcept {
  bool has_partner = false;
  for_each_needed([&](const auto&) { has_partner = true; });
  return has_partner;
}

// ---- receiving ------------------------------------------------------------------------------------------------

void SampleExchange::receive(const transport::Received& received, const wire::Header& header, StepIndex n,
                             Refusals& refusals) {
  for_each_inbox([&](auto& inbox) {
    if (inbox.reading.sample != received.topic || !inbox.is_needed) return;
    if (header.phase == Phase::init) inbox.keep_init(received, refusals);
    if (header.phase == Phase::running && inbox.is_needed_each_step) inbox.keep(received, header.step, n, refusals);
  });
}

bool SampleExchange::find_start(coupling::PartnerSamples& partners) const noexcept {
  return take_start(actuators_, partners.actuators) && take_start(elastic_, partners.elastic) &&
         take_start(mechanism_, partners.mechanism) && take_start(flexible_, partners.flexible) &&
         take_start(poses_, partners.poses);
}

bool SampleExchange::find(StepIndex step, coupling::PartnerSamples& partners) const noexcept {
  partners.actuators_age = rules_.age(Topic::actuators, step);
  partners.mechanism_age = rules_.age(Topic::mechanism, step);
  return take_step(actuators_, step, partners.actuators) && take_step(elastic_, step, partners.elastic) &&
         take_step(mechanism_, step, partners.mechanism) && take_step(flexible_, step, partners.flexible) &&
         take_step(poses_, step, partners.poses);
}

void SampleExchange::find_newest(StepIndex step, coupling::PartnerSamples& partners) const noexcept {
  if (const auto* newest = actuators_.is_needed ? actuators_.find_newest(step) : nullptr) {
    partners.actuators = &newest->sample;
    partners.actuators_age = step - newest->header.step;
  }
  if (const auto* newest = mechanism_.is_needed ? mechanism_.find_newest(step) : nullptr) {
    partners.mechanism = &newest->sample;
    partners.mechanism_age = step - newest->header.step;
  }
}

// ---- sending --------------------------------------------------------------------------------------------------

template <typename Message>
void SampleExchange::publish_probe(SessionMember& member, transport::MessagePool<Message>& pool) {
  const std::shared_ptr<Message>& message = pool.take();
  message->header = member.header(Phase::join, kJoinStep);
  member.publish(transport::kTopicOf<Message>, *message);
}

void SampleExchange::probe(SessionMember& member) {
  for (const Outbox& outbox : outboxes_) {
    if (member.is_acknowledged_on(outbox.topic)) continue;
    if (outbox.topic == Topic::mechanism) publish_probe(member, mechanism_out_);
    if (outbox.topic == Topic::actuators) publish_probe(member, actuators_out_);
    if (outbox.topic == Topic::flexible) publish_probe(member, flexible_out_);
    if (outbox.topic == Topic::elastic) publish_probe(member, elastic_out_);
    if (outbox.topic == Topic::poses) publish_probe(member, poses_out_);
    if (outbox.topic == Topic::sensors) publish_probe(member, sensors_out_);
  }
}

// A message that every reader took as an object is not lost: it is not kept.
template <typename Message>
void SampleExchange::send(SessionMember& member, StepIndex step, const std::shared_ptr<Message>& message) {
  constexpr Topic kTopic = transport::kTopicOf<Message>;
  Outbox& outbox = *std::find_if(outboxes_.begin(), outboxes_.end(), [](const Outbox& o) { return o.topic == kTopic; });
  member.publish_object<Message>(message, buffer_);
  if (!buffer_.empty()) outbox.sent.keep(step, buffer_);
}

void SampleExchange::publish(SessionMember& member, Phase phase, StepIndex step, const wire::SampleState& state,
                             const coupling::OwnSample& own) {
  const auto fill = [&](auto& pool, const auto& sample) -> const auto& {
    const auto& message = pool.take();
    message->header = member.header(phase, step);
    if constexpr (requires { message->state; }) message->state = state;
    message->sample = sample;
    return message;
  };
  const auto is_due = [&](Topic topic) { return phase == Phase::running && rules_.age(topic, step) == 0; };
  if (own_ == Role::mechanics) {
    send(member, step, fill(mechanism_out_, own.mechanism));
    if (has_flexible_ && is_due(Topic::flexible)) send(member, step, fill(flexible_out_, own.flexible));
    if (has_sensors_ && is_due(Topic::poses)) send(member, step, fill(poses_out_, own.poses));
  } else if (own_ == Role::hydraulics) {
    send(member, step, fill(actuators_out_, own.actuators));
  } else if (own_ == Role::flex) {
    send(member, step, fill(elastic_out_, own.elastic));
  } else {
    send(member, step, fill(sensors_out_, own.sensors));
  }
}

std::size_t SampleExchange::answer(SessionMember& member, const wire::ResendRequest& request) {
  std::size_t answers = 0;
  for (const Outbox& outbox : outboxes_) {
    if (request.topic != static_cast<std::uint8_t>(outbox.topic)) continue;
    const StepIndex last = std::min(request.last_step, request.header.step + kMostAnswers - 1);
    for (StepIndex step = request.header.step; step <= last; ++step) {
      const std::span<const std::byte> sent = outbox.sent.find(step);
      if (sent.empty()) continue;
      member.send(outbox.topic, sent);
      ++answers;
    }
  }
  return answers;
}

}  // namespace slew::node
