// SPDX-License-Identifier: Apache-2.0
// `slewring flex build` and `slewring flex report`: files, texts, figures and errors.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "command.h"
#include "flex/flexible_files.h"
#include "scene/flexible_model.h"

namespace slew::testing {
namespace flex_test {

namespace fs = std::filesystem;

class Flex : public ::testing::Test {
 protected:
  CommandResult flex(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "flex");
    return run("slewring", arguments, work_.path());
  }
  fs::path write(const std::string& name, const std::string& text) {
    std::ofstream(work_.path() / name, std::ios::binary) << text;
    return work_.path() / name;
  }
  // includes lie beside the including file
  std::string include_boom() {
    fs::copy_file(scene_file("beams/jib_boom.yaml"), work_.path() / "jib_boom.yaml",
                  fs::copy_options::overwrite_existing);
    return "include: jib_boom.yaml";
  }
  WorkFolder work_;
};

const std::string kBoom = scene_file("beams/jib_boom.yaml");
constexpr double kGravity = 9.81;  // m/s2

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void expect_part(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << part << "\nis not in\n" << text;
}

flex::Reduction reduction_of(const std::string& description) {
  const scene::FlexibleModel from = scene::load_flexible_file(description);
  return slew::flex::reduce(from.model, from.reduction);
}

// under gravity along y, loads at the last node, by all modes
double tip_sag(const slew::flex::ReducedBody& body, double load_kg) {
  double sag = 0;
  for (std::size_t k = 0; k < body.modes(); ++k) {
    const double tip = body.nodes.back().phi[k].y();
    sag += tip * kGravity * (load_kg * tip + body.C[k].y()) / (body.omega[k] * body.omega[k]);
  }
  return sag;
}

TEST_F(Flex, BuildWritesTheFilesOfTheLibrary) {
  const CommandResult result = flex({"build", kBoom, "--output", "."});
  ASSERT_EQ(result.code, 0) << result.err;
  expect_part(result.out, "truck_crane_beam_hard_*.dat: 9 files, ");
  expect_part(result.out, "mass 127.55");
  expect_part(result.out, "13 modes: 8.1");
  expect_part(result.out, "modes 1 to 2    reach 0.00, 96.9");
  EXPECT_EQ(result.out.find("replaced"), std::string::npos);
  const fs::path folder = work_.path() / "direct";
  fs::create_directory(folder);
  const slew::flex::FlexibleFileSet set{folder, "truck_crane", "beam_hard"};
  slew::flex::write_flexible_files(set, reduction_of(kBoom));
  for (const std::string& matrix : slew::flex::flexible_matrices()) {
    const fs::path direct = slew::flex::flexible_file(set, matrix);
    EXPECT_EQ(text_of(work_.path() / direct.filename()), text_of(direct)) << matrix;
  }
}

TEST_F(Flex, BuildGoesBesideTheDescriptionAndReportsReplacedFiles) {
  const fs::path file = write("boom.yaml", include_boom() + "\n");
  fs::create_directory(work_.path() / "elsewhere");
  const CommandResult first = flex({"build", file.string(), "--model", "m", "--prefix", "p_1"});
  ASSERT_EQ(first.code, 0) << first.err;
  const std::string frequencies = text_of(work_.path() / "m_p_1_Frequencies.dat");
  const CommandResult again =
      flex({"build", file.string(), "--model", "m", "--prefix", "p_1", "--set", "line.nodes=10", "--json"});
  ASSERT_EQ(again.code, 0) << again.err;
  const nlohmann::json json = nlohmann::json::parse(again.out);
  EXPECT_EQ(json.at("replaced"), 9);
  EXPECT_EQ(json.at("nodes"), 10);
  EXPECT_EQ(json.at("files").size(), 9u);
  EXPECT_NE(text_of(work_.path() / "m_p_1_Frequencies.dat"), frequencies);
  expect_part(flex({"build", file.string(), "--model", "m", "--prefix", "p_1"}).out,
              "; 9 files of an older set replaced");
  for (const auto& entry : fs::directory_iterator(work_.path())) EXPECT_NE(entry.path().extension(), ".new");
}

TEST_F(Flex, AnUnfinishedSetIsNotLeftBehind) {
  ASSERT_EQ(flex({"build", kBoom, "--output", "."}).code, 0);
  const std::string before = text_of(work_.path() / "truck_crane_beam_hard_Source.dat");
  fs::create_directory(work_.path() / "truck_crane_beam_hard_Recovery.dat.new");
  const CommandResult result = flex({"build", kBoom, "--output", ".", "--set", "line.nodes=5"});
  EXPECT_EQ(result.code, 6) << result.err;
  expect_part(result.err, "truck_crane_beam_hard_Recovery.dat.new: the file cannot be written");
  EXPECT_EQ(text_of(work_.path() / "truck_crane_beam_hard_Source.dat"), before);
  EXPECT_EQ(flex({"report", "truck_crane_beam_hard"}).code, 0);
}

TEST_F(Flex, TheCranesFilesAreThoseOfTheirDescriptions) {
  for (const auto& [file, prefix] : {std::pair("jib_boom", "beam_hard"), std::pair("jib_boom_soft", "beam_soft")}) {
    const slew::flex::ReducedBody made = reduction_of(scene_file(std::string("beams/") + file + ".yaml")).body;
    const slew::flex::ReducedBody kept = slew::flex::read_flexible_files({scene_file(""), "truck_crane", prefix}).body;
    ASSERT_EQ(kept.modes(), made.modes()) << file;
    for (std::size_t k = 0; k < made.modes(); ++k) EXPECT_NEAR(kept.omega[k] / made.omega[k], 1, 1e-9) << file << k;
    EXPECT_NEAR(kept.mass / made.mass, 1, 1e-12);
  }
}

TEST_F(Flex, TheJibBoomHasTheFiguresOfTheCrane) {
  const slew::flex::ReducedBody hard = reduction_of(kBoom).body;
  EXPECT_NEAR(hard.mass, 127.56, 0.01);
  EXPECT_NEAR(hard.omega[0] / (2 * M_PI), 8.2, 0.05);
  // bag and hook
  EXPECT_NEAR(tip_sag(hard, 520), 0.068, 5e-4);
  EXPECT_NEAR(tip_sag(hard, 1520), 0.187, 1e-3);
  const slew::flex::ReducedBody soft = reduction_of(scene_file("beams/jib_boom_soft.yaml")).body;
  EXPECT_NEAR(tip_sag(soft, 520) / tip_sag(hard, 520), 10, 1e-6);
}

TEST_F(Flex, ReportComparesWithTheWholeModel) {
  const CommandResult result = flex({"report", kBoom, "--modes", "1;2", "--svg", "shapes.svg"});
  ASSERT_EQ(result.code, 0) << result.err;
  for (const char* part :
       {"20 nodes, 19 elements, 234 freedoms: 6 held, 6 of interfaces, 222 inside", "2 kept", "whole model [Hz]",
        "relative error", "static compliance of node 20 with node 1 held", "effective mass of the kept modes",
        "clamped x, y, z [%]     free x, y, z [%]", "  1;2 ", "  lowest 4", "  all ", "mode shapes: shapes.svg"})
    expect_part(result.out, part);
  expect_part(text_of(work_.path() / "shapes.svg"), "Mode 2: 8.1");
}

TEST_F(Flex, ReportGivesTheFiguresOfBothBodyFrames) {
  const nlohmann::json json = nlohmann::json::parse(flex({"report", kBoom, "--modes", "1;2", "--json"}).out);
  EXPECT_TRUE(json.at("has_model").get<bool>());
  EXPECT_EQ(json.at("modes").size(), 13u);
  EXPECT_NEAR(json.at("modes").at(0).at("full_hz").get<double>(), 8.2, 0.05);
  EXPECT_LT(json.at("modes").at(1).at("relative_error").get<double>(), 1e-4);
  EXPECT_NEAR(json.at("full_mass").at("mass").get<double>(), 127.56, 0.01);
  EXPECT_NEAR(json.at("reduced_mass").at("inertia").at(2).get<double>(), 451, 0.5);
  const nlohmann::json& rows = json.at("attachments").at("rows");
  EXPECT_EQ(rows.at(0).at("modes"), "1;2");
  EXPECT_EQ(rows.at(1).at("modes"), "lowest 4");
  for (const int a : {1, 2}) {
    EXPECT_NEAR(rows.at(0).at("clamped").at(a).get<double>(), 0.97, 0.005);
    EXPECT_NEAR(rows.at(0).at("free").at(a).get<double>(), 0.51, 0.015);
    EXPECT_NEAR(rows.at(1).at("clamped").at(a).get<double>(), 0.995, 0.002);
    EXPECT_NEAR(json.at("compliance").at("directions").at(a).at("share").get<double>(),
                rows.at(0).at("clamped").at(a).get<double>(), 1e-12);
  }
  // the same two sums whichever frame the body has
  const nlohmann::json free = nlohmann::json::parse(
      flex({"report", kBoom, "--modes", "1;2", "--json", "--set", "reduction.attachment=free"}).out);
  const nlohmann::json& freed = free.at("attachments").at("rows").at(0);
  for (const char* frame : {"clamped", "free"})
    EXPECT_NEAR(freed.at(frame).at(1).get<double>(), rows.at(0).at(frame).at(1).get<double>(), 1e-9) << frame;
}

TEST_F(Flex, ReportOfFilesNamesItsMissingValues) {
  ASSERT_EQ(flex({"build", kBoom, "--output", "."}).code, 0);
  const CommandResult result = flex({"report", "truck_crane_beam_hard", "--frequency-up-to", "60 Hz"});
  ASSERT_EQ(result.code, 0) << result.err;
  expect_part(result.out, "4 kept");
  expect_part(result.out, "all modes [m/N]");
  expect_part(result.out, "need the whole model: name the description that the files were built from");
  EXPECT_EQ(result.out.find("relative error"), std::string::npos);
  const nlohmann::json files = nlohmann::json::parse(flex({"report", "truck_crane_beam_hard", "--json"}).out);
  EXPECT_EQ(nlohmann::json::parse(flex({"report", "./truck_crane_beam_hard_Modes.dat", "--json"}).out), files);
  const nlohmann::json model = nlohmann::json::parse(flex({"report", kBoom, "--json"}).out);
  EXPECT_FALSE(files.at("has_model").get<bool>());
  EXPECT_TRUE(files.at("full_mass").is_null());
  EXPECT_TRUE(files.at("modes").at(0).at("full_hz").is_null());
  for (const std::size_t a : {0, 1, 2}) {
    // all modes are statically exact at the interface
    const double sum = files.at("compliance").at("directions").at(a).at("all_modes").get<double>();
    EXPECT_NEAR(sum / model.at("compliance").at("directions").at(a).at("full").get<double>(), 1, 1e-9);
  }
  EXPECT_EQ(files.at("reduced_mass"), model.at("reduced_mass"));
}

TEST_F(Flex, ErrorsNameTheirPlaceAndHaveTheirCodes) {
  write("bad.yaml", include_boom() + "\nline: {nods: 3}\nreduction: {clamped_nodes: [77]}\n");
  write("far.yaml", include_boom() + "\nreduction: {clamped_nodes: [77]}\n");
  write("bent.yaml",
        "model: m\nprefix: p\nmaterials: {S: {youngs_modulus: 2e11, density: 7700}}\n"
        "sections: {R: {shape: solid_circle, diameter: 0.1}}\nreduction: {stiffening: straight_beam, "
        "fixed_interface_modes: 2}\n"
        "nodes: {1: [0, 0, 0], 2: [1, 0, 0], 3: [1, 1, 0]}\n");
  ASSERT_EQ(flex({"build", kBoom, "--output", ".", "--model", "a", "--prefix", "b_c"}).code, 0);
  struct Case {
    std::vector<std::string> arguments;
    int code;
    const char* sentence;
  };
  const std::vector<Case> cases = {
      {{}, 2, "A subcommand is required"},
      {{"build", "bad.yaml"}, 2, "bad.yaml:2:8: line.nods: unknown key; did you mean 'nodes'?"},
      {{"report", "far.yaml"}, 2, "far.yaml:2:28: reduction.clamped_nodes: there is no node 77"},
      {{"build", "bent.yaml"}, 2, "bent.yaml:5:25: reduction.stiffening: node 2 is "},
      {{"build", "nowhere.yaml"}, 2, "nowhere.yaml: cannot be read"},
      {{"build", kBoom, "--output", "nowhere"}, 2, "there is no folder 'nowhere'; nothing was written"},
      {{"build", kBoom, "--prefix", "a/b"}, 2, "'a/b' cannot be part of a file's name"},
      {{"build", kBoom, "--output", ".", "--model", "a_b", "--prefix", "c"}, 2, "this is of model 'a', prefix 'b_c'"},
      {{"report", kBoom, "--modes", "1;99"}, 2, "--modes: there is no mode 99; expected 1 to 13"},
      {{"report", kBoom, "--modes", "one"}, 2, "--modes: 'one' in the list of modes"},
      {{"report", kBoom, "--frequency-up-to", "5 kg"}, 2, "--frequency-up-to: "},
      {{"report", kBoom, "--frequency-up-to", "1 Hz"}, 2, "there is no mode up to 1 Hz; the lowest has 8.1"},
      {{"report", kBoom, "--frequency-up-to", "1 Hz", "--modes", "1"}, 2, "excludes"},
      {{"report", kBoom, "--svg", "/no/such/folder/a.svg"}, 6, "/no/such/folder/a.svg: the file cannot be written"},
      {{"report", "no_such_set"}, 2, "no_such_set_Source.dat: the file is missing"},
      {{"report", "a_b_c", "--set", "line.nodes=3"}, 2, "--set changes a description"},
  };
  for (const Case& c : cases) {
    const CommandResult result = flex(c.arguments);
    EXPECT_EQ(result.code, c.code) << result.err;
    expect_part(result.err, c.sentence);
    EXPECT_TRUE(result.out.empty()) << result.out;
  }
}

}  // namespace flex_test
}  // namespace slew::testing
