// SPDX-License-Identifier: Apache-2.0
#include "flex/beam.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numeric>

#include "flex/input_error.h"

namespace slew::flex {

using math::Mat3;
using math::Vec3;

namespace {

// sine below which a direction does not define the section's y axis
constexpr double kAlongElement = 1e-3;

// four points of Gauss and Legendre on 0 to 1: exact to the seventh power; the integrals need the sixth
const std::array<std::array<double, 2>, 4> kGauss = [] {
  const double a = std::sqrt(3.0 / 7 - 2.0 / 7 * std::sqrt(6.0 / 5)),
               b = std::sqrt(3.0 / 7 + 2.0 / 7 * std::sqrt(6.0 / 5));
  const double wa = (18 + std::sqrt(30.0)) / 72, wb = (18 - std::sqrt(30.0)) / 72;
  return std::array<std::array<double, 2>, 4>{
      {{(1 - b) / 2, wb}, {(1 - a) / 2, wa}, {(1 + a) / 2, wa}, {(1 + b) / 2, wb}}};
}();

std::vector<BeamElementDef> elements_of(const BeamDef& def) {
  if (!def.elements.empty()) return def.elements;
  std::vector<BeamElementDef> chain;
  for (std::size_t i = 1; i < def.nodes.size(); ++i) chain.push_back({def.nodes[i - 1].id, def.nodes[i].id, 0, 0, {}});
  return chain;
}

// local axes; without direction the columns are zero
Mat3 axes_of(Vec3 along, const BeamElementDef& element, const BeamDef& def) {
  const Vec3 x = along * (1 / norm(along));
  const Vec3 own(element.y_axis);
  Vec3 y = norm(own) > 0 ? own : Vec3(def.y_axis);
  y = y * (1 / norm(y));
  if (norm(own) == 0 && norm(cross(x, y)) < kAlongElement) y = Vec3(0, 0, 1);
  const Vec3 z = cross(x, y);
  const double sine = norm(z);
  if (!(sine > kAlongElement)) return {};
  const Vec3 unit_z = z * (1 / sine);
  return {x, cross(unit_z, x), unit_z};
}

bool is_finite(const Triple& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

class Checker {
 public:
  explicit Checker(const BeamDef& def) : def_(def), elements_(elements_of(def)) {}

  Problems run() {
    check_lists();
    for (std::size_t i = 0; i < def_.materials.size(); ++i) check_material(i);
    for (std::size_t i = 0; i < def_.sections.size(); ++i)
      check_section(fmt::format("{}.sections[{}]", def_.name, i), def_.sections[i], problems_);
    check_nodes();
    if (!problems_.empty()) return problems_;
    for (std::size_t i = 0; i < elements_.size(); ++i) check_element(i);
    if (problems_.empty()) check_connection();
    return problems_;
  }

 private:
  void add(const std::string& path, std::string what, std::string expected) {
    problems_.push_back({def_.name + '.' + path, std::move(what), std::move(expected), {}});
  }

  void check_lists() {
    if (def_.nodes.size() < 2) add("nodes", fmt::format("{} nodes are too few", def_.nodes.size()), "two or more");
    if (def_.materials.empty()) add("materials", "there is none", "one or more");
    if (def_.sections.empty()) add("sections", "there is none", "one or more");
    if (def_.mass == MassKind::lumped && def_.rotary_inertia == RotaryInertia::none)
      add("rotary_inertia", "lumped mass without rotary inertia leaves rotations without mass",
          "rotary inertia, or consistent mass");
    if (!is_finite(def_.y_axis) || norm(Vec3(def_.y_axis)) == 0) add("y_axis", "it has no direction", "a vector");
  }

  void check_material(std::size_t i) {
    const Material& m = def_.materials[i];
    const auto positive = [&](const char* key, double value, const char* unit) {
      if (!(std::isfinite(value) && value > 0))
        add(fmt::format("materials[{}].{}", i, key), fmt::format("{} {} is out of range", value, unit),
            fmt::format("a number > 0 {}", unit));
    };
    positive("youngs_modulus", m.youngs_modulus, "Pa");
    positive("density", m.density, "kg/m3");
    if (m.shear_modulus != 0) positive("shear_modulus", m.shear_modulus, "Pa");
    if (!(m.poisson_ratio > -1 && m.poisson_ratio < 0.5))
      add(fmt::format("materials[{}].poisson_ratio", i), fmt::format("{} is out of range", m.poisson_ratio),
          "a number between -1 and 0.5");
  }

  void check_nodes() {
    for (std::size_t i = 0; i < def_.nodes.size(); ++i) {
      const BeamNodeDef& node = def_.nodes[i];
      if (!is_finite(node.position)) add(fmt::format("nodes[{}].position", i), "it is not finite", "three numbers [m]");
      if (!index_.insert({node.id, i}).second)
        add(fmt::format("nodes[{}].id", i), fmt::format("{} is given twice", node.id), "another number a node");
    }
  }

  void check_element(std::size_t i) {
    const BeamElementDef& element = elements_[i];
    const std::string path = fmt::format("elements[{}]", i);
    for (const int id : {element.node1, element.node2}) {
      if (!index_.contains(id)) add(path, fmt::format("there is no node {}", id), "a node of the list");
    }
    if (element.section >= def_.sections.size())
      add(path + ".section", fmt::format("there is no section {}", element.section), "a place in the list of sections");
    if (element.material >= def_.materials.size())
      add(path + ".material", fmt::format("there is no material {}", element.material),
          "a place in the list of materials");
    if (!is_finite(element.y_axis)) add(path + ".y_axis", "it is not finite", "a vector");
    if (!problems_.empty()) return;
    const Vec3 along =
        Vec3(def_.nodes[index_[element.node2]].position) - Vec3(def_.nodes[index_[element.node1]].position);
    if (!(norm(along) > 0))
      add(path, fmt::format("nodes {} and {} are at the same place", element.node1, element.node2), "a length > 0");
    else if (norm(axes_of(along, element, def_).c[0]) == 0)
      add(path + ".y_axis", "it lies along the element", "a vector across it");
  }

  // checks that every node is connected to the first
  void check_connection() {
    std::vector<std::size_t> group(def_.nodes.size());
    std::iota(group.begin(), group.end(), std::size_t{0});
    const auto root = [&](std::size_t i) {
      while (group[i] != i) i = group[i];
      return i;
    };
    for (const BeamElementDef& e : elements_) group[root(index_[e.node1])] = root(index_[e.node2]);
    for (std::size_t i = 1; i < group.size(); ++i) {
      if (root(i) == root(0)) continue;
      add("elements", fmt::format("nothing joins node {} to node {}", def_.nodes[i].id, def_.nodes[0].id),
          "elements that make one piece");
      return;
    }
  }

  const BeamDef& def_;
  std::vector<BeamElementDef> elements_;
  std::map<int, std::size_t> index_;
  Problems problems_;
};

BeamElement build_element(const BeamDef& def, const BeamElementDef& from, int id,
                          const std::map<int, std::size_t>& index) {
  const Material& material = def.materials[from.material];
  BeamElement out;
  out.id = id;
  out.node1 = index.at(from.node1);
  out.node2 = index.at(from.node2);
  for (int i = 0; i < 6; ++i) {
    out.freedoms[static_cast<std::size_t>(i)] = 6 * static_cast<int>(out.node1) + i;
    out.freedoms[static_cast<std::size_t>(6 + i)] = 6 * static_cast<int>(out.node2) + i;
    out.freedoms[static_cast<std::size_t>(kNodalFreedoms + i)] = -1;
  }
  out.start = Vec3(def.nodes[out.node1].position);
  const Vec3 along = Vec3(def.nodes[out.node2].position) - out.start;
  out.axes = axes_of(along, from, def);
  out.length = norm(along);
  out.youngs_modulus = material.youngs_modulus;
  out.shear_modulus = material.shear_modulus > 0 ? material.shear_modulus
                                                 : material.youngs_modulus / (2 * (1 + material.poisson_ratio));
  out.density = material.density;
  out.section = make_section(def.sections[from.section], material.poisson_ratio);
  const Section& s = out.section;
  out.phi_y =
      shear_number(out.youngs_modulus * s.second_moment_z, s.shear_factor_y, out.shear_modulus, s.area, out.length);
  out.phi_z =
      shear_number(out.youngs_modulus * s.second_moment_y, s.shear_factor_z, out.shear_modulus, s.area, out.length);
  return out;
}

void add_consistent(std::vector<MassSample>& samples, const BeamElement& e, RotaryInertia rotary) {
  for (const auto& [xi, weight] : kGauss) {
    const ElementField field = field_at(e, xi, rotary);
    const double scale = weight * e.length * e.density;
    const Vec3 place = e.start + e.axes.c[0] * (xi * e.length);
    samples.push_back({scale * e.section.area, false, place, e.freedoms, field.axis});
    samples.push_back({scale * e.section.second_moment_z, true, e.axes.c[1], e.freedoms, field.per_y});
    samples.push_back({scale * e.section.second_moment_y, true, e.axes.c[2], e.freedoms, field.per_z});
  }
}

// displacement of a point at `offset` from the node whose freedoms begin at `first`: u + r x offset
Matrix3xElement carried(int first, Vec3 offset, bool is_offset) {
  Matrix3xElement N = Matrix3xElement::Zero();
  const Mat3 turning = math::skew(-offset);
  for (int a = 0; a < 3; ++a) {
    if (!is_offset) N(a, first + a) = 1;
    for (int b = 0; b < 3 && is_offset; ++b) N(a, first + 3 + b) = turning(a, b);
  }
  return N;
}

void add_lumped(std::vector<MassSample>& samples, const BeamElement& e) {
  const double half = e.density * e.length / 2;
  for (int end = 0; end < 2; ++end) {
    const Vec3 place = e.start + e.axes.c[0] * (end * e.length);
    const Vec3 y = e.axes.c[1], z = e.axes.c[2];
    samples.push_back({half * e.section.area, false, place, e.freedoms, carried(6 * end, {}, false)});
    samples.push_back({half * e.section.second_moment_z, true, y, e.freedoms, carried(6 * end, y, true)});
    samples.push_back({half * e.section.second_moment_y, true, z, e.freedoms, carried(6 * end, z, true)});
  }
}

// rows behind `first`; returns the next free one
int number_internal(BeamElement& element, RotaryInertia rotary, int first) {
  const std::array<bool, 6> has = internal_freedoms(element, rotary);
  for (std::size_t i = 0; i < has.size(); ++i) {
    if (has[i]) element.freedoms[kNodalFreedoms + i] = first++;
  }
  return first;
}

// M = sum w N^T N, K element by element, of n freedoms
void assemble(FeModel& model, int n) {
  std::vector<Eigen::Triplet<double>> mass, stiffness;
  const auto add = [](std::vector<Eigen::Triplet<double>>& to, const ElementFreedoms& at, const ElementMatrix& block) {
    for (int j = 0; j < kElementFreedoms; ++j) {
      for (int i = 0; i < kElementFreedoms; ++i) {
        const int row = at[static_cast<std::size_t>(i)], column = at[static_cast<std::size_t>(j)];
        // freedoms without entries of K must not be coupled in its factors
        const bool is_apart = (i >= kNodalFreedoms || j >= kNodalFreedoms) && block(i, j) == 0;
        if (row >= 0 && column >= 0 && !is_apart) to.emplace_back(row, column, block(i, j));
      }
    }
  };
  for (const MassSample& sample : model.samples) {
    ElementMatrix block;
    for (int j = 0; j < kElementFreedoms; ++j) {
      for (int i = 0; i < kElementFreedoms; ++i) block(i, j) = sample.weight * sample.N.col(i).dot(sample.N.col(j));
    }
    add(mass, sample.freedoms, block);
  }
  for (const BeamElement& element : model.elements) add(stiffness, element.freedoms, stiffness_of(element));
  model.M.resize(n, n);
  model.K.resize(n, n);
  model.M.setFromTriplets(mass.begin(), mass.end());
  model.K.setFromTriplets(stiffness.begin(), stiffness.end());
}

}  // namespace

std::vector<BeamNodeDef> line_of_nodes(Triple start, Triple end, int count) {
  std::vector<BeamNodeDef> nodes;
  for (int i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / (count - 1);
    Triple place;
    for (std::size_t a = 0; a < 3; ++a) place[a] = start[a] + share * (end[a] - start[a]);
    nodes.push_back({i + 1, place});
  }
  return nodes;
}

Problems check_beam(const BeamDef& def) {
  return Checker(def).run();
}

FeModel build_beam(const BeamDef& def) {
  refuse_if_any(check_beam(def));
  FeModel model;
  model.name = def.name;
  std::map<int, std::size_t> index;
  for (std::size_t i = 0; i < def.nodes.size(); ++i) {
    index[def.nodes[i].id] = i;
    model.nodes.push_back({def.nodes[i].id, Vec3(def.nodes[i].position), 6 * static_cast<int>(i), 6});
  }
  int freedoms = 6 * static_cast<int>(model.nodes.size());
  for (const BeamElementDef& element : elements_of(def)) {
    model.elements.push_back(build_element(def, element, static_cast<int>(model.elements.size()) + 1, index));
    if (def.mass == MassKind::consistent) {
      freedoms = number_internal(model.elements.back(), def.rotary_inertia, freedoms);
      add_consistent(model.samples, model.elements.back(), def.rotary_inertia);
    } else {
      add_lumped(model.samples, model.elements.back());
    }
  }
  model.axes = model.elements.front().axes;
  model.made_of = fmt::format("beam of {} nodes and {} elements, {} mass", model.nodes.size(), model.elements.size(),
                              def.mass == MassKind::consistent ? "consistent" : "lumped");
  assemble(model, freedoms);
  return model;
}

}  // namespace slew::flex
