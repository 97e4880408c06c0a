// SPDX-License-Identifier: Apache-2.0
// Mesh files become binary glTF (Khronos, glTF 2.0) in metres: read back here byte by byte.
#include "contact/mesh_file/glb_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <set>

#include "core/json.h"

namespace slew::contact {
namespace glb_file_test {

namespace fs = std::filesystem;

template <typename Value>
Value value_at(const std::string& bytes, std::size_t at) {
  Value value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// The two chunks of a file.
struct Glb {
  Json json;
  std::string buffer;

  explicit Glb(const std::string& bytes) {
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(value_at<std::uint32_t>(bytes, 4), 2u);
    EXPECT_EQ(value_at<std::uint32_t>(bytes, 8), bytes.size());
    const auto size = value_at<std::uint32_t>(bytes, 12);
    EXPECT_EQ(bytes.substr(16, 4), "JSON");
    EXPECT_EQ(size % 4, 0u);
    json = *Json::parse(std::string_view(bytes).substr(20, size));
    EXPECT_EQ(bytes.substr(20 + size + 4, 4), std::string("BIN\0", 4));
    buffer = bytes.substr(20 + size + 8);
    EXPECT_EQ(value_at<std::uint32_t>(bytes, 20 + size), buffer.size());
    EXPECT_EQ(json.at("buffers").items()[0].at("byteLength").integer(), static_cast<std::int64_t>(buffer.size()));
  }
  [[nodiscard]] const Json& primitive(std::size_t i) const {
    return json.at("meshes").items()[0].at("primitives").items().at(i);
  }
  [[nodiscard]] const Json& accessor(const Json& index) const {
    return json.at("accessors").items().at(static_cast<std::size_t>(index.integer()));
  }
  template <typename Value>
  [[nodiscard]] std::vector<Value> values(const Json& index) const {
    const Json& view =
        json.at("bufferViews").items().at(static_cast<std::size_t>(accessor(index).at("bufferView").integer()));
    const auto begin = static_cast<std::size_t>(view.at("byteOffset").integer());
    std::vector<Value> found(static_cast<std::size_t>(accessor(index).at("count").integer()));
    EXPECT_EQ(found.size() * sizeof(Value), static_cast<std::size_t>(view.at("byteLength").integer()));
    for (std::size_t i = 0; i < found.size(); ++i) found[i] = value_at<Value>(buffer, begin + i * sizeof(Value));
    return found;
  }
};

using Point = std::array<float, 3>;

// By the divergence theorem, positive for outward triangles.
double enclosed_volume(const std::vector<Point>& p, const std::vector<std::uint32_t>& indices) {
  double volume = 0;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const Point &a = p[indices[i]], &b = p[indices[i + 1]], &c = p[indices[i + 2]];
    volume += static_cast<double>(a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                                  a[2] * (b[0] * c[1] - b[1] * c[0]));
  }
  return volume / 6;
}

class GlbFile : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
  }
  fs::path folder_ = fs::temp_directory_path() / ("slewring_glb_file_" + std::to_string(::getpid()));
};

// a block of 1 x 2 x 3 from the origin on
constexpr const char* kBlock =
    "v 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 0\nv 0 0 3\nv 1 0 3\nv 1 2 3\nv 0 2 3\n"
    "f 1 4 3 2\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 7 8\n";

TEST_F(GlbFile, IsInMetresWithItsUpwardAxisAlongY) {
  Problems problems;
  const std::string bytes =
      read_as_glb("Block", {.path = write("block.obj", kBlock), .unit = 0.1, .up_in_file = UpAxis::z, .up = UpAxis::y},
                  Rgb{1, 0.5, 0}, problems);
  ASSERT_TRUE(problems.empty()) << problems[0].what;
  const Glb glb(bytes);
  const Json& primitive = glb.primitive(0);
  const auto positions = glb.values<Point>(primitive.at("attributes").at("POSITION"));
  const auto normals = glb.values<Point>(primitive.at("attributes").at("NORMAL"));
  const auto indices = glb.values<std::uint32_t>(primitive.at("indices"));
  // sharp edges: three normals at each of eight corners
  EXPECT_EQ(positions.size(), 24u);
  EXPECT_EQ(indices.size(), 36u);
  EXPECT_NEAR(enclosed_volume(positions, indices), 6e-3, 1e-8);
  // z of the file becomes y, y becomes -z
  const Json& bounds = glb.accessor(primitive.at("attributes").at("POSITION"));
  const double most[] = {0.1, 0.3, 0}, least[] = {0, 0, -0.2};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(bounds.at("max").items()[k].number(), most[k], 1e-7);
    EXPECT_NEAR(bounds.at("min").items()[k].number(), least[k], 1e-7);
  }
  std::set<Point> directions;
  for (const Point& n : normals) {
    EXPECT_NEAR(std::hypot(n[0], n[1], n[2]), 1, 1e-6);
    directions.insert({std::round(n[0]), std::round(n[1]), std::round(n[2])});
  }
  EXPECT_EQ(directions.size(), 6u);
  // IEC 61966-2-1: 0.5 is 0.2140 of the light
  const Json& color = glb.json.at("materials").items()[0].at("pbrMetallicRoughness").at("baseColorFactor");
  EXPECT_EQ(color.items()[0].number(), 1);
  EXPECT_NEAR(color.items()[1].number(), 0.2140, 1e-4);
  EXPECT_EQ(color.items()[2].number(), 0);
}

TEST_F(GlbFile, OfAGlbHasItsColoursAndTheSameBlock) {
  Problems problems;
  const MeshFileDef first = {.path = write("block.obj", kBlock), .up_in_file = UpAxis::y, .up = UpAxis::y};
  const std::string bytes = read_as_glb("Block", first, Rgb{1, 0.5, 0}, problems);
  const MeshFileDef second = {.path = write("again.glb", bytes), .up_in_file = UpAxis::y, .up = UpAxis::y};
  const Glb again(read_as_glb("Block", second, std::nullopt, problems));
  ASSERT_TRUE(problems.empty()) << problems[0].what;
  const auto positions = again.values<Point>(again.primitive(0).at("attributes").at("POSITION"));
  EXPECT_NEAR(enclosed_volume(positions, again.values<std::uint32_t>(again.primitive(0).at("indices"))), 6, 1e-5);
  const auto colour = [](const Glb& glb, std::size_t i) {
    return glb.json.at("materials").items()[0].at("pbrMetallicRoughness").at("baseColorFactor").items()[i].number();
  };
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(colour(again, i), colour(Glb(bytes), i), 1e-6);
}

TEST_F(GlbFile, RefusesOtherFilesWithTheReason) {
  const auto refusal = [](const MeshFileDef& def) {
    Problems problems;
    EXPECT_EQ(read_as_glb("View", def, std::nullopt, problems), "");
    EXPECT_EQ(problems.size(), 1u);
    if (problems.empty()) return std::string();
    EXPECT_EQ(problems[0].path, "View.file");
    return problems[0].what;
  };
  EXPECT_NE(refusal({.path = folder_ / "none.stl"}).find("none.stl"), std::string::npos);
  EXPECT_NE(refusal({.path = write("a.txt", "x")}).find("unknown ending"), std::string::npos);
  EXPECT_NE(refusal({.path = write("a.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n")}).find("no triangles"), std::string::npos);
  EXPECT_NE(refusal({.path = write("b.stl", "no mesh")}).find("b.stl"), std::string::npos);
}

}  // namespace glb_file_test
}  // namespace slew::contact
