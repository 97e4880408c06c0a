// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "contact/find_named.h"
#include "contact/mesh_check.h"
#include "core/display.h"
#include "multibody/build/validate.h"
#include "multibody/contacts/contact_conversion.h"
#include "multibody/contacts/contact_elements.h"
#include "multibody/contacts/contact_passes.h"
#include "multibody/contacts/contact_rate.h"
#include "multibody/formulations/integrators.h"
#include "multibody/model/model.h"
#include "multibody/model/topology.h"
#include "multibody/results/observe.h"

namespace slew::multibody {
using contact::find_named;

namespace {

// depth above that of any load on resting shapes
constexpr double kDeepStart = 1e-2;  // m

bool is_mesh(const ShapeDef& shape) {
  return shape.type == contact::ShapeType::convex_mesh || shape.type == contact::ShapeType::triangle_mesh;
}

class ContactValidator {
 public:
  ContactValidator(const MechanicsDef& mechanics, Problems& problems) : m_(mechanics), problems_(problems) {
    Problems known;  // problems of the tree are reported elsewhere
    carrier_ = merged_into(m_, find_tree(m_, known));
  }

  void run() {
    const std::size_t before = problems_.size();
    for (const ShapeDef& shape : m_.shapes) check_lists(shape);
    for (const FrictionDef& friction : m_.frictions) contact::check(friction.name, friction.law, problems_);
    for (const ContactPairDef& pair : m_.contacts) check_names(pair);
    if (problems_.size() > before) return;
    Problems found;
    contact::validate(definition(), found);
    for (Problem& problem : found) add_translated(std::move(problem));
  }

 private:
  void add(const std::string& owner, std::string_view key, std::string what, std::string expected) {
    problems_.push_back({fmt::format("{}.{}", owner, key), std::move(what), std::move(expected), {}});
  }

  void check_lists(const ShapeDef& shape) {
    if (number_of_(shape.body) == kNoBody) {
      add(shape.name, "body", fmt::format("there is no body '{}'", shape.body), "the name of a body, or Ground");
    }
    if (!is_mesh(shape)) return;
    if (shape.vertices.size() % 3 != 0) {
      add(shape.name, "vertices", fmt::format("there are {} numbers", shape.vertices.size()),
          "three numbers for each vertex");
    }
    if (shape.triangles.size() % 3 != 0) {
      add(shape.name, "triangles", fmt::format("there are {} numbers", shape.triangles.size()),
          "three numbers of vertices for each triangle");
    }
  }

  void check_names(const ContactPairDef& pair) {
    for (const auto& [key, name] : {std::pair("shape_a", &pair.shape_a), std::pair("shape_b", &pair.shape_b)}) {
      if (find_named(m_.shapes, *name) == nullptr) {
        add(pair.name, key, fmt::format("there is no shape '{}'", *name), "the name of a shape");
      }
    }
    if (pair.shape_a == pair.shape_b) {
      add(pair.name, "shape_b", fmt::format("both shapes are '{}'", pair.shape_a), "two different shapes");
    }
    if (!pair.friction.empty() && find_named(m_.frictions, pair.friction) == nullptr) {
      add(pair.name, "friction", fmt::format("there is no friction '{}'", pair.friction), "the name of a friction");
    }
  }

  [[nodiscard]] int carrier_of(const ShapeDef& shape) const {
    return carrier_[static_cast<std::size_t>(number_of_(shape.body))];
  }

  // check everything; for pairs without relative motion only the law
  contact::ContactDef definition() {
    contact::ContactDef def;
    for (const ShapeDef& shape : m_.shapes) {
      def.shapes.push_back(contact_shape(shape));
      if (find_named(def.frames, shape.body) != nullptr) continue;
      def.frames.push_back({shape.body, carrier_of(shape) == kGround});
    }
    for (const ContactPairDef& pair : m_.contacts) {
      const bool is_tested =
          carrier_of(*find_named(m_.shapes, pair.shape_a)) != carrier_of(*find_named(m_.shapes, pair.shape_b));
      if (is_tested) {
        def.pairs.push_back(contact_pair(m_, pair));
        def.pairs.back().friction.reset();  // checked under its own name
      } else {
        contact::check(pair.name, pair.normal, problems_);
      }
    }
    return def;
  }

