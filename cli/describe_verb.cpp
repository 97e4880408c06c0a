// SPDX-License-Identifier: Apache-2.0
// `slewring describe SCENE`: the parts of a scene, its number of states, and its nodes with reasons; on request the
// cost of each part, its eigenvalues and its liftable load.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "analysis/description/cost.h"
#include "analysis/description/eigenvalues.h"
#include "analysis/description/instant.h"
#include "analysis/description/liftable_load.h"
#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/display.h"
#include "core/json.h"
#include "core/printable.h"
#include "core/report_table.h"
#include "hydraulics/circuit.h"
#include "multibody/model/model.h"
#include "multibody/model/observe.h"
#include "program/add_scene_options.h"
#include "scene/ports.h"
#include "scene/scene.h"
#include "scene/scene_options.h"

namespace slew::cli {
namespace {

// s, default length of the run whose cost is measured: some manoeuvre, some seconds of waiting
constexpr double kCostTime = 8;

struct DescribeOptions {
  std::string scene;
  std::vector<std::string> overrides;
  bool is_json = false;
  // results beside the description
  bool has_cost = false, has_eigenvalues = false, is_frictionless = false, has_liftable = false;
  std::string until;      // end of the run whose cost is measured; empty: all of it, at most kCostTime
  std::size_t count = 8;  // eigenvalues of either end
  std::string at = "0 s";
  std::vector<std::string> pose;

