// SPDX-License-Identifier: Apache-2.0
// The saddle-point matrix of body coordinates, block by block.
#include <array>

#include "core/index.h"
#include "multibody/formulations/body_block.h"
#include "multibody/formulations/body_passes.h"

namespace slew::multibody {

using math::Vec3;

namespace {

class Filling {
 public:
  Filling(const Model& model, const BodyModel& body, const Workspace& ws, BodyWorkspace& bws) noexcept
      : model_(model), body_(body), ws_(ws), bws_(bws) {}

  void fill() noexcept {
    bws_.ldl.clear();
    BodyMatrix matrix(body_, bws_.ldl);
    add_masses(model_, ws_, matrix);
    for (std::size_t link = 1; link < model_.links.size(); ++link) add_joint(static_cast<int>(link));
    for (std::size_t i = model_.links.size(); i < body_.joints.size(); ++i) add_cut(i);
    for (std::size_t k = 0; k < bws_.gears.size(); ++k) add_gear(k);
    add_modal_masses(
        model_, ws_, body_.modal, [this](int link) { return node_size(link); }, bws_.ldl);
    for (const ModalBlock& block : body_.modal) add_modal_rows(block);
  }

 private:
  [[nodiscard]] int rows(int link) const noexcept { return static_cast<int>(body_.joints[at(link)].rows.size()); }
  [[nodiscard]] int node_size(int link) const noexcept { return kBody + rows(link); }

  void add_joint(int link) noexcept {
    const Constraint& joint = body_.joints[at(link)];
    const int size = node_size(link), parent = joint.link1;
    ModalWide own{}, outer{};
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

  // the rows of nodes that ride on modes
  void add_modal_rows(const ModalBlock& block) noexcept {
    const FlexiblePart& part = model_.parts[block.part];
    for (int link = 1; link < body_.links; ++link) {
      const int node = body_.joints[at(link)].node;
      if (node < 0 || at(model_.nodes[at(node)].part) != block.part) continue;
      const std::size_t columns = at(node_size(link));
      ModalWide wide{};
      for (int row = 0; row < rows(link); ++row) {
        const double* m = bws_.modal.data() + bws_.first_modal[at(link)] + at(row) * part.modes + block.first;
        for (std::size_t k = 0; k < block.count; ++k) wide[k * columns + at(kBody + row)] = m[k];
      }
      bws_.ldl.add_coupling(block.node, link - 1, {wide.data(), block.count * columns});
    }
  }

  void add_cut(std::size_t index) noexcept {
    const Constraint& joint = body_.joints[index];
    const int rows = static_cast<int>(joint.rows.size());
    for (const int link : {joint.link1, joint.link2}) {
      if (link == 0) continue;
      const int columns = node_size(link);
      ModalWide block{};
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

  void add_gear(std::size_t index) noexcept {
    for_each_end(bws_.gears[index], [&](int link, Vec3 v, Vec3 w) {
      ModalWide block{};
      for (int c = 0; c < 3; ++c) {
        block[at(c)] = v[c];
        block[at(3 + c)] = w[c];
      }
      const int node = body_.first_gear + static_cast<int>(index);
      bws_.ldl.add_coupling(node, link - 1, {block.data(), at(node_size(link))});
    });
  }

  const Model& model_;
  const BodyModel& body_;
  const Workspace& ws_;
  BodyWorkspace& bws_;
};

}  // namespace

void BodyMatrix::add(int row_link, int column_link, const SpatialBlock& block) noexcept {
  const auto node_size = [this](int link) { return kBody + static_cast<int>(body_.joints[at(link)].rows.size()); };
  const int columns = node_size(column_link);
  ModalWide wide{};
  for (int r = 0; r < kBody; ++r) {
    for (int c = 0; c < kBody; ++c) wide[at(r * columns + c)] = block[at(r * kBody + c)];
  }
  const std::span<const double> used(wide.data(), at(node_size(row_link) * columns));
  if (row_link == column_link) {
    ldl_.add_diagonal(row_link - 1, used);
  } else {
    ldl_.add_coupling(row_link - 1, column_link - 1, used);
  }
}

void fill_matrix(const Model& model, const BodyModel& body, const Workspace& ws, BodyWorkspace& bws) noexcept {
  Filling(model, body, ws, bws).fill();
}

}  // namespace slew::multibody
