// SPDX-License-Identifier: Apache-2.0
#include "view_node/taken_session.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <utility>

#include "core/failure.h"
#include "core/installation.h"
#include "core/json.h"
#include "core/time.h"
#include "node/session_options.h"
#include "session/recorded.h"

namespace slew::view_node {
namespace {

constexpr double kLongestReplay = 86400;                   // s, of the recorded part
constexpr std::int64_t kLongestClosingNs = 5'000'000'000;  // for the end of the session and of its recording
constexpr std::size_t kNameBytes = 40;                     // of the recorded session's name
constexpr std::size_t kMostOutput = 4096;                  // bytes that an answer states

// The addresses in a window's line of JSON; nothing: the line is another one.
std::optional<Json> addresses_in(const std::string& line) {
  std::optional<Json> json = Json::parse(line);
  return json && json->find("page") != nullptr ? json : std::nullopt;
}

}  // namespace

TakenSession::TakenSession(WindowOptions options, const std::string& name, SessionTimeOf session_time_of)
    : options_(std::move(options)),
      session_time_of_(std::move(session_time_of)),
      name_(options_.session.session.empty()
                ? fmt::format("{}-live-{}", node::session_name_of(name).substr(0, kNameBytes), getpid())
                : options_.session.session) {}

TakenSession::~TakenSession() {
  if (session_ == nullptr || session_->poll_end()) return;
  session_->send_signal(SIGINT);
  const std::int64_t end_ns = monotonic_ns() + kLongestClosingNs;
  while (!session_->poll_end() && monotonic_ns() < end_ns) {
    pollfd request{session_->output_fd(), POLLIN, 0};
    ::poll(&request, 1, 20);
    static_cast<void>(session_->take_lines());
  }
}

void TakenSession::start(const gateway::ContinuationRequest& request, Done done) {
  if (done_) return done({.problem = "another client takes this recording over just now; nothing was started"});
  if (session_ != nullptr && !session_->poll_end()) {
    return done({.problem = fmt::format("session '{}' was taken over from this recording and still runs; nothing was "
                                        "started; end it with 'slewring control stop --session {}'",
                                        name_, name_)});
  }
  SessionTime begin;
  try {
    begin = session_time_of_(request.time);
  } catch (const Failure& failure) {
    return done({.problem = failure.what()});
  }
  if (request.duration != 0 && request.duration <= begin.time) {
    return done(
        {.problem = fmt::format("'duration' ends the session at {:.6g} s, and it would go on at {:.6g} s of its "
                                "own time; nothing was started; choose a later end, or 0 for none",
                                request.duration, begin.time)});
  }
  std::vector<std::string> arguments = {"replay",
                                        options_.recording,
                                        "--until",
                                        fmt::format("{} s", begin.time),
                                        "--epoch",
                                        fmt::to_string(begin.epoch),
                                        "--then-live",
                                        "--session",
                                        name_,
                                        "--input",
                                        request.input == gateway::ContinuationInput::script ? "script" : "none",
                                        "--duration",
                                        fmt::format("{} s", request.duration),
                                        "--quiet"};
  if (!options_.assets.empty()) arguments.insert(arguments.end(), {"--assets", options_.assets});
  const std::vector<std::string> network = node::network_arguments(options_.session);
  arguments.insert(arguments.end(), network.begin(), network.end());
  WindowOptions window = options_;
  if (window.assets.empty()) window.assets = session::recorded_assets(options_.recording);
  window.recording.clear();
  window.beside.clear();
  window.session.session = name_;
  window.session_timeout = kLongestReplay;
  window.port = 0;
  window.is_json = true;
  output_.clear();
  try {
    auto session = std::make_unique<ChildProcess>("session", sibling_program("slewring"), arguments);
    window_ = std::make_unique<ChildProcess>("window", sibling_program("view_node"), window_arguments(window));
    session_ = std::move(session);
  } catch (const Failure& failure) {
    return done({.problem = failure.what()});
  }
  done_ = std::move(done);
}

void TakenSession::end(const std::string& problem) {
  std::string text = output_.size() > kMostOutput ? output_.substr(output_.size() - kMostOutput) : output_;
  while (text.ends_with('\n')) text.pop_back();
  const Done done = std::exchange(done_, nullptr);
  done({.problem = text.empty() ? problem : problem + ": " + text});
}

std::vector<std::string> TakenSession::poll() {
  std::vector<std::string> reports;
  if (session_ == nullptr) return reports;
  const bool is_over = session_->poll_end().has_value();
  const bool is_without_window = window_->poll_end().has_value();
  for (const std::string& line : session_->take_lines()) {
    if (done_) output_ += line + "\n";
    reports.push_back(name_ + ": " + line);
  }
  for (const std::string& line : window_->take_lines()) {
    const std::optional<Json> addresses = addresses_in(line);
    if (!addresses) {
      if (done_) output_ += line + "\n";
      continue;
    }
    reports.push_back(fmt::format("session '{}' goes on from the recording: {}", name_, addresses->at("page").text()));
    if (!done_) continue;
    const Done done = std::exchange(done_, nullptr);
    done({.session = name_, .page = addresses->at("page").text(), .foxglove = addresses->at("foxglove").text()});
  }
  if (done_ && is_over) {
    window_->send_signal(SIGINT);
    end("the session did not go on from there");
  } else if (done_ && is_without_window) {
    session_->send_signal(SIGINT);
    end("the window of the session has ended");
  }
  return reports;
}

}  // namespace slew::view_node
