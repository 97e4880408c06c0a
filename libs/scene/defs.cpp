// SPDX-License-Identifier: Apache-2.0
#include "scene/defs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "scene/cpu_places.h"

namespace slew::scene {
namespace {

// a step of 1.0000001 ms counts as a typing error
constexpr double kWholeNanosecondTolerance = 1e-3;  // ns

constexpr Range kStepRange{.min = kMinStep, .max = kMaxStep, .min_is_open = false, .max_is_open = false};
constexpr Range kDurationRange{.min = 0, .max = 1e6, .min_is_open = false, .max_is_open = false};
constexpr std::int64_t kMaxWindow = 64;
constexpr Range kWindowRange{.min = 0, .max = kMaxWindow, .min_is_open = false, .max_is_open = false};
constexpr Range kTimeoutRange{.min = 0.01, .max = 60, .min_is_open = false, .max_is_open = false};
constexpr Range kBlockRange{.min = 0, .max = 15, .min_is_open = false, .max_is_open = false};
constexpr Range kChannelRange{.min = 0, .max = 63, .min_is_open = false, .max_is_open = false};
constexpr Range kDeadZoneRange{.min = 0, .max = 1, .min_is_open = false};
constexpr Range kRampRange{.min = 0, .max = 60, .min_is_open = false, .max_is_open = false};
constexpr Range kDelayRange{.min = 1, .max = 64, .min_is_open = false, .max_is_open = false};
constexpr Range kWaitRange{.min = 0.001, .max = 60, .min_is_open = false, .max_is_open = false};
constexpr Range kRawRange{.min = -1, .max = 1, .min_is_open = false, .max_is_open = false};
constexpr Range kExchangeRange{.min = 1, .max = 64, .min_is_open = false, .max_is_open = false};
constexpr Range kStallRange{.min = 0.5, .max = 3600, .min_is_open = false, .max_is_open = false};
constexpr Range kGiveUpRange{.min = 0.5, .max = 60, .min_is_open = false, .max_is_open = false};
constexpr Range kRejoinRange{.min = 0, .max = 3600, .min_is_open = false, .max_is_open = false};
constexpr Range kBudgetRange{.min = 0, .max = 0.1, .min_is_open = false, .max_is_open = false};
constexpr Range kToleranceRange{.min = 1e-10, .max = 1e-3, .min_is_open = false, .max_is_open = false};
constexpr Range kOverrunAfterRange{.min = 0, .max = 1e6, .min_is_open = false, .max_is_open = false};
constexpr Range kOverrunLagRange{.min = 0.001, .max = 60, .min_is_open = false, .max_is_open = false};
constexpr Range kGraceRange{.min = 0, .max = 60, .min_is_open = false, .max_is_open = false};
constexpr Range kEveryRange{.min = 1, .max = 1e6, .min_is_open = false, .max_is_open = false};

constexpr Range kBitsRange{.min = 8, .max = kAllBits, .min_is_open = false, .max_is_open = false};

constexpr std::string_view kStepsKept[] = {"all", "ticks", "none"};
constexpr std::string_view kCodings[] = {"zstd", "columns"};
constexpr std::string_view kPaces[] = {"real", "free"};
constexpr std::string_view kModes[] = {"lockstep", "free_running"};
constexpr std::string_view kLevels[] = {"hold", "linear", "two", "tlm"};
constexpr std::string_view kCouplingAlarms[] = {"stop", "warn"};
constexpr std::string_view kContactUses[] = {"tested", "off"};
constexpr std::string_view kSolutions[] = {"split", "monolithic"};
constexpr std::string_view kElasticExchanges[] = {"once", "every_step", "condensed"};
constexpr std::string_view kOverrunPolicies[] = {"slip", "hold", "stop"};
constexpr std::string_view kShedLoads[] = {"none", "view", "variables"};
constexpr std::string_view kControllerModes[] = {"sampled", "lockstep"};
constexpr std::string_view kSubs[] = {"control_voltage"};
constexpr std::string_view kInterpolations[] = {"linear", "step"};

constexpr ReadBy kReadByMonolith[] = {
    read_by<&SessionDef::solution, Solution::monolithic>("solution", "solution: monolithic")};
constexpr ReadBy kReadByRealPace[] = {read_by<&SessionDef::pace, Pace::real>("pace", "pace: real")};
constexpr ReadBy kReadByStopping[] = {
    read_by<&SessionDef::pace, Pace::real>("pace", "pace: real"),
    read_by<&SessionDef::overrun, OverrunPolicy::hold, OverrunPolicy::stop>("overrun", "overrun: hold or stop")};
constexpr ReadBy kReadByLockstep[] = {
    read_by<&InputDef::controller, ControllerMode::lockstep>("controller", "controller: lockstep")};

constexpr Field kSessionFields[] = {
    field<&SessionDef::step>("step",
                             {.dimension = Dimension::time,
                              .range = kStepRange,
                              .doc = "communication step H, whole nanoseconds; a warning outside 0.1 to 10 ms"}),
    field<&SessionDef::duration>(
        "duration",
        {.dimension = Dimension::time, .range = kDurationRange, .doc = "length of a run; 0: until stopped"}),
    field<&SessionDef::pace>("pace",
                             {.choices = kPaces, .doc = "real: paced by the wall clock; free: as fast as possible"}),
    field<&SessionDef::coupling>("coupling", {.change = Change::live,
                                              .choices = kLevels,
                                              .doc = "level at which a node uses the partner's model inside a step, at "
                                                     "every cylinder without a level of its own"}),
    field<&SessionDef::flexible>(
        "flexible",
        {.choices = kElasticExchanges,
         .doc = "exchange of the elastic forces of the modes. once: the flex node publishes them at the start, and no "
                "node waits; every_step: about each step's modal coordinates, and the mechanics waits; condensed: it "
                "integrates the modes (trapezoidal, one sub-step) and publishes the condensed forces"}),
    field<&SessionDef::mode>("mode",
                             {.choices = kModes,
                              .doc = "node without the partner's sample. lockstep: it waits, with the same result on "
                                     "any machine; free_running: for wait_budget at most, then it continues its copy "
                                     "of the partner's model (real pace; levels linear and two)"}),
    field<&SessionDef::exchange_every>(
        "exchange_every", {.range = kExchangeRange,
                           .doc = "steps between two exchanges of mechanics and hydraulics, for which each node "
                                  "continues its copy of the partner's model; ticks and inputs arrive at every step"}),
    field<&SessionDef::coupling_alarm>("coupling_alarm",
                                       {.choices = kCouplingAlarms,
                                        .doc = "coupling outside of its validity. stop: the session ends and names the "
                                               "port when level linear or two diverges, and a free-running session "
                                               "above the limit of omega_H does not start; warn: red lamps and flags"}),
    field<&SessionDef::wait_budget>("wait_budget",
                                    {.dimension = Dimension::time,
                                     .range = kBudgetRange,
                                     .doc = "longest time a free-running node waits for a sample; 0: half a step"}),
    field<&SessionDef::solution>(
        "solution", {.choices = kSolutions,
                     .doc = "split: every node solves its own part; monolithic: one system in one process, the "
                            "reference for accuracy, without effect of coupling, formulation and integrators"}),
    field<&SessionDef::rtol>(
        "rtol",
        {.range = kToleranceRange, .read_by = kReadByMonolith, .doc = "relative tolerance of a monolithic solution"}),
    field<&SessionDef::contact>(
        "contact",
        {.choices = kContactUses, .doc = "off: the session omits the `contacts`, with their variables and cost"}),
    field<&SessionDef::window>(
        "window",
        {.range = kWindowRange,
         .doc =
             "ticks ahead of the slowest node; 0: 1 in real pace, 4 in free pace, those of 100 ms when free-running"}),
    field<&SessionDef::controller_timeout>("controller_timeout", {.dimension = Dimension::time,
                                                                  .range = kTimeoutRange,
                                                                  .doc = "silence, or time out of step, after which a "
                                                                         "controller's channel goes to neutral"}),
    field<&SessionDef::rejoin>("rejoin",
                               {.dimension = Dimension::time,
                                .range = kRejoinRange,
                                .doc = "time for which the place of a lost physics node is held for a process that "
                                       "continues from the last checkpoint; 0: no checkpoints, the session ends"}),
    field<&SessionDef::stall_timeout>("stall_timeout", {.dimension = Dimension::time,
                                                        .range = kStallRange,
                                                        .doc = "longest wait of a step for one message of a node whose "
                                                               "other messages arrive; then the node is given up"}),
    field<&SessionDef::give_up_after>(
        "give_up_after", {.dimension = Dimension::time,
                          .range = kGiveUpRange,
                          .doc = "silence after which a node is given up: the session ends with exit code 4, or with "
                                 "rejoin its place is held. Nodes keep the ticks and samples of this time and 0.5 s"}),
    field<&SessionDef::overrun>(
        "overrun", {.choices = kOverrunPolicies,
                    .read_by = kReadByRealPace,
                    .doc = "loss of real pace. slip: whole steps of wall time are dropped and counted; hold: the "
                           "session pauses until it is resumed; stop: it ends with exit code 3"}),
    field<&SessionDef::overrun_after>(
        "overrun_after",
        {.range = kOverrunAfterRange,
         .read_by = kReadByStopping,
         .doc =
             "steps in a row longer than session.step after which overrun takes effect; 0: overrun_lag alone decides"}),
    field<&SessionDef::overrun_lag>("overrun_lag",
                                    {.dimension = Dimension::time,
                                     .range = kOverrunLagRange,
                                     .read_by = kReadByRealPace,
                                     .doc = "time behind the wall clock after which overrun takes effect"}),
    field<&SessionDef::shed>(
        "shed", {.choices = kShedLoads,
                 .read_by = kReadByRealPace,
                 .doc = "what is left out on overrun, in this order, never a step's messages. view: the flex node's "
                        "variables; variables: also those of mechanics and hydraulics while no controller steers"}),
    field<&SessionDef::start_grace>("start_grace", {.dimension = Dimension::time,
                                                    .range = kGraceRange,
                                                    .read_by = kReadByRealPace,
                                                    .doc = "time after step 0 without overrun checks"}),
    field<&SessionDef::cpus>(
        "cpus", {.doc = "processors of the nodes that `run` starts, as \"mechanics=1, hydraulics=0\"; empty: any"}),
};

constexpr Field kInputFields[] = {
    field<&InputDef::primitive>(
        "primitive", {.presence = Presence::required,
                      .reference = "component or force",
                      .doc = "component whose control signal it sets, point force or torque that it multiplies"}),
    field<&InputDef::sub>("sub", {.choices = kSubs, .doc = "signal of the component"}),
    field<&InputDef::block>("block", {.range = kBlockRange, .doc = "block: that of the joystick which moves it"}),
    field<&InputDef::channel>(
        "channel", {.range = kChannelRange, .doc = "channel of the block, of one input alone: axis or button"}),
    field<&InputDef::scale>("scale", {.dimension = Dimension::electric_signal,
                                      .doc = "control signal at full stick; negative reverses the direction"}),
    field<&InputDef::dead_zone>(
        "dead_zone", {.range = kDeadZoneRange, .doc = "raw values up to this are 0, larger ones are not rescaled"}),
    field<&InputDef::ramp>("ramp", {.dimension = Dimension::time,
                                    .range = kRampRange,
                                    .doc = "shortest time from neutral to full stick; 0: none"}),
    field<&InputDef::rate_limit>("rate_limit",
                                 {.dimension = Dimension::frequency,
                                  .range = kNotNegative,
                                  .doc = "largest change per second of the value behind the dead zone; 0: any"}),
    field<&InputDef::controller>(
        "controller",
        {.choices = kControllerModes,
         .doc = "sampled: a tick takes the controller's latest value; lockstep: it waits for the value computed from a "
                "certain step's variables (the same bits on any machine), step 0 for a controller"}),
    field<&InputDef::controller_delay>("controller_delay",
                                       {.range = kDelayRange,
                                        .read_by = kReadByLockstep,
                                        .doc = "tick n takes the value computed from step n less this, or from the "
                                               "last step before with variables (recording.every)"}),
    field<&InputDef::controller_wait>("controller_wait",
                                      {.dimension = Dimension::time,
                                       .range = kWaitRange,
                                       .read_by = kReadByLockstep,
                                       .doc = "longest wait of a tick; then the input holds its value, and goes to "
                                              "neutral after session.controller_timeout"}),
    field<&InputDef::supervisor>("supervisor",
                                 {.doc = "controller that may take the input from its holder; empty: none"}),
};

constexpr Field kScriptFields[] = {
    field<&ScriptDef::interpolation>("interpolation",
                                     {.choices = kInterpolations,
                                      .doc = "between two points a line, of which a step gets the mean, or the earlier "
                                             "value; a digital input always holds"}),
};

constexpr Field kScriptTrackFields[] = {
    field<&ScriptTrack::points>(
        "points",
        {.dimension = Dimension::time,
         .range = kRawRange,
         .has_jumps = true,
         .doc = "points [time, raw value -1 to 1]; two at one time are a jump; the first and last value are held"}),
};

constexpr Field kScriptChangeFields[] = {
    field<&ScriptChange::at>("at", {.dimension = Dimension::time,
                                    .range = kDurationRange,
                                    .presence = Presence::required,
                                    .doc = "time of the change, from the first step on that begins then or later"}),
    field<&ScriptChange::set>("set", {.presence = Presence::required, .doc = "live parameter, Element.key"}),
    field<&ScriptChange::over>("over",
                               {.dimension = Dimension::time,
                                .range = kRampRange,
                                .doc = "duration of the change, rounded to whole steps; default: the parameter's own"}),
};

constexpr Field kRecordingFields[] = {
    field<&RecordingDef::every>("every", {.range = kEveryRange, .doc = "steps between two published values"}),
    field<&RecordingDef::variables>("variables", {.doc = "names of variables, or patterns with * and ?"}),
    field<&RecordingDef::steps>(
        "steps", {.choices = kStepsKept,
                  .doc = "stored messages of the steps. all: ticks and samples; ticks: ticks and digests of the state "
                         "hashes, enough for replay and its check; none: variables and events alone, no replay"}),
    field<&RecordingDef::coding>("coding",
                                 {.choices = kCodings,
                                  .doc = "zstd: for every MCAP program; columns: a third of the size or less, for "
                                         "Slewring and programs with a decoder (recording-format.md)"}),
    field<&RecordingDef::significant_bits>("significant_bits",
                                           {.range = kBitsRange,
                                            .doc = "bits of a recorded value of a variable, rounded; 53: all, 24: "
                                                   "single precision. Ticks, samples and hashes keep all"}),
};

constexpr Field kPlotFields[] = {
    field<&PlotDef::title>("title", {.doc = "heading; without it the plot's name"}),
    field<&PlotDef::variables>("variables", {.presence = Presence::required, .doc = "names or patterns of variables"}),
};

}  // namespace

SimDuration SessionDef::step_duration() const noexcept {
  return duration_of_seconds(step);
}

StepIndex SessionDef::steps() const noexcept {
  return std::llround(duration / step_duration().seconds());
}

std::int64_t SessionDef::window_steps() const noexcept {
  if (window > 0) return window;
  if (mode == ExchangeMode::free_running) {
    return std::clamp<std::int64_t>(kLongestCopy.ns / step_duration().ns, 1, kMaxWindow);
  }
  return pace == Pace::real ? 1 : 4;
}

SimDuration SessionDef::wait_budget_duration() const noexcept {
  return wait_budget > 0 ? duration_of_seconds(wait_budget) : SimDuration{step_duration().ns / 2};
}

std::span<const Field> session_fields() noexcept {
  return kSessionFields;
}
std::span<const Field> input_fields() noexcept {
  return kInputFields;
}
std::span<const Field> script_fields() noexcept {
  return kScriptFields;
}
std::span<const Field> script_track_fields() noexcept {
  return kScriptTrackFields;
}
std::span<const Field> script_change_fields() noexcept {
  return kScriptChangeFields;
}
std::span<const Field> recording_fields() noexcept {
  return kRecordingFields;
}
std::span<const Field> plot_fields() noexcept {
  return kPlotFields;
}

std::string_view obstacle_of(const SessionDef& session, coupling::Level level) noexcept {
  const bool is_free_running = session.mode == ExchangeMode::free_running;
  if (is_free_running && (level == coupling::Level::hold || level == coupling::Level::tlm)) {
    return "a free-running node continues its partner's model, which this level does not provide";
  }
  if (session.exchange_every > 1 && level == coupling::Level::tlm) {
    return "the waves of this level need an exchange at every step";
  }
  return "";
}

namespace {

void validate_free_running(const SessionDef& session, Problems& errors) {
  const auto refuse = [&](const char* key, const char* what, const char* expected) {
    errors.push_back({key, what, expected, ""});
  };
  if (session.pace == Pace::free) {
    refuse("session.pace", "a free-running session has no other clock than the wall's", "real");
  }
  if (session.flexible != coupling::ElasticExchange::once) {
    refuse("session.flexible", "elastic forces that are published step by step cannot be continued without new samples",
           "once");
  }
  if (session.exchange_every > 1) {
    refuse("session.exchange_every", "a free-running node uses every sample that arrives", "1");
  }
}

void validate_rejoin(const SessionDef& session, Problems& errors) {
  if (const std::string_view obstacle = obstacle_to_saving(session); !obstacle.empty()) {
    errors.push_back({"session.rejoin", "no other process can take over: " + std::string(obstacle), "0", ""});
  }
}

}  // namespace

std::string_view obstacle_to_saving(const SessionDef& session) noexcept {
  if (session.mode == ExchangeMode::free_running) {
    return "in a free-running session the clock determines which samples a step uses, and a state alone does not "
           "determine how "
           "it goes on";
  }
  if (session.solution == Solution::monolithic) {
    return "a monolithic solution is CVODE's, whose history cannot be restored";
  }
  return "";
}

void validate(const SessionDef& session, Problems& errors, Problems& warnings) {
  if (session.rejoin > 0) validate_rejoin(session, errors);
  const double nanoseconds = session.step * 1e9;
  if (std::abs(nanoseconds - std::round(nanoseconds)) > kWholeNanosecondTolerance) {
    errors.push_back({"session.step", fmt::format("{} s is not a whole number of nanoseconds", session.step),
                      fmt::format("{} ns", std::llround(nanoseconds)), ""});
  }
  if (session.step < kMinUsualStep || session.step > kMaxUsualStep) {
    warnings.push_back({"session.step", fmt::format("{} ms is outside 0.1 to 10 ms", session.step * 1e3), "", ""});
  }
  // the run takes the nearest whole number of steps
  if (session.duration > 0 && session.duration < session.step / 2) {
    errors.push_back({"session.duration",
                      fmt::format("{} ms are less than half a step of {} ms: the run would have no step",
                                  session.duration * 1e3, session.step * 1e3),
                      "at least one session.step, or 0 for a run without end", ""});
  }
  if (session.overrun_after > 0 && session.overrun == OverrunPolicy::slip) {
    warnings.push_back({"session.overrun_after", "it has no effect with session.overrun: slip", "hold or stop", ""});
  }
  if (session.mode == ExchangeMode::free_running) validate_free_running(session, errors);
  const double exchange = session.step * static_cast<double>(session.exchange_every);
  if (session.exchange_every > 1 && exchange > kMaxStep * (1 + 1e-9)) {
    errors.push_back({"session.exchange_every",
                      fmt::format("{} steps of {} ms are {} ms between two exchanges", session.exchange_every,
                                  session.step * 1e3, exchange * 1e3),
                      fmt::format("at most {} ms", kMaxStep * 1e3), ""});
  }
  if (session.wait_budget > 0 && session.mode != ExchangeMode::free_running) {
    errors.push_back({"session.wait_budget", "a session in lockstep waits without limit",
                      "session.mode: free_running beside it", ""});
  }
  if (session.solution == Solution::monolithic &&
      (session.mode == ExchangeMode::free_running || session.exchange_every > 1)) {
    errors.push_back({"session.solution", "a monolithic solution exchanges nothing",
                      "split, or session.mode: lockstep and session.exchange_every: 1", ""});
  }
  if (session.solution == Solution::monolithic && session.flexible == coupling::ElasticExchange::condensed) {
    errors.push_back({"session.flexible",
                      "'condensed' leaves the modes to the flex node, a monolithic solution has them", "once", ""});
  }
  if (session.overrun_lag < session.step) {
    errors.push_back({"session.overrun_lag",
                      fmt::format("{} ms are less than a step of {} ms", session.overrun_lag * 1e3, session.step * 1e3),
                      "at least session.step", ""});
  }
  std::vector<CpuPlace> places;
  if (const Status cpus = parse_cpu_places(session.cpus, places); !cpus.is_ok()) {
    errors.push_back({"session.cpus", cpus.text, "such as \"mechanics=1, hydraulics=0\"", ""});
  }
  if (const std::string_view obstacle = obstacle_of(session, session.coupling); !obstacle.empty()) {
    errors.push_back({"session.coupling", std::string(obstacle), "two or linear", ""});
  }
}

void validate(const std::vector<InputDef>& inputs, Problems& errors) {
  std::map<std::pair<std::int64_t, std::int64_t>, std::string> by_channel;
  std::map<std::string, std::string> by_primitive;
  for (const InputDef& input : inputs) {
    const auto [same_channel, is_new_channel] = by_channel.emplace(std::pair(input.block, input.channel), input.name);
    if (!is_new_channel) {
      errors.push_back(
          {input.name + ".channel",
           fmt::format("channel {} of block {} is taken by '{}'", input.channel, input.block, same_channel->second),
           "a channel of its own", ""});
    }
    const auto [same_primitive, is_new_primitive] = by_primitive.emplace(input.primitive, input.name);
    if (!is_new_primitive && !input.primitive.empty()) {
      errors.push_back({input.name + ".primitive",
                        fmt::format("'{}' is driven by '{}' already", input.primitive, same_primitive->second),
                        "one input for a component", ""});
    }
  }
  if (inputs.size() > kMaxInputs) {
    errors.push_back({inputs[kMaxInputs].name, fmt::format("there are {} inputs", inputs.size()),
                      fmt::format("at most {}", kMaxInputs), ""});
  }
}

}  // namespace slew::scene
