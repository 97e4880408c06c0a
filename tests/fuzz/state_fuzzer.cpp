// SPDX-License-Identifier: Apache-2.0
// States as nodes load them: any bytes in the place of a node's state are refused, which leaves the node as after a
// reset, or they become a state that can be stepped and shown, the same one each time.
//
// An input is a list of changes to a state that the node has just saved: the kept inputs outlive changes of layouts.
// Sums are made right after the changes, in three of four inputs.
#include <array>
#include <cstring>
#include <memory>
#include <vector>

#include "build_paths.h"
#include "core/state_hash.h"
#include "flex_node/flex_subsystem.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "io_node/tick_follower.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "node/checkpoint.h"
#include "tests/fuzz/bytes.h"

namespace {

using namespace slew;

constexpr StepIndex kStep = 30;

// ---- layouts, as in libs/node/checkpoint.cpp and libs/core/state_bytes.h -------------------------------------------

constexpr std::size_t kFront = 30;  // bytes in front of the sum
constexpr std::size_t kSum = sizeof(std::uint64_t);
constexpr std::size_t kHeader = 32, kLengthAt = 16, kSumAt = 24;  // offsets in a subsystem's own bytes

std::uint64_t sum_of(const std::byte* data, std::size_t size) {
  StateHash hash;
  hash.add_bytes(data, size);
  return hash.digest();
}

void repair_own(std::vector<std::byte>& bytes, std::size_t begin) {
  if (bytes.size() < begin + kHeader) return;
  std::byte* const header = bytes.data() + begin;
  const std::uint64_t length = bytes.size() - begin - kHeader;
  const std::uint64_t sum = sum_of(header + kHeader, length);
  std::memcpy(header + kLengthAt, &length, sizeof length);
  std::memcpy(header + kSumAt, &sum, sizeof sum);
}

void repair_front(std::vector<std::byte>& bytes) {
  if (bytes.size() < kFront + kSum) return;
  const std::uint64_t sum = sum_of(bytes.data(), kFront);
  std::memcpy(bytes.data() + kFront, &sum, sizeof sum);
}

// Bytes, whole numbers and lengths that are others.
void change(std::vector<std::byte>& bytes, fuzz::Choices& choices) {
  while (choices.has_more() && !bytes.empty()) {
    const std::size_t at = (std::size_t{choices.byte()} << 8 | choices.byte()) % bytes.size();
    const std::size_t room = bytes.size() - at;
    switch (choices.below(4)) {
      case 0:
        bytes[at] = std::byte{choices.byte()};
        break;
      case 1: {
        const double value = choices.number();
        std::memcpy(bytes.data() + at, &value, std::min(room, sizeof value));
        break;
      }
      case 2: {
        const std::int64_t value = static_cast<std::int8_t>(choices.byte());
        std::memcpy(bytes.data() + at, &value, std::min(room, sizeof value));
        break;
      }
      default:
        if (choices.byte() % 8 == 0) bytes.resize(at);
        break;
    }
  }
}

// ---- physics nodes

scene::Scene load_scene(const std::string& file) {
  return scene::load_file(SLEWRING_SOURCE_DIR "/scenes/" + file);
}

// A subsystem, a state that it has saved, and its partners' samples of that step.
struct Loaded {
  coupling::Subsystem* subsystem = nullptr;
  node::Checkpoint saved;
  coupling::PartnerSamples partners;
  std::size_t channels = 0;
  std::uint64_t reset_hash = 0;
};

void expect(const Status& status) {
  fuzz::require(status.is_ok());
}

// Mechanics, hydraulics and modes of a scene, as far as kStep.
class Machine {
 public:
  explicit Machine(const std::string& file)
      : scene_(load_scene(file)),
        mechanics_(mechanics_node::make_mechanics_subsystem(scene_)),
        hydraulics_(hydraulics_node::make_hydraulics_subsystem(scene_)) {
    if (scene_.has_modes()) flex_ = flex_node::make_flex_subsystem(scene_);
    start();
    const std::vector<double> controls(scene_.inputs.size(), 0.3);
    coupling::OwnSample mechanics, hydraulics;
    for (StepIndex n = 0; n < kStep; ++n) {
      mechanics_->step(n, of_mechanics(), controls, mechanics);
      hydraulics_->step(n, of_hydraulics(), controls, hydraulics);
      mechanics_sample_ = mechanics;
      hydraulics_sample_ = hydraulics;
    }
  }

  [[nodiscard]] Loaded mechanics() { return loaded(*mechanics_, of_mechanics()); }
  [[nodiscard]] Loaded hydraulics() { return loaded(*hydraulics_, of_hydraulics()); }
  [[nodiscard]] Loaded flex() {
    coupling::PartnerSamples partners;
    partners.flexible = &mechanics_sample_.flexible;
    return loaded(*flex_, partners);
  }

