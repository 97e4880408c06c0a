// SPDX-License-Identifier: Apache-2.0
#include "flex/imported_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <set>

#include "flex/decompositions.h"
#include "flex/input_error.h"
#include "flex/matrix_market.h"
#include "flex/text_lines.h"

namespace slew::flex {

using math::Vec3;

namespace {

// |A - A^T| over the largest element: rounding of eight printed digits
constexpr double kSymmetricMatrix = 1e-7;
// force of a rigid motion over that of its stiffest row: eight printed digits, and room for a fine mesh
constexpr double kRigidForce = 1e-6;
// tolerance of the masses in x, y and z
constexpr double kOneMass = 1e-6;
// a pivot of K + shift M over its diagonal below this is not positive
constexpr double kIndefinite = -1e-12;
// added to the diagonal of M before its signs are counted: above the rounding of a zero
constexpr double kLift = 1e-9;
// share of its length below which a box is too thin to give a density
constexpr double kFlat = 1e-3;
// kg/m3 over the box around the nodes: below a balloon of foil, above the densest metal
constexpr double kLightest = 1e-2, kDensest = 25000;

[[noreturn]] void refuse(const std::string& name, const std::string& what, const std::string& expected,
                         const std::string& remedy) {
  throw InputError(fmt::format("{}: {}; expected {}; {}", name, what, expected, remedy));
}

std::vector<FeNode> read_nodes(const std::filesystem::path& file) {
  TextLines lines(file);
  std::vector<FeNode> nodes;
  std::set<int> ids;
  while (lines.next()) {
    const auto words = lines.words();
    if (words.empty() || words[0].starts_with('#') || (nodes.empty() && words[0] == "id")) continue;
    if (words.size() != 5) lines.refuse(fmt::format("{} words", words.size()), "id x y z freedoms");
    FeNode node;
    node.id = static_cast<int>(lines.whole_of(words[0], 0));
    node.position = Vec3(lines.number_of(words[1]), lines.number_of(words[2]), lines.number_of(words[3]));
    node.freedoms = static_cast<int>(lines.whole_of(words[4], 0));
    if (node.freedoms != 3 && node.freedoms != 6)
      lines.refuse(fmt::format("a node of {} freedoms", node.freedoms), "3 (ux uy uz) or 6 (with rx ry rz)");
    if (!ids.insert(node.id).second) lines.refuse(fmt::format("node {} is given twice", node.id), "each once");
    nodes.push_back(node);
  }
  if (nodes.size() < 2) refuse_file(file, 0, fmt::format("{} nodes", nodes.size()), "two or more");
  return nodes;
}

double largest(const SparseMatrix& A) {
  double value = 0;
  for (int j = 0; j < A.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator it(A, j); it; ++it) value = std::max(value, std::abs(it.value()));
  }
  return value;
}

void check_size(const std::string& name, const char* which, const SparseMatrix& A, const std::vector<FeNode>& nodes) {
  int size = 0;
  for (const FeNode& node : nodes) size += node.freedoms;
  if (A.rows() != A.cols())
    refuse(name, fmt::format("the {} matrix has {} rows and {} columns", which, A.rows(), A.cols()), "a square matrix",
           "check the export");
  if (A.rows() != size)
    refuse(name, fmt::format("the {} matrix has {} rows", which, A.rows()),
           fmt::format("{}, the freedoms of the {} nodes of the table together", size, nodes.size()),
           "list every node that has rows, with 3 or 6 freedoms, and no other");
}

void check_symmetry(const std::string& name, const char* which, const SparseMatrix& A) {
  for (int j = 0; j < A.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator it(A, j); it; ++it) {
      if (!std::isfinite(it.value()))
        refuse(name, fmt::format("the {} matrix has {} at ({}, {})", which, it.value(), it.row() + 1, j + 1),
               "finite numbers", "check the export");
    }
  }
  const SparseMatrix transposed = A.transpose();
  const SparseMatrix difference = A - transposed;
  const double skew = largest(difference), scale = largest(A);
  if (skew > kSymmetricMatrix * scale)
    refuse(name, fmt::format("the {} matrix is not symmetric: {:.3g} of its largest element", which, skew / scale),
           fmt::format("at most {:.0e}", kSymmetricMatrix),
           "export it without follower loads, damping and gyroscopic terms");
}

// nodes in ascending id, and the new row of each old one
struct Ordered {
  std::vector<FeNode> nodes;
  std::vector<int> row;
};

Ordered in_order(std::vector<FeNode> nodes) {
  int rows = 0;
  for (FeNode& node : nodes) {
    node.first = rows;
    rows += node.freedoms;
  }
  Ordered out;
  out.nodes = std::move(nodes);
  std::sort(out.nodes.begin(), out.nodes.end(), [](const FeNode& a, const FeNode& b) { return a.id < b.id; });
  out.row.resize(static_cast<std::size_t>(rows));
  int at = 0;
  for (FeNode& node : out.nodes) {
    for (int a = 0; a < node.freedoms; ++a) out.row[static_cast<std::size_t>(node.first + a)] = at + a;
    node.first = at;
    at += node.freedoms;
  }
  return out;
}

