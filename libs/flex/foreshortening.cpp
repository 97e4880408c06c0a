// SPDX-License-Identifier: Apache-2.0
#include "flex/foreshortening.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "flex/input_error.h"

namespace slew::flex {

using Eigen::Index;
using Eigen::MatrixXd;
using math::Vec3;

namespace {

// nodes may be off the line by this share of its length
constexpr double kStraight = 1e-9;

// three points of Gauss and Legendre on 0 to 1: exact for the fourth power, which squared slopes have
const std::array<std::array<double, 2>, 3> kGauss3 = {
    {{(1 - std::sqrt(0.6)) / 2, 5.0 / 18}, {0.5, 8.0 / 18}, {(1 + std::sqrt(0.6)) / 2, 5.0 / 18}}};
// four of them for integrals with the mass: exact to the seventh power
const std::array<std::array<double, 2>, 4> kGauss4 = [] {
  const double a = std::sqrt(3.0 / 7 - 2.0 / 7 * std::sqrt(6.0 / 5)),
               b = std::sqrt(3.0 / 7 + 2.0 / 7 * std::sqrt(6.0 / 5));
  const double wa = (18 + std::sqrt(30.0)) / 72, wb = (18 - std::sqrt(30.0)) / 72;
  return std::array<std::array<double, 2>, 4>{
      {{(1 - b) / 2, wb}, {(1 - a) / 2, wa}, {(1 + a) / 2, wa}, {(1 + b) / 2, wb}}};
}();

// The beam: its axis, and the elements in the order of the chain with the direction of each.
struct Chain {
  Vec3 e;
  std::vector<std::size_t> elements;
};

[[noreturn]] void refuse(const FeModel& model, const std::string& what) {
  throw InputError(
      model.name + ": geometric stiffening was requested, but " + what +
      "; expected one straight chain of beam elements; switch it off, or model the body as several straight "
      "ones");
}

constexpr const char* kSeveralClamps =
    "it is clamped at several nodes, which keep their distance and cause tension instead of shortening";

double along(const FeModel& model, Vec3 e, std::size_t node) {
  return dot(model.nodes[node].position - model.nodes.front().position, e);
}

// Fills the chain; returns the reason if there is none, else an empty text.
std::string find_chain(const FeModel& model, Chain& chain) {
  if (!model.is_beam()) return "the model has imported matrices, which lack the slopes inside";
  Vec3 farthest;
  for (const FeNode& node : model.nodes) {
    const Vec3 d = node.position - model.nodes.front().position;
    if (norm(d) > norm(farthest)) farthest = d;
  }
  const double size = norm(farthest);
  chain.e = farthest * (1 / size);
  for (const FeNode& node : model.nodes) {
    const Vec3 d = node.position - model.nodes.front().position;
    const double off = norm(cross(d, chain.e));
    if (off > kStraight * size) return fmt::format("node {} is {:.3g} m off the line of the beam", node.id, off);
  }
  for (std::size_t i = 0; i < model.elements.size(); ++i) chain.elements.push_back(i);
  const auto low = [&](std::size_t i) {
    return std::min(along(model, chain.e, model.elements[i].node1), along(model, chain.e, model.elements[i].node2));
  };
  std::stable_sort(chain.elements.begin(), chain.elements.end(),
                   [&](std::size_t a, std::size_t b) { return low(a) < low(b); });
  // every element begins where the one before it ends
  for (std::size_t i = 1; i < chain.elements.size(); ++i) {
    const BeamElement &before = model.elements[chain.elements[i - 1]], &here = model.elements[chain.elements[i]];
    const std::size_t end = dot(before.axes.c[0], chain.e) > 0 ? before.node2 : before.node1;
    const std::size_t begin = dot(here.axes.c[0], chain.e) > 0 ? here.node1 : here.node2;
    if (end != begin) return fmt::format("elements {} and {} do not follow each other", before.id, here.id);
  }
  return {};
}

Chain chain_of(const FeModel& model) {
  Chain chain;
  const std::string obstacle = find_chain(model, chain);
  if (!obstacle.empty()) refuse(model, obstacle);
  return chain;
}

// t_k . t_l of all pairs at a point of an element
void slope_products(const BeamElement& e, double xi, const MatrixXd& Phi, std::vector<double>& out) {
  const Matrix3xElement S = slope_at(e, xi);
  const auto m = static_cast<std::size_t>(Phi.cols());
  std::vector<Vec3> t(m);
  for (std::size_t k = 0; k < m; ++k) {
    double sum[3] = {};
    for (int j = 0; j < kElementFreedoms; ++j) {
      const int freedom = e.freedoms[static_cast<std::size_t>(j)];
      if (freedom < 0) continue;
      const double d = Phi(freedom, static_cast<Index>(k));
      for (int a = 0; a < 3; ++a) sum[a] += S(a, j) * d;
    }
    t[k] = Vec3(sum[0], sum[1], sum[2]);
  }
  for (std::size_t k = 0; k < m; ++k) {
    for (std::size_t l = 0; l < m; ++l) out[k * m + l] = dot(t[k], t[l]);
  }
}

// integral of the products from xi = 0 to `to` [m]
std::vector<double> shortening(const BeamElement& e, double to, const MatrixXd& Phi) {
  const auto pairs = static_cast<std::size_t>(Phi.cols() * Phi.cols());
  std::vector<double> sum(pairs), product(pairs);
  for (const auto& [xi, weight] : kGauss3) {
    slope_products(e, xi * to, Phi, product);
    for (std::size_t i = 0; i < pairs; ++i) sum[i] += weight * to * e.length * product[i];
  }
  return sum;
}

class Shortener {
 public:
  Shortener(const FeModel& model, const MatrixXd& Phi, ReducedBody& body)
      : model_(model), Phi_(Phi), body_(body), chain_(chain_of(model)), pairs_(body.modes() * body.modes()) {}

