// SPDX-License-Identifier: Apache-2.0
// An installation: moved after it was made, it runs the crane from any folder; uninstalled, it leaves nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "build_paths.h"
#include "command.h"
#include "tests/support/test_domain.h"

namespace slew::testing {
namespace install_test {

namespace fs = std::filesystem;

// Installs everything into a folder of its own. The list of files that an earlier installation of this build left
// for `uninstall` is kept.
class Installation : public ::testing::Test {
 protected:
  Installation() {
    if (fs::exists(manifest_)) fs::copy_file(manifest_, kept_);
    const CommandResult result = cmake({"--install", SLEWRING_BINARY_DIR, "--prefix", prefix_.string()});
    EXPECT_EQ(result.code, 0) << result.err;
  }
  ~Installation() override {
    fs::remove(manifest_);
    if (fs::exists(kept_)) fs::copy_file(kept_, manifest_);
  }

  CommandResult cmake(const std::vector<std::string>& arguments) {
    return run(SLEWRING_CMAKE, arguments, work_.path());
  }
  CommandResult slewring(const std::vector<std::string>& arguments) {
    return run((prefix_ / "bin/slewring").string(), arguments, elsewhere_.path());
  }
  // With the prefix under another name.
  void move() {
    const fs::path moved = work_.path() / "moved";
    fs::rename(prefix_, moved);
    prefix_ = moved;
  }

  WorkFolder work_, elsewhere_;
  fs::path prefix_ = work_.path() / "installed";
  fs::path manifest_ = fs::path(SLEWRING_BINARY_DIR) / "install_manifest.txt";
  fs::path kept_ = work_.path() / "kept_manifest.txt";
  TestDomain domain_;
};

TEST_F(Installation, MovedElsewhereRunsTheCraneInAnyFolder) {
  move();
  // as in the README, without a clone
  const CommandResult result = slewring({"run", "scenes/truck_crane.yaml", "--duration", "0.2 s", "--pace", "free",
                                         "--domain", std::to_string(domain_.number()), "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const fs::path recording = elsewhere_.recording();
  const CommandResult replay = slewring({"replay", recording.string(), "--verify"});
  EXPECT_EQ(replay.code, 0) << replay.err;
  EXPECT_NE(replay.out.find("equal bit for bit"), std::string::npos) << replay.out;

  // scenes and roles by their names alone
  EXPECT_EQ(slewring({"check", "truck_crane_flexible.yaml"}).code, 0);
  EXPECT_EQ(slewring({"check", "contact/no_such_scene.yaml"}).code, 2);
  EXPECT_NE(slewring({"--complete", "run", "truck_crane_c"}).out.find("truck_crane_contact.yaml"), std::string::npos);
  EXPECT_EQ(slewring({"help", "node", "mechanics"}).code, 0);
  const nlohmann::json version = nlohmann::json::parse(slewring({"--version", "--json"}).out);
  const nlohmann::json built = nlohmann::json::parse(run("slewring", {"--version", "--json"}, work_.path()).out);
  EXPECT_EQ(version, built) << "the same middlewares are found";
}

TEST_F(Installation, AFileOfTheUserGoesBeforeTheInstalledScene) {
  std::ofstream(elsewhere_.path() / "truck_crane.yaml") << "bodies:\n  Rod: {mas: 2 kg}\n";
  const CommandResult result = slewring({"check", "truck_crane.yaml"});
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.err.find("truck_crane.yaml:2:"), std::string::npos) << result.err;
}

TEST_F(Installation, HasWhatControllersNeed) {
  move();
  for (const char* file : {"include/slewring_client.h", "include/slewring_client.hpp", "share/slewring/slewring.idl",
                           "share/slewring/slewring.lcm", "lib/python3/dist-packages/slewring_client.py",
                           "share/man/man1/slewring-run.1", "share/bash-completion/completions/slewring",
                           "lib/systemd/system/slewring@.service", "share/doc/slewring/docs/README.md"}) {
    EXPECT_TRUE(fs::is_regular_file(prefix_ / file)) << file;
  }
  fs::path pkgconfig, package;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(prefix_ / "lib")) {
    if (entry.path().filename() == "slewring-client.pc") pkgconfig = entry.path().parent_path();
    if (entry.path().filename() == "slewring-config.cmake") package = entry.path();
  }
  EXPECT_FALSE(package.empty());
  // a controller of the documents, compiled with what pkg-config gives
  const std::string build = "PKG_CONFIG_PATH=" + pkgconfig.string() + " sh -c '" SLEWRING_C_COMPILER " -o first " +
                            SLEWRING_SOURCE_DIR
                            "/examples/controller/first_controller.c "
                            "$(pkg-config --cflags --libs slewring-client) -lm'";
  if (run("/bin/sh", {"-c", "command -v pkg-config"}, work_.path()).code != 0) GTEST_SKIP() << "no pkg-config";
  const CommandResult built = run("/bin/sh", {"-c", build}, elsewhere_.path());
  EXPECT_EQ(built.code, 0) << built.err;
}

TEST_F(Installation, UninstalledLeavesNothing) {
  const std::string script = SLEWRING_SOURCE_DIR "/cmake/Uninstall.cmake";
  // of another program in the same prefix
  fs::create_directories(prefix_ / "share/doc/other");
  std::ofstream(prefix_ / "share/doc/other/file") << "stays\n";
  const CommandResult result = cmake({"-DBUILD=" SLEWRING_BINARY_DIR, "-P", script});
  EXPECT_EQ(result.code, 0) << result.err;
  std::vector<std::string> left;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(prefix_)) {
    left.push_back(fs::relative(entry.path(), prefix_).string());
  }
  std::sort(left.begin(), left.end());
  EXPECT_EQ(left, (std::vector<std::string>{"share", "share/doc", "share/doc/other", "share/doc/other/file"}));

  const CommandResult again = cmake({"-DBUILD=" SLEWRING_BINARY_DIR, "-P", script});
  EXPECT_NE(again.code, 0);
  EXPECT_NE(again.err.find("There is no install_manifest.txt"), std::string::npos) << again.err;
}

}  // namespace install_test
}  // namespace slew::testing
