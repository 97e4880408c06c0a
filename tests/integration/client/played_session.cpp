// SPDX-License-Identifier: Apache-2.0
// A session of which only the words are there: io's variables from the start, those of the mechanics when it gets
// SIGUSR1, its end with SIGTERM.
//
//   played_session NAME DOMAIN
#include <csignal>
#include <cstdlib>
#include <memory>

#include "transport/cdr/codec.h"
#include "transport/cyclone/cyclone_transport.h"

namespace {

namespace wire = slew::wire;
namespace transport = slew::transport;
using wire::Role;

template <typename Message>
void publish_message(transport::Transport& transport, const Message& message) {
  transport::ByteBuffer bytes;
  if (!transport::encode(message, bytes) || !transport.publish(transport::kTopicOf<Message>, bytes).is_ok())
    std::exit(1);
}

wire::Header header_of(Role role) {
  wire::Header header;
  header.session = {1, 2, 3};
  header.role = role;
  header.phase = wire::Phase::running;
  return header;
}

wire::SessionDescription session_of(const char* name) {
  wire::SessionDescription session;
  session.header = header_of(Role::io);
  session.name = name;
  session.step_ns = 1'000'000;
  session.required_roles = wire::bit(Role::io) | wire::bit(Role::mechanics);
  return session;
}

wire::VariableDirectory directory_of(Role role, const char* variable) {
  wire::VariableDirectory directory;
  directory.header = header_of(role);
  directory.total = 1;
  directory.entries.push_back({variable, "m"});
  return directory;
}

void wait_for(int signal) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, signal);
  int came = 0;
  sigwait(&signals, &came);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGUSR1);
  sigaddset(&signals, SIGTERM);
  sigprocmask(SIG_BLOCK, &signals, nullptr);  // before the middleware has threads

  transport::Endpoint options;
  options.session = argv[1];
  options.role = "io";
  options.writes = {wire::Topic::session, wire::Topic::variable_directory};
  std::unique_ptr<transport::CycloneTransport> transport;
  transport::Network network{static_cast<std::uint32_t>(std::atoi(argv[2])), "lo", {}};
  if (!transport::CycloneTransport::open(network, options, transport).is_ok()) return 1;
  publish_message(*transport, session_of(argv[1]));
  publish_message(*transport, directory_of(Role::io, "Input_Lift.value"));
  wait_for(SIGUSR1);
  publish_message(*transport, directory_of(Role::mechanics, "Bag.position.x"));
  wait_for(SIGTERM);
}
