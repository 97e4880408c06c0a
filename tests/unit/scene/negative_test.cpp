// SPDX-License-Identifier: Apache-2.0
// Every file of tests/scenes_negative is refused with exactly the text beside it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "build_paths.h"
#include "scene/scene.h"
#include "scene/source.h"
#include "temporary_folder.h"

namespace slew::scene {
namespace negative_test {

namespace fs = std::filesystem;

const fs::path kFolder = fs::path(SLEWRING_SOURCE_DIR) / "tests/scenes_negative";

std::vector<std::string> negative_scenes() {
  std::vector<std::string> names;
  for (const auto& file : fs::directory_iterator(kFolder)) {
    if (file.path().extension() == ".expected") names.push_back(file.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string refusal_of(const std::string& path, const Overrides& overrides = {}) {
  try {
    (void)load_file(path, overrides);
  } catch (const LoadError& error) {
    return error.what();
  }
  return "accepted";
}

// file names in messages are as the user gave them
std::string without_folder(std::string text) {
  const std::string prefix = kFolder.string() + "/";
  for (std::size_t at = 0; (at = text.find(prefix)) != std::string::npos;) text.erase(at, prefix.size());
  return text;
}

TEST(NegativeScene, IsRefusedWithItsPlaceAndMessage) {
  for (const std::string& name : negative_scenes()) {
    SCOPED_TRACE("tests/scenes_negative/" + name + ".yaml");
    std::ifstream in(kFolder / (name + ".expected"));
    std::stringstream expected;
    expected << in.rdbuf();
    EXPECT_EQ(without_folder(refusal_of((kFolder / (name + ".yaml")).string()) + "\n"), expected.str());
  }
}

TEST(NegativeFile, ThereAreAtLeastFortyExamples) {
  EXPECT_GE(negative_scenes().size(), 40u);
}

TEST(NegativeFile, ADirectoryIsRefused) {
  EXPECT_EQ(refusal_of("/tmp"), "/tmp: is a directory; expected a file");
}

TEST(NegativeFile, AFileThatIsNotThereIsRefused) {
  EXPECT_EQ(refusal_of("no/such/scene.yaml"), "no/such/scene.yaml: cannot be read: No such file or directory");
}

TEST(NegativeFile, ADeviceIsRefused) {
  EXPECT_EQ(refusal_of("/dev/zero"), "/dev/zero: is not a regular file; expected a file");
}

TEST(NegativeFile, AFileWithoutPermissionIsRefused) {
  const TemporaryFolder folder;
  const std::string path = folder.write("scene.yaml", "scene: x\n");
  fs::permissions(path, fs::perms::none);
  if (std::ifstream(path)) GTEST_SKIP() << "this user may read any file";
  EXPECT_EQ(refusal_of(path), path + ": cannot be read: Permission denied");
}

TEST(NegativeFile, AFileOfHundredMegabytesIsRefusedByItsSizeAlone) {
  const TemporaryFolder folder;
  const std::string path = folder.write("huge.yaml", "");
  fs::resize_file(path, 100'000'000);
  // read, its zeros would be refused as NUL bytes
  EXPECT_EQ(refusal_of(path), path + ": is 100.0 MB large; expected at most 10.0 MB");
}

TEST(NegativeFile, AnOverrideIsReportedByItsText) {
  const std::string crane = SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml";
  EXPECT_EQ(refusal_of(crane, {"Bag.mass=-5 kg"}),
            "--set Bag.mass=-5 kg: '-5 kg' is out of range; expected more than 0 kg");
  EXPECT_EQ(refusal_of(crane, {"Bog.mass=5"}), "--set Bog.mass=5: no element or section 'Bog'; did you mean 'Bag'?");
  EXPECT_EQ(refusal_of(crane, {"Bag.mas=5"}), "--set Bag.mas=5: unknown key; did you mean 'mass'?");
  EXPECT_EQ(refusal_of(crane, {"Bag.mass"}),
            "--set Bag.mass: is not a setting; expected Element.key=value, such as 'Bag.mass=1500kg'");
  EXPECT_EQ(refusal_of(crane, {"Bag.mass="}),
            "--set Bag.mass=: has no value; expected Element.key=value, such as 'Bag.mass=1500kg'");
  EXPECT_EQ(
      refusal_of(crane, {"Cyl_Lift.rod_diameter=250 mm"}),
      "--set Cyl_Lift.rod_diameter=250 mm: the rod is not thinner than the piston; expected less than piston_diameter");
  EXPECT_EQ(refusal_of(crane, {"Bag.inertia=[1, 1"}),
            "--set Bag.inertia=[1, 1: this '[' is not closed; expected ']' or ','");
}

}  // namespace negative_test
}  // namespace slew::scene