  // keys of libs/contact to those of a scene
  void add_translated(Problem problem) {
    const std::size_t dot = problem.path.rfind('.');
    const std::string owner = problem.path.substr(0, dot), key = problem.path.substr(dot + 1);
    const ShapeDef* shape = find_named(m_.shapes, owner);
    if (shape != nullptr && key == "frame") problem.path = owner + ".body";
    if (shape != nullptr && key == "mesh") problem.path = owner + (shape->file.empty() ? ".triangles" : ".file");
    if (shape != nullptr && key == "height_field") problem.path = owner + ".heights";
    problems_.push_back(std::move(problem));
  }

  const MechanicsDef& m_;
  BodyNumbers number_of_{m_};
  Problems& problems_;
  std::vector<int> carrier_;
};

void find_deep_starts(const MechanicsDef& m, Problems& warnings) {
  const Model model = build_model(m);
  Workspace ws(model);
  observe(model, start_state(model), ws);
  std::vector<double> deepest(model.contact->pairs.size(), 0.0);
  for (std::size_t i = 0; i < ws.contact->force_count; ++i) {
    const ContactForce& force = ws.contact->forces[i];
    double& depth = deepest[static_cast<std::size_t>(force.pair)];
    depth = std::max(depth, force.depth);
  }
  for (std::size_t i = 0; i < deepest.size(); ++i) {
    if (deepest[i] <= kDeepStart) continue;
    warnings.push_back(
        {model.contact->pairs[i].name,
         fmt::format("the shapes start {:.3g} m deep in each other, and push each other out", deepest[i]),
         "shapes that touch by less than 1 cm at the start", ""});
  }
}

// sqrt(k/m) or c/m, for the smallest impact speed of the law
struct ImpactRate {
  double spring = 0, damping = 0;  // 1/s
  [[nodiscard]] double fastest() const noexcept { return std::max(spring, damping); }
};
ImpactRate rate_of_impact(const Model& model, const contact::ContactPair& pair) {
  const int links[2] = {model.contact->frames[model.contact->model.frame_of(pair.shape_a)].link,
                        model.contact->frames[model.contact->model.frame_of(pair.shape_b)].link};
  const double both = links[0] == 0 || links[1] == 0 ? 1 : 2;
  double largest = 0, sum = 0;
  for (const int link : links) {
    const double mass = link == 0 ? 0 : model.links[static_cast<std::size_t>(link)].mass;
    if (!(mass > 0)) continue;
    largest = std::max(largest, both / mass);
    sum += both / mass;
  }
  if (!(sum > 0)) return {};
  const contact::NormalForce slopes =
      slopes_of_impact(pair.normal, 1, 0, pair.normal.smallest_impact_speed, {}, 1 / sum);
  return {std::sqrt(slopes.d_depth * largest), slopes.d_depth_rate * largest};
}

}  // namespace

void validate_contacts(const MechanicsDef& mechanics, Problems& problems) {
  ContactValidator(mechanics, problems).run();
}

void check_contact_rates(const MechanicsDef& mechanics, double substep, Problems& problems) {
  if (mechanics.contacts.empty() || is_implicit(step_rule(mechanics).integrator)) return;
  const bool is_euler = step_rule(mechanics).integrator == Integrator::semi_implicit_euler;
  const double reach = mechanics.formulation == Formulation::augmented ? kReachOfCorrections
                       : is_euler                                      ? kReachOfEuler
                                                                       : kReach;
  const double fastest = kMostStiffParts * reach / substep;
  const Model model = build_model(mechanics);
  if (model.contact == nullptr) return;
  const std::span<const contact::ContactPair> pairs = model.contact->model.pairs();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const int tested = model.contact->pair_of_tested[i];
    const contact::NormalLaw& law = pairs[i].normal;
    const double rate = rate_of_impact(model, pairs[i]).fastest();
    if (!(rate > fastest)) continue;
    problems.push_back(
        {model.contact->pairs[static_cast<std::size_t>(tested)].name + ".spring_constant",
         fmt::format("an impact is over within {:.2g} s, the shortest part of a sub-step of {:.3g} s is {:.2g} s: the "
                     "bodies would leave each other faster than they met",
                     1 / rate, substep, substep / kMostStiffParts),
         fmt::format("at most {:.2g} N/m, a larger restitution_coefficient, mechanics.max_substep of at most {:.2g} s, "
                     "or an implicit mechanics.integrator such as trapezoidal",
                     rounded_down(law.stiffness * std::pow(fastest / rate, law.exponent + 1), 2),
                     rounded_down(substep * fastest / rate, 2)),
         ""});
  }
}

