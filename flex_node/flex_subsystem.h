// SPDX-License-Identifier: Apache-2.0
// The flexible bodies of a scene as a Subsystem: their elastic forces, and deflection, stress and strain energy from
// the modal coordinates of the mechanics (coupling study, section 5, scheme A1).
//
// The mechanics owns the modal coordinates and integrates them with the coupled mass matrix; this side publishes
//   Q - K (q - q_ref) - D (u - u_ref)                                                                  (1)
// once, about q_ref = 0, or at every step about the mechanics' coordinates of that step (scene: session.flexible). It
// then has no state: a step only reads the mechanics' sample of the step's end. Scheme B (session.flexible: condensed):
// this side keeps q, u and moves them by the trapezoidal rule. With the mean accelerations of the step eliminated, the
// mechanics sees modes of the mass M and a constant force,
//   M = 1 + H/2 D + H^2/4 K,   Q = -K (q + H/2 u) - D u                                                (2)
// and publishes the rates at the step's end, from which   q <- q + H/2 (u + u_end),   u <- u_end             (3)
// Not covered: stress by modes that the body does not take; loads and accelerations are not used for it.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "coupling/port_levels.h"
#include "coupling/subsystem.h"
#include "flex/reduction.h"
#include "scene/scene.h"

namespace slew::flex_node {

class FlexSubsystem final : public coupling::Subsystem {
 public:
  // Pre-condition: a validated scene whose flexible files were read.
  explicit FlexSubsystem(const scene::Scene& scene);

  [[nodiscard]] bool first_sample(coupling::OwnSample& sample) noexcept override;
  Status start(const coupling::PartnerSamples& partners, coupling::OwnSample& sample) override;
  StepReport step(StepIndex n, const coupling::PartnerSamples& partners, std::span<const double> controls,
                  coupling::OwnSample& sample) noexcept override;
  bool change_parameter(StepIndex n, const coupling::ParameterChange& change) noexcept override;
  void reset() override;
  [[nodiscard]] std::uint64_t state_hash() const noexcept override;
  [[nodiscard]] Status can_save() const override;
  void save(std::vector<std::byte>& state) const override;
  Status load(std::span<const std::byte> state, coupling::OwnSample& sample) override;
  [[nodiscard]] coupling::Level level() const noexcept override { return levels_.lowest(); }
  [[nodiscard]] std::span<const ElementVariable> variables() const noexcept override { return variables_; }
  void read_variables(std::span<double> values) const noexcept override;
  [[nodiscard]] std::string_view offender_name(std::int32_t index) const noexcept override;

 private:
  struct Body {
    std::string name;
    std::shared_ptr<const flex::Reduction> model;
    std::size_t first_mode = 0, modes = 0;
    std::size_t first_pair = 0;
    double strain_energy = 0;  // J
  };

  [[nodiscard]] std::span<const double> modes_of(const Body& body) const noexcept {
    return q_.span().subspan(body.first_mode, body.modes);
  }
  void see(const coupling::FlexibleSample& mechanics, coupling::ElasticSample& sample) noexcept;
  void state_law(const Body& body) noexcept;
  void list_variables(const Body& body);

  coupling::PortLevels levels_;  // the session's levels; this node has no port of its own
  coupling::ElasticExchange exchange_;
  double H_;                  // s
  std::vector<Body> bodies_;  // in the order of the samples
  coupling::ElasticSample constant_;
  coupling::ElasticSample published_;
  coupling::ModeArray q_, u_;
  std::vector<ElementVariable> variables_;
  std::uint64_t saved_model_ = 0;  // digest of the model of saved states
};

[[nodiscard]] std::unique_ptr<coupling::Subsystem> make_flex_subsystem(const scene::Scene& scene);

}  // namespace slew::flex_node
