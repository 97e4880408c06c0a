// SPDX-License-Identifier: Apache-2.0
#include "flex/flexible_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "flex/flexible_files.h"
#include "flex/foreshortening.h"
#include "flex/imported_model.h"
#include "flex/input_error.h"

namespace slew::flex {
namespace {

// place of the name in the list; without a name, that of the only entry
template <typename Named>
std::optional<std::size_t> place_of(const std::vector<Named>& all, const std::string& name) {
  if (name.empty()) return all.size() == 1 ? std::optional<std::size_t>(0) : std::nullopt;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].name == name) return i;
  }
  return std::nullopt;
}

bool is_id(double value) {
  return value >= 0 && value <= std::numeric_limits<int>::max() && value == std::floor(value);
}

// Appends the problems of a list of ids; true if it is sound.
bool check_ids(const std::string& path, const std::vector<double>& ids, Problems& problems) {
  const std::size_t before = problems.size();
  for (const double id : ids) {
    if (!is_id(id)) problems.push_back({path, fmt::format("{} is no node's number", id), "whole numbers", {}});
  }
  return problems.size() == before;
}

std::vector<int> ids_of(const std::vector<double>& ids) {
  std::vector<int> out;
  for (const double id : ids) out.push_back(static_cast<int>(id));
  return out;
}

SectionDef section_of(const NamedSection& named) {
  SectionDef def = named.section;
  const auto factor = [&](double own) {
    const double value = own > 0 ? own : named.shear_factor;
    return value > 0 ? std::optional<double>(value) : std::nullopt;
  };
  def.shear_factor_y = factor(named.shear_factor_y);
  def.shear_factor_z = factor(named.shear_factor_z);
  for (const StressPointDef& point : named.stress_points) {
    const bool has_shear = point.torsion_modulus > 0;
    def.points.push_back({point.y, point.z, has_shear ? std::optional<double>(point.torsion_modulus) : std::nullopt});
  }
  return def;
}

// A beam, and the entry of the description for each element.
struct BeamOf {
  BeamDef beam;
  std::vector<std::size_t> chain;
};

// Pre-condition: every chain has a section, a material and sound ids.
BeamOf beam_of(const FlexibleBodyDef& def) {
  BeamOf out;
  BeamDef& beam = out.beam;
  beam.name = def.model;
  for (const NamedMaterial& named : def.materials) beam.materials.push_back(named.material);
  for (const NamedSection& named : def.sections) beam.sections.push_back(section_of(named));
  beam.nodes = def.nodes;
  if (def.line.nodes > 0) beam.nodes = line_of_nodes(def.line.start, def.line.end, static_cast<int>(def.line.nodes));
  beam.y_axis = def.y_axis;
  beam.mass = def.mass_matrix;
  beam.rotary_inertia = def.rotary_inertia;
  std::vector<ElementChainDef> chains = def.elements;
  if (chains.empty()) {
    chains.emplace_back();
    for (const BeamNodeDef& node : beam.nodes) chains[0].through.push_back(node.id);
  }
  for (std::size_t c = 0; c < chains.size(); ++c) {
    const ElementChainDef& chain = chains[c];
    const auto section = place_of(def.sections, chain.section.empty() ? def.section : chain.section);
    const auto material = place_of(def.materials, chain.material.empty() ? def.material : chain.material);
    const std::vector<int> ids = ids_of(chain.through);
    for (std::size_t i = 1; i < ids.size(); ++i) {
      beam.elements.push_back({ids[i - 1], ids[i], section.value_or(0), material.value_or(0), chain.y_axis});
      out.chain.push_back(c);
    }
  }
  return out;
}

class BodyChecker {
 public:
  explicit BodyChecker(const FlexibleBodyDef& def) : def_(def) {}

