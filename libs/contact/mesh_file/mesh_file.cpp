// SPDX-License-Identifier: Apache-2.0
#include "contact/mesh_file/mesh_file.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/mesh.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <map>

#include "core/input_file.h"

namespace slew::contact {
namespace {

constexpr std::array kEndings = {".stl", ".obj", ".dae", ".3ds", ".glb", ".fbx"};

Triple turned(const Triple& p, const MeshFileDef& def) {
  Triple out = {p[0] * def.unit, p[1] * def.unit, p[2] * def.unit};
  if (def.up_in_file == def.up) return out;
  // a quarter turn about x: y to z, or z to y
  if (def.up == UpAxis::z) return {out[0], -out[2], out[1]};
  return {out[0], out[2], -out[1]};
}

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

std::string ending_of(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

// Undoes assimp's conversion of axes and unit; the caller states both. assimp turns .3ds from z up to y up, scales the
// root of .dae by the unit in the file, and turns the root of .fbx by its axes; these roots have no other
// transformation. No option prevents it.
aiMatrix4x4 undoing(const std::string& ending, const aiMatrix4x4& root) {
  if (ending == ".3ds") return {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1};
  aiMatrix4x4 undone;
  if (ending == ".dae" || ending == ".fbx") undone = aiMatrix4x4(root).Inverse();
  return undone;
}

// Opens this file alone and none that it refers to: a material library may be anywhere and no regular file.
class OneFile final : public Assimp::DefaultIOSystem {
 public:
  explicit OneFile(std::string name) : name_(std::move(name)) {}
  bool Exists(const char* file) const override { return file == name_ && DefaultIOSystem::Exists(file); }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    return file == name_ ? DefaultIOSystem::Open(file, mode) : nullptr;
  }

 private:
  std::string name_;
};

}  // namespace

MeshDef read_mesh(const std::string& owner, const MeshFileDef& def, Problems& problems) {
  const auto refuse = [&](std::string what, std::string expected) {
    problems.push_back({owner + ".mesh", std::move(what), std::move(expected), {}});
    return MeshDef{};
  };
  const std::string name = def.path.string();
  const std::string ending = ending_of(def.path);
  if (std::find(kEndings.begin(), kEndings.end(), ending) == kEndings.end()) {
    return refuse(fmt::format("'{}' has an unknown ending", name), ".stl, .obj, .dae, .3ds, .glb or .fbx");
  }
  if (!(std::isfinite(def.unit) && def.unit > 0)) {
    return refuse(fmt::format("a unit of {} m is out of range", def.unit), "a number > 0 m");
  }
  if (const auto fault = find_input_fault(def.path, kMaxAssetBytes)) {
    return refuse(fmt::format("'{}' {}", name, fault->what), fault->expected.empty() ? "a mesh file" : fault->expected);
  }
  Assimp::Importer importer;
  importer.SetIOHandler(new OneFile(name));  // owned by the importer
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(name, aiProcess_Triangulate);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    return refuse(fmt::format("'{}' cannot be read: {}", name, importer.GetErrorString()), "a mesh file");
  }
  Collector collector(def);
  collector.add(*scene, *scene->mRootNode, undoing(ending, scene->mRootNode->mTransformation));
  MeshDef mesh = collector.take();
  if (mesh.triangles.empty()) return refuse(fmt::format("'{}' holds no triangles", name), "a surface of triangles");
  return mesh;
}

}  // namespace slew::contact
