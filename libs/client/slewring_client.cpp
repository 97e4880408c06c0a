// SPDX-License-Identifier: Apache-2.0
#include "client/slewring_client.h"

#include <cmath>
#include <exception>
#include <limits>
#include <string>

#include "client/client_session.h"

// the opaque struct of the C interface
struct slewring_session {
  std::unique_ptr<slew::client::ClientSession> client;
};

namespace {

using slew::client::Answer;
using slew::client::ClientSession;
using slew::client::Code;
using slew::observer::VariableView;

// answer of a failed join, when there is no session that could keep it
Answer& join_answer() {
  thread_local Answer answer;
  return answer;
}

constexpr double kLongestWait = 1e9;  // s

slew::SimDuration duration(double seconds) {
  const bool is_time = seconds > 0;  // false for NaN
  return slew::duration_of_seconds(is_time ? std::fmin(seconds, kLongestWait) : 0);
}

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin < list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    if (end > begin) parts.push_back(list.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

std::string text_of(const char* text) {
  return text != nullptr ? text : "";
}

// Null: the session has not named so many variables.
const VariableView* variable_of(const slewring_session* session, int number) {
  if (session == nullptr || number < 0) return nullptr;
  const slew::observer::SessionView& view = session->client->view();
  const auto index = static_cast<std::size_t>(number);
  return index < view.places().size() ? &view.variable(view.places()[index]) : nullptr;
}

// Runs an action that may fail: no exception crosses the border to C.
template <typename Action>
int guarded(slewring_session* session, Action action) {
  if (session == nullptr) {
    // after a failed join its reason is the useful text
    if (join_answer().text.empty()) join_answer().text = "the session is NULL";
    return SLEWRING_BAD_ARGUMENT;
  }
  Answer answer;
  int result = SLEWRING_OK;
  try {
    answer = action(*session->client, result);
  } catch (const std::exception& error) {
    answer = {Code::failed, error.what()};
  }
  if (answer.code == Code::ok) return result;
  session->client->error = std::move(answer.text);
  return static_cast<int>(answer.code);
}

}  // namespace

extern "C" {

slewring_session* slewring_join(const char* session, const char* controller, unsigned domain,
                                const char* interface_name, const char* peers, double timeout_s) {
  try {
    slew::client::JoinOptions options;
    options.session = text_of(session);
    options.controller = text_of(controller);
    options.network.domain = domain;
    if (!text_of(interface_name).empty()) options.network.interface = interface_name;
    options.network.peers = split(text_of(peers));
    std::unique_ptr<ClientSession> client;
    const Answer answer = ClientSession::join(options, duration(timeout_s), client);
    join_answer() = answer;
    return client != nullptr ? new slewring_session{std::move(client)} : nullptr;
  } catch (const std::exception& error) {
    join_answer() = {Code::failed, error.what()};
    return nullptr;
  }
}

void slewring_leave(slewring_session* session) {
  delete session;
}

const char* slewring_error(const slewring_session* session) {
  return session != nullptr ? session->client->error.c_str() : join_answer().text.c_str();
}

int slewring_join_code(void) {
  return static_cast<int>(join_answer().code);
}

double slewring_step_size(const slewring_session* session) {
  return session != nullptr ? session->client->step_size().seconds() : 0;
}

int slewring_steps_per_block(const slewring_session* session) {
  return session != nullptr ? static_cast<int>(session->client->steps_per_block()) : 0;
}

int slewring_variable_count(slewring_session* session) {
  return guarded(session, [](ClientSession& client, int& count) {
    client.drain();
    count = static_cast<int>(client.view().places().size());
    return Answer{};
  });
}

const char* slewring_variable_name(const slewring_session* session, int number) {
  const VariableView* variable = variable_of(session, number);
  return variable != nullptr ? variable->name.c_str() : nullptr;
}

const char* slewring_variable_unit(const slewring_session* session, int number) {
  const VariableView* variable = variable_of(session, number);
  return variable != nullptr ? variable->unit.c_str() : nullptr;
}

int slewring_find(slewring_session* session, const char* variable, double timeout_s) {
  return guarded(session, [&](ClientSession& client, int& handle) {
    return client.find(text_of(variable), duration(timeout_s), handle);
  });
}

double slewring_value(const slewring_session* session, int variable) {
  return session != nullptr ? session->client->value(variable) : std::numeric_limits<double>::quiet_NaN();
}

int slewring_acquire(slewring_session* session, const char* channel, double timeout_s) {
  return guarded(session, [&](ClientSession& client, int& handle) {
    return client.acquire(text_of(channel), 0, duration(timeout_s), handle);
  });
}

int slewring_take_over(slewring_session* session, const char* channel, double timeout_s) {
  return guarded(session, [&](ClientSession& client, int& handle) {
    return client.acquire(text_of(channel), slew::wire::kTakeOver, duration(timeout_s), handle);
  });
}

int slewring_release(slewring_session* session, int channel) {
  return guarded(session, [&](ClientSession& client, int&) { return client.release(channel); });
}

int slewring_step(slewring_session* session, double timeout_s) {
  return guarded(session, [&](ClientSession& client, int&) {
    return client.step(slew::client::Which::next, duration(timeout_s));
  });
}

int slewring_latest(slewring_session* session, double timeout_s) {
  return guarded(session, [&](ClientSession& client, int&) {
    return client.step(slew::client::Which::newest, duration(timeout_s));
  });
}

long long slewring_present_step(const slewring_session* session) {
  return session != nullptr ? session->client->present_step() : slew::kJoinStep;
}

double slewring_time(const slewring_session* session) {
  if (session == nullptr || session->client->present_step() < 0) return 0;
  return static_cast<double>(session->client->present_step()) * session->client->step_size().seconds();
}

long long slewring_blocks_missed(const slewring_session* session) {
  return session != nullptr ? static_cast<long long>(session->client->blocks_missed()) : 0;
}

int slewring_write(slewring_session* session, int channel, double value) {
  return guarded(session, [&](ClientSession& client, int&) { return client.write(channel, value); });
}

const char* slewring_notice(slewring_session* session) {
  bool is_new = false;
  static_cast<void>(guarded(session, [&](ClientSession& client, int&) {
    is_new = client.take_notice(client.notice);
    return Answer{};
  }));
  return is_new ? session->client->notice.c_str() : nullptr;
}

}  // extern "C"