  Problems run() {
    check_name("model", def_.model);
    check_name("prefix", def_.prefix);
    const bool has_line = def_.line.nodes > 0;
    const int bodies = (has_line ? 1 : 0) + (def_.nodes.empty() ? 0 : 1) + (def_.matrices.is_given() ? 1 : 0);
    if (bodies != 1)
      add("", bodies == 0 ? "the geometry of the body is missing" : "the body is described more than once",
          "one of line, nodes and matrices");
    for (const NamedSection& section : def_.sections) check_shear(section);
    check_ids("reduction.clamped_nodes", def_.reduction.clamped_nodes, problems_);
    check_ids("reduction.interface_nodes", def_.reduction.interface_nodes, problems_);
    if (def_.reduction.attachment == Attachment::free && !def_.reduction.clamped_nodes.empty())
      add("reduction.clamped_nodes", "a free body has none", "no such key, or attachment: clamped");
    if (bodies != 1) return problems_;
    if (def_.matrices.is_given()) {
      if (def_.reduction.stiffening != GeometricStiffening::none)
        add("reduction.stiffening", "imported matrices have no straight beam", "none");
      return problems_;
    }
    check_chains();
    const bool has_length = !has_line || def_.line.start != def_.line.end;
    if (!has_length) add("line.end", "it is at the start", "another place");
    if (has_sound_chains_ && has_length) check_as_beam();
    return problems_;
  }

 private:
  void add(const std::string& path, std::string what, std::string expected) {
    problems_.push_back({path, std::move(what), std::move(expected), {}});
  }

  void check_name(const std::string& key, const std::string& name) {
    if (!is_flexible_name(name))
      add(key, fmt::format("'{}' cannot be part of a file's name", name), "letters, digits, _ - .");
  }

  void check_shear(const NamedSection& section) {
    const std::string path = "sections." + section.name;
    const bool has_one = section.shear_factor > 0, has_own = section.shear_factor_y > 0 || section.shear_factor_z > 0;
    if (has_one && has_own)
      add(path + ".shear_factor", "it is given beside one of y or z", "shear_factor, or shear_factor_y and _z");
    if (section.section.shear == Shear::none && (has_one || has_own))
      add(path + ".shear", "none has no shear factors", "timoshenko, or no shear factors");
  }

  // a section or material for every element, and ids
  void check_chains() {
    bool needs_section = def_.elements.empty(), needs_material = needs_section;
    for (std::size_t i = 0; i < def_.elements.size(); ++i) {
      const ElementChainDef& chain = def_.elements[i];
      const std::string path = fmt::format("elements[{}].through", i);
      needs_section |= chain.section.empty();
      needs_material |= chain.material.empty();
      if (chain.through.size() < 2) add(path, fmt::format("{} ids are too few", chain.through.size()), "two or more");
      has_sound_chains_ &= check_ids(path, chain.through, problems_);
    }
    check_choice("section", def_.sections.size(), needs_section && def_.section.empty());
    check_choice("material", def_.materials.size(), needs_material && def_.material.empty());
  }

  void check_choice(const std::string& key, std::size_t count, bool is_open) {
    if (count > 1 && is_open)
      add(key, fmt::format("there are {} {}s, and elements that name none", count, key),
          fmt::format("the name of one here, or one for every element", key));
  }

  // the rules of beams, reported with the keys of the description
  void check_as_beam() {
    const BeamOf made = beam_of(def_);
    for (Problem problem : check_beam(made.beam)) {
      problem.path = path_of(problem.path.substr(def_.model.size() + 1), made);
      const bool is_known = std::any_of(problems_.begin(), problems_.end(), [&](const Problem& other) {
        return other.path == problem.path && other.what == problem.what;
      });
      if (!is_known) problems_.push_back(std::move(problem));
    }
  }

  // "sections[0].wall" as "sections.Box.wall"
  [[nodiscard]] std::string path_of(const std::string& path, const BeamOf& made) const {
    const std::size_t open = path.find('['), close = path.find(']');
    if (open == std::string::npos) return path == "nodes" && def_.line.nodes > 0 ? "line.nodes" : path;
    const std::string list = path.substr(0, open), rest = path.substr(close + 1);
    const std::size_t i = std::stoul(path.substr(open + 1, close - open - 1));
    if (list == "materials") return "materials." + def_.materials[i].name + rest;
    if (list == "sections") return "sections." + def_.sections[i].name + rest;
    if (list == "nodes") return def_.line.nodes > 0 ? "line" : fmt::format("nodes.{}", def_.nodes[i].id);
    if (!def_.elements.empty()) return fmt::format("elements[{}]{}", made.chain[i], rest);
    return rest == ".y_axis" ? "y_axis" : def_.line.nodes > 0 ? "line" : "nodes";
  }

