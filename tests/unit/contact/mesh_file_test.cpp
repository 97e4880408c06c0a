// SPDX-License-Identifier: Apache-2.0
// One block in four file formats becomes the same solid; other files are refused with the reason.
#include "contact/mesh_file/mesh_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <string>

#include "contact/mass_properties.h"
#include "contact/mesh_check.h"
#include "support/contact_shapes.h"

namespace slew::contact {
namespace mesh_file_test {

namespace fs = std::filesystem;

using math::Vec3;
using namespace testing;

// 1 x 2 x 3 from the origin on, so that every axis and sign shows
MeshDef block() {
  MeshDef mesh = box_mesh(1, 2, 3).mesh;
  for (Triple& v : mesh.vertices) v = {v[0] + 0.5, v[1] + 1, v[2] + 1.5};
  return mesh;
}

class MeshFile : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
  }
  static MeshDef read(const MeshFileDef& def) {
    Problems problems;
    MeshDef mesh = read_mesh("Bag", def, problems);
    EXPECT_TRUE(problems.empty()) << problems[0].what;
    return mesh;
  }
  static std::string refusal(const MeshFileDef& def) {
    Problems problems;
    const MeshDef mesh = read_mesh("Bag", def, problems);
    EXPECT_TRUE(mesh.triangles.empty());
    EXPECT_EQ(problems.size(), 1u);
    if (problems.empty()) return "";
    EXPECT_EQ(problems[0].path, "Bag.mesh");
    return problems[0].what;
  }
  // the block with its unit, before it was turned
  static void expect_block(const MeshDef& mesh, double unit, Vec3 centre) {
    ASSERT_FALSE(find_convex_fault(mesh).has_value()) << find_convex_fault(mesh)->what;
    EXPECT_EQ(mesh.vertices.size(), 8u);
    EXPECT_EQ(mesh.triangles.size(), 12u);
    const MassProperties p = mass_properties(mesh, 1000);
    EXPECT_NEAR(p.volume, 6 * unit * unit * unit, 1e-6 * 6 * unit * unit * unit);  // single precision inside assimp
    EXPECT_LT(norm(p.centre - centre * unit), 1e-6 * unit);
  }
  fs::path folder_ = fs::temp_directory_path() / ("slewring_mesh_file_" + std::to_string(::getpid()));
};

std::string stl_text(const MeshDef& mesh) {
  std::string out = "solid block\n";
  for (const auto& t : mesh.triangles) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (const auto v : t) {
      const Triple& p = mesh.vertices[v];
      out += "vertex " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + "\n";
    }
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid block\n";
}

std::string obj_text(const MeshDef& mesh) {
  std::string out;
  for (const Triple& p : mesh.vertices) {
    out += "v " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + "\n";
  }
  for (const auto& t : mesh.triangles) {
    out += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " + std::to_string(t[2] + 1) + "\n";
  }
  return out;
}

std::string dae_text(const MeshDef& mesh) {
  std::string positions, indices;
  for (const Triple& p : mesh.vertices) {
    for (const double x : p) positions += std::to_string(x) + " ";
  }
  for (const auto& t : mesh.triangles) {
    for (const auto v : t) indices += std::to_string(v) + " ";
  }
  return R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g" name="g"><mesh>
<source id="p"><float_array id="a" count="24">)" +
         positions + R"(</float_array><technique_common><accessor source="#a" count="8" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/><p>)" +
         indices + R"(</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

template <typename T>
std::string bytes(T value) {
  std::string out(sizeof value, '\0');
  std::memcpy(out.data(), &value, sizeof value);
  return out;
}

std::string chunk(std::uint16_t id, const std::string& content) {
  return bytes(id) + bytes(static_cast<std::uint32_t>(content.size() + 6)) + content;
}

std::string studio_bytes(const MeshDef& mesh) {
  std::string points = bytes(static_cast<std::uint16_t>(mesh.vertices.size()));
  for (const Triple& p : mesh.vertices) {
    for (const double x : p) points += bytes(static_cast<float>(x));
  }
  std::string faces = bytes(static_cast<std::uint16_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    for (const auto v : t) faces += bytes(static_cast<std::uint16_t>(v));
    faces += bytes(std::uint16_t{0});
  }
  const std::string object = std::string("block") + '\0' + chunk(0x4100, chunk(0x4110, points) + chunk(0x4120, faces));
  return chunk(0x4D4D, chunk(0x3D3D, chunk(0x4000, object)));
}

// binary glTF 2.0: a chunk of JSON, a chunk of positions and indices
std::string glb_bytes(const MeshDef& mesh) {
  std::string data;
  for (const Triple& p : mesh.vertices) {
    for (const double x : p) data += bytes(static_cast<float>(x));
  }
  const std::size_t positions = data.size();
  for (const auto& t : mesh.triangles) {
    for (const auto v : t) data += bytes(v);
  }
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"buffers":[{"byteLength":)" +
      std::to_string(data.size()) + R"(}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":)" +
      std::to_string(positions) + R"(},{"buffer":0,"byteOffset":)" + std::to_string(positions) + R"(,"byteLength":)" +
      std::to_string(data.size() - positions) + R"(}],"accessors":[{"bufferView":0,"componentType":5126,"count":)" +
      std::to_string(mesh.vertices.size()) +
      R"(,"type":"VEC3","min":[0,0,0],"max":[1,2,3]},{"bufferView":1,"componentType":5125,"count":)" +
      std::to_string(3 * mesh.triangles.size()) + R"(,"type":"SCALAR"}]})";
  while (json.size() % 4 != 0) json += ' ';
  const auto part = [](std::uint32_t kind, const std::string& content) {
    return bytes(static_cast<std::uint32_t>(content.size())) + bytes(kind) + content;
  };
  const std::string chunks = part(0x4E4F534A, json) + part(0x004E4942, data);
  return bytes(std::uint32_t{0x46546C67}) + bytes(std::uint32_t{2}) +
         bytes(static_cast<std::uint32_t>(chunks.size() + 12)) + chunks;
}

