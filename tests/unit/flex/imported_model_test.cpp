// SPDX-License-Identifier: Apache-2.0
// Matrices from files: accepted files, and refused ones with their messages.
#include "flex/imported_model.h"

#include <gtest/gtest.h>

#include "flex/matrix_market.h"
#include "tests/support/flex_beams.h"
#include "tests/support/temporary_folder.h"

namespace slew::flex {
namespace imported_model_test {

using namespace testing;
using slew::testing::TemporaryFolder;

class MatrixMarket : public ::testing::Test {
 protected:
  std::string error(const std::string& text) {
    const auto file = folder_.write("m.mtx", text);
    std::string out = error_of([&] { (void)read_matrix_market(file); });
    const std::string path = folder_.path().string() + "/";
    if (const std::size_t at = out.find(path); at != std::string::npos) out.erase(at, path.size());
    return out;
  }
  TemporaryFolder folder_{"flex_mtx"};
};

TEST_F(MatrixMarket, SymmetricAndGeneralFilesAreRead) {
  const auto symmetric = folder_.write(
      "s.mtx", "%%MatrixMarket matrix coordinate real symmetric\n% remark\n\n2 2 2\n1 1 3\n2 1 -1e-1\r\n");
  const SparseMatrix A = read_matrix_market(symmetric);
  EXPECT_EQ(A.coeff(0, 1), -0.1);
  EXPECT_EQ(A.coeff(1, 0), -0.1);
  EXPECT_EQ(A.coeff(1, 1), 0);
  const auto general = folder_.write("g.mtx", "%%MatrixMarket MATRIX Coordinate integer general\n2 3 2\n1 3 +4\n2 1 5");
  const SparseMatrix B = read_matrix_market(general);
  EXPECT_EQ(B.cols(), 3);
  EXPECT_EQ(B.coeff(0, 2), 4);
  EXPECT_EQ(B.coeff(1, 0), 5);
}

TEST_F(MatrixMarket, WrittenMatrixComesBackToTheBit) {
  const FeModel model = at_nodes(build_beam(jib_boom(5)));
  write_matrix_market(folder_.path() / "k.mtx", model.K, "stiffness");
  const SparseMatrix back = read_matrix_market(folder_.path() / "k.mtx");
  EXPECT_EQ((back - model.K).norm(), 0);
}

TEST_F(MatrixMarket, FaultsAreNamedWithTheirLine) {
  const std::string head = "%%MatrixMarket matrix coordinate real symmetric\n";
  EXPECT_EQ(error(""),
            "m.mtx: the file is empty; expected '%%MatrixMarket matrix coordinate real symmetric' or '... general'");
  EXPECT_NE(error("1 2 3\n").find("m.mtx:1: the first line is '1 2 3'"), std::string::npos);
  EXPECT_NE(error("%%MatrixMarket matrix array real general\n2 2\n").find("expected '%%MatrixMarket matrix coordinate"),
            std::string::npos);
  EXPECT_NE(error("%%MatrixMarket matrix coordinate complex symmetric\n").find("m.mtx:1"), std::string::npos);
  EXPECT_EQ(error(head), "m.mtx: the line of sizes is missing; expected rows columns entries");
  EXPECT_EQ(error(head + "2 2\n"), "m.mtx:2: 2 numbers in the line of sizes; expected rows columns entries");
  EXPECT_EQ(error(head + "2 3 0\n"),
            "m.mtx:2: a symmetric matrix of 2 rows and 3 columns; expected as many columns as rows");
  EXPECT_EQ(error(head + "2 2 1\n1 3 1\n"), "m.mtx:3: the entry (1, 3) is outside; expected at most (2, 2)");
  EXPECT_EQ(error(head + "2 2 1\n1 2 1\n"),
            "m.mtx:3: the entry (1, 2) is above the diagonal; expected the lower triangle of a symmetric matrix");
  EXPECT_EQ(error(head + "2 2 1\n0 1 1\n"), "m.mtx:3: 0 is out of range; expected 1 or more");
  EXPECT_EQ(error(head + "2 2 1\n1 1 x\n"), "m.mtx:3: 'x' is no number; expected a number");
  EXPECT_EQ(error(head + "2 2 1\n1 1 inf\n"), "m.mtx:3: inf is not finite; expected a finite number");
  EXPECT_EQ(error(head + "2 2 1\n1 1\n"), "m.mtx:3: 2 words; expected row column value");
  EXPECT_EQ(error(head + "2 2 2\n1 1 1\n"),
            "m.mtx: the file ends after 1 entries; expected 2; it may have been cut; export it again");
  EXPECT_EQ(error(head + "2 2 1\n1 1 1\n2 2 1\n"), "m.mtx:4: there is more than the entries; expected 1 entries");
  EXPECT_EQ(error(head + "2 2 2\n1 1 1\n1 1 1\n"), "m.mtx: 1 entries are given twice; expected each once");
  EXPECT_NE(error_of([&] {
              (void)read_matrix_market(folder_.path() / "none.mtx");
            }).find("none.mtx: the file cannot be read"),
            std::string::npos);
}

class Import : public ::testing::Test {
 protected:
  Import() : model_(at_nodes(build_beam(straight(square(0.1), steel(), {1.5, 1, 0.5}, 6)))) {}

