// SPDX-License-Identifier: Apache-2.0
#include "node/state_transfer.h"

#include <algorithm>

namespace slew::node {

using wire::Phase;
using wire::Topic;

void StateTransfer::save_if_due(SessionMember& member, StepIndex n, const wire::SampleState& published) {
  StepReport report;
  report.flags = published.flags;
  if (report.has_failed()) return;
  if (is_requested(n)) return publish_state(member, n, published);
  const bool is_of_interval = n % checkpoint_interval(built_.exchange_unit) == 0;
  const bool is_due = is_of_interval && member.session().rejoin_ns > 0 && n >= caught_up_at_;
  if (is_due && !checkpoint_.has_more()) save_node(*built_.subsystem, published, n, checkpoint_.next());
  if (n == 0) return checkpoint_.send_rest(member);
  if (checkpoint_.has_more()) checkpoint_.send_part(member);
}

void StateTransfer::publish_state(SessionMember& member, StepIndex n, const wire::SampleState& published) {
  if (built_.subsystem->can_save().is_ok()) {
    save_node(*built_.subsystem, published, n, checkpoint_.next());
    return checkpoint_.send_rest(member);
  }
  part_ = {};
  part_.header = member.header(Phase::running, n);
  part_.role = member.role();
  member.publish(Topic::checkpoint, part_);
}

void StateTransfer::receive_part(std::span<const std::byte> bytes, SessionMember& member) {
  if (!member.decode(bytes, part_) || part_.role != member.role() || taken_over_.is_whole()) return;
  taken_over_.take(part_);
}

Status StateTransfer::load(const SessionMember& member, StepIndex& n, wire::SampleState& published,
                           coupling::OwnSample& own) {
  if (Status loaded = load_node(taken_over_.checkpoint(), *built_.subsystem, published, own); !loaded.is_ok()) {
    return loaded;
  }
  n = taken_over_.checkpoint().step;
  taken_over_.clear();
  const wire::Header& session = member.session().header;
  caught_up_at_ = session.epoch == member.epoch() ? std::max(n, session.step) : n;
  return Status::ok();
}

void StateTransfer::restart() noexcept {
  requested_ = kNoStep;
  caught_up_at_ = 0;
  checkpoint_.next().bytes.clear();
  taken_over_.clear();
}

}  // namespace slew::node