// ASCII FBX 7.4 with z up and centimetres, which must have no effect
std::string fbx_text(const MeshDef& mesh) {
  std::string positions, indices;
  for (const Triple& p : mesh.vertices) {
    for (const double x : p) positions += (positions.empty() ? "" : ",") + std::to_string(x);
  }
  for (const auto& t : mesh.triangles) {
    // the last corner of a polygon is its complement
    indices += (indices.empty() ? "" : ",") + std::to_string(t[0]) + "," + std::to_string(t[1]) + "," +
               std::to_string(-1 - static_cast<int>(t[2]));
  }
  return R"(; FBX 7.4.0 project file
FBXHeaderExtension:  {
	FBXHeaderVersion: 1003
	FBXVersion: 7400
}
GlobalSettings:  {
	Version: 1000
	Properties70:  {
		P: "UpAxis", "int", "Integer", "",2
		P: "UpAxisSign", "int", "Integer", "",1
		P: "FrontAxis", "int", "Integer", "",1
		P: "FrontAxisSign", "int", "Integer", "",-1
		P: "CoordAxis", "int", "Integer", "",0
		P: "CoordAxisSign", "int", "Integer", "",1
		P: "UnitScaleFactor", "double", "Number", "",100
	}
}
Objects:  {
	Geometry: 1000, "Geometry::block", "Mesh" {
		Vertices: *)" +
         std::to_string(3 * mesh.vertices.size()) + " {\n\t\t\ta: " + positions + "\n\t\t}\n\t\tPolygonVertexIndex: *" +
         std::to_string(3 * mesh.triangles.size()) + " {\n\t\t\ta: " + indices + R"(
		}
		GeometryVersion: 124
	}
	Model: 2000, "Model::block", "Mesh" {
		Version: 232
	}
}
Connections:  {
	C: "OO",1000,2000
	C: "OO",2000,0
}
)";
}

TEST_F(MeshFile, OfEveryFormatHoldsTheSameBlock) {
  const fs::path files[] = {write("block.stl", stl_text(block())),  write("block.OBJ", obj_text(block())),
                            write("block.dae", dae_text(block())),  write("block.3ds", studio_bytes(block())),
                            write("block.glb", glb_bytes(block())), write("block.fbx", fbx_text(block()))};
  for (const fs::path& file : files) {
    SCOPED_TRACE(file);
    expect_block(read({.path = file}), 1, {0.5, 1, 1.5});
    expect_block(read({.path = file, .unit = 0.001}), 0.001, {0.5, 1, 1.5});
    // y up in the file: its y becomes z, its z becomes -y
    expect_block(read({.path = file, .up_in_file = UpAxis::y, .up = UpAxis::z}), 1, {0.5, -1.5, 1});
    expect_block(read({.path = file, .up_in_file = UpAxis::z, .up = UpAxis::y}), 1, {0.5, 1.5, -1});
  }
}

TEST_F(MeshFile, ThatIsNoMeshIsRefused) {
  EXPECT_NE(refusal({.path = folder_ / "none.stl"}).find("cannot be read"), std::string::npos);
  EXPECT_NE(refusal({.path = write("block.ply", "ply")}).find("unknown ending"), std::string::npos);
  EXPECT_NE(refusal({.path = write("text.dae", "hello")}).find("cannot be read"), std::string::npos);
  EXPECT_FALSE(refusal({.path = write("points.obj", "v 0 0 0\nv 1 0 0\n")}).empty());
  const fs::path file = write("block.stl", stl_text(block()));
  for (const double unit : {0.0, -1.0, std::nan("")}) {
    EXPECT_NE(refusal({.path = file, .unit = unit}).find("unit"), std::string::npos);
  }
}

// a FIFO waits for its writer for ever
TEST_F(MeshFile, IsReadWithoutTheFilesThatItNames) {
  ASSERT_EQ(::mkfifo((folder_ / "fifo.mtl").c_str(), 0600), 0);
  const std::string text = "mtllib fifo.mtl\nusemtl paint\n" + obj_text(block());
  expect_block(read({.path = write("block.obj", text)}), 1, {0.5, 1, 1.5});
  ASSERT_EQ(::mkfifo((folder_ / "pipe.stl").c_str(), 0600), 0);
  EXPECT_NE(refusal({.path = folder_ / "pipe.stl"}).find("is not a regular file"), std::string::npos);
}

TEST_F(MeshFile, ThatIsOpenOrInsideOutIsNamedByTheChecks) {
  MeshDef open = block();
  open.triangles.pop_back();
  const auto fault = find_closed_fault(read({.path = write("open.stl", stl_text(open))}));
  ASSERT_TRUE(fault.has_value());
  EXPECT_NE(fault->what.find("not closed"), std::string::npos);
  MeshDef turned = block();
  for (auto& t : turned.triangles) std::swap(t[0], t[1]);
  const auto inside_out = find_closed_fault(read({.path = write("turned.obj", obj_text(turned))}));
  ASSERT_TRUE(inside_out.has_value());
  EXPECT_EQ(inside_out->what, "it is inside out");
}

}  // namespace mesh_file_test
}  // namespace slew::contact