  std::string error(const SparseMatrix& M, const SparseMatrix& K, std::vector<FeNode> nodes) {
    return error_of([&] { (void)model_of_matrices("Body", std::move(nodes), M, K); });
  }
  FeModel model_;
};

TEST_F(Import, FilesGiveTheModelBack) {
  const TemporaryFolder folder("flex_import");
  const ImportDef files{"Body", folder.path() / "m.mtx", folder.path() / "k.mtx", folder.path() / "nodes.csv"};
  export_model(model_, files);
  const FeModel back = import_model(files);
  EXPECT_EQ((back.M - model_.M).norm(), 0);
  EXPECT_EQ((back.K - model_.K).norm(), 0);
  for (std::size_t i = 0; i < model_.nodes.size(); ++i)
    EXPECT_EQ(back.nodes[i].position.array(), model_.nodes[i].position.array());
}

TEST_F(Import, TableOfNodesIsChecked) {
  const TemporaryFolder folder("flex_nodes");
  const ImportDef files{"Body", folder.path() / "m.mtx", folder.path() / "k.mtx", folder.path() / "nodes.csv"};
  export_model(model_, files);
  const auto text = [&](const std::string& table) {
    (void)folder.write("nodes.csv", table);
    return error_of([&] { (void)import_model(files); });
  };
  EXPECT_NE(text("id,x,y,z,freedoms\n1,0,0,0\n").find("nodes.csv:2: 4 words; expected id x y z freedoms"),
            std::string::npos);
  EXPECT_NE(text("1 0 0 0 5\n").find("nodes.csv:1: a node of 5 freedoms; expected 3 (ux uy uz) or 6"),
            std::string::npos);
  EXPECT_NE(text("1 0 0 0 6\n1 1 0 0 6\n").find("nodes.csv:2: node 1 is given twice; expected each once"),
            std::string::npos);
  EXPECT_NE(text("1 0 zero 0 6\n").find("'zero' is no number"), std::string::npos);
  EXPECT_NE(text("# nothing\n").find("0 nodes; expected two or more"), std::string::npos);
  EXPECT_NE(text("1 0 0 0 6\n2 1 0 0 6\n")
                .find("the mass matrix has 36 rows; expected 12, the freedoms of the 2 nodes of the table together"),
            std::string::npos);
}

TEST_F(Import, WrongMatricesAreRefused) {
  SparseMatrix K = model_.K;
  K.coeffRef(1, 5) *= 1.001;
  EXPECT_NE(error(model_.M, K, model_.nodes).find("the stiffness matrix is not symmetric"), std::string::npos);
  K = model_.K;
  K.coeffRef(1, 1) = std::nan("");
  EXPECT_NE(error(model_.M, K, model_.nodes).find("the stiffness matrix has nan at (2, 2); expected finite numbers"),
            std::string::npos);
  // a support
  K = model_.K;
  K.coeffRef(2, 2) *= 2;
  EXPECT_NE(
      error(model_.M, K, model_.nodes).find("moved along z as a rigid body the stiffness matrix resists: at node 1"),
      std::string::npos);
  const SparseMatrix negative = -1 * model_.K;
  EXPECT_NE(error(model_.M, negative, model_.nodes).find("on its diagonal; expected none below 0"), std::string::npos);
  const SparseMatrix wide = model_.M.leftCols(30);
  EXPECT_NE(
      error(wide, model_.K, model_.nodes).find("the mass matrix has 36 rows and 30 columns; expected a square matrix"),
      std::string::npos);
}

TEST_F(Import, NodesInMillimetresOrInAnotherOrderAreRefused) {
  std::vector<FeNode> nodes = model_.nodes;
  for (FeNode& node : nodes) node.position = node.position * 1000;
  EXPECT_NE(error(model_.M, model_.K, nodes).find("give positions in the unit of the matrices (m)"), std::string::npos);
  nodes = model_.nodes;
  std::swap(nodes[1].position, nodes[3].position);
  EXPECT_NE(error(model_.M, model_.K, nodes).find("the nodes in the order of the rows"), std::string::npos);
}

TEST_F(Import, ScaledMassesAndLengthsOfOneDirectionAreRefused) {
  SparseMatrix M = model_.M;
  for (int j = 0; j < M.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator it(M, j); it; ++it) {
      if (it.row() % 6 == 1 && j % 6 == 1) it.valueRef() *= 1.01;
    }
  }
  EXPECT_NE(error(M, model_.K, model_.nodes).find("expected one mass > 0 in all three"), std::string::npos);
  const SparseMatrix tonnes = 1e-6 * model_.M;
  EXPECT_NE(error(tonnes, model_.K, model_.nodes).find("expected 0.01 to 25000 kg/m3"), std::string::npos);
}

TEST_F(Import, NegativeMassOfAMotionIsRefused) {
  SparseMatrix M = model_.M;
  // the same total, but the first two nodes swing against each other with less than nothing
  for (int a = 0; a < 3; ++a) {
    const double more = 2 * M.coeff(a, a);
    M.coeffRef(a, a) -= more;
    M.coeffRef(6 + a, 6 + a) -= more;
    M.coeffRef(a, 6 + a) += more;
    M.coeffRef(6 + a, a) += more;
  }
  EXPECT_NE(error(M, model_.K, model_.nodes).find("the mass matrix has -"), std::string::npos);
  M = model_.M;
  const double more = 2 * M.coeff(0, 0);
  for (int a = 0; a < 3; ++a) {
    M.coeffRef(a, 6 + a) += more;
    M.coeffRef(6 + a, a) += more;
    M.coeffRef(12 + a, 12 + a) += more;
  }
  EXPECT_NE(error(M, model_.K, model_.nodes).find("motions have negative mass; expected a semidefinite mass matrix"),
            std::string::npos);
}

TEST_F(Import, TwoLoosePiecesAreRefused) {
  const int n = model_.freedoms();
  std::vector<Eigen::Triplet<double>> mass, stiffness;
  std::vector<FeNode> nodes = model_.nodes;
  for (int copy = 0; copy < 2; ++copy) {
    for (int j = 0; j < n; ++j) {
      for (SparseMatrix::InnerIterator it(model_.M, j); it; ++it)
        mass.emplace_back(copy * n + it.row(), copy * n + j, it.value());
      for (SparseMatrix::InnerIterator it(model_.K, j); it; ++it)
        stiffness.emplace_back(copy * n + it.row(), copy * n + j, it.value());
    }
  }
  for (FeNode node : model_.nodes) {
    node.id += 10;
    nodes.push_back(node);
  }
  SparseMatrix M(2 * n, 2 * n), K(2 * n, 2 * n);
  M.setFromTriplets(mass.begin(), mass.end());
  K.setFromTriplets(stiffness.begin(), stiffness.end());
  EXPECT_NE(error(M, K, nodes).find("expected six near zero and all others above"), std::string::npos);
}

// ---- units ----------------------------------------------------------------------------------------------------------

// matrices of a cantilever of 3 m, 100 x 100 mm, from a code without units, with lengths, masses and times in these
// units
struct Exported {
  SparseMatrix M, K;
  std::vector<FeNode> nodes;
};
Exported exported(const FeModel& model, double length, double mass, double time) {
  Exported out{model.M, model.K, model.nodes};
  std::vector<double> d;
  for (FeNode& node : out.nodes) {
    node.position = node.position * (1 / length);
    for (int a = 0; a < node.freedoms; ++a) d.push_back(a < 3 ? 1 : 1 / length);
  }
  const auto scale = [&d](SparseMatrix& A, double factor) {
    for (int j = 0; j < A.outerSize(); ++j) {
      for (SparseMatrix::InnerIterator it(A, j); it; ++it) {
        it.valueRef() *= factor * d[static_cast<std::size_t>(it.row())] * d[static_cast<std::size_t>(j)];
      }
    }
  };
  scale(out.M, 1 / mass);
  scale(out.K, time * time / mass);
  return out;
}

struct NamedUnits {
  ModelUnits units;
  double length, mass, time;
};
const NamedUnits kOthers[] = {{ModelUnits::mm_t_s, 1e-3, 1e3, 1},
                              {ModelUnits::mm_kg_ms, 1e-3, 1, 1e-3},
                              {ModelUnits::mm_kg_s, 1e-3, 1, 1},
                              {ModelUnits::in_lbf_s, 0.0254, 175.126835, 1},
                              {ModelUnits::ft_lbf_s, 0.3048, 14.5939029, 1}};

class Units : public ::testing::Test {
 protected:
  Units() : line_(at_nodes(build_beam(straight(square(0.1), steel(), {3, 0, 0}, 13)))) {}
  FeModel line_;
};

TEST_F(Units, OfALineOfNodesAreFoundByItsWaveSpeedAndNamed) {
  for (const NamedUnits& other : kOthers) {
    const Exported out = exported(line_, other.length, other.mass, other.time);
    const std::string error = error_of([&] { (void)model_of_matrices("Boom", out.nodes, out.M, out.K); });
    const std::string name(kUnitNames[static_cast<std::size_t>(other.units)]);
    EXPECT_NE(error.find("Boom: in m_kg_s this is no solid: "), std::string::npos) << name << ": " << error;
    EXPECT_NE(error.find("units: " + name + " (235.5 kg, 3 m long, "), std::string::npos) << name << ": " << error;
  }
}

TEST_F(Units, ThatAreStatedGiveTheModelInSi) {
  for (const NamedUnits& other : kOthers) {
    const Exported out = exported(line_, other.length, other.mass, other.time);
    const FeModel back = model_of_matrices("Boom", out.nodes, out.M, out.K, other.units);
    EXPECT_NEAR(rigid_mass(back).mass, 235.5, 1e-5);
    EXPECT_NEAR(centre_of(rigid_mass(back))[0], 1.5, 1e-9);
    EXPECT_LE((back.K - line_.K).norm(), 1e-7 * line_.K.norm());
    EXPECT_LE((back.M - line_.M).norm(), 1e-7 * line_.M.norm());
  }
}

TEST_F(Units, ThatAreStatedWronglyAreRefused) {
  const std::string error =
      error_of([&] { (void)model_of_matrices("Boom", line_.nodes, line_.M, line_.K, ModelUnits::mm_t_s); });
  EXPECT_NE(error.find("in mm_t_s this is no solid"), std::string::npos) << error;
  EXPECT_NE(error.find("set units: m_kg_s (235.5 kg, 3 m long"), std::string::npos) << error;
}

// a mass in grams or milligrams leaves the wave speed of its own stiffness unit
TEST_F(Units, OfMassAloneAreFoundByTheDensityAlongTheLine) {
  const Exported out = exported(line_, 1, 1e-3, 1);
  const std::string error = error_of([&] { (void)model_of_matrices("Boom", out.nodes, out.M, out.K); });
  EXPECT_NE(error.find("kg/m3 along the line"), std::string::npos) << error;
}

TEST_F(Units, OfThinTubesAndOfOtherDirectionsAreTakenAsTheyAre) {
  const Triple ends[] = {{3, 0, 0}, {0, -40, 0}, {1, 1, 0.5}};
  for (const Triple& end : ends) {
    const FeModel beam = at_nodes(build_beam(straight(square(0.02), steel(), end, 6)));
    EXPECT_EQ(error_of([&] { (void)model_of_matrices("Boom", beam.nodes, beam.M, beam.K); }), "");
  }
}

}  // namespace imported_model_test
}  // namespace slew::flex