// the symmetric part, without zeros
SparseMatrix reordered(const SparseMatrix& A, const Ordered& order) {
  const SparseMatrix transposed = A.transpose();
  const SparseMatrix mean = 0.5 * (A + transposed);
  std::vector<Eigen::Triplet<double>> entries;
  for (int j = 0; j < mean.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator it(mean, j); it; ++it) {
      if (it.value() == 0) continue;
      entries.emplace_back(order.row[static_cast<std::size_t>(it.row())], order.row[static_cast<std::size_t>(j)],
                           it.value());
    }
  }
  SparseMatrix out(A.rows(), A.cols());
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

// K R = 0: largest force over that of the stiffness without cancellation
void check_rigid_motions(const FeModel& model) {
  const Eigen::Matrix<double, Eigen::Dynamic, 6> R = rigid_motions(model, model.nodes.front().position);
  constexpr const char* kMotions[6] = {"along x", "along y", "along z", "about x", "about y", "about z"};
  for (int motion = 0; motion < 6; ++motion) {
    double worst = 0;
    int where = 0;
    std::vector<double> force(static_cast<std::size_t>(model.freedoms())), scale = force;
    for (int j = 0; j < model.freedoms(); ++j) {
      for (SparseMatrix::InnerIterator it(model.K, j); it; ++it) {
        force[static_cast<std::size_t>(it.row())] += it.value() * R(j, motion);
        scale[static_cast<std::size_t>(it.row())] += std::abs(it.value() * R(j, motion));
      }
    }
    for (std::size_t i = 0; i < force.size(); ++i) {
      const double share = scale[i] > 0 ? std::abs(force[i]) / scale[i] : 0;
      if (share > worst) {
        worst = share;
        where = static_cast<int>(i);
      }
    }
    // cancelling sums of few terms have the rounding of the largest row; compare with it too
    const double overall = *std::max_element(scale.begin(), scale.end());
    if (worst > kRigidForce && std::abs(force[static_cast<std::size_t>(where)]) > kRigidForce * kRigidForce * overall) {
      const auto node = std::find_if(model.nodes.begin(), model.nodes.end(),
                                     [&](const FeNode& n) { return where < n.first + n.freedoms; });
      refuse(model.name,
             fmt::format(
                 "moved {} as a rigid body the stiffness matrix resists: at node {} with {:.3g} of the forces that "
                 "should cancel",
                 kMotions[motion], node->id, worst),
             fmt::format("at most {:.0e} for each of six rigid motions", kRigidForce),
             motion < 3
                 ? "take supports out of the model before the export"
                 : "give positions in the unit of the matrices (m), and the nodes in the order of the rows; take "
                   "supports out");
    }
  }
}

// mass over the box around the nodes: the only check that detects scaled lengths or masses of solid elements
void check_density(const FeModel& model, double mass) {
  Vec3 low = model.nodes.front().position, high = low;
  for (const FeNode& node : model.nodes) {
    for (int a = 0; a < 3; ++a) {
      low.lanes[a] = std::min(low[a], node.position[a]);
      high.lanes[a] = std::max(high[a], node.position[a]);
    }
  }
  const Vec3 box = high - low;
  const double size = std::max({box[0], box[1], box[2]}), volume = box[0] * box[1] * box[2];
  if (std::min({box[0], box[1], box[2]}) < kFlat * size) return;
  if (mass < kLightest * volume || mass > kDensest * volume)
    refuse(
        model.name,
        fmt::format("{:.6g} kg in a box of {:.3g} x {:.3g} x {:.3g} m around the nodes", mass, box[0], box[1], box[2]),
        fmt::format("{} to {} kg/m3", kLightest, kDensest),
        "set `units:` of the matrices, or give lengths in m, masses in kg, stiffness in N/m");
}

void check_mass(const FeModel& model) {
  const Eigen::Matrix<double, Eigen::Dynamic, 6> R = rigid_motions(model);
  double mass[3];
  for (int a = 0; a < 3; ++a) {
    const Eigen::VectorXd r = R.col(a), Mr = model.M * r;
    mass[a] = r.dot(Mr);
  }
  const auto [low, high] = std::minmax_element(mass, mass + 3);
  if (!(*low > 0) || *high - *low > kOneMass * *high)
    refuse(model.name,
           fmt::format("the mass is {:.9g} kg in x, {:.9g} in y and {:.9g} in z", mass[0], mass[1], mass[2]),
           "one mass > 0 in all three", "check the order of the rows at each node: ux uy uz [rx ry rz]");
  const RigidMass rigid = rigid_mass(model);
  const Vec3 c = rigid.first * (1 / rigid.mass);
  const auto W = math::symmetric_eigenvalues(rigid.second * (1 / rigid.mass) - outer(c, c));
  const double size = extent(model), off = norm(c - model.nodes.front().position);
  if (off > size * (1 + kOneMass) || W[2] > size * size || W[0] < -1e-6 * W[2])
    refuse(model.name,
           fmt::format(
               "by the mass matrix the centre is {:.3g} m from the first node and the squared radii of gyration are "
               "{:.3g}, {:.3g}, {:.3g} m2",
               off, W[0], W[1], W[2]),
           fmt::format("them not negative and within the extent of the nodes, {:.3g} m", size),
           "give all lengths in m, also those in the rows of rotations, and the nodes in the order of the rows");
  check_density(model, rigid.mass);
}

