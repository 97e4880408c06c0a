// SPDX-License-Identifier: Apache-2.0
#include "bridge/bridge.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "bridge/incoming.h"
#include "bridge/lcm_link.h"
#include "bridge/outgoing.h"
#include "bridge/parameter_door.h"
#include "core/failure.h"
#include "lcm_log/event_log.h"
#include "observer/silence_watch.h"

namespace slew::bridge {
namespace {

constexpr SimDuration kDirectoryTimeout = milliseconds(5000);
constexpr std::int64_t kSecondNs = 1'000'000'000;
constexpr SimDuration kLongestWait = milliseconds(20);
constexpr int kInputWaitMs = 1;  // with inputs: variables leave this much later at most

std::vector<lcm_log::InputChannel> input_channels(const SceneView& scene) {
  std::vector<lcm_log::InputChannel> channels;
  for (const Channel& channel : scene.channels)
    channels.push_back({channel.name, channel.is_digital, channel.is_lockstep});
  return channels;
}

// Waits until the session has named its variables, and compares the lists with them.
void wait_for_names(const std::vector<lcm_log::SignalList>& lists, observer::Observer& observer) {
  if (lists.empty()) return;
  const observer::SessionView& view = observer.view();
  const bool has_names =
      observer.wait_for([&] { return view.has_whole_directory() || view.is_over(); }, kDirectoryTimeout);
  if (!has_names && !observer.is_stopped()) {
    throw Failure(ExitCode::failed,
                  fmt::format("session '{}' has not named its variables within {}; nothing was written or sent; it may "
                              "still be starting: try again, or look with 'slewring sessions'",
                              observer.session_name(), seconds_text(kDirectoryTimeout)));
  }
  if (view.has_whole_directory()) check_names(lists, view, "the session");
}

}  // namespace

struct Bridge::State final : observer::Receiver {
  explicit State(Settings chosen) : settings(std::move(chosen)), lists(read_lists(settings)) {}

  void begin_session() override {
    if (outgoing) outgoing->begin_session();
    early.clear();
    has_new_session = true;
  }
  void take_directory(const wire::VariableDirectory& directory) override {
    outgoing ? outgoing->take(directory) : early.push_back(directory);
  }
  void take_block(const wire::VariableBlock& block, std::span<const std::byte>, double time) override {
    if (incoming) incoming->take_epoch(block.header.epoch);
    if (block.header.epoch != epoch) newest_step = kJoinStep;
    epoch = block.header.epoch;
    newest_step = std::max(newest_step, block.header.step);
    if (outgoing) outgoing->take(block, time);
  }
  void take_lease(const wire::ControllerLease& lease) override {
    if (incoming) incoming->take(lease);
  }
  void take_reply(const wire::ControlReply& reply) override {
    if (door) door->take(reply);
  }

  void open(observer::Observer& observer, const SceneView& scene);
  void open_door(observer::Observer& observer, const SceneView& scene, const std::string& prefix);
  void each_second(observer::Observer& observer, std::int64_t now_ns);
  [[nodiscard]] bool receives() const { return !settings.controllers.empty() || settings.takes_parameters; }

