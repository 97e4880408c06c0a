// SPDX-License-Identifier: Apache-2.0
// Symbolic links in a scene's folder: a link out of it is refused unread, by each key that names a file; links inside
// of it, and a folder that is itself reached by a link, are read. The right answer is the kernel's: what realpath
// gives.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "flex/flexible_files.h"
#include "scene/scene.h"
#include "support/flex_beams.h"
#include "temporary_folder.h"

namespace slew::scene {
namespace linked_files_test {

namespace fs = std::filesystem;

constexpr const char* kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const std::string kBody =
    "bodies: {B: {mass: 1, inertia: [1, 1, 1]}}\njoints: {J: {type: prismatic, body2: B}}\n"
    "forces: {F: {type: point_force, body: B, force: 1}}\ninputs: {Stick: {type: analog, primitive: F}}\n";

// file: its name in the folder; scene: the scene that names it
struct Named {
  const char *file, *content;
  std::string scene;
};

std::vector<Named> every_key() {
  return {
      {"part.yaml", "session: {duration: 3 s}\n", "include: part.yaml\n" + kBody},
      {"part.yaml", kBody.c_str(), "include: [{file: part.yaml, prefix: Left_}]\n"},
      {"part.yaml", "inputs: {Stick: [[0 s, 0], [1 s, 1]]}\n", kBody + "script: {file: part.yaml}\n"},
      {"part.csv", "time,Stick\n0,0\n1,1\n", kBody + "script: {file: part.csv}\n"},
      {"part.csv", "time [s],F [N]\n0,0\n1,1\n",
       "bodies: {B: {mass: 1, inertia: [1, 1, 1]}}\njoints: {J: {type: prismatic, body2: B}}\n"
       "forces: {F: {type: point_force, body: B, force_table: part.csv}}\n"},
      {"part.obj", kTetrahedron,
       "bodies: {B: {inertia: from_mesh, mesh: part.obj, mesh_unit: 1 m, mesh_up: y, density: 7850}}\n"
       "joints: {J: {type: prismatic, body2: B}}\n"},
      {"part.obj", kTetrahedron,
       kBody + "shapes: {S: {type: convex_mesh, body: B, file: part.obj, unit: 1 m, up: y}}\n"},
      {"part.obj", kTetrahedron, kBody + "graphics: {G: {body: B, file: part.obj, unit: 1 m, up: y}}\n"},
      {"part.txt", "text\n", kBody + "assets: [part.txt]\n"},
  };
}

std::string refusal(const std::string& path) {
  try {
    (void)load_file(path);
  } catch (const LoadError& error) {
    return error.what();
  }
  return "";
}

TEST(LinkedFiles, OutOfTheFolderAreRefusedWhicheverKeyNamesThem) {
  for (const Named& named : every_key()) {
    SCOPED_TRACE(named.scene);
    const TemporaryFolder elsewhere, folder;
    const std::string target = elsewhere.write(named.file, named.content);
    const std::string scene = folder.write("scene.yaml", named.scene);
    fs::create_symlink(target, fs::path(folder.path()) / named.file);
    const std::string message = refusal(scene);
    EXPECT_NE(message.find("'" + std::string(named.file) + "' is a link to '" + target +
                           "', outside of the scene's folder, and was not read"),
              std::string::npos)
        << message;
    // without the link
    fs::remove(fs::path(folder.path()) / named.file);
    folder.write(named.file, named.content);
    EXPECT_EQ(refusal(scene), "");
  }
}

TEST(LinkedFiles, InAFolderThatIsALinkAreRefusedToo) {
  for (const Named& named : every_key()) {
    std::string scene = named.scene;
    const std::string file = named.file;
    scene.replace(scene.find(file), file.size(), "parts/" + file);
    SCOPED_TRACE(scene);
    const TemporaryFolder elsewhere, folder;
    elsewhere.write(file, named.content);
    const std::string path = folder.write("scene.yaml", scene);
    fs::create_directory_symlink(elsewhere.path(), fs::path(folder.path()) / "parts");
    EXPECT_NE(refusal(path).find("outside of the scene's folder"), std::string::npos) << refusal(path);
  }
}

TEST(LinkedFiles, InsideOfTheFolderAreRead) {
  for (const Named& named : every_key()) {
    SCOPED_TRACE(named.scene);
    const TemporaryFolder folder;
    const fs::path inside = fs::path(folder.path()) / "parts";
    fs::create_directory(inside);
    folder.write(std::string("parts/") + named.file, named.content);
    fs::create_symlink(fs::path("parts") / named.file, fs::path(folder.path()) / named.file);
    EXPECT_EQ(refusal(folder.write("scene.yaml", named.scene)), "");
  }
}

TEST(LinkedFiles, TheFolderItselfMayBeReachedByALink) {
  for (const Named& named : every_key()) {
    SCOPED_TRACE(named.scene);
    const TemporaryFolder folder, beside;
    folder.write(named.file, named.content);
    folder.write("scene.yaml", named.scene);
    const fs::path link = fs::path(beside.path()) / "machine";
    fs::create_directory_symlink(folder.path(), link);
    EXPECT_EQ(refusal((link / "scene.yaml").string()), "");
  }
}

TEST(LinkedFiles, OfFlexibleBodiesStayInTheFolder) {
  const std::string scene =
      "scene: crane\nbodies:\n  Boom: {type: flexible, flex_file_prefix: beam}\njoints:\n  Root: {type: revolute, "
      "body2: "
      "Boom}\n";
  const TemporaryFolder elsewhere, folder;
  flex::write_flexible_files({elsewhere.path(), "crane", "beam"},
                             flex::reduce(flex::build_beam(flex::testing::jib_boom()), flex::testing::with_modes(1)));
  for (const std::string& matrix : flex::flexible_matrices()) {
    const fs::path file = flex::flexible_file({elsewhere.path(), "crane", "beam"}, matrix);
    fs::create_symlink(file, fs::path(folder.path()) / file.filename());
  }
  const std::string message = refusal(folder.write("scene.yaml", scene));
  EXPECT_NE(message.find("outside of the scene's folder"), std::string::npos) << message;
  EXPECT_EQ(refusal(elsewhere.write("scene.yaml", scene)), "");
}

}  // namespace linked_files_test
}  // namespace slew::scene