// a negative mass in any motion; rows without mass are given some
void check_mass_definite(const FeModel& model) {
  SparseMatrix lifted = model.M;
  for (int i = 0; i < model.freedoms(); ++i) {
    const double own = model.M.coeff(i, i);
    lifted.coeffRef(i, i) += own > 0 ? kLift * own : 1;
  }
  const Pivots pivots = pivots_of(lifted);
  if (pivots.negative > 0)
    refuse(model.name, fmt::format("{} motions have negative mass", pivots.negative), "a semidefinite mass matrix",
           "check the signs of its elements off the diagonal");
}

// only six motions without stiffness, and none with negative stiffness or mass
void check_definite(const FeModel& model) {
  // between zero and the first elastic mode of most meshes: the stiffest motions are 1e7 to 1e10 above it
  const double shift = 1e-8 * model.K.diagonal().cwiseAbs().sum() / model.M.diagonal().cwiseAbs().sum();
  for (const auto& [which, A] :
       {std::pair<const char*, const SparseMatrix*>{"stiffness", &model.K}, {"mass", &model.M}}) {
    for (int i = 0; i < A->rows(); ++i) {
      const double d = A->coeff(i, i);
      if (d < 0)
        refuse(model.name, fmt::format("the {} matrix has {:.3g} on its diagonal", which, d), "none below 0",
               "check the export");
    }
  }
  check_mass_definite(model);
  const SparseMatrix shifted = model.K + shift * model.M;
  const Pivots pivots = pivots_of(shifted);
  if (pivots.negative > 0 || pivots.smallest < kIndefinite)
    refuse(model.name, fmt::format("{} motions have negative stiffness or mass", pivots.negative),
           "semidefinite matrices", "check the signs, and export without loads and geometric stiffness");
  // one below the seventh mode is rigid: count the modes below a small share of the first elastic one
  const Modes modes = lowest_modes(model.K, model.M, std::min(model.freedoms(), 8), shift);
  if (modes.lambda.size() < 7)
    refuse(model.name, fmt::format("{} modes have mass", modes.lambda.size()), "seven or more",
           "check the mass matrix");
  const double elastic = modes.lambda[6];
  if (!(elastic > 0) || std::abs(modes.lambda[5]) > 1e-5 * elastic || modes.lambda[0] < -1e-5 * elastic)
    refuse(model.name,
           fmt::format("the lowest w^2 are {:.3g}, {:.3g} (sixth), {:.3g} (seventh) 1/s2", modes.lambda[0],
                       modes.lambda[5], elastic),
           "six near zero and all others above",
           "look for supports, mechanisms, loose parts and rows without stiffness");
}

}  // namespace

FeModel model_of_matrices(const std::string& name, std::vector<FeNode> nodes, const SparseMatrix& M,
                          const SparseMatrix& K, ModelUnits units) {
  check_size(name, "mass", M, nodes);
  check_size(name, "stiffness", K, nodes);
  check_symmetry(name, "mass", M);
  check_symmetry(name, "stiffness", K);
  const Ordered order = in_order(std::move(nodes));
  FeModel model;
  model.name = name;
  model.made_of = fmt::format("matrices of {} nodes and {} freedoms", order.nodes.size(), M.rows());
  model.nodes = order.nodes;
  model.M = reordered(M, order);
  model.K = reordered(K, order);
  check_rigid_motions(model);
  to_si(units, model);
  check_mass(model);
  check_definite(model);
  judge_units(model, units);
  return model;
}

FeModel import_model(const ImportDef& def) {
  return model_of_matrices(def.name, read_nodes(def.nodes), read_matrix_market(def.mass),
                           read_matrix_market(def.stiffness), def.units);
}

void export_model(const FeModel& model, const ImportDef& files) {
  int of_nodes = 0;
  for (const FeNode& node : model.nodes) of_nodes += node.freedoms;
  if (of_nodes != model.freedoms()) {
    throw InputError(
        fmt::format("{}: {} freedoms are inside elements, and the files hold those of nodes alone; expected "
                    "a model without them; take mass_matrix: lumped",
                    model.name, model.freedoms() - of_nodes));
  }
  write_matrix_market(files.mass, model.M, model.name + ": mass, kg, kg m, kg m2");
  write_matrix_market(files.stiffness, model.K, model.name + ": stiffness, N/m, N, N m");
  std::string table = "# " + model.name + ": nodes in the order of the matrices' rows, m\nid x y z freedoms\n";
  for (const FeNode& node : model.nodes) {
    fmt::format_to(std::back_inserter(table), "{} {:.16e} {:.16e} {:.16e} {}\n", node.id, node.position.x(),
                   node.position.y(), node.position.z(), node.freedoms);
  }
  write_text(files.nodes, table);
}

}  // namespace slew::flex