  Settings settings;
  std::vector<lcm_log::SignalList> lists;
  LcmUrl url;
  std::optional<LcmLink> link;
  std::optional<Outgoing> outgoing;
  std::optional<Incoming> incoming;
  std::optional<ParameterDoor> door;
  std::vector<wire::VariableDirectory> early;  // received before the channels had their names
  bool has_new_session = false;
  std::uint32_t epoch = 0;
  StepIndex newest_step = kJoinStep;  // of the blocks of this epoch
  std::uint64_t unsent_inputs = 0;
  observer::SilenceWatch silence;
  std::vector<std::string> notices;
};

Bridge::Bridge(Settings settings) : state_(std::make_unique<State>(std::move(settings))) {
  State& state = *state_;
  const Reach reach = state.settings.is_insecure_lan ? Reach::network : Reach::this_machine;
  state.url = read_url(state.settings.url, reach);
  for (const std::string& controller : state.settings.controllers) {
    const std::size_t longest = wire::kMaxNameLength - std::string_view(kLeasePrefix).size();
    if (!controller.empty() && controller.size() <= longest) continue;
    throw Failure(ExitCode::bad_input, fmt::format("--controller {}: expected 1 to {} characters; nothing was started",
                                                   controller, longest));
  }
}

Bridge::~Bridge() = default;

observer::Receiver& Bridge::receiver() noexcept {
  return *state_;
}

bool Bridge::is_door() const noexcept {
  return state_->receives();
}

std::string Bridge::types(observer::Observer& observer) {
  if (state_->lists.empty()) {
    throw Failure(ExitCode::bad_input,
                  "--write-types writes the types of signal lists, and there is none; nothing was written; add "
                  "--signals crane=Cyl_Lift.stroke,Cyl_Lift.force");
  }
  wait_for_names(state_->lists, observer);
  if (!observer.view().has_whole_directory())
    throw Failure(ExitCode::failed, "the session ended, or a stop was requested; nothing was written");
  std::vector<std::vector<std::string>> units;
  for (const lcm_log::SignalList& list : state_->lists) {
    std::vector<std::string>& of_list = units.emplace_back();
    for (const std::string& variable : list.variables) of_list.push_back(observer.view().find(variable)->unit);
  }
  return types_text(state_->lists, units);
}

void Bridge::State::open(observer::Observer& observer, const SceneView& scene) {
  const std::string prefix = prefix_of(settings, observer.session_name(), lists);
  check_every(settings, scene);
  if (receives() && !settings.is_insecure_lan) require_loopback(url);
  link.emplace(url, settings.is_insecure_lan ? Reach::network : Reach::this_machine);
  if (receives()) open_door(observer, scene, prefix);
  outgoing.emplace(
      prefix, lists, settings.every,
      [this](const std::string& channel, std::string_view bytes, StepIndex) { link->publish(channel, bytes); });
  for (const wire::VariableDirectory& directory : early) outgoing->take(directory);
}

void Bridge::State::open_door(observer::Observer& observer, const SceneView& scene, const std::string& prefix) {
  if (!settings.controllers.empty()) {
    const bool is_all_lockstep = std::ranges::all_of(scene.channels, &Channel::is_lockstep);
    if (is_all_lockstep) {
      throw Failure(ExitCode::bad_input,
                    "--controller: every input of the scene is lockstep, or there is none: each tick would wait for a "
                    "message that LCM may lose; nothing was started; run the session with "
                    "--set <input>.controller=sampled");
    }
    incoming.emplace(input_channels(scene), settings.controllers,
                     [this, &observer](const wire::ControllerInput& input) {
                       wire::ControllerInput message = input;
                       message.session = observer.session_name();
                       if (!observer.send(message).is_ok()) ++unsent_inputs;
                     });
    link->subscribe(prefix + "_INPUT",
                    [this](std::span<const std::byte> bytes) { incoming->take(bytes, monotonic_ns(), newest_step); });
  }
  if (settings.takes_parameters) {
    door.emplace([&observer](wire::ControlRequest request) { return observer.send(std::move(request)); },
                 [this, prefix](const ParameterDoor::Reply& reply) {
                   std::string bytes;
                   encode(reply, bytes);
                   link->publish(prefix + "_REPLY", bytes);
                 });
    link->subscribe(prefix + "_PARAMETER",
                    [this](std::span<const std::byte> bytes) { door->take(bytes, monotonic_ns()); });
  }
}

void Bridge::State::each_second(observer::Observer& observer, std::int64_t now_ns) {
  const StepIndex step = observer.view().step();
  if (silence.has_changed(observer.view(), now_ns) && !has_new_session) {
    notices.push_back(
        silence.is_silent()
            ? fmt::format("no message of session '{}' has come for 5 s; its health is not published until "
                          "one comes; look with 'slewring sessions' whether it still runs",
                          observer.session_name())
            : fmt::format("messages of session '{}' come again", observer.session_name()));
  }
  if (!silence.is_silent()) {
    outgoing->publish_directory(step);
    outgoing->publish_health(observer.view(), step);
  }
  if (receives())
    outgoing->publish(incoming ? incoming->counts() : lcm_log::InputCounts(), door ? door->refused() : 0, step);
}

void Bridge::run(observer::Observer& observer, const SceneView& scene,
                 const std::function<void(const std::string&)>& report) {
  State& state = *state_;
  state.open(observer, scene);
  state.has_new_session = false;
  wait_for_names(state.lists, observer);
  report(fmt::format("session '{}' on {}, channels {}_*", observer.session_name(), state.url.text(),
                     prefix_of(state.settings, observer.session_name(), state.lists)));
  const auto report_notices = [&] {
    for (const std::string& notice : std::exchange(state.notices, {})) report(notice);
    if (!state.incoming) return;
    for (const std::string& notice : state.incoming->take_notices()) report(notice);
  };
  std::int64_t next_ns = 0;
  bool has_ended = false;
  const auto is_over = [&] { return has_ended = observer.view().is_over() || state.has_new_session; };
  while (!has_ended && !observer.is_stopped()) {
    if (state.receives()) {
      state.link->handle(kInputWaitMs);
      observer.wait_for(is_over, {});
    } else {
      observer.wait_for(is_over, kLongestWait);
    }
    const std::int64_t now_ns = monotonic_ns();
    if (state.door) state.door->poll(now_ns);
    report_notices();
    if (now_ns < next_ns) continue;
    next_ns = now_ns + kSecondNs;
    state.each_second(observer, now_ns);
  }
  if (state.incoming && !has_ended) state.incoming->release();
  state.each_second(observer, monotonic_ns());
  report_notices();
  const observer::SessionView& view = observer.view();
  if (state.has_new_session && view.has_session()) {
    report("another session of this name has begun; start the bridge again for it");
  } else if (has_ended) {
    const std::string cause = view.end().value_or("");
    report(fmt::format("session '{}' has ended{}{}", observer.session_name(), cause.empty() ? "" : ": ", cause));
  }
}

Json Bridge::summary() const {
  const State& state = *state_;
  Json json = {{"published", state.outgoing ? state.outgoing->published() : 0},
               {"unsent", state.link ? state.link->unsent() : 0},
               {"incomplete_signals", state.outgoing ? state.outgoing->incomplete() : 0}};
  if (state.incoming) {
    const lcm_log::InputCounts& counts = state.incoming->counts();
    json["inputs"] = {
        {"applied", counts.applied}, {"gaps", counts.gaps}, {"lost", counts.lost}, {"unsent", state.unsent_inputs}};
    for (std::size_t i = 0; i < lcm_log::kCauses; ++i)
      json["inputs"]["refused"][std::string(to_text(static_cast<lcm_log::Cause>(i)))] = counts.refused[i];
  }
  if (state.door) json["refused_parameter_requests"] = state.door->refused();
  return json;
}

std::string Bridge::summary_text() const {
  const State& state = *state_;
  std::string text = fmt::format("{} messages published", state.outgoing ? state.outgoing->published() : 0);
  const auto add = [&](std::uint64_t number, std::string_view what) {
    if (number > 0) text += fmt::format(", {} {}", number, what);
  };
  add(state.link ? state.link->unsent() : 0, "not sent");
  add(state.outgoing ? state.outgoing->incomplete() : 0, "signal lists incomplete");
  if (state.incoming) {
    const lcm_log::InputCounts& counts = state.incoming->counts();
    text += fmt::format("\n{} inputs applied, {} lost in {} gaps", counts.applied, counts.lost, counts.gaps);
    add(state.unsent_inputs, "not sent into the session");
    const std::string refused = refusals_text(counts);
    if (!refused.empty()) text += "\nnot applied: " + refused;
  }
  if (state.door && state.door->refused() > 0)
    text += fmt::format("\n{} parameter requests damaged or refused by the bridge", state.door->refused());
  return text;
}

}  // namespace slew::bridge
