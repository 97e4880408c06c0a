// SPDX-License-Identifier: Apache-2.0
#include "flex/craig_bampton.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "flex/input_error.h"
#include "flex/mode_order.h"

namespace slew::flex {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// w^2 of a rigid motion over the first elastic one: rounding gives 1e-10 with 20 elements, 1e-7 with 200
constexpr double kRigid = 1e-5;
// modes beyond the requested ones, so that a group of one frequency is complete before it is cut
constexpr int kSpareModes = 4;

std::vector<std::size_t> nodes_of(const FeModel& model, const std::vector<int>& ids, const std::string& key) {
  std::vector<std::size_t> nodes;
  for (const int id : ids) {
    const std::size_t node = find_node(model, id, key);
    if (std::find(nodes.begin(), nodes.end(), node) != nodes.end())
      throw InputError(fmt::format("{}.{}: node {} is named twice; expected it once", model.name, key, id));
    nodes.push_back(node);
  }
  return nodes;
}

std::vector<int> rows_of(const FeModel& model, const std::vector<std::size_t>& nodes) {
  std::vector<int> rows;
  for (const std::size_t i : nodes) {
    for (int a = 0; a < model.nodes[i].freedoms; ++a) rows.push_back(model.nodes[i].first + a);
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

// rows that are in none of the two sorted lists
std::vector<int> other_rows(int count, const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> rows;
  for (int row = 0; row < count; ++row) {
    if (!std::binary_search(a.begin(), a.end(), row) && !std::binary_search(b.begin(), b.end(), row))
      rows.push_back(row);
  }
  return rows;
}

SparseMatrix block_of(const SparseMatrix& A, const std::vector<int>& rows, const std::vector<int>& columns) {
  std::vector<int> place(static_cast<std::size_t>(A.rows()), -1);
  for (std::size_t i = 0; i < rows.size(); ++i) place[static_cast<std::size_t>(rows[i])] = static_cast<int>(i);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t j = 0; j < columns.size(); ++j) {
    for (SparseMatrix::InnerIterator it(A, columns[j]); it; ++it) {
      const int row = place[static_cast<std::size_t>(it.row())];
      if (row >= 0) entries.emplace_back(row, static_cast<int>(j), it.value());
    }
  }
  SparseMatrix block(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  block.setFromTriplets(entries.begin(), entries.end());
  return block;
}

// rank of the rigid motions in the rows: number of the six that they hold
int motions_held(const FeModel& model, const std::vector<int>& rows) {
  Eigen::Matrix<double, Eigen::Dynamic, 6> R = rigid_motions(model, model.nodes.front().position);
  double size = 0;
  for (const FeNode& node : model.nodes) size = std::max(size, norm(node.position - model.nodes.front().position));
  R.rightCols<3>() /= size;
  MatrixXd held(static_cast<Index>(rows.size()), 6);
  for (std::size_t i = 0; i < rows.size(); ++i) held.row(static_cast<Index>(i)) = R.row(rows[i]);
  return solve_small(held, MatrixXd::Zero(held.rows(), 1)).rank;
}

void require_held(const FeModel& model, const std::vector<int>& rows, const std::string& key, const char* what) {
  const int held = motions_held(model, rows);
  if (held == 6) return;
  throw InputError(fmt::format(
      "{}.{}: these nodes hold {} of the six rigid motions; expected all six, so that {}; name more of them: one node "
      "with rotations, or three with translations that are not in one line",
      model.name, key, held, what));
}

struct Partition {
  std::vector<int> held, boundary, interior;
};

Partition partition(const FeModel& model, const CraigBamptonDef& def, CraigBampton& out) {
  const int first = model.nodes.front().id, last = model.nodes.back().id;
  out.clamped_nodes = def.clamped_nodes;
  out.interface_nodes = def.interface_nodes;
  if (def.attachment == Attachment::free && !def.clamped_nodes.empty())
    throw InputError(model.name + ".clamped_nodes: a free body has none; expected no nodes; or clamp it");
  if (def.attachment == Attachment::clamped && def.clamped_nodes.empty()) out.clamped_nodes = {first};
  if (def.interface_nodes.empty()) {
    if (def.attachment == Attachment::clamped)
      out.interface_nodes = {last};
    else
      out.interface_nodes = {first, last};
  }
  const auto clamped = nodes_of(model, out.clamped_nodes, "clamped_nodes");
  const auto boundary = nodes_of(model, out.interface_nodes, "interface_nodes");
  for (const std::size_t node : boundary) {
    if (std::find(clamped.begin(), clamped.end(), node) != clamped.end())
      throw InputError(fmt::format("{}.interface_nodes: node {} is clamped; expected a node that moves", model.name,
                                   model.nodes[node].id));
  }
  Partition p{rows_of(model, clamped), rows_of(model, boundary), {}};
  p.interior = other_rows(model.freedoms(), p.held, p.boundary);
  if (def.attachment == Attachment::clamped)
    require_held(model, p.held, "clamped_nodes", "the body frame is fixed in the body");
  else
    require_held(model, p.boundary, "interface_nodes", "the inside is held while they are");
  return p;
}

// phi^N spread over all rows, the first `count` of them
struct FixedInterface {
  std::vector<double> lambda;
  MatrixXd Phi;
};

FixedInterface fixed_interface_modes(const FeModel& model, const Partition& p, const CraigBamptonDef& def) {
  const int inside = static_cast<int>(p.interior.size());
  if (def.fixed_interface_modes < 0 || def.fixed_interface_modes > inside)
    throw InputError(fmt::format("{}.fixed_interface_modes: {} is out of range; expected 0 to {}, the freedoms inside",
                                 model.name, def.fixed_interface_modes, inside));
  const auto count = static_cast<std::size_t>(def.fixed_interface_modes);
  const SparseMatrix K = block_of(model.K, p.interior, p.interior), M = block_of(model.M, p.interior, p.interior);
  const Modes modes = lowest_modes(K, M, count == 0 ? 0 : static_cast<int>(count) + kSpareModes, 0, def.method);
  if (modes.lambda.size() < count)
    throw InputError(fmt::format("{}.fixed_interface_modes: only {} of {} modes have mass; expected at most these",
                                 model.name, modes.lambda.size(), count));
  FixedInterface out{modes.lambda, MatrixXd::Zero(model.freedoms(), modes.vectors.cols())};
  for (Index k = 0; k < modes.vectors.cols(); ++k) {
    for (std::size_t i = 0; i < p.interior.size(); ++i)
      out.Phi(p.interior[i], k) = modes.vectors(static_cast<Index>(i), k);
  }
  separate_repeated(model, out.lambda, out.Phi);
  choose_signs(model, out.Phi);
  // a group of one frequency stays whole: half of a pair would stiffen one plane of a square section only
  std::size_t kept = count;
  while (kept > 0 && kept < out.lambda.size() && out.lambda[kept] == out.lambda[kept - 1]) ++kept;
  out.lambda.resize(kept);
  out.Phi.conservativeResize(Eigen::NoChange, static_cast<Index>(kept));
  return out;
}

// (1): Phi^C; the first use of a stiff inside
MatrixXd constraint_modes(const FeModel& model, const Partition& p) {
  return -solve_positive(block_of(model.K, p.interior, p.interior), MatrixXd(block_of(model.K, p.interior, p.boundary)),
                         model.name +
                             ": the inside is not held by the interface nodes; expected a stiffness matrix without "
                             "mechanisms; look for joints, loose parts and a wrong order of nodes");
}

// (1), (2)
struct ReducedMatrices {
  MatrixXd Phi, K, M;
};

ReducedMatrices reduce_matrices(const FeModel& model, const Partition& p, const MatrixXd& constraint,
                                const FixedInterface& fixed) {
  const auto nb = static_cast<Index>(p.boundary.size());
  const auto nn = static_cast<Index>(fixed.lambda.size());
  ReducedMatrices out;
  out.Phi = MatrixXd::Zero(model.freedoms(), nb + nn);
  for (Index j = 0; j < nb; ++j) {
    out.Phi(p.boundary[static_cast<std::size_t>(j)], j) = 1;
    for (std::size_t i = 0; i < p.interior.size(); ++i)
      out.Phi(p.interior[i], j) = constraint(static_cast<Index>(i), j);
  }
  out.Phi.rightCols(nn) = fixed.Phi;
  out.K = MatrixXd::Zero(nb + nn, nb + nn);
  const SparseMatrix K_BI = block_of(model.K, p.boundary, p.interior);
  MatrixXd K_BB = MatrixXd(block_of(model.K, p.boundary, p.boundary)) + K_BI * constraint;
  out.K.topLeftCorner(nb, nb) = 0.5 * (K_BB + K_BB.transpose());
  for (Index k = 0; k < nn; ++k) out.K(nb + k, nb + k) = fixed.lambda[static_cast<std::size_t>(k)];
  const MatrixXd M_Phi = model.M * out.Phi;
  const MatrixXd M = out.Phi.transpose() * M_Phi;
  out.M = 0.5 * (M + M.transpose());
  return out;
}

// (3) for a free body: shifted by its own first elastic mode
Modes free_modes(const FeModel& model, const ReducedMatrices& reduced, CraigBampton& out) {
  if (reduced.K.rows() < 7)
    throw InputError(model.name +
                     ": a free body of six reduced freedoms has rigid motions only; expected more interface "
                     "nodes or fixed-interface modes");
  // begin with a rough shift: interfaces may have directions without stiffness, so no single ratio is sufficient
  const double shift = all_modes(reduced.K, reduced.M, 1e-3 * reduced.K.trace() / reduced.M.trace()).lambda[6];
  Modes modes = all_modes(reduced.K, reduced.M, shift);
  const double limit = kRigid * modes.lambda[6];
  const auto rigid = std::count_if(modes.lambda.begin(), modes.lambda.end(), [&](double x) { return x < limit; });
  if (rigid != 6 || std::abs(modes.lambda[5]) > limit)
    throw InputError(fmt::format(
        "{}: the free body has {} rigid motions (w^2 of the sixth and seventh mode {:.3g}, {:.3g} 1/s2); expected six; "
        "look for supports, joints and loose parts in the model",
        model.name, rigid, modes.lambda[5], modes.lambda[6]));
  out.rigid.assign(modes.lambda.begin(), modes.lambda.begin() + 6);
  modes.lambda.erase(modes.lambda.begin(), modes.lambda.begin() + 6);
  modes.vectors = MatrixXd(modes.vectors.rightCols(modes.vectors.cols() - 6));
  return modes;
}

// exactly across the rigid motions, which rounding leaves open to 1e-7 of a mode
void remove_rigid_share(const FeModel& model, MatrixXd& Phi) {
  const MatrixXd R = rigid_motions(model);
  const MatrixXd MR = model.M * R;
  const MatrixXd RMR = R.transpose() * MR, shares = MR.transpose() * Phi;
  Phi -= R * solve_small(RMR, shares).x;
}

}  // namespace

CraigBampton craig_bampton(const FeModel& model, const CraigBamptonDef& def) {
  fix_product_blocks();
  CraigBampton out;
  const Partition p = partition(model, def, out);
  const MatrixXd constraint = constraint_modes(model, p);
  const FixedInterface fixed = fixed_interface_modes(model, p, def);
  const ReducedMatrices reduced = reduce_matrices(model, p, constraint, fixed);
  Modes modes =
      def.attachment == Attachment::free ? free_modes(model, reduced, out) : all_modes(reduced.K, reduced.M, 0);
  out.Phi = reduced.Phi * modes.vectors;
  separate_repeated(model, modes.lambda, out.Phi);
  choose_signs(model, out.Phi);
  if (def.attachment == Attachment::free) remove_rigid_share(model, out.Phi);
  for (const double lambda : modes.lambda) out.omega.push_back(std::sqrt(lambda));
  for (const double lambda : fixed.lambda) out.fixed_interface.push_back(std::sqrt(lambda));
  out.held = p.held;
  out.boundary = p.boundary;
  out.interior = p.interior;
  return out;
}

std::vector<double> full_frequencies(const FeModel& model, const std::vector<int>& held, int count, double shift,
                                     EigenMethod method) {
  const std::vector<int> rows = other_rows(model.freedoms(), held, {});
  const int rigid = held.empty() ? 6 : 0;
  const Modes modes = lowest_modes(block_of(model.K, rows, rows), block_of(model.M, rows, rows), count + rigid,
                                   held.empty() ? shift : 0, method);
  std::vector<double> omega;
  for (std::size_t i = static_cast<std::size_t>(rigid); i < modes.lambda.size(); ++i)
    omega.push_back(std::sqrt(modes.lambda[i]));
  return omega;
}

MatrixXd static_answer(const FeModel& model, const std::vector<int>& held, const std::vector<int>& loaded) {
  const std::vector<int> rows = other_rows(model.freedoms(), held, {});
  MatrixXd loads = MatrixXd::Zero(static_cast<Index>(rows.size()), static_cast<Index>(loaded.size()));
  for (std::size_t j = 0; j < loaded.size(); ++j) {
    const auto at = std::lower_bound(rows.begin(), rows.end(), loaded[j]);
    if (at != rows.end() && *at == loaded[j]) loads(at - rows.begin(), static_cast<Index>(j)) = 1;
  }
  const MatrixXd moved =
      solve_positive(block_of(model.K, rows, rows), loads,
                     model.name + ": the held model is not stiff; expected all six rigid motions held");
  MatrixXd out = MatrixXd::Zero(model.freedoms(), loads.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) out.row(rows[i]) = moved.row(static_cast<Index>(i));
  return out;
}

}  // namespace slew::flex
