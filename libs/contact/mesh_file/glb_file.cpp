// SPDX-License-Identifier: Apache-2.0
#include "contact/mesh_file/glb_file.h"

#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/postprocess.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>
#include <vector>

#include "contact/mesh_file/mesh_import.h"
#include "core/json.h"

namespace slew::contact {
namespace {

constexpr float kSharpEdge = 35;  // deg, between the normals of neighbours
constexpr Rgb kGrey = {0.6, 0.6, 0.6};
constexpr double kRoughness = 0.7;
// values of glTF 2.0
constexpr unsigned kFloat = 5126, kUnsignedInt = 5125, kVertexBuffer = 34962, kIndexBuffer = 34963, kTriangles = 4;
constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

// The triangles of one material.
struct Primitive {
  std::vector<std::array<float, 3>> positions, normals;
  std::vector<std::uint32_t> indices;
};

std::array<float, 3> to_floats(const Triple& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

class VisualCollector {
 public:
  VisualCollector(const MeshFileDef& def, unsigned materials) : def_(def), primitives_(materials) {}

  void add(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above) {
    const aiMatrix4x4 here = above * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) add(*scene.mMeshes[node.mMeshes[i]], here);
    for (unsigned i = 0; i < node.mNumChildren; ++i) add(scene, *node.mChildren[i], here);
  }
  [[nodiscard]] const std::vector<Primitive>& primitives() const noexcept { return primitives_; }
  [[nodiscard]] bool is_finite() const noexcept { return is_finite_; }

 private:
  void add(const aiMesh& part, const aiMatrix4x4& placement) {
    if (!part.HasNormals() || part.mMaterialIndex >= primitives_.size()) return;  // points and lines
    Primitive& primitive = primitives_[part.mMaterialIndex];
    const auto first = static_cast<std::uint32_t>(primitive.positions.size());
    // normals keep their angle to a surface that is stretched: inverse transpose
    const aiMatrix3x3 of_normals = aiMatrix3x3(placement).Inverse().Transpose();
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      const aiVector3D v = placement * part.mVertices[i];
      const Triple p = turned({v.x, v.y, v.z}, def_);
      is_finite_ = is_finite_ && std::isfinite(p[0] + p[1] + p[2]);
      primitive.positions.push_back(to_floats(p));
      const aiVector3D n = of_normals * part.mNormals[i];
      Triple normal = turned({n.x, n.y, n.z}, def_);
      const double size = std::hypot(normal[0], normal[1], normal[2]);
      // a triangle without area has no normal
      normal = size > 0 && std::isfinite(size) ? Triple{normal[0] / size, normal[1] / size, normal[2] / size}
                                               : Triple{0, 1, 0};
      primitive.normals.push_back(to_floats(normal));
    }
    const bool is_mirrored = placement.Determinant() < 0;
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices != 3) continue;
      const std::array<unsigned, 3> corners = {face.mIndices[is_mirrored ? 1 : 0], face.mIndices[is_mirrored ? 0 : 1],
                                               face.mIndices[2]};
      for (const unsigned corner : corners) primitive.indices.push_back(first + corner);
    }
  }

  const MeshFileDef& def_;
  std::vector<Primitive> primitives_;  // by material
  bool is_finite_ = true;
};

// IEC 61966-2-1
Rgb linear_of(const Rgb& color) {
  Rgb linear = color;
  for (double& c : linear) c = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  return linear;
}

Rgb color_of(const aiMaterial& material) {
  aiColor4D color;
  if (material.Get(AI_MATKEY_BASE_COLOR, color) != aiReturn_SUCCESS &&
      material.Get(AI_MATKEY_COLOR_DIFFUSE, color) != aiReturn_SUCCESS)
    return kGrey;
  const auto bounded = [](float c) { return std::isfinite(c) ? std::clamp(static_cast<double>(c), 0.0, 1.0) : 0.0; };
  return {bounded(color.r), bounded(color.g), bounded(color.b)};
}

template <typename Value>
void put(std::string& bytes, const Value& value) {
  static_assert(std::is_trivially_copyable_v<Value>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);  // little-endian, as the machine is
}

