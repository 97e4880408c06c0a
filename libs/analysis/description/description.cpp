// SPDX-License-Identifier: Apache-2.0
#include "analysis/description/description.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/display.h"
#include "core/printable.h"
#include "core/report_table.h"
#include "hydraulics/circuit.h"
#include "multibody/model/model.h"
#include "multibody/results/observe.h"
#include "scene/ports.h"

namespace slew::analysis {
namespace {

void describe_cuts(const multibody::Description& m, Description& d) {
  for (const multibody::CutDescription& cut : m.cuts) {
    std::string redundant;
    for (const std::string& row : cut.redundant) redundant += (redundant.empty() ? "; redundant: " : ", ") + row;
    d.closed.push_back(fmt::format("{} ({}, {}{})", cut.joint, cut.joint_type,
                                   counted(static_cast<std::uint64_t>(cut.rows), "row", "rows"), redundant));
  }
}

void describe_mechanics(const scene::Scene& scene, Description& d) {
  d.bodies = scene.mechanics.bodies.size();
  d.joints = scene.mechanics.joints.size();
  if (!scene.has_mechanics()) return;
  const multibody::Description m =
      multibody::describe(multibody::build_model(scene.mechanics, scene::row_names(scene)));
  d.links = m.links.size();
  d.flexible = m.flexible;
  d.rows = static_cast<std::size_t>(m.rows);
  d.degrees_of_freedom = m.degrees_of_freedom;
  describe_cuts(m, d);
  d.driven = m.driven;
  d.gears = m.gears;
  d.contacts = m.pairs;
  for (const std::string& pair : m.pairs_at_rest) {
    const auto& pairs = scene.mechanics.contacts;
    const bool is_tested =
        std::any_of(pairs.begin(), pairs.end(), [&](const auto& one) { return one.name == pair && one.tested; });
    d.left_out.push_back("contact " + pair +
                         (is_tested ? ": its shapes cannot move against each other, it is not tested"
                                    : ": the scene excludes it from the test"));
  }
  for (const std::string& body : m.fixed_to_ground) d.merged.push_back(body + " with Ground");
  for (const multibody::LinkDescription& link : m.links) {
    if (link.joint_type == "node") {
      --d.links;
      for (std::size_t i = 1; i < link.bodies.size(); ++i) {
        d.merged.push_back(link.bodies[i] + " with " + link.bodies[0]);
      }
      continue;
    }
    const std::string& moved = link.joint.empty() ? link.bodies.at(0) : link.joint;
    d.motions.push_back(fmt::format("{} ({}, {})", moved, link.joint_type, link.degrees_of_freedom));
    for (std::size_t i = 1; i < link.bodies.size(); ++i) d.merged.push_back(link.bodies[i] + " with " + link.bodies[0]);
  }
}

void describe_bodies(const scene::Scene& scene, Description& d) {
  for (const multibody::BodyDef& body : scene.mechanics.bodies) {
    const auto& solids = scene.solid_inertias;
    const auto solid = std::find_if(solids.begin(), solids.end(),
                                    [&](const scene::SolidInertia& one) { return one.body == body.name; });
    multibody::BodyDef numbers = body;
    for (const multibody::FlexibleBodyDef& flexible : scene.mechanics.flexible_bodies) {
      if (flexible.body == body.name) multibody::take_mass(*flexible.modes, numbers);
    }
    for (const multibody::SegmentedBodyDef& segmented : scene.mechanics.segmented_bodies) {
      if (segmented.body == body.name) multibody::take_mass(*segmented.chain, numbers);
    }
    d.body_numbers.push_back({numbers, solid == solids.end() ? std::nullopt : std::optional(*solid)});
  }
}

void describe_hydraulics(const scene::Scene& scene, Description& d) {
  d.components = scene.hydraulics.components.size();
  if (!scene.has_hydraulics()) return;
  const hydraulics::Circuit circuit(scene.hydraulics);
  for (int i = 0; i < circuit.volume_count(); ++i) ++(circuit.is_fixed(i) ? d.fixed_volumes : d.free_volumes);
  d.hydraulic_states = circuit.state_count() - static_cast<int>(d.fixed_volumes);
}

void describe_nodes(const scene::Scene& scene, Description& d) {
  d.nodes.push_back({"io", true, "owns the session, gives the clock, takes the input"});
  d.nodes.push_back(
      {"mechanics", scene.has_mechanics(), scene.has_mechanics() ? counted(d.bodies, "body", "bodies") : "no bodies"});
  d.nodes.push_back({"hydraulics", scene.has_hydraulics(),
                     scene.has_hydraulics() ? counted(scene.hydraulics.volumes.size(), "volume", "volumes") + ", " +
                                                  counted(d.components, "component", "components")
                                            : "no volumes"});
  const bool is_stated_once = scene.session.flexible == coupling::ElasticExchange::once;
  d.nodes.push_back({"flex", scene.has_modes(),
                     !scene.has_modes()
                         ? "no flexible bodies with modes"
                         : counted(scene.flexible_bodies.size(), "body", "bodies") +
                               (is_stated_once ? ", elastic forces stated once" : ", elastic forces at every step")});
  d.nodes.push_back({"sensor", scene.has_sensors(),
                     scene.has_sensors() ? counted(scene.sensors.size(), "sensor", "sensors") : "no sensors"});
  d.nodes.push_back({"recorder", true, "unless --no-record is given"});
  if (!scene.has_mechanics()) d.left_out.emplace_back("mechanics: no bodies, no process, no states");
  if (!scene.has_hydraulics()) d.left_out.emplace_back("hydraulics: no volumes, no process, no states");
  if (!scene.has_modes()) d.left_out.emplace_back("flexible bodies: none with modes, no flex_node, no modal states");
  if (!scene.has_sensors()) d.left_out.emplace_back("sensors: none, no sensor_node, no search for distances");
  if (d.contacts.empty()) d.left_out.emplace_back("contact: no collision pairs, no collision detection");
  if (scene.ports.empty()) d.left_out.emplace_back("coupling: no actuator drives a force, no ports");
}

Json body_json(const BodyNumbers& body) {
  const bool is_about_center = body.def.inertia_about == multibody::InertiaPoint::center_of_mass;
  Json json = {{"name", body.def.name},
               {"mass", body.def.mass},
               {"center_of_mass", body.def.center_of_mass},
               {"inertia", body.def.inertia},
               {"products", body.def.products},
               {"inertia_about", is_about_center ? "center_of_mass" : "body_origin"}};
  if (body.solid && !body.solid->mesh.empty()) {
    json["mesh"] = {{"file", body.solid->mesh}, {"volume", body.solid->volume}, {"density", body.solid->density}};
  } else if (body.solid) {
    json["shapes"] = {{"solid", body.solid->shapes}, {"volume", body.solid->volume}, {"density", body.solid->density}};
  }
  return json;
}

std::string triple_text(const Triple& v) {
  return fmt::format("[{}, {}, {}]", digits_text(v[0], 6), digits_text(v[1], 6), digits_text(v[2], 6));
}

// "Bag from bag.stl: 0.64 m3 of 781.25 kg/m3, 500 kg; centre of mass [0, -0.6, 0] m; about it ..."
std::string solid_text(const BodyNumbers& body) {
  return fmt::format(
      "{} from {}: {:.6g} m3 of {:.6g} kg/m3, {:.6g} kg; centre of mass {} m; about it Ixx, Iyy, Izz {} and Ixy, Ixz, "
      "Iyz {} kg m2",
      body.def.name, body.solid->mesh + body.solid->shapes, body.solid->volume, body.solid->density, body.def.mass,
      triple_text(body.def.center_of_mass), triple_text(body.def.inertia), triple_text(body.def.products));
}

std::string listed(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text.empty() ? "none" : text;
}

}  // namespace

Description describe(const scene::Scene& scene) {
  Description d;
  d.name = scene.name;
  d.text = scene.description;
  d.step = scene.session.step;
  d.duration = scene.session.duration;
  d.pace = scene.session.pace == Pace::free ? "free" : "real";
  describe_bodies(scene, d);
  describe_mechanics(scene, d);
  describe_hydraulics(scene, d);
  for (const scene::PortDef& port : scene.ports) d.ports.push_back(port.name + " drives " + port.force);
  for (const scene::InputDef& input : scene.inputs) d.inputs.push_back(input.name + " moves " + input.primitive);
  describe_nodes(scene, d);
  return d;
}

Json report_json(const Description& d) {
  Json bodies = Json::array();
  for (const BodyNumbers& body : d.body_numbers) bodies.push_back(body_json(body));
  Json nodes = Json::array();
  for (const NodeNeed& node : d.nodes) {
    nodes.push_back({{"role", node.role}, {"needed", node.is_needed}, {"reason", node.reason}});
  }
  return {{"name", d.name},
          {"description", d.text},
          {"session", {{"step", d.step}, {"duration", d.duration}, {"pace", d.pace}}},
          {"mechanics",
           {{"bodies", d.bodies},
            {"joints", d.joints},
            {"links", d.links},
            {"motions", d.motions},
            {"driven", d.driven},
            {"gears", d.gears},
            {"flexible", d.flexible},
            {"closed", d.closed},
            {"merged", d.merged},
            {"contacts", d.contacts},
            {"degrees_of_freedom", d.degrees_of_freedom},
            {"rows", d.rows},
            {"mass_properties", bodies}}},
          {"hydraulics",
           {{"components", d.components},
            {"pressure_states", d.free_volumes},
            {"fixed_pressures", d.fixed_volumes},
            {"states", d.hydraulic_states}}},
          {"ports", d.ports},
          {"inputs", d.inputs},
          {"nodes", nodes},
          {"left_out", d.left_out}};
}

std::string report_text(const Description& d, std::size_t width) {
  ReportTable rows({"", ""});
  rows.add({"scene", d.name});
  rows.add({"session", fmt::format("step {}, duration {}, pace {}", duration_text(d.step),
                                   d.duration > 0 ? duration_text(d.duration) : "until stopped", d.pace)});
  rows.add({"mechanics", listed({counted(d.bodies, "body", "bodies"), counted(d.joints, "joint", "joints"),
                                 counted(d.links, "moving link", "moving links"),
                                 counted(static_cast<std::uint64_t>(d.degrees_of_freedom), "degree of freedom",
                                         "degrees of freedom")})});
  rows.add({"motions", listed(d.motions)});
  rows.add({"merged", listed(d.merged)});
  rows.add({"contacts", listed(d.contacts)});
  rows.add(
      {"hydraulics", listed({counted(d.components, "component", "components"),
                             counted(d.free_volumes, "pressure state", "pressure states"),
                             counted(d.fixed_volumes, "fixed pressure", "fixed pressures"),
                             counted(static_cast<std::uint64_t>(d.hydraulic_states), "state", "states") + " in all"})});
  rows.add({"ports", listed(d.ports)});
  rows.add({"inputs", listed(d.inputs)});
  for (const std::string& body : d.flexible) rows.add({"flexible", body});
  if (!d.driven.empty()) rows.add({"driven", listed(d.driven)});
  if (!d.gears.empty()) rows.add({"gears", listed(d.gears)});
  if (!d.closed.empty()) rows.add({"closed by rows", listed(d.closed)});
  for (const BodyNumbers& body : d.body_numbers) {
    if (body.solid) rows.add({"inertia", solid_text(body)});
  }
  for (const NodeNeed& node : d.nodes) {
    rows.add({node.role + " node", (node.is_needed ? "needed: " : "not needed: ") + node.reason});
  }
  for (const std::string& part : d.left_out) rows.add({"left out", part});
  return (d.text.empty() ? "" : printable_lines(d.text) + "\n\n") + rows.text("", width);
}

}  // namespace slew::analysis