  const FlexibleBodyDef& def_;
  bool has_sound_chains_ = true;
  Problems problems_;
};

// Checks that the model has the ids, each once; returns them.
std::set<int> known_ids(const std::string& path, const std::vector<double>& ids, const FeModel& model,
                        Problems& problems) {
  std::set<int> known;
  for (const int id : ids_of(ids)) {
    const bool is_there =
        std::any_of(model.nodes.begin(), model.nodes.end(), [&](const FeNode& node) { return node.id == id; });
    if (!is_there)
      problems.push_back({path,
                          fmt::format("there is no node {}", id),
                          fmt::format("one of the body's {} nodes, {} to {}", model.nodes.size(),
                                      model.nodes.front().id, model.nodes.back().id),
                          {}});
    else if (!known.insert(id).second)
      problems.push_back({path, fmt::format("node {} is named twice", id), "each once", {}});
  }
  return known;
}

}  // namespace

Problems check_flexible_body(const FlexibleBodyDef& def) {
  return BodyChecker(def).run();
}

Problems check_reduction(const FlexibleBodyDef& def, const FeModel& model) {
  Problems problems;
  const BodyReductionDef& reduction = def.reduction;
  std::set<int> clamped = known_ids("reduction.clamped_nodes", reduction.clamped_nodes, model, problems);
  std::set<int> interfaces = known_ids("reduction.interface_nodes", reduction.interface_nodes, model, problems);
  if (!problems.empty()) return problems;
  const bool is_clamped = reduction.attachment == Attachment::clamped;
  if (is_clamped && clamped.empty()) clamped.insert(model.nodes.front().id);
  if (interfaces.empty()) {
    interfaces.insert(model.nodes.back().id);
    if (!is_clamped) interfaces.insert(model.nodes.front().id);
  }
  int inside = model.freedoms();
  for (const FeNode& node : model.nodes) {
    if (clamped.contains(node.id) && interfaces.contains(node.id))
      problems.push_back({reduction.interface_nodes.empty() ? "reduction.clamped_nodes" : "reduction.interface_nodes",
                          fmt::format("node {} is clamped and an interface", node.id),
                          "interfaces that move",
                          {}});
    if (clamped.contains(node.id) || interfaces.contains(node.id)) inside -= node.freedoms;
  }
  if (reduction.stiffening == GeometricStiffening::straight_beam) {
    const std::string obstacle = obstacle_to_foreshortening(model, is_clamped ? clamped.size() : 0);
    if (!obstacle.empty())
      problems.push_back({"reduction.stiffening", obstacle, "one straight chain of beam elements, or none", {}});
  }
  if (reduction.fixed_interface_modes > inside)
    problems.push_back({"reduction.fixed_interface_modes",
                        fmt::format("{} is out of range", reduction.fixed_interface_modes),
                        fmt::format("0 to {}, the freedoms inside", inside),
                        {}});
  return problems;
}

FeModel model_of(const FlexibleBodyDef& def, const std::filesystem::path& folder) {
  refuse_if_any(check_flexible_body(def));
  if (!def.matrices.is_given()) return build_beam(beam_of(def).beam);
  const MatrixFilesDef& files = def.matrices;
  return import_model({def.model, folder / files.mass, folder / files.stiffness, folder / files.nodes, files.units});
}

ReductionDef reduction_of(const FlexibleBodyDef& def) {
  const BodyReductionDef& from = def.reduction;
  ReductionDef out;
  out.modes.attachment = from.attachment;
  out.modes.clamped_nodes = ids_of(from.clamped_nodes);
  out.modes.interface_nodes = ids_of(from.interface_nodes);
  out.modes.fixed_interface_modes = static_cast<int>(from.fixed_interface_modes);
  out.modes.method = from.eigen_method;
  out.stiffening = from.stiffening;
  return out;
}

}  // namespace slew::flex
