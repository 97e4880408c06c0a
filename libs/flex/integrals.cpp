// SPDX-License-Identifier: Apache-2.0
#include "flex/integrals.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace slew::flex {

using Eigen::Index;
using Eigen::MatrixXd;
using math::Mat3;
using math::Vec3;

namespace {

Vec3 moved(const MassSample& sample, const MatrixXd& Phi, Index mode) {
  double u[3] = {0, 0, 0};
  for (int j = 0; j < kElementFreedoms; ++j) {
    const int row = sample.freedoms[static_cast<std::size_t>(j)];
    if (row < 0) continue;
    for (int a = 0; a < 3; ++a) u[a] += sample.N(a, j) * Phi(row, mode);
  }
  return {u[0], u[1], u[2]};
}

// (1)
void add_samples(const FeModel& model, const MatrixXd& Phi, ReducedBody& body) {
  const std::size_t m = body.modes();
  std::vector<Vec3> u(m);
  for (const MassSample& sample : model.samples) {
    const Vec3 wx = sample.position * sample.weight;
    for (std::size_t k = 0; k < m; ++k) u[k] = moved(sample, Phi, static_cast<Index>(k));
    body.W0 += outer(wx, sample.position);
    if (!sample.is_offset) {
      body.mass += sample.weight;
      body.s0 += wx;
    }
    for (std::size_t k = 0; k < m; ++k) {
      if (!sample.is_offset) body.C[k] += u[k] * sample.weight;
      body.Z[k] += outer(wx, u[k]);
      for (std::size_t l = 0; l < m; ++l) body.Y[body.pair(k, l)] += outer(u[k] * sample.weight, u[l]);
    }
  }
}

Vec3 translation(const FeNode& node, const MatrixXd& Phi, std::size_t mode) {
  const auto k = static_cast<Index>(mode);
  return {Phi(node.first, k), Phi(node.first + 1, k), Phi(node.first + 2, k)};
}

// m_ij of all pairs of nodes that M couples, column by column
struct NodeMasses {
  struct Entry {
    std::size_t i, j;
    double mass;
  };
  std::vector<Entry> entries;
  double deviation = 0;
};

NodeMasses node_masses(const FeModel& model) {
  std::vector<int> node_of(static_cast<std::size_t>(model.freedoms()));
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    for (int a = 0; a < model.nodes[i].freedoms; ++a)
      node_of[static_cast<std::size_t>(model.nodes[i].first + a)] = static_cast<int>(i);
  }
  NodeMasses out;
  double largest = 0, largest_deviation = 0;
  std::vector<Mat3> blocks(model.nodes.size());
  std::vector<std::uint8_t> is_touched(model.nodes.size());
  std::vector<std::size_t> touched;
  for (std::size_t j = 0; j < model.nodes.size(); ++j) {
    for (int b = 0; b < 3; ++b) {
      for (SparseMatrix::InnerIterator it(model.M, model.nodes[j].first + b); it; ++it) {
        const auto i = static_cast<std::size_t>(node_of[static_cast<std::size_t>(it.row())]);
        const auto a = static_cast<int>(it.row()) - model.nodes[i].first;
        if (a >= 3) continue;
        if (is_touched[i] == 0) touched.push_back(i);
        is_touched[i] = 1;
        blocks[i].c[b].lanes[a] += it.value();
      }
    }
    for (const std::size_t i : touched) {
      const double mass = (blocks[i](0, 0) + blocks[i](1, 1) + blocks[i](2, 2)) / 3;
      for (int b = 0; b < 3; ++b) {
        for (int a = 0; a < 3; ++a)
          largest_deviation = std::max(largest_deviation, std::abs(blocks[i](a, b) - (a == b ? mass : 0)));
      }
      largest = std::max(largest, std::abs(mass));
      out.entries.push_back({i, j, mass});
      blocks[i] = Mat3();
      is_touched[i] = 0;
    }
    touched.clear();
  }
  out.deviation = largest > 0 ? largest_deviation / largest : 0;
  return out;
}

// (2)
void add_rigid_parts(const FeModel& model, const MatrixXd& M_Phi, ReducedBody& body) {
  const RigidMass rigid = rigid_mass(model);
  body.mass = rigid.mass;
  body.s0 = rigid.first;
  body.W0 = rigid.second;
  const Eigen::Matrix<double, Eigen::Dynamic, 6> R = rigid_motions(model);
  for (std::size_t k = 0; k < body.modes(); ++k) {
    double share[6] = {};
    for (int row = 0; row < model.freedoms(); ++row) {
      for (int a = 0; a < 6; ++a) share[a] += R(row, a) * M_Phi(row, static_cast<Index>(k));
    }
    body.C[k] = Vec3(share[0], share[1], share[2]);
    // angular momentum L = integral rho x cross phi: Z - Z^T = -L~
    body.Z[k] += math::skew(Vec3(share[3], share[4], share[5])) * -0.5;
  }
}

double modal_mass(const MatrixXd& Phi, const MatrixXd& M_Phi, std::size_t k, std::size_t l) {
  double sum = 0;
  for (Index row = 0; row < Phi.rows(); ++row)
    sum += Phi(row, static_cast<Index>(k)) * M_Phi(row, static_cast<Index>(l));
  return sum;
}

// (3)
MassDeviation add_matrix(const FeModel& model, const MatrixXd& Phi, ReducedBody& body) {
  const std::size_t m = body.modes();
  const MatrixXd M_Phi = model.M * Phi;
  add_rigid_parts(model, M_Phi, body);
  const NodeMasses masses = node_masses(model);
  for (const auto& [i, j, mass] : masses.entries) {
    const FeNode &node_i = model.nodes[i], &node_j = model.nodes[j];
    for (std::size_t k = 0; k < m; ++k) {
      const Mat3 product = outer(node_i.position * mass, translation(node_j, Phi, k));
      body.Z[k] += (product + transpose(product)) * 0.5;
      const Vec3 u = translation(node_i, Phi, k) * mass;
      for (std::size_t l = 0; l < m; ++l) body.Y[body.pair(k, l)] += outer(u, translation(node_j, Phi, l));
    }
  }
  MassDeviation deviation{masses.deviation, 0};
  for (std::size_t k = 0; k < m; ++k) {
    for (std::size_t l = 0; l < m; ++l) {
      Mat3& Y = body.Y[body.pair(k, l)];
      const double missing = modal_mass(Phi, M_Phi, k, l) - (Y(0, 0) + Y(1, 1) + Y(2, 2));
      deviation.modal = std::max(deviation.modal, std::abs(missing));
      Y += Mat3::diagonal(missing / 3, missing / 3, missing / 3);
    }
  }
  return deviation;
}

// Y_lk = Y_kl^T to the bit
void mirror(ReducedBody& body) {
  for (std::size_t k = 0; k < body.modes(); ++k) {
    Mat3& own = body.Y[body.pair(k, k)];
    own = (own + transpose(own)) * 0.5;
    for (std::size_t l = k + 1; l < body.modes(); ++l) body.Y[body.pair(l, k)] = transpose(body.Y[body.pair(k, l)]);
  }
}

}  // namespace

MassDeviation add_integrals(const FeModel& model, const MatrixXd& Phi, ReducedBody& body) {
  const auto m = static_cast<std::size_t>(Phi.cols());
  body.C.assign(m, {});
  body.Z.assign(m, {});
  body.Y.assign(m * m, {});
  MassDeviation deviation;
  if (!model.samples.empty())
    add_samples(model, Phi, body);
  else
    deviation = add_matrix(model, Phi, body);
  mirror(body);
  return deviation;
}

}  // namespace slew::flex
