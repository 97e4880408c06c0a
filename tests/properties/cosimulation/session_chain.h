// The physics subsystems of a scene stepped by hand under inputs that move, to be saved and continued by another chain.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "coupling/subsystem.h"
#include "scene/scene.h"

namespace slew::testing {

// A parameter change that begins at a step.
struct ChainChange {
  StepIndex at = 0;
  std::string path;
  double value = 0;
  SimDuration over;
};

// Driving of a chain; the same for a continued one.
struct Drive {
  std::vector<ChainChange> changes{};
  // Raw value -1..1 of every channel; none: to and fro, each at its own pace.
  std::vector<double> held_sticks{};
  // How old the newest samples of mechanics and hydraulics are at a step; none: as the scene exchanges.
  std::function<StepIndex(StepIndex)> ages{};
};

// Small changes of every number of the scene that may be changed live, ten steps from the start and of different
// lengths: at step 100 some have arrived and some are under way.
[[nodiscard]] std::vector<ChainChange> small_changes(const scene::Scene& scene);

enum Part : std::size_t { kMechanics, kHydraulics, kFlex, kParts };

class SessionChain {
 public:
  // scene and drive outlive the chain.
  SessionChain(const scene::Scene& scene, const Drive& drive);

  void start();
  void step();
  void run_to(StepIndex n) {
    while (n_ < n) step();
  }

  using Saved = std::array<std::vector<std::byte>, kParts>;
  [[nodiscard]] Saved save() const;
  // In the place of start(): from what another chain saved now; its samples that are still to be exchanged with it.
  void go_on(const Saved& saved, const SessionChain& from);

  // Fails the test, and gives false, where anything differs in a bit: samples, reports, hashes, variables.
  [[nodiscard]] bool is_same_as(const SessionChain& other) const;

  [[nodiscard]] StepIndex n() const noexcept { return n_; }
  // Null: the scene has no such part.
  [[nodiscard]] coupling::Subsystem* part(Part part) const noexcept { return parts_[part].get(); }
  [[nodiscard]] coupling::OwnSample& sample(Part part) noexcept { return now_[part]; }
  [[nodiscard]] const StepReport& report(Part part) const noexcept { return reports_[part]; }

 private:
  struct Exchanged {
    coupling::MechanismSample mechanism;
    coupling::ActuatorSample actuators;
  };
  [[nodiscard]] coupling::PartnerSamples partners_of(Part part) noexcept;
  void advance(Part part, const coupling::PartnerSamples& partners, coupling::OwnSample& next);

  const scene::Scene& scene_;
  const Drive& drive_;
  std::array<std::unique_ptr<coupling::Subsystem>, kParts> parts_;
  std::array<coupling::OwnSample, kParts> now_, next_;
  std::array<StepReport, kParts> reports_{};
  std::vector<Exchanged> exchanged_;  // samples of the last steps, by step
  std::vector<double> controls_;
  StepIndex n_ = 0;
};

}  // namespace slew::testing