// rk4 takes parts of contact_substep or kReach over the rate: stable, and too long for the rebound of a stiff pair
void find_coarse_rebounds(const MechanicsDef& mechanics, double substep, Problems& warnings) {
  constexpr double kCoarse = 0.75;  // rate times part: below, the rebound is right to half a per cent
  const Model model = build_model(mechanics);
  if (model.contact == nullptr) return;
  const std::span<const contact::ContactPair> pairs = model.contact->model.pairs();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const ImpactRate rate = rate_of_impact(model, pairs[i]);
    if (rate.fastest() > kMostStiffParts * kReach / substep) continue;  // refused
    const double part = std::min({substep, mechanics.contact_substep, kReach / rate.fastest()});
    if (!(rate.spring * part > kCoarse) || !rebounds(pairs[i].normal)) continue;
    const int tested = model.contact->pair_of_tested[i];
    warnings.push_back(
        {model.contact->pairs[static_cast<std::size_t>(tested)].name + ".spring_constant",
         fmt::format("an impact lasts some {:.2g} s and is resolved in parts of {:.2g} s: its rebound may be off by a "
                     "tenth of the speed of the impact, to either side",
                     M_PI / rate.spring, part),
         fmt::format("mechanics.contact_substep of at most {:.2g} s where the rebound matters",
                     rounded_down(0.2 / rate.spring, 2)),
         ""});
  }
}

void find_lost_rebounds(const MechanicsDef& mechanics, double substep, Problems& warnings) {
  if (mechanics.contacts.empty()) return;
  if (step_rule(mechanics).integrator == Integrator::rk4) return find_coarse_rebounds(mechanics, substep, warnings);
  const bool is_augmented = mechanics.formulation == Formulation::augmented;
  if (!is_implicit(step_rule(mechanics).integrator) && !is_augmented) return;
  const double fastest = kMostStiffParts * (is_augmented ? kLostBlowOfCorrections : kLostBlow) / substep;
  const Model model = build_model(mechanics);
  if (model.contact == nullptr) return;
  const std::span<const contact::ContactPair> pairs = model.contact->model.pairs();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const contact::NormalLaw& law = pairs[i].normal;
    const ImpactRate both = rate_of_impact(model, pairs[i]);
    const double rate = both.spring;
    if (!(rate > fastest) || !rebounds(law)) continue;
    if (is_augmented && both.fastest() > kMostStiffParts * kReachOfCorrections / substep) continue;  // refused
    const int tested = model.contact->pair_of_tested[i];
    warnings.push_back(
        {model.contact->pairs[static_cast<std::size_t>(tested)].name + ".spring_constant",
         fmt::format("an impact is over within {:.2g} s, the shortest part of a sub-step of {:.3g} s is {:.2g} s: "
                     "{}, and their steps are flagged not_converged",
                     1 / rate, substep, substep / kMostStiffParts,
                     is_augmented ? "the rebound of impacts may be off by a tenth of their speed, to either side"
                                  : "impacts lose a part of their rebound or all of it"),
         fmt::format("at most {:.2g} N/m, or mechanics.max_substep of at most {:.2g} s; with a restitution_coefficient "
                     "below {} nothing is lost",
                     rounded_down(law.stiffness * std::pow(fastest / rate, law.exponent + 1), 2),
                     rounded_down(substep * fastest / rate, 2), kPlastic),
         ""});
  }
}

void find_unlikely_contacts(const MechanicsDef& mechanics, Problems& warnings) {
  if (mechanics.contacts.empty()) return;
  for (const ContactPairDef& pair : mechanics.contacts) {
    const std::string& body = find_named(mechanics.shapes, pair.shape_a)->body;
    // between fixed shapes a pair is a name
    if (find_named(mechanics.shapes, pair.shape_b)->body != body || body == kGroundName) continue;
    warnings.push_back(
        {pair.name, fmt::format("it has no effect: both shapes are of '{}'", body), "shapes of two bodies", ""});
  }
  find_deep_starts(mechanics, warnings);
}

}  // namespace slew::multibody