  void run(std::span<const int> clamped_nodes) {
    if (clamped_nodes.size() > 1) refuse(model_, kSeveralClamps);
    at_node_.assign(model_.nodes.size(), std::vector<double>(pairs_));
    integrate_nodes();
    reference_.assign(pairs_, 0);
    if (!clamped_nodes.empty()) reference_ = at_node_[find_node(model_, clamped_nodes.front(), "clamped_nodes")];
    body_.G.assign(pairs_, {});
    body_.H.assign(pairs_, {});
    for (const BeamElement& element : model_.elements) add_element(element);
    if (clamped_nodes.empty()) take_mean_away();
    for (std::size_t i = 0; i < body_.nodes.size(); ++i) {
      body_.nodes[i].g.assign(pairs_, {});
      for (std::size_t p = 0; p < pairs_; ++p) body_.nodes[i].g[p] = chain_.e * -(at_node_[i][p] - reference_[p]);
    }
  }

 private:
  // from the low end of the chain, for any clamping
  void integrate_nodes() {
    for (const std::size_t i : chain_.elements) {
      const BeamElement& element = model_.elements[i];
      const bool is_along = dot(element.axes.c[0], chain_.e) > 0;
      const std::size_t begin = is_along ? element.node1 : element.node2,
                        end = is_along ? element.node2 : element.node1;
      const std::vector<double> whole = shortening(element, 1, Phi_);
      for (std::size_t p = 0; p < pairs_; ++p) at_node_[end][p] = at_node_[begin][p] + whole[p];
    }
  }

  void add_element(const BeamElement& element) {
    const double sign = dot(element.axes.c[0], chain_.e) > 0 ? 1 : -1;
    for (const auto& [xi, weight] : kGauss4) {
      const std::vector<double> part = shortening(element, xi, Phi_);
      const double mass = weight * element.length * element.density * element.section.area;
      const Vec3 place = element.start + element.axes.c[0] * (xi * element.length);
      for (std::size_t p = 0; p < pairs_; ++p) {
        const double s = at_node_[element.node1][p] + sign * part[p] - reference_[p];
        const Vec3 g = chain_.e * -s;
        body_.G[p] += g * mass;
        body_.H[p] += outer(place * mass, g);
      }
    }
  }

  void take_mean_away() {
    for (std::size_t p = 0; p < pairs_; ++p) {
      const double mean = -dot(body_.G[p], chain_.e) / body_.mass;
      reference_[p] = mean;
      body_.H[p] += outer(body_.s0, chain_.e * mean);
      body_.G[p] = Vec3();
    }
  }

  const FeModel& model_;
  const MatrixXd& Phi_;
  ReducedBody& body_;
  Chain chain_;
  std::size_t pairs_;
  std::vector<std::vector<double>> at_node_;  // integral from the low end to the node, by pair [1/(kg m)]
  std::vector<double> reference_;             // the same at the place where g vanishes
};

}  // namespace

std::string obstacle_to_foreshortening(const FeModel& model, std::size_t clamped_nodes) {
  Chain chain;
  return clamped_nodes > 1 ? kSeveralClamps : find_chain(model, chain);
}

void add_foreshortening(const FeModel& model, const MatrixXd& Phi, std::span<const int> clamped_nodes,
                        ReducedBody& body) {
  Shortener(model, Phi, body).run(clamped_nodes);
}

}  // namespace slew::flex