  [[nodiscard]] bool has_part() const { return has_cost || has_eigenvalues || has_liftable; }
};

// A body's inertia, and the mesh that it was computed from.
struct BodyNumbers {
  multibody::BodyDef def;
  std::optional<scene::MeshInertia> mesh;
};

struct NodeNeed {
  std::string role;
  bool is_needed = false;
  std::string reason;
};

struct Description {
  std::string name, text;
  double step = 0, duration = 0;
  std::string pace;
  std::vector<BodyNumbers> body_numbers;
  std::size_t bodies = 0, joints = 0, links = 0, rows = 0;
  int degrees_of_freedom = 0;
  std::vector<std::string> motions;   // "Body_Pillar (revolute, 1)"
  std::vector<std::string> flexible;  // "Boom: 2 modes ..."
  std::vector<std::string> driven;    // "Crank_Drive (Crank_Pin, angle)": prescribed motions
  std::vector<std::string> gears;     // "Slew_Gear (Pinion_Axis, Slew_Joint)"
  std::vector<std::string> closed;    // "Coupler (revolute_revolute, 1 row)": joints outside of the tree
  std::vector<std::string> merged;    // "Pole with Pillar"
  std::vector<std::string> contacts;  // pairs that are tested
  std::size_t components = 0, free_volumes = 0, fixed_volumes = 0;
  int hydraulic_states = 0;
  std::vector<std::string> ports;   // "Cyl_Lift drives ForceT_Lift"
  std::vector<std::string> inputs;  // "Input_Lift moves L90Lift"
  std::vector<NodeNeed> nodes;
  std::vector<std::string> left_out;
};

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
    const auto& meshes = scene.mesh_inertias;
    const auto mesh = std::find_if(meshes.begin(), meshes.end(),
                                   [&](const scene::MeshInertia& one) { return one.body == body.name; });
    multibody::BodyDef numbers = body;
    for (const multibody::FlexibleBodyDef& flexible : scene.mechanics.flexible_bodies) {
      if (flexible.body == body.name) multibody::take_mass(*flexible.modes, numbers);
    }
    for (const multibody::SegmentedBodyDef& segmented : scene.mechanics.segmented_bodies) {
      if (segmented.body == body.name) multibody::take_mass(*segmented.chain, numbers);
    }
    d.body_numbers.push_back({numbers, mesh == meshes.end() ? std::nullopt : std::optional(*mesh)});
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

Json body_json(const BodyNumbers& body) {
  const bool is_about_center = body.def.inertia_about == multibody::InertiaPoint::center_of_mass;
  Json json = {{"name", body.def.name},
               {"mass", body.def.mass},
               {"center_of_mass", body.def.center_of_mass},
               {"inertia", body.def.inertia},
               {"products", body.def.products},
               {"inertia_about", is_about_center ? "center_of_mass" : "body_origin"}};
  if (body.mesh) {
    json["mesh"] = {{"file", body.mesh->mesh}, {"volume", body.mesh->volume}, {"density", body.mesh->density}};
  }
  return json;
}

std::string triple_text(const Triple& v) {
  return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", v[0], v[1], v[2]);
}

// "Bag from bag.stl: 0.64 m3 of 781.25 kg/m3, 500 kg; centre of mass [0, -0.6, 0] m; about it ..."
std::string mesh_text(const BodyNumbers& body) {
  return fmt::format(
      "{} from {}: {:.6g} m3 of {:.6g} kg/m3, {:.6g} kg; centre of mass {} m; about it Ixx, Iyy, Izz {} and Ixy, Ixz, "
      "Iyz {} kg m2",
      body.def.name, body.mesh->mesh, body.mesh->volume, body.mesh->density, body.def.mass,
      triple_text(body.def.center_of_mass), triple_text(body.def.inertia), triple_text(body.def.products));
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

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text.empty() ? "none" : text;
}

// width [characters]: of the lines of the table; 0: no limit.
std::string report_text(const Description& d, std::size_t width) {
  ReportTable rows({"", ""});
  rows.add({"scene", d.name});
  rows.add({"session", fmt::format("step {}, duration {}, pace {}", duration_text(d.step),
                                   d.duration > 0 ? duration_text(d.duration) : "until stopped", d.pace)});
  rows.add({"mechanics", joined({counted(d.bodies, "body", "bodies"), counted(d.joints, "joint", "joints"),
                                 counted(d.links, "moving link", "moving links"),
                                 counted(static_cast<std::uint64_t>(d.degrees_of_freedom), "degree of freedom",
                                         "degrees of freedom")})});
  rows.add({"motions", joined(d.motions)});
  rows.add({"merged", joined(d.merged)});
  rows.add({"contacts", joined(d.contacts)});
  rows.add(
      {"hydraulics", joined({counted(d.components, "component", "components"),
                             counted(d.free_volumes, "pressure state", "pressure states"),
                             counted(d.fixed_volumes, "fixed pressure", "fixed pressures"),
                             counted(static_cast<std::uint64_t>(d.hydraulic_states), "state", "states") + " in all"})});
  rows.add({"ports", joined(d.ports)});
  rows.add({"inputs", joined(d.inputs)});
  for (const std::string& body : d.flexible) rows.add({"flexible", body});
  if (!d.driven.empty()) rows.add({"driven", joined(d.driven)});
  if (!d.gears.empty()) rows.add({"gears", joined(d.gears)});
  if (!d.closed.empty()) rows.add({"closed by rows", joined(d.closed)});
  for (const BodyNumbers& body : d.body_numbers) {
    if (body.mesh) rows.add({"inertia", mesh_text(body)});
  }
  for (const NodeNeed& node : d.nodes) {
    rows.add({node.role + " node", (node.is_needed ? "needed: " : "not needed: ") + node.reason});
  }
  for (const std::string& part : d.left_out) rows.add({"left out", part});
  return (d.text.empty() ? "" : printable_lines(d.text) + "\n\n") + rows.text("", width);
}

// Prints only the requested parts, in the order of the options.
ExitCode show_parts(const DescribeOptions& options) {
  // the same physics, in the parts that are described
  scene::Overrides overrides = options.overrides;
  overrides.emplace_back("session.solution=split");
  scene::Scene scene = scene::load_file(options.scene, overrides);
  const double at = analysis::read_option("--at", options.at, Dimension::time);
  Json json = {{"name", scene.name}};
  std::vector<std::string> texts;
  if (options.has_cost) {
    const double whole = scene.session.duration > 0 ? std::min(scene.session.duration, kCostTime) : kCostTime;
    const double until =
        options.until.empty() ? whole : analysis::read_option("--until", options.until, Dimension::time);
    const std::vector<std::string> not_paid = describe(scene).left_out;
    const analysis::CostByPart cost = analysis::measure_cost(scene, options.scene, overrides, until);
    json["cost"] = analysis::report_json(cost, not_paid);
    texts.push_back(analysis::report_text(cost, not_paid, output_width()));
  }
  if (options.has_eigenvalues) {
    const analysis::Eigenvalues eigenvalues = analysis::find_eigenvalues(
        scene, at, options.is_frictionless ? analysis::DryFriction::neglected : analysis::DryFriction::kept);
    json["eigenvalues"] = analysis::report_json(eigenvalues);
    texts.push_back(analysis::report_text(eigenvalues, options.count, output_width()));
  }
  if (options.has_liftable) {
    const std::vector<analysis::LiftableLoad> loads =
        analysis::find_liftable_of_each(scene, {at, options.pose}, analysis::ListedSettings::named);
    json["liftable"] = analysis::report_json(loads.front());
    // the further bodies of the scene's payload
    for (std::size_t i = 1; i < loads.size(); ++i) json["liftable_others"].push_back(analysis::report_json(loads[i]));
    for (const analysis::LiftableLoad& load : loads) texts.push_back(analysis::report_text(load, output_width()));
  }
  if (options.is_json) {
    fmt::print("{}\n", json.dump(2));
    return ExitCode::ok;
  }
  for (std::size_t i = 0; i < texts.size(); ++i) fmt::print("{}{}", i == 0 ? "" : "\n", texts[i]);
  return ExitCode::ok;
}

ExitCode show(const DescribeOptions& options) {
  if (options.has_part()) return show_parts(options);
  const scene::Scene scene = scene::load_file(options.scene, options.overrides);
  const Description description = describe(scene);
  if (options.is_json) {
    fmt::print("{}\n", report_json(description).dump(2));
  } else {
    fmt::print("{}", report_text(description, output_width()));
  }
  return ExitCode::ok;
}

}  // namespace

void add_describe(options::Command& program) {
  options::Command verb = program.command("describe", "parts of a scene and the nodes it needs, with reasons");
  const auto options = std::make_shared<DescribeOptions>();  // lives as long as the command line's callbacks
  program::add_scene_file(verb, "scene", options->scene).required();
  verb.option("--set", options->overrides, "change a value of the scene; repeat for more")
      .value_name("PATH=VALUE")
      .one_value_each();
  verb.flag("--json", options->is_json, "for machines");
  options::Option cost = verb.flag("--cost", options->has_cost, "what each part costs, measured on the scene's run");
  verb.option("--until", options->until, "end of that run (default: the scene's, at most 8 s)")
      .value_name("TIME")
      .needs(cost);
  options::Option eigenvalues = verb.flag("--eigenvalues", options->has_eigenvalues,
                                          "fastest and slowest motions of the whole machine, and their owners");
  options::Option liftable =
      verb.flag("--liftable", options->has_liftable, "largest payload that the cylinders lift, and its limit");
  verb.option("--at", options->at, "time of the scene's own run at which to look").value_name("TIME").show_default();
  verb.option("--count", options->count, "eigenvalues shown of either end").needs(eigenvalues).show_default();
  verb.flag("--frictionless", options->is_frictionless, "eigenvalues without the dry friction of cylinders and joints")
      .needs(eigenvalues);
  verb.option("--pose", options->pose, "joints put elsewhere, with --liftable; repeat or separate by commas")
      .value_name("JOINT=VALUE")
      .comma_separated()
      .needs(liftable);
  verb.footer(
      "Examples:\n"
      "  slewring describe scenes/truck_crane.yaml\n"
      "  slewring describe scenes/truck_crane.yaml --cost\n"
      "  slewring describe scenes/truck_crane.yaml --eigenvalues --at 5s\n"
      "  slewring describe scenes/truck_crane.yaml --liftable --pose 'Pillar_LiftBoom=20 deg'");
  verb.action([options] { return show(*options); });
}

}  // namespace slew::cli
