// SPDX-License-Identifier: Apache-2.0
#include "contact/mesh_file/mesh_import.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "contact/mesh_file/glb_file.h"

namespace slew::contact {
namespace {

constexpr std::array kEndings = {".stl", ".obj", ".dae", ".3ds", ".glb", ".fbx"};

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

Triple turned(const Triple& p, const MeshFileDef& def) {
  Triple out = {p[0] * def.unit, p[1] * def.unit, p[2] * def.unit};
  if (def.up_in_file == def.up) return out;
  // a quarter turn about x: y to z, or z to y
  if (def.up == UpAxis::z) return {out[0], -out[2], out[1]};
  return {out[0], out[2], -out[1]};
}

std::optional<InputFault> find_mesh_fault(const std::filesystem::path& path) {
  const std::string ending = ending_of(path);
  if (std::find(kEndings.begin(), kEndings.end(), ending) == kEndings.end()) {
    return InputFault{fmt::format("'{}' has an unknown ending", path.string()), ".stl, .obj, .dae, .3ds, .glb or .fbx"};
  }
  std::optional<InputFault> fault = find_input_fault(path, kMaxAssetBytes);
  if (!fault) return std::nullopt;
  return InputFault{fmt::format("'{}' {}", path.string(), fault->what),
                    fault->expected.empty() ? "a mesh file" : fault->expected};
}

ImportedMesh import_mesh(const MeshFileDef& def, unsigned steps, Assimp::Importer& importer) {
  const auto refuse = [](std::string what, std::string expected) {
    ImportedMesh refused;
    refused.what = std::move(what);
    refused.expected = std::move(expected);
    return refused;
  };
  if (auto fault = find_mesh_fault(def.path)) return refuse(std::move(fault->what), std::move(fault->expected));
  if (!(std::isfinite(def.unit) && def.unit > 0)) {
    return refuse(fmt::format("a unit of {} m is out of range", def.unit), "a number > 0 m");
  }
  const std::string name = def.path.string(), ending = ending_of(def.path);
  importer.SetIOHandler(new OneFile(name));  // owned by the importer
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  ImportedMesh imported;
  imported.scene = importer.ReadFile(name, aiProcess_Triangulate | steps);
  if (imported.scene == nullptr || imported.scene->mRootNode == nullptr) {
    return refuse(fmt::format("'{}' cannot be read: {}", name, importer.GetErrorString()), "a mesh file");
  }
  imported.undoing = undoing(ending, imported.scene->mRootNode->mTransformation);
  return imported;
}

}  // namespace slew::contact
