// SPDX-License-Identifier: Apache-2.0
// Static demand of a payload on the actuators: line forces that hold the ports at rest, and their change with the
// payload's mass,
//   W F = -a_free                                                                                     (1)
//   dF/dm = F(m + 1 kg) - F(m)                                                                        (2)
// without friction and limits of joints. (2) is exact at rest, since gravity is linear in the mass.
#pragma once

#include <span>
#include <vector>

#include "coupling/samples.h"
#include "multibody/formulations/dynamics.h"

namespace slew::mechanics_node {

// The scene's `payload`. By default the rigid body with a single joint and the most moving joints between it and
// Ground, the last one in the file where several have as many; in a machine without such a body the last one that
// moves. 0: no body moves.
[[nodiscard]] int payload_of(const multibody::MechanicsDef& mechanics, const multibody::Model& model);

// Present mass [kg].
[[nodiscard]] double mass_of(const multibody::Model& model, int body) noexcept;

// (1) at the state with the payload at `mass` [kg > 0], which stays in the model. The ports are the first rows; ratio:
// m or m/rad of each. False: no forces hold them. Does not allocate.
[[nodiscard]] bool static_line_forces(multibody::Model& model, const multibody::State& state, multibody::Workspace& ws,
                                      std::span<const double> ratio, int payload, double mass,
                                      std::span<double> F) noexcept;

// W of (1), row-major, of the workspace that static_line_forces() evaluated. Allocates.
[[nodiscard]] std::vector<double> port_mobility(const multibody::Model& model, const multibody::Workspace& ws,
                                                std::span<const double> ratio);

// (2) [m/s2] at `mass`; zero where no forces hold the ports, or without payload. The payload of the model keeps 1 kg
// more. Does not allocate.
void payload_slopes(multibody::Model& model, const multibody::State& state, multibody::Workspace& ws,
                    std::span<const double> ratio, int payload, double mass, std::span<double> slopes) noexcept;

// (2) of a running mechanism, on a model of its own whose payload has 1 kg more. The owner applies each change of the
// mechanism's model to this model as well.
class PayloadSensitivity {
 public:
  // payload: body of the model, 0: none; ratio: m or m/rad of each port. Allocates.
  PayloadSensitivity(const multibody::Model& model, int payload, std::vector<double> ratio);

  [[nodiscard]] int payload() const noexcept { return payload_; }
  [[nodiscard]] multibody::Model& model() noexcept { return model_; }
  // Takes over all parameters of the mechanism's model. Allocates.
  void copy(const multibody::Model& model) { model_ = model; }
  // Takes over the signals of its loads. Does not allocate.
  void copy_signals(const multibody::Model& model) noexcept;

  // As payload_slopes(), in the workspace ws. Does not allocate.
  void read(const multibody::State& state, double mass, multibody::Workspace& ws, std::span<double> slopes) noexcept;

 private:
  multibody::Model model_;
  int payload_;
  std::vector<double> ratio_;
};

}  // namespace slew::mechanics_node