// Buffer and its description.
class GlbWriter {
 public:
  // color: linear, as glTF has it.
  void add(const Primitive& primitive, const Rgb& color) {
    const std::size_t positions = accessor(primitive.positions, "VEC3", kFloat, kVertexBuffer, Bounds::stated);
    const std::size_t normals = accessor(primitive.normals, "VEC3", kFloat, kVertexBuffer);
    const std::size_t indices = accessor(primitive.indices, "SCALAR", kUnsignedInt, kIndexBuffer);
    primitives_.push_back({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}},
                           {"indices", indices},
                           {"material", materials_.items().size()},
                           {"mode", kTriangles}});
    const Json factor = Json::array({color[0], color[1], color[2], 1.0});
    materials_.push_back({{"pbrMetallicRoughness",
                           {{"baseColorFactor", factor}, {"metallicFactor", 0.0}, {"roughnessFactor", kRoughness}}},
                          {"doubleSided", true}});
  }

  [[nodiscard]] std::string file() const {
    std::string json = Json({{"asset", {{"version", "2.0"}, {"generator", "slewring"}}},
                             {"scene", 0},
                             {"scenes", Json::array({Json({{"nodes", Json::array({0})}})})},
                             {"nodes", Json::array({Json({{"mesh", 0}})})},
                             {"meshes", Json::array({Json({{"primitives", primitives_}})})},
                             {"materials", materials_},
                             {"accessors", accessors_},
                             {"bufferViews", views_},
                             {"buffers", Json::array({Json({{"byteLength", buffer_.size()}})})}})
                           .dump();
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string bytes;
    put(bytes, kMagic);
    put(bytes, kVersion);
    put(bytes, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + buffer_.size()));
    put(bytes, static_cast<std::uint32_t>(json.size()));
    put(bytes, kJsonChunk);
    bytes += json;
    put(bytes, static_cast<std::uint32_t>(buffer_.size()));
    put(bytes, kBinaryChunk);
    return bytes + buffer_;
  }
  [[nodiscard]] std::size_t bytes() const noexcept { return buffer_.size(); }

 private:
  enum class Bounds : bool { left_out, stated };  // those of positions are required

  // Every value has 4 bytes, so that the parts are aligned.
  template <typename Value>
  std::size_t accessor(const std::vector<Value>& values, const char* type, unsigned component, unsigned target,
                       Bounds bounds = Bounds::left_out) {
    views_.push_back({{"buffer", 0},
                      {"byteOffset", buffer_.size()},
                      {"byteLength", values.size() * sizeof(Value)},
                      {"target", target}});
    for (const Value& value : values) put(buffer_, value);
    Json accessor = {{"bufferView", views_.items().size() - 1},
                     {"componentType", component},
                     {"count", values.size()},
                     {"type", type}};
    if constexpr (std::is_same_v<Value, std::array<float, 3>>) {
      if (bounds == Bounds::stated) put_bounds(values, accessor);
    }
    accessors_.push_back(std::move(accessor));
    return accessors_.items().size() - 1;
  }

  static void put_bounds(const std::vector<std::array<float, 3>>& points, Json& accessor) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto by_axis = [k](const auto& a, const auto& b) { return a[k] < b[k]; };
      const auto [least, most] = std::minmax_element(points.begin(), points.end(), by_axis);
      accessor["min"].push_back(static_cast<double>((*least)[k]));
      accessor["max"].push_back(static_cast<double>((*most)[k]));
    }
  }

  std::string buffer_;
  Json views_ = Json::array(), accessors_ = Json::array(), materials_ = Json::array(), primitives_ = Json::array();
};

}  // namespace

std::string read_as_glb(const std::string& owner, const MeshFileDef& def, const std::optional<Rgb>& color,
                        Problems& problems) {
  const auto refuse = [&](std::string what, std::string expected) {
    problems.push_back({owner + ".file", std::move(what), std::move(expected), {}});
    return std::string();
  };
  Assimp::Importer importer;
  importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, kSharpEdge);
  unsigned steps = aiProcess_GenSmoothNormals | aiProcess_JoinIdenticalVertices | aiProcess_SortByPType;
  std::string ending = def.path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  const bool is_glb = ending == ".glb";
  if (ending == ".stl") steps |= aiProcess_ForceGenNormals;
  ImportedMesh imported = import_mesh(def, steps, importer);
  if (imported.scene == nullptr) return refuse(std::move(imported.what), std::move(imported.expected));
  const aiScene& scene = *imported.scene;
  VisualCollector collector(def, std::max(1U, scene.mNumMaterials));
  collector.add(scene, *scene.mRootNode, imported.undoing);
  const std::string name = def.path.string();
  if (!collector.is_finite()) return refuse(fmt::format("'{}' has a point that is not finite", name), "finite points");
  GlbWriter writer;
  for (std::size_t i = 0; i < collector.primitives().size(); ++i) {
    if (collector.primitives()[i].indices.empty()) continue;
    Rgb of_file = i < scene.mNumMaterials ? color_of(*scene.mMaterials[i]) : kGrey;
    // that of a .glb is linear already
    if (!is_glb) of_file = linear_of(of_file);
    writer.add(collector.primitives()[i], color ? linear_of(*color) : of_file);
  }
  if (writer.bytes() == 0) return refuse(fmt::format("'{}' holds no triangles", name), "a surface of triangles");
  if (writer.bytes() > kMaxGlbBytes) {
    return refuse(fmt::format("'{}' has {} bytes as binary glTF", name, writer.bytes()),
                  fmt::format("at most {}: a mesh of fewer triangles", kMaxGlbBytes));
  }
  return writer.file();
}

}  // namespace slew::contact
