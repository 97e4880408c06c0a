// SPDX-License-Identifier: Apache-2.0
#include "gateway/client_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace slew::gateway {
namespace {

constexpr std::int64_t kAnswerNs = 3'000'000'000;  // longest wait for the answer to a request of a lease

}  // namespace

ClientInputs::ClientInputs(std::vector<InputChannel> channels, std::string controller, observer::InputLeases::Send send)
    : channels_(std::move(channels)), controller_(std::move(controller)), leases_(std::move(send)) {}

std::string ClientInputs::controller_of(ClientId client) const {
  return fmt::format("{}:{}", controller_, client);
}

observer::InputLeases::Key ClientInputs::key_of(const Place& place) const {
  return {controller_of(place.first), place.second};
}

std::string ClientInputs::problem_of(const std::string& input) const {
  const auto found = std::ranges::find(channels_, input, &InputChannel::name);
  if (found == channels_.end()) return "the scene has no input '" + input + "'; /session.json lists its inputs";
  if (found->is_lockstep) {
    return "input " + input +
           " has controller: lockstep, so each tick would wait for this client; run the session with --set " + input +
           ".controller=sampled";
  }
  return "";
}

std::string ClientInputs::publish(ClientId client, const std::string& input, double value, StepIndex newest_step,
                                  std::int64_t now_ns) {
  if (std::string problem = problem_of(input); !problem.empty()) return problem;
  if (!std::isfinite(value)) return "the value of input " + input + " is not finite";
  const Place place{client, input};
  if (std::ranges::find(used_, place) == used_.end()) used_.push_back(place);
  if (leases_.write(key_of(place), value, newest_step, now_ns)) driven_[place] = now_ns;
  return "";
}

std::string ClientInputs::lease(ClientId client, const std::string& input, observer::InputLeases::Acquire acquire,
                                Done done, std::int64_t now_ns) {
  if (std::string problem = problem_of(input); !problem.empty()) return problem;
  const Place place{client, input};
  if (leases_.is_held(key_of(place))) {
    done("");
    return "";
  }
  if (std::ranges::find(used_, place) == used_.end()) used_.push_back(place);
  leases_.request(key_of(place), acquire);
  waiting_.push_back({place, std::move(done), now_ns + kAnswerNs});
  return "";
}

std::string ClientInputs::release(ClientId client, const std::string& input) {
  if (std::string problem = problem_of(input); !problem.empty()) return problem;
  const Place place{client, input};
  if (std::ranges::find(used_, place) == used_.end()) return "this client has not requested input " + input;
  leases_.release(key_of(place));
  driven_.erase(place);
  std::erase(used_, place);
  return "";
}

void ClientInputs::leave(ClientId client) {
  for (const Place& place : used_) {
    if (place.first == client) leases_.release(key_of(place));
  }
  std::erase_if(used_, [&](const Place& place) { return place.first == client; });
  std::erase_if(driven_, [&](const auto& entry) { return entry.first.first == client; });
  std::erase_if(waiting_, [&](const Waiting& waiting) { return waiting.place.first == client; });
}

void ClientInputs::take(const wire::ControllerLease& lease) {
  leases_.take(lease);
  if (lease.answers == 0) return;
  std::vector<Done> answered;
  std::erase_if(waiting_, [&](Waiting& waiting) {
    const observer::InputLeases::Key key = key_of(waiting.place);
    if (key.first != lease.controller || key.second != lease.channel) return false;
    if (lease.is_granted && !leases_.is_held(key)) return false;  // of another process of this name
    answered.push_back(std::move(waiting.done));
    return true;
  });
  for (const Done& done : answered) done(lease.is_granted ? "" : lease.reason);
}

void ClientInputs::poll(std::int64_t now_ns, const Silent& silent) {
  std::vector<Done> given_up;
  std::erase_if(waiting_, [&](Waiting& waiting) {
    if (now_ns < waiting.until_ns) return false;
    given_up.push_back(std::move(waiting.done));
    return true;
  });
  for (const Done& done : given_up) done("the session has not answered within 3 s; the input may be held");
  std::vector<Place> stopped;
  for (const auto& [place, last_ns] : driven_) {
    if (now_ns - last_ns >= kNeutralAfterNs) stopped.push_back(place);
  }
  for (const Place& place : stopped) {
    driven_.erase(place);
    // not one that another controller has taken over
    if (!leases_.is_held(key_of(place))) continue;
    static_cast<void>(leases_.write(key_of(place), 0, kJoinStep, now_ns));
    silent(place.first, place.second);
  }
}

}  // namespace slew::gateway
