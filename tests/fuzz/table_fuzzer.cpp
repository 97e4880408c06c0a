// SPDX-License-Identifier: Apache-2.0
// Tables in CSV files: any bytes are a script, an export, a force table or a table of named columns, or are refused
// with place and reason. Accepted values are in order and finite, and the scene's own text gives them again.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "scene/scene.h"
#include "scene/script.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/memory_file.h"

namespace {

using namespace slew;

const std::string kSlide =
    "bodies: {B: {mass: 1, inertia: [1, 1, 1]}}\n"
    "joints: {J: {type: prismatic, body2: B}}\n";
const std::string kInput =
    "forces: {F: {type: point_force, body: B, force: 1}}\n"
    "inputs: {I: {type: analog, primitive: F}, K: {type: digital, primitive: F, channel: 1}}\n";

std::string scene_of(std::uint8_t choice, const std::string& file) {
  switch (choice % 4) {
    case 0:
      return kSlide + kInput + "script: {file: " + file + "}\n";
    case 1:
      return kSlide + kInput + "script: {file: " + file + ", columns: [I]}\n";
    case 2:
      return kSlide + "forces: {F: {type: point_force, body: B, force_table: " + file + "}}\n";
    default:
      return kSlide + "forces: {F: {type: point_force, body: B, force_table: {file: " + file + ", columns: [t, F]}}}\n";
  }
}

void require_order(const scene::Scene& scene) {
  const auto check = [](const Table& table, bool has_jumps) {
    for (std::size_t i = 0; i < table.size(); ++i) {
      fuzz::require(std::isfinite(table[i][0]) && std::isfinite(table[i][1]));
      fuzz::require(i == 0 || table[i][0] > table[i - 1][0] || (has_jumps && table[i][0] == table[i - 1][0]));
      fuzz::require(i < 2 || table[i][0] > table[i - 2][0]);
    }
  };
  for (const scene::ScriptTrack& track : scene.script.tracks) {
    fuzz::require(!track.points.empty());
    check(track.points, true);
  }
  for (const auto& force : scene.mechanics.point_forces) check(force.force_table, false);
}

// Gone at the end of the program.
struct Folder {
  const std::filesystem::path path = fuzz::written_file(".tables");
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder scratch;
  const std::filesystem::path& folder = scratch.path;
  fuzz::Choices choices(data, size);
  const std::uint8_t choice = choices.byte();
  const std::string content = size > 0 ? std::string(reinterpret_cast<const char*>(data + 1), size - 1) : std::string();
  std::ofstream(folder / "t.csv", std::ios::binary) << content;
  std::ofstream(folder / "scene.yaml") << scene_of(choice, "t.csv");
  try {
    const scene::Scene scene = scene::load_file((folder / "scene.yaml").string());
    require_order(scene);
    const scene::ScriptPlayer player(scene);
    fuzz::require(std::isfinite(player.value(0, {1'000'000})));
    const scene::Scene again = scene::load_text(scene.expanded_text, "scene");
    fuzz::require(again.expanded_text == scene.expanded_text);
  } catch (const scene::LoadError& error) {
    fuzz::require(!error.diagnostics().empty() && error.diagnostics().size() <= scene::kMaxReportedProblems + 1);
  }
  return 0;
}
