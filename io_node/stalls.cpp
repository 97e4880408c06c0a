// io_node's part that watches the messages which the next tick needs: a writer may be heard and never deliver them.
#include "io_node/io_node.h"
#include "transport/roles.h"

namespace slew::io_node {

using wire::Role;
using wire::Topic;

// The first message that Tick n_ lacks, as long as no other reason for the wait is told.
std::optional<node::Awaited> IoNode::awaited() const noexcept {
  if (!vacancies_.empty()) return std::nullopt;
  const std::optional<Role> role = holds_back(n_);
  if (!role) return node::Awaited{Role::recorder, Topic::node_status, n_};
  return node::Awaited{*role, transport::traits(*role).sample, newest_of(*role) + 1};
}

// Named after 0.3 s; after session.stall_timeout the place is given away, or the session ends. The recorder may wait
// for its disk as long as that takes.
void IoNode::look_for_stall(std::int64_t now_ns) {
  const std::uint64_t asked = health().resends_asked;
  stall_.look(awaited(), asked, now_ns);
  if (stall_.begins(member_, now_ns)) {
    if (stall_.may_warn()) member_.warn(stall_.text(member_, asked));
    show_running();
  }
  const SimDuration stall_timeout = duration_of_seconds(config_.session.stall_timeout);
  if (!stall_.is_named() || stall_.waited() < stall_timeout) return;
  const Role role = stall_.awaited().role;
  if (role == Role::recorder) return;
  const std::string text = stall_.text(member_, asked);
  if (rejoin_.ns > 0 && hold_place(role, now_ns)) {
    member_.warn(text + " for " + node::seconds_text(stall_timeout) + "; its place was given away");
    return;
  }
  begin_ending(ExitCode::node_lost,
               text + ", nothing came within " + node::seconds_text(stall_timeout) +
                   " (session.stall_timeout); the session was held after step " + std::to_string(n_) +
                   " and ended, what was recorded up to there is valid; look for a filter or tunnel that drops some "
                   "datagrams",
               now_ns);
}

// Everything is there, or ticks are withheld for another reason.
void IoNode::end_stall(std::int64_t now_ns) {
  const bool was_named = stall_.is_named();
  stall_.look(std::nullopt, health().resends_asked, now_ns);
  if (was_named) show_running();
}

}  // namespace slew::io_node
