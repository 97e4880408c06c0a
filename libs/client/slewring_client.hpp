// SPDX-License-Identifier: Apache-2.0
// The client library in C++: slewring_client.h with exceptions and a destructor, nothing else.
//
//   slewring::Session session({.session = "truck_crane", .controller = "pid"});
//   const slewring::Variable stroke = session.find("Cyl_Lift.stroke");
//   const slewring::Channel lift = session.acquire("Input_Lift");
//   while (session.step()) session.write(lift, 20 * (0.86 - session.value(stroke)));
//
// step() without a time waits through a pause; with one it throws SLEWRING_TIMEOUT when no block comes.
//
// Needs C++17 (the braces above C++20). Every failure is a slewring::Error with code() and a sentence, but the end of
// the session, at which step() and latest() give false.
#ifndef SLEWRING_CLIENT_HPP
#define SLEWRING_CLIENT_HPP

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "slewring_client.h"

namespace slewring {

class Error : public std::runtime_error {
 public:
  Error(int code, const std::string& text) : std::runtime_error(text), code_(code) {}
  int code() const noexcept { return code_; }  // SLEWRING_TIMEOUT, ...

 private:
  int code_;
};

struct Variable {
  int handle;
};
struct Channel {
  int handle;
};

struct Options {
  std::string session;
  std::string controller;
  unsigned domain = 0;
  std::string interface_name = "lo";
  std::string peers = {};  // separated by commas
  double timeout = 10;     // s, for the session to be heard
};

class Session {
 public:
  explicit Session(const Options& options)
      : session_(slewring_join(options.session.c_str(), options.controller.c_str(), options.domain,
                               options.interface_name.c_str(), options.peers.c_str(), options.timeout)) {
    if (!session_) throw Error(slewring_join_code(), slewring_error(nullptr));
  }

  double step_size() const { return slewring_step_size(session_.get()); }
  Variable find(const std::string& name, double timeout = 5) {
    return {checked(slewring_find(session_.get(), name.c_str(), timeout))};
  }
  double value(Variable variable) const { return slewring_value(session_.get(), variable.handle); }

  Channel acquire(const std::string& name, double timeout = 5) {
    return {checked(slewring_acquire(session_.get(), name.c_str(), timeout))};
  }
  Channel take_over(const std::string& name, double timeout = 5) {
    return {checked(slewring_take_over(session_.get(), name.c_str(), timeout))};
  }
  void release(Channel channel) { checked(slewring_release(session_.get(), channel.handle)); }
  void write(Channel channel, double value) { checked(slewring_write(session_.get(), channel.handle, value)); }

  // Next block, or the newest; false when the session has ended. Without a time-out [s] they wait as long as it takes.
  bool step() { return waits(slewring_step); }
  bool step(double timeout) { return has_come(slewring_step(session_.get(), timeout)); }
  bool latest() { return waits(slewring_latest); }
  bool latest(double timeout) { return has_come(slewring_latest(session_.get(), timeout)); }
  long long blocks_missed() const { return slewring_blocks_missed(session_.get()); }
  long long present_step() const { return slewring_present_step(session_.get()); }
  double time() const { return slewring_time(session_.get()); }

  std::optional<std::string> notice() {
    const char* text = slewring_notice(session_.get());
    return text != nullptr ? std::optional<std::string>(text) : std::nullopt;
  }

 private:
  struct Leave {
    void operator()(slewring_session* session) const { slewring_leave(session); }
  };
  int checked(int result) const {
    if (result < 0) throw Error(result, slewring_error(session_.get()));
    return result;
  }
  bool waits(int (*next)(slewring_session*, double)) {
    int result = SLEWRING_TIMEOUT;
    while (result == SLEWRING_TIMEOUT) result = next(session_.get(), 10);
    return has_come(result);
  }
  bool has_come(int result) const { return result != SLEWRING_ENDED && checked(result) == SLEWRING_OK; }

  std::unique_ptr<slewring_session, Leave> session_;
};

}  // namespace slewring

#endif
