// The saddle-point matrix of body coordinates, block by block.
#include <array>

#include "multibody/body_block.h"

namespace slew::multibody {

using math::Vec3;

namespace {

std::size_t at(int index) noexcept {
  return static_cast<std::size_t>(index);
}

class Filling {
 public:
  Filling(const Model& model, const BodyModel& body, const Workspace& ws, BodyWorkspace& bws) noexcept
      : model_(model), body_(body), ws_(ws), bws_(bws) {}

  void fill() noexcept {
    bws_.ldl.clear();
    for (std::size_t link = 1; link < model_.links.size(); ++link) {
      add_mass(static_cast<int>(link));
      add_joint(static_cast<int>(link));
    }
    for (std::size_t i = 0; i < model_.coupled.size(); ++i) add_coupled(model_.coupled[i], ws_.coupled[i]);
    for (std::size_t i = model_.links.size(); i < body_.joints.size(); ++i) add_cut(i);
  }

 private:
  [[nodiscard]] int rows(int link) const noexcept { return static_cast<int>(body_.joints[at(link)].rows.size()); }
  [[nodiscard]] int node_size(int link) const noexcept { return kBody + rows(link); }

  void add_mass(int link) noexcept { add_block(body_, bws_.ldl, link, link, inertia_block(ws_.inertia[at(link)])); }

  void add_joint(int link) noexcept {
    const Constraint& joint = body_.joints[at(link)];
    const int size = node_size(link), parent = joint.link1;
    std::array<double, static_cast<std::size_t>(math::kMaxBlock) * math::kMaxBlock> own{}, outer{};
    const int columns = parent > 0 ? node_size(parent) : 0;
    for (int k = 0; k < rows(link); ++k) {
      const RowGradient& G = bws_.rows[at(bws_.first_row[at(link)] + k)].G;
      for (int c = 0; c < 3; ++c) {
        const int row = kBody + k;
        own[at(row * size + c)] = own[at(c * size + row)] = G.v2[c];
        own[at(row * size + 3 + c)] = own[at((3 + c) * size + row)] = G.w2[c];
        if (parent == 0) continue;
        outer[at(row * columns + c)] = G.v1[c];
        outer[at(row * columns + 3 + c)] = G.w1[c];
      }
    }
    bws_.ldl.add_diagonal(link - 1, {own.data(), at(size * size)});
    if (parent > 0 && rows(link) > 0) bws_.ldl.add_coupling(link - 1, parent - 1, {outer.data(), at(size * columns)});
  }

  void add_cut(std::size_t index) noexcept {
    const Constraint& joint = body_.joints[index];
    const int rows = static_cast<int>(joint.rows.size());
    for (const int link : {joint.link1, joint.link2}) {
      if (link == 0) continue;
      const int columns = node_size(link);
      std::array<double, static_cast<std::size_t>(math::kMaxBlock) * math::kMaxBlock> block{};
      for (int k = 0; k < rows; ++k) {
        const RowGradient& G = bws_.rows[at(bws_.first_row[index] + k)].G;
        const Vec3 v = link == joint.link1 ? G.v1 : G.v2, w = link == joint.link1 ? G.w1 : G.w2;
        for (int c = 0; c < 3; ++c) {
          block[at(k * columns + c)] = v[c];
          block[at(k * columns + 3 + c)] = w[c];
        }
      }
      bws_.ldl.add_coupling(static_cast<int>(index) - 1, link - 1, {block.data(), at(rows * columns)});
    }
  }

  void add_coupled(const CoupledMass& mass, const CoupledMotion& m) noexcept {
    const LineElement& line = model_.lines[at(mass.line)];
    const LineMotion& motion = ws_.lines[at(mass.line)];
    const PointMasses between = point_masses(mass, m);
    add_pair(body_, bws_.ldl,
             {{line.link1, line.link2},
              {motion.P1 - ws_.motion[at(line.link1)].p, motion.P2 - ws_.motion[at(line.link2)].p},
              {{{between.A11, between.A12}, {between.A12, between.A22}}}});
  }

  const Model& model_;
  const BodyModel& body_;
  const Workspace& ws_;
  BodyWorkspace& bws_;
};

}  // namespace

void add_block(const BodyModel& body, math::BlockLdl& ldl, int row_link, int column_link,
               const SpatialBlock& block) noexcept {
  const auto node_size = [&body](int link) { return kBody + static_cast<int>(body.joints[at(link)].rows.size()); };
  const int columns = node_size(column_link);
  std::array<double, static_cast<std::size_t>(math::kMaxBlock) * math::kMaxBlock> wide{};
  for (int r = 0; r < kBody; ++r) {
    for (int c = 0; c < kBody; ++c) wide[at(r * columns + c)] = block[at(r * kBody + c)];
  }
  const std::span<const double> used(wide.data(), at(node_size(row_link) * columns));
  if (row_link == column_link) {
    ldl.add_diagonal(row_link - 1, used);
  } else {
    ldl.add_coupling(row_link - 1, column_link - 1, used);
  }
}

void add_pair(const BodyModel& body, math::BlockLdl& ldl, const PointPair& pair) noexcept {
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < 2; ++j) {
      // of the two couplings one is the other's transposed
      const int row = pair.links[i], column = pair.links[j];
      if (row == 0 || column == 0 || (i != j && row < column)) continue;
      add_block(body, ldl, row, column, point_mass_block(pair.A[i][j], pair.s[i], pair.s[j]));
    }
  }
}

void fill_matrix(const Model& model, const BodyModel& body, const Workspace& ws, BodyWorkspace& bws) noexcept {
  Filling(model, body, ws, bws).fill();
}

}  // namespace slew::multibody
