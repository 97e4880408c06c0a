#include "mechanics_node/payload.h"

#include <algorithm>
#include <vector>

#include "core/index.h"
#include "coupling/static_forces.h"
#include "multibody/parameters.h"

namespace slew::mechanics {

namespace {

// joints that move between a link and Ground
int distance_of(const multibody::Model& model, int link) noexcept {
  int joints = 0;
  for (; link > 0; link = model.links[at(link)].parent) ++joints;
  return joints;
}

// carries another body, or closes a loop
std::vector<bool> links_inside(const multibody::Model& model) {
  std::vector<bool> inside(model.links.size(), false);
  for (const multibody::Link& link : model.links) inside[at(link.parent)] = true;
  for (const multibody::Joint& joint : model.joints) {
    if (joint.cut < 0) continue;
    inside[at(model.bodies[at(joint.body1)].link)] = inside[at(model.bodies[at(joint.body2)].link)] = true;
  }
  return inside;
}

}  // namespace

int payload_of(const multibody::MechanicsDef& mechanics, const multibody::Model& model) {
  if (!mechanics.payload.empty()) return multibody::find_body(model, mechanics.payload);
  const std::vector<bool> inside = links_inside(model);
  int payload = 0, longest = 0;
  for (std::size_t i = 1; i <= mechanics.bodies.size(); ++i) {
    const int link = model.bodies[i].link;
    if (mechanics.bodies[i - 1].type != multibody::BodyType::rigid || link == 0) continue;
    const int distance = inside[at(link)] ? 0 : distance_of(model, link);
    if (distance < longest) continue;
    longest = distance;
    payload = static_cast<int>(i);
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
