// SPDX-License-Identifier: Apache-2.0
// Writes DIR/known.mcap with messages of every topic and DIR/known.json with their contents.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <string>

#include "build_paths.h"
#include "recording/writer.h"
#include "transport/cdr/codec.h"
#include "transport/topics.h"
#include "wire_json.h"

namespace slew::recording {
namespace {

using nlohmann::json;

constexpr StepIndex kSteps = 1'500;
constexpr SimDuration kStep = milliseconds(1);
constexpr const char* kSceneText = "scene: {name: known}\ndescription: Überlast, 100 % — λ\n";

// numbers that a careless encoder or decoder changes
double awkward_number(std::uint64_t seed) {
  constexpr double kNumbers[] = {0.0,
                                 -0.0,
                                 1.0 / 3,
                                 -2.5e7,
                                 std::numeric_limits<double>::denorm_min(),
                                 std::numeric_limits<double>::max(),
                                 std::numeric_limits<double>::infinity(),
                                 -std::numeric_limits<double>::infinity(),
                                 std::numeric_limits<double>::quiet_NaN(),
                                 1e-300};
  return seed % 3 == 0 ? kNumbers[seed / 3 % std::size(kNumbers)] : 1e-3 * static_cast<double>(seed * 7919 % 100'003);
}

template <typename List>
void fill(List& list, std::size_t size, std::uint64_t seed) {
  list.resize(size);
  for (std::size_t i = 0; i < size; ++i) list[i] = awkward_number(seed + 31 * i);
}

wire::Header header_at(StepIndex step, wire::Role role) {
  wire::Header header;
  for (std::size_t i = 0; i < header.session.size(); ++i) header.session[i] = static_cast<std::uint8_t>(255 - 16 * i);
  header.role = role;
  header.incarnation = 1;
  header.epoch = 0;
  header.phase = step < 0 ? wire::Phase::init : wire::Phase::running;
  header.step = step;
  return header;
}

wire::SampleState state_at(StepIndex step) {
  const auto n = static_cast<std::uint64_t>(step);
  wire::SampleState state;
  state.used_step = step - 1;
  state.lost = static_cast<std::uint32_t>(step % 7);
  state.state_hash = n * 0x9E3779B97F4A7C15u;
  state.flags = 0x80000001u;
  state.offender = step % 2 == 0 ? -1 : 12;
  state.substeps = 4;
  return state;
}

// Writes messages and remembers their contents.
class KnownRecording {
 public:
  explicit KnownRecording(const std::filesystem::path& directory) {
    SessionIdentity identity;
    identity.scene = "known";
    identity.session_name = "verification";
    identity.session_id = "fe0102";
    identity.build = "test";
    identity.communication_step = kStep;
    expect_ok(Writer::create(directory / "known.mcap", identity, WriterLimits{}, writer_));
    expected_["metadata"]["slewring.recording"] = to_entries(identity);
    expect_ok(writer_->add_attachment("scene.yaml", "application/yaml", as_byte_span(kSceneText)));
    expected_["attachments"]["scene.yaml"] = kSceneText;

    std::ifstream file(SLEWRING_SOURCE_DIR "/idl/slewring.idl");
    const std::string idl((std::istreambuf_iterator<char>(file)), {});
    for (std::size_t i = 0; i < wire::kTopics; ++i) {
      const transport::TopicTraits& traits = transport::traits(static_cast<wire::Topic>(i));
      std::string type = traits.type_name;
      ChannelId channel{};
      expect_ok(writer_->add_channel({traits.name, type, idl, {}}, channel));
      channels_[static_cast<wire::Topic>(i)] = channel;
      expected_["topics"][traits.name] = {{"type", type}, {"messages", json::array()}};
    }
  }

  template <typename Message>
  void write(const Message& message, StepIndex step) {
    constexpr wire::Topic kTopic = transport::kTopicOf<Message>;
    json& messages = expected_["topics"][transport::traits(kTopic).name]["messages"];
    const auto sequence = static_cast<std::uint32_t>(messages.size());
    if (!transport::encode(message, buffer_)) fail("a message cannot be encoded");
    expect_ok(writer_->write(channels_[kTopic], {0, step, sequence, 0}, buffer_));
    messages.push_back({{"log_time", std::to_string(start_of(std::max<StepIndex>(step, 0), kStep).ns)},
                        {"sequence", sequence},
                        {"value", to_json(message)}});
  }

  void close(const std::filesystem::path& directory) {
    const TextMap summary = {{"result", "ended"}, {"lost", "0"}};
    expect_ok(writer_->close(summary));
    expected_["metadata"]["slewring.summary"] = summary;
    std::ofstream(directory / "known.json") << expected_;
  }

 private:
  [[noreturn]] static void fail(const std::string& text) {
    std::fprintf(stderr, "%s\n", text.c_str());
    std::exit(1);
  }
  static void expect_ok(const Status& status) {
    if (!status.is_ok()) fail(status.text);
  }

  std::unique_ptr<Writer> writer_;
  std::map<wire::Topic, ChannelId> channels_;
  std::vector<std::byte> buffer_;
  json expected_;
};

void write_session(KnownRecording& recording) {
  wire::SessionDescription session;
  session.header = header_at(kJoinStep, wire::Role::io);
  session.name = "verification";
  session.scene_name = "known";
  session.scene_text = kSceneText;
  session.assets = {{"bag.obj", 123'456'789'012, {}}, {"", 0, {}}};
  session.assets[0].sha256.fill(0xAB);
  session.build = "test";
  session.self_test = std::numeric_limits<std::uint64_t>::max();
  session.step_ns = kStep.ns;
  session.pace = Pace::free;
  session.window = 4;
  session.required_roles = 0b10111;
  session.host = "bench";
  session.pid = 4'000'000'000u;
  session.started_ns = 1'700'000'000'123'456'789;
  recording.write(session, kJoinStep);

  wire::NodeStatus status;
  status.header = header_at(kJoinStep, wire::Role::mechanics);
  status.state = wire::NodeState::fault;
  status.host = "bench";
  status.started_ns = std::numeric_limits<std::int64_t>::min();
  status.heard = {{wire::Role::io, 1, 2}, {wire::Role::hydraulics, 3, 255}};
  status.reason = std::string(wire::kMaxReasonLength, 'x');
  status.exit_code = -5;
  recording.write(status, kJoinStep);

  wire::VariableDirectory directory;
  directory.header = header_at(kJoinStep, wire::Role::hydraulics);
  directory.total = 2'000;
  directory.first = 1'024;
  directory.entries = {{"Cyl_Lift.force", "N"}, {"Bag.position.y", "m"}, {"", ""}};
  recording.write(directory, kJoinStep);
}

void write_step(KnownRecording& recording, StepIndex step) {
  const auto n = static_cast<std::uint64_t>(step);
  wire::Tick tick;
  tick.header = header_at(step, wire::Role::io);
  tick.flags = step == kSteps - 1 ? static_cast<std::uint32_t>(wire::TickFlag::end) : 0;
  tick.state_hash = ~n;
  fill(tick.controls, n % (wire::kMaxChannels + 1), n);
  tick.age.resize(tick.controls.size());
  for (std::size_t i = 0; i < tick.age.size(); ++i) tick.age[i] = static_cast<std::uint32_t>(n + i);
  for (std::uint64_t i = 0; i < n % 4; ++i) {
    tick.commands.push_back({n, std::string(i, 'p') + ".mass", awkward_number(n), -1'000'000'007});
  }
  recording.write(tick, step);

  const std::size_t ports = n % (coupling::kMaxPorts + 1);
  wire::MechanismMessage mechanism;
  mechanism.header = header_at(step, wire::Role::mechanics);
  mechanism.state = state_at(step);
  coupling::MechanismSample& m = mechanism.sample;
  m.W_kind = coupling::MobilityKind::step;
  std::uint64_t seed = n;
  for (coupling::PortArray* list :
       {&m.x, &m.v, &m.a, &m.a_free, &m.F_used, &m.F_line, &m.work, &m.impulse, &m.v_mean}) {
    fill(*list, ports, ++seed);
  }
  fill(m.W, ports * ports, n);
  recording.write(mechanism, step);

  wire::ActuatorMessage actuators;
  actuators.header = header_at(step, wire::Role::hydraulics);
  actuators.state = state_at(step);
  coupling::ActuatorSample& a = actuators.sample;
  a.flags = 7;
  for (coupling::PortArray* list : {&a.F, &a.F_dot, &a.K, &a.lambda, &a.D, &a.x_ref, &a.v_ref, &a.friction_scale,
                                    &a.work, &a.impulse, &a.p_A, &a.p_B, &a.Q_A, &a.Q_B}) {
    fill(*list, ports, ++seed);
  }
  fill(a.K_cross, n % 2 * ports * ports, ++seed);
  recording.write(actuators, step);

  wire::FlexibleMessage flexible;
  flexible.header = header_at(step, wire::Role::mechanics);
  fill(flexible.sample.q, n % 5, ++seed);
  fill(flexible.sample.u, n % 5, ++seed);
  fill(flexible.sample.frame, 13 * (n % 3), ++seed);
  recording.write(flexible, step);

  wire::ElasticMessage elastic;
  elastic.header = header_at(step, wire::Role::flex);
  elastic.state = state_at(step);
  elastic.sample.is_constant = step % 2 == 0;
  for (coupling::ModeArray* list : {&elastic.sample.Q, &elastic.sample.q_ref, &elastic.sample.u_ref}) {
    fill(*list, n % 5, ++seed);
  }
  for (coupling::ModePairs* list : {&elastic.sample.K, &elastic.sample.D, &elastic.sample.M})
    fill(*list, (n % 5) * (n % 5), ++seed);
  fill(elastic.sample.strain_energy, n % 3, ++seed);
  recording.write(elastic, step);

  wire::VariableBlock block;
  block.header = header_at(step, wire::Role::mechanics);
  block.first = 3;
  fill(block.values, n % 100 == 0 ? wire::kMaxVariablesPerBlock : n % 5, n);
  recording.write(block, step);
}

void write_occasional(KnownRecording& recording, StepIndex step) {
  const auto n = static_cast<std::uint64_t>(step);
  recording.write(
      wire::ControllerInput{"verification", "pid", "Input_Lift", wire::ControllerAction::write, -0.25, n, step - 2},
      step);
  recording.write(wire::ControllerLease{header_at(step, wire::Role::io), "pid", "Input_Slew", step % 2 == 0, "panel",
                                        "held by panel", n},
                  step);
  recording.write(wire::ControlRequest{"verification", ~n, wire::ControlAction::set_parameter, "Bag.mass", 1'500, -1},
                  step);
  recording.write(wire::ControlReply{header_at(step, wire::Role::io), ~n, true, 0.5 * static_cast<double>(step), "",
                                     "set Bag.mass to 1500"},
                  step);
  wire::Health health;
  health.header = header_at(step, wire::Role::recorder);
  health.state = wire::NodeState::holding;
  health.is_waiting = true;
  health.waiting_for = wire::Role::hydraulics;
  health.waiting_step = step + 1;
  health.steps_done = n;
  health.step_time_mean = 12.5e-6;
  health.step_time_max = awkward_number(n);
  health.slip_ns = -1;
  recording.write(health, step);
  recording.write(wire::ResendRequest{header_at(step, wire::Role::flex), wire::Role::io, 2, step + 3}, step);
  wire::StatePart part;
  part.header = header_at(step, wire::Role::io);
  part.role = wire::Role::hydraulics;
  part.request = ~n;
  part.state_hash = n << 40;
  part.total = 20'000;
  part.first = wire::kMaxStatePart;
  for (std::uint64_t i = 0; i < n % 300; ++i) part.bytes.push_back(static_cast<std::uint8_t>(i));
  recording.write(part, step);
}

}  // namespace
}  // namespace slew::recording

int main(int argc, char** argv) {
  using namespace slew;
  using namespace slew::recording;
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s DIRECTORY\n", argv[0]);
    return 2;
  }
  const std::filesystem::path directory = argv[1];
  std::filesystem::remove(directory / "known.mcap");
  KnownRecording recording(directory);
  write_session(recording);
  for (StepIndex step = 0; step < kSteps; ++step) {
    write_step(recording, step);
    if (step % 100 == 0) write_occasional(recording, step);
  }
  recording.close(directory);
  return 0;
}
