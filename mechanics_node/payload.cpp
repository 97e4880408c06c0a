#include "mechanics_node/payload.h"

#include <algorithm>

#include "coupling/static_forces.h"
#include "multibody/parameters.h"

namespace slew::mechanics {

int payload_of(const multibody::MechanicsDef& mechanics, const multibody::Model& model) {
  int payload = 0;
  for (std::size_t i = 1; i <= mechanics.bodies.size(); ++i) {
    const bool is_rigid = mechanics.bodies[i - 1].type == multibody::BodyType::rigid;
    if (is_rigid && model.bodies[i].link > 0) payload = static_cast<int>(i);
  }
  return payload;
}

double mass_of(const multibody::Model& model, int body) noexcept {
  const int lumped = model.bodies[static_cast<std::size_t>(body)].lumped;
  return model.lumped[static_cast<std::size_t>(lumped)].mass;
}

bool static_line_forces(multibody::Model& model, const multibody::State& state, multibody::Workspace& ws,
                        std::span<const double> ratio, int payload, double mass, std::span<double> F) noexcept {
  const std::size_t m = ratio.size();
  const std::size_t rows = model.rows.size();
  multibody::set_body_mass(model, payload, mass);
  multibody::evaluate(model, state, ws);
  coupling::PortMatrix W;
  coupling::PortArray a_free;
  W.resize(m * m);
  a_free.resize(m);
  for (std::size_t i = 0; i < m; ++i) {
    a_free[i] = ratio[i] * ws.row_a_free[i];
    for (std::size_t j = 0; j < m; ++j) W[i * m + j] = ratio[i] * ws.row_W[i * rows + j] * ratio[j];
  }
  return coupling::static_forces(W.span(), a_free.span(), F);
}

void payload_slopes(multibody::Model& model, const multibody::State& state, multibody::Workspace& ws,
                    std::span<const double> ratio, int payload, double mass, std::span<double> slopes) noexcept {
  const std::size_t m = ratio.size();
  std::fill(slopes.begin(), slopes.end(), 0.0);
  if (m == 0 || payload == 0) return;
  coupling::PortArray now, more;
  now.resize(m);
  more.resize(m);
  if (!static_line_forces(model, state, ws, ratio, payload, mass, now.span()) ||
      !static_line_forces(model, state, ws, ratio, payload, mass + 1, more.span()))
    return;
  for (std::size_t i = 0; i < m; ++i) slopes[i] = more[i] - now[i];
}

}  // namespace slew::mechanics
