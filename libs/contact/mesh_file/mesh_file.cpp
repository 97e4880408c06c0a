// SPDX-License-Identifier: Apache-2.0
#include "contact/mesh_file/mesh_file.h"

#include <assimp/mesh.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>

#include "contact/mesh_file/mesh_import.h"

namespace slew::contact {
namespace {

class Collector {
 public:
  explicit Collector(const MeshFileDef& def) : def_(def) {}

  void add(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above) {
    const aiMatrix4x4 here = above * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) add(*scene.mMeshes[node.mMeshes[i]], here);
    for (unsigned i = 0; i < node.mNumChildren; ++i) add(scene, *node.mChildren[i], here);
  }
  [[nodiscard]] MeshDef take() { return std::move(mesh_); }

 private:
  void add(const aiMesh& part, const aiMatrix4x4& placement) {
    // a mirrored part turns the other way
    const bool is_mirrored = placement.Determinant() < 0;
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices != 3) continue;  // points and lines
      std::array<std::uint32_t, 3> triangle{};
      for (std::size_t k = 0; k < 3; ++k) triangle[k] = vertex(placement * part.mVertices[face.mIndices[k]]);
      if (is_mirrored) std::swap(triangle[0], triangle[1]);
      mesh_.triangles.push_back(triangle);
    }
  }

  std::uint32_t vertex(const aiVector3D& v) {
    const Triple p = turned({static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)}, def_);
    // a NaN would break the order of the map; it is kept for mesh_check.h to name
    if (!std::isfinite(p[0] + p[1] + p[2])) return append(p);
    const auto [at, is_new] = index_.insert({p, static_cast<std::uint32_t>(mesh_.vertices.size())});
    return is_new ? append(p) : at->second;
  }

  std::uint32_t append(const Triple& p) {
    mesh_.vertices.push_back(p);
    return static_cast<std::uint32_t>(mesh_.vertices.size() - 1);
  }

  const MeshFileDef& def_;
  MeshDef mesh_;
  std::map<Triple, std::uint32_t> index_;
};

}  // namespace

MeshDef read_mesh(const std::string& owner, const MeshFileDef& def, Problems& problems) {
  const auto refuse = [&](std::string what, std::string expected) {
    problems.push_back({owner + ".mesh", std::move(what), std::move(expected), {}});
    return MeshDef{};
  };
  Assimp::Importer importer;
  ImportedMesh imported = import_mesh(def, 0, importer);
  if (imported.scene == nullptr) return refuse(std::move(imported.what), std::move(imported.expected));
  Collector collector(def);
  collector.add(*imported.scene, *imported.scene->mRootNode, imported.undoing);
  MeshDef mesh = collector.take();
  if (mesh.triangles.empty()) {
    return refuse(fmt::format("'{}' holds no triangles", def.path.string()), "a surface of triangles");
  }
  return mesh;
}

}  // namespace slew::contact