 private:
  void start() {
    coupling::OwnSample init;
    static_cast<void>(mechanics_->first_sample(init));
    coupling::PartnerSamples partners;
    partners.mechanism = &init.mechanism;
    expect(hydraulics_->start(partners, hydraulics_sample_));
    partners = {};
    partners.actuators = &hydraulics_sample_.actuators;
    if (flex_ != nullptr) {
      static_cast<void>(flex_->first_sample(flex_sample_));
      partners.elastic = &flex_sample_.elastic;
    }
    expect(mechanics_->start(partners, mechanics_sample_));
    if (flex_ == nullptr) return;
    partners = {};
    partners.flexible = &mechanics_sample_.flexible;
    expect(flex_->start(partners, flex_sample_));
  }
  [[nodiscard]] coupling::PartnerSamples of_mechanics() const {
    coupling::PartnerSamples partners;
    partners.actuators = &hydraulics_sample_.actuators;
    return partners;
  }
  [[nodiscard]] coupling::PartnerSamples of_hydraulics() const {
    coupling::PartnerSamples partners;
    partners.mechanism = &mechanics_sample_.mechanism;
    return partners;
  }
  [[nodiscard]] Loaded loaded(coupling::Subsystem& subsystem, const coupling::PartnerSamples& partners) const {
    Loaded loaded{&subsystem, {}, partners, scene_.inputs.size(), 0};
    wire::SampleState published;
    published.state_hash = subsystem.state_hash();
    node::save_node(subsystem, published, kStep, loaded.saved);
    fuzz::require(loaded.saved.bytes.size() > kFront + kSum + kHeader);
    subsystem.reset();
    loaded.reset_hash = subsystem.state_hash();
    return loaded;
  }

  scene::Scene scene_;
  std::unique_ptr<coupling::Subsystem> mechanics_, hydraulics_, flex_;
  coupling::OwnSample mechanics_sample_, hydraulics_sample_, flex_sample_;
};

void go_on(const Loaded& of) {
  const std::vector<double> controls(of.channels, 0.3);
  std::vector<double> values(of.subsystem->variables().size());
  coupling::OwnSample sample;
  for (StepIndex n = kStep; n < kStep + 3; ++n) {
    const StepReport report = of.subsystem->step(n, of.partners, controls, sample);
    static_cast<void>(of.subsystem->offender_name(report.offender));
    of.subsystem->read_variables(values);
  }
  static_cast<void>(of.subsystem->failure_text());
}

void try_physics(const Loaded& of, bool has_right_sums, fuzz::Choices& choices) {
  node::Checkpoint checkpoint = of.saved;
  change(checkpoint.bytes, choices);
  if (has_right_sums) {
    repair_front(checkpoint.bytes);
    repair_own(checkpoint.bytes, kFront + kSum);
  }
  const auto require_refused = [&](const Status& status) {
    fuzz::require(status.code == ExitCode::bad_input && !status.text.empty());
    fuzz::require(of.subsystem->state_hash() == of.reset_hash);
  };
  // a copy with its own end: a sanitizer sees reads beyond it
  const std::size_t front = std::min(checkpoint.bytes.size(), kFront + kSum);
  const std::vector<std::byte> own(checkpoint.bytes.begin() + static_cast<std::ptrdiff_t>(front),
                                   checkpoint.bytes.end());
  coupling::OwnSample sample;
  const Status loaded = of.subsystem->load(own, sample);
  if (loaded.is_ok()) {
    // a node takes a state of the hash that it had where it was saved
    checkpoint.state_hash = of.subsystem->state_hash();
    go_on(of);
  } else {
    require_refused(loaded);
  }
  wire::SampleState published;
  const Status of_node = node::load_node(checkpoint, *of.subsystem, published, sample);
  if (!of_node.is_ok()) return require_refused(of_node);
  fuzz::require(loaded.is_ok() && published.state_hash == checkpoint.state_hash);
}

// ---- io

io_node::IoConfig io_config() {
  io_node::IoConfig config;
  io_node::ChannelConfig lift, slew;
  lift.name = "Input_Lift";
  lift.ramp = 0.3;
  slew.name = "Input_Slew";
  slew.scale = 0.7;
  config.channels = {lift, slew};
  config.parameters = {{"Bag.mass", 1000}, {"Cyl_Lift.coupling", 2}};
  return config;
}

void try_io(bool has_right_sums, fuzz::Choices& choices) {
  static const io_node::IoConfig config = io_config();
  io_node::TickFollower follower(config);
  wire::Tick tick;
  tick.header.step = 0;
  tick.controls.resize(config.channels.size());
  tick.controls[0] = 0.5;
  tick.commands.push_back({0, "Bag.mass", 1500, 40'000'000});
  follower.take(tick);
  node::Checkpoint checkpoint = follower.state(1);
  change(checkpoint.bytes, choices);
  if (has_right_sums) repair_own(checkpoint.bytes, 0);
  checkpoint.bytes.shrink_to_fit();
  const Status status = follower.begin(&checkpoint);
  fuzz::require(status.is_ok() || (status.code == ExitCode::bad_input && !status.text.empty()));
  if (!status.is_ok()) return;
  for (tick.header.step = 1; tick.header.step < 4; ++tick.header.step) follower.take(tick);
  expect(follower.begin(&checkpoint));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Machine rigid("single_cylinder.yaml"), bending("truck_crane_flexible.yaml");
  static const Loaded physics[] = {rigid.mechanics(), rigid.hydraulics(), bending.flex()};
  fuzz::Choices choices(data, size);
  const std::size_t which = choices.below(std::size(physics) + 1);
  const bool has_right_sums = choices.below(4) != 0;
  if (which == std::size(physics)) {
    try_io(has_right_sums, choices);
  } else {
    try_physics(physics[which], has_right_sums, choices);
  }
  return 0;
}
