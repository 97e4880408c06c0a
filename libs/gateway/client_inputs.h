// SPDX-License-Identifier: Apache-2.0
// Inputs of a session that clients move: each client is a controller of its own, "NAME:number", so that one client at a
// time drives an input.
//
// A lease is requested with a client's first value for an input, or by its request. A client that sends nothing for
// kNeutralAfter while it drives an input (a page that sleeps) is at neutral: the gateway writes 0 once. A client that
// leaves gives its inputs back, which puts them to neutral. Both are within 200 ms; the silence of the gateway itself
// is the session's matter (session.controller_timeout).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/time.h"
#include "observer/input_leases.h"
#include "transport/wire.h"

namespace slew::gateway {

using ClientId = std::uint32_t;

struct InputChannel {
  std::string name;
  bool is_digital = false;
  bool is_lockstep = false;  // each tick waits for its controller: not for clients
};

class ClientInputs {
 public:
  static constexpr std::int64_t kNeutralAfterNs = 150'000'000;

  // controller: beginning of the clients' names in leases.
  ClientInputs(std::vector<InputChannel> channels, std::string controller, observer::InputLeases::Send send);

  [[nodiscard]] const std::vector<InputChannel>& channels() const noexcept { return channels_; }
  // The client's name in leases.
  [[nodiscard]] std::string controller_of(ClientId client) const;

  // Forwards a value if the client holds the input, else requests it. Result: empty, or the reason why the value has no
  // effect.
  [[nodiscard]] std::string publish(ClientId client, const std::string& input, double value, StepIndex newest_step,
                                    std::int64_t now_ns);
  // Requests the input. Result: empty, or the reason why nothing was requested. done is called once: with an empty
  // text when the client holds the input, or with the reason of the refusal.
  using Done = std::function<void(const std::string& problem)>;
  [[nodiscard]] std::string lease(ClientId client, const std::string& input, observer::InputLeases::Acquire acquire,
                                  Done done, std::int64_t now_ns);
  // Result: empty, or the reason why there is nothing to give back.
  [[nodiscard]] std::string release(ClientId client, const std::string& input);
  // The client is gone.
  void leave(ClientId client);
  // All clients are.
  void leave_all() { leases_.release(); }

  void take(const wire::ControllerLease& lease);
  // After a reset every input is free.
  void take_epoch(std::uint32_t epoch) { leases_.take_epoch(epoch); }

  // An input that was put to neutral since the client was silent.
  using Silent = std::function<void(ClientId client, const std::string& input)>;
  void poll(std::int64_t now_ns, const Silent& silent);

 private:
  using Place = std::pair<ClientId, std::string>;  // client, input
  struct Waiting {
    Place place;
    Done done;
    std::int64_t until_ns = 0;
  };

  // Empty, or the reason why clients cannot have this input.
  [[nodiscard]] std::string problem_of(const std::string& input) const;
  [[nodiscard]] observer::InputLeases::Key key_of(const Place& place) const;

  std::vector<InputChannel> channels_;
  std::string controller_;
  observer::InputLeases leases_;
  std::map<Place, std::int64_t> driven_;  // time of the last value [ns]
  std::vector<Place> used_;               // leases that were requested
  std::vector<Waiting> waiting_;
};

}  // namespace slew::gateway
