// SPDX-License-Identifier: Apache-2.0
// The command line of every program: help, versions, exit codes, texts of errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "build_paths.h"
#include "command.h"
#include "core/node_names.h"
#include "recording/writer.h"

namespace slew::testing {
namespace program_test {

class Program : public ::testing::Test {
 protected:
  CommandResult slewring(const std::vector<std::string>& arguments) { return run("slewring", arguments, work_.path()); }
  WorkFolder work_;
};

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// A printed example must not be refused: beyond this machine it has keys, or names their absence.
void expect_keys_beyond_this_machine(const std::string& help) {
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    if (!contains(line, "--interface eth") || contains(line, "slewring doctor")) continue;
    EXPECT_TRUE(contains(line, "--keys") || contains(line, "--insecure-lan")) << line;
  }
}

// Names below "Subcommands:" of a help text; a line that continues a description begins further right.
std::vector<std::string> verbs_below(const std::string& help) {
  std::vector<std::string> names;
  std::istringstream lines(help.substr(std::min(help.find("Subcommands:"), help.size())));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line) && !line.empty()) {
    if (line.size() > 2 && line[2] != ' ') names.push_back(line.substr(2, line.find(' ', 2) - 2));
  }
  return names;
}

TEST_F(Program, EveryVerbExplainsItselfWithAnExample) {
  std::vector<std::vector<std::string>> verbs = {{}};
  for (std::size_t i = 0; i < verbs.size(); ++i) {
    std::vector<std::string> arguments = verbs[i];
    std::string verb = "slewring";
    for (const std::string& word : arguments) verb += ' ' + word;
    arguments.emplace_back("--help");
    const CommandResult result = slewring(arguments);
    EXPECT_EQ(result.code, 0) << verb;
    EXPECT_TRUE(contains(result.out, "Example")) << verb;
    // of its own, not of the command above it
    const std::string example = result.out.substr(std::min(result.out.find("Example"), result.out.size()));
    EXPECT_TRUE(contains(example, "  " + verb)) << verb << ": " << example;
    EXPECT_TRUE(result.err.empty()) << verb << ": " << result.err;
    expect_keys_beyond_this_machine(result.out);
    for (const std::string& name : verbs_below(result.out)) {
      arguments.back() = name;
      verbs.push_back(arguments);
    }
  }
  EXPECT_GE(verbs.size(), 40u);
}

TEST(Howto, HasNoExampleBeyondThisMachineThatIsRefused) {
  for (const auto& entry : std::filesystem::directory_iterator(SLEWRING_SOURCE_DIR "/docs/howto")) {
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    SCOPED_TRACE(entry.path().string());
    expect_keys_beyond_this_machine(text.str());
  }
}

TEST_F(Program, EveryNodeExplainsItselfWithAnExample) {
  for (const std::string_view name : kNodeNames) {
    const std::string role(name);
    const CommandResult through = slewring({"node", role, "--help"});
    EXPECT_EQ(through.code, 0) << role;
    EXPECT_TRUE(contains(through.out, role + "_node")) << role;
    EXPECT_TRUE(contains(through.out, "Example")) << role;
    expect_keys_beyond_this_machine(through.out);
    EXPECT_EQ(run(role + "_node", {"--help"}, work_.path()).out, through.out) << role;
  }
}

// with --rt: nothing waits for the recorder, everything for io
TEST_F(Program, TheClockGoesBeforeThePhysicsAndThePhysicsBeforeTheRecorder) {
  const auto priority = [this](const std::string& role) {
    const std::string help = slewring({"node", role, "--help"}).out;
    const std::string range = "in [1 - 99]=";
    const std::size_t at = help.find(range, help.find("--priority"));
    return at == std::string::npos ? 0 : std::stoi(help.substr(at + range.size()));
  };
  EXPECT_GT(priority("io"), priority("mechanics"));
  EXPECT_EQ(priority("mechanics"), priority("hydraulics"));
  EXPECT_GT(priority("hydraulics"), priority("recorder"));
  EXPECT_GT(priority("recorder"), 0);
}

TEST_F(Program, EveryProgramPrintsTheSameBuild) {
  const std::string own = slewring({"--version"}).out;
  ASSERT_TRUE(own.starts_with("slewring 0.")) << own;
  for (const std::string_view role : kNodeNames) {
    const std::string node = std::string(role) + "_node";
    const CommandResult result = run(node, {"--version"}, work_.path());
    EXPECT_EQ(result.code, 0);
    EXPECT_EQ(result.out, node + own.substr(std::string("slewring").size()));
  }
}

TEST_F(Program, TheVersionIsThatOfTheChangelogForMachinesToo) {
  std::ifstream changelog(SLEWRING_SOURCE_DIR "/CHANGELOG.md");
  std::string version;
  for (std::string line; version.empty() && std::getline(changelog, line);) {
    if (line.starts_with("## [")) version = line.substr(4, line.find(']') - 4);
  }
  ASSERT_FALSE(version.empty());
  for (const char* program : {"slewring", "mechanics_node"}) {
    const std::string text = run(program, {"--version"}, work_.path()).out;
    EXPECT_TRUE(text.starts_with(program + (" " + version + "-"))) << text;
    const nlohmann::json json = nlohmann::json::parse(run(program, {"--version", "--json"}, work_.path()).out);
    EXPECT_EQ(json.at("program"), program);
    EXPECT_EQ(json.at("version"), version);
    EXPECT_EQ(std::string(program) + " " + json.at("build").get<std::string>() + "\n", text);
    EXPECT_TRUE(contains(text, json.at("compiler").get<std::string>())) << text;
    EXPECT_EQ(json.at("middlewares").at(0), "cyclone");
  }
  EXPECT_EQ(slewring({"--json"}).code, 2);
}

TEST_F(Program, HelpOfAVerbIsThatOfItsOption) {
  EXPECT_EQ(slewring({"help"}).out, slewring({"--help"}).out);
  for (const std::vector<std::string>& verbs : std::vector<std::vector<std::string>>{
           {"run"}, {"control"}, {"control", "pause"}, {"node"}, {"node", "mechanics"}}) {
    std::vector<std::string> helped = {"help"}, asked = verbs;
    helped.insert(helped.end(), verbs.begin(), verbs.end());
    asked.emplace_back("--help");
    const CommandResult help = slewring(helped);
    EXPECT_EQ(help.code, 0) << help.err;
    EXPECT_EQ(help.out, slewring(asked).out) << verbs[0];
  }
  const CommandResult typo = slewring({"help", "chek"});
  EXPECT_EQ(typo.code, 2);
  EXPECT_TRUE(contains(typo.err, "there is no 'chek' here; did you mean 'check'?")) << typo.err;
}

// a session that fails to start and a scene that is refused print the same object
TEST_F(Program, RunForMachinesPrintsOneObjectAlsoWhereItIsRefused) {
  std::ofstream(work_.path() / "bad.yaml") << "bodies:\n  Rod: {mas: 2 kg}\n";
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"run", "bad.yaml", "--json"},
           {"run", "nowhere.yaml", "--json"},
           {"run", scene_file("first_steps.yaml"), "--json", "--in-process", "--cpu", "mechanics=0"}}) {
    const CommandResult result = slewring(arguments);
    EXPECT_EQ(result.code, 2) << result.err;
    EXPECT_FALSE(result.err.empty());
    const nlohmann::json json = nlohmann::json::parse(result.out);
    EXPECT_FALSE(json.at("ok").get<bool>());
    EXPECT_EQ(json.at("code"), 2);
    EXPECT_FALSE(json.at("problems").at(0).at("what").get<std::string>().empty());
  }
}

TEST_F(Program, APlotOfAnotherFormatIsRefused) {
  const CommandResult result = slewring({"plot", "x", "-o", "x.png"});
  EXPECT_EQ(result.code, 2);
  EXPECT_TRUE(contains(result.err, "'x.png' ends neither in .svg nor in .html")) << result.err;
  EXPECT_FALSE(std::filesystem::exists(work_.path() / "x.png"));
}

TEST_F(Program, UsageErrorsReportWhatWhereAndWhatToDoAndExitWith2) {
  struct Case {
    std::vector<std::string> arguments;
    const char* sentence;
  };
  const std::vector<Case> cases = {
      {{}, "slewring: A subcommand is required; nothing was done; see 'slewring --help'\n"},
      {{"chek"}, "slewring: there is no 'chek' here; did you mean 'check'?; nothing was done; see 'slewring --help'\n"},
      {{"control", "puase"}, "did you mean 'pause'?; nothing was done; see 'slewring control --help'\n"},
      {{"run"}, "slewring: scene is required; nothing was done; see 'slewring run --help'\n"},
      {{"run", "x.yaml", "--pace", "slow"}, "--pace: slow not in {real,free}"},
      {{"run", "x.yaml", "--durtion", "5"}, "there is no option '--durtion' here; did you mean '--duration'?"},
      {{"run", "x.yaml", "--domain", "500"}, "--domain: Value 500 not in range 0 to 230"},
      {{"param", "set", "A=1", "B=2"}, "'A=1' has its value, and 'B=2' is a second one; nothing was changed"},
      {{"run", "x.yaml", "--keep-free", "nan"},
       "--keep-free: 'nan' is no number from 0 to 1000000000; nothing was done"},
      {{"run", "x.yaml", "--join-timeout", "0"},
       "--join-timeout: '0' is no number from 0.1 to 86400; nothing was done"},
      {{"replay", "x", "--join-timeout", "nan"}, "--join-timeout: 'nan' is no number from 0.1 to 86400"},
      {{"stress", "x.yaml", "--max-miss", "nan"}, "--max-miss: 'nan' is no number from 0 to 100; nothing was done"},
      {{"stress", "x.yaml", "--p99", "nan"}, "--p99: 'nan' is no number"},
      {{"stress", "x.yaml", "--add-work", "0,nan"}, "--add-work: 'nan' is no number"},
      {{"stress", "x.yaml", "--seconds", "inf"}, "--seconds: 'inf' is no number from 0.5 to 86400"},
      {{"sessions", "--time", "nan"}, "--time: 'nan' is no number"},
      {{"watch", "x", "--every", "nan"}, "--every: 'nan' is no number"},
      {{"node", "mechanics", "--session", "s", "--add-work", "nan"},
       "--add-work: 'nan' is no number from 0 to 1000000"},
      {{"node", "io", "x.yaml", "--session", "s", "--join-timeout", "nan"}, "--join-timeout: 'nan' is no number"},
      {{"node", "recorder", "--session", "s", "--keep-free", "nan"}, "--keep-free: 'nan' is no number"},
      {{"watch", "x", "--session", "*"}, "a session's name consists of letters, digits"},
      {{"node"}, "a role is missing"},
      {{"node", "mechanic"}, "there is no role 'mechanic'; nothing was started; did you mean 'mechanics'?\n"},
      {{"node", "mechanics"}, "mechanics_node: --session is required; nothing was done; see 'mechanics_node --help'\n"},
      {{"node", "io", "--session", "s"}, "io_node: scene is required"},
  };
  for (const Case& c : cases) {
    const CommandResult result = slewring(c.arguments);
    EXPECT_EQ(result.code, 2) << result.err;
    EXPECT_TRUE(contains(result.err, c.sentence)) << result.err << "\nexpected: " << c.sentence;
    EXPECT_TRUE(result.out.empty()) << result.out;
  }
}

TEST_F(Program, CheckPrintsEveryProblemWithItsPlace) {
  std::ofstream(work_.path() / "bad.yaml") << "bodies:\n  Rod: {mas: 2 kg, mass: -1 kg}\n";
  const CommandResult result = slewring({"check", "bad.yaml"});
  EXPECT_EQ(result.code, 2);
  EXPECT_TRUE(contains(result.err, "bad.yaml:2:9: Rod.mas: ")) << result.err;
  EXPECT_TRUE(contains(result.err, "did you mean 'mass'?")) << result.err;
  EXPECT_TRUE(contains(result.err, "bad.yaml:2:")) << result.err;
  const nlohmann::json json = nlohmann::json::parse(slewring({"check", "bad.yaml", "--json"}).out);
  EXPECT_FALSE(json.at("ok").get<bool>());
  EXPECT_EQ(json.at("problems").at(0).at("line"), 2);
}

TEST_F(Program, CheckJudgesTheVariablesOfOutputsByNameAndDimension) {
  std::filesystem::copy_file(scene_file("first_steps.yaml"), work_.path() / "first_steps.yaml");
  std::ofstream(work_.path() / "lamps.yaml")
      << "include: first_steps.yaml\n"
         "outputs:\n  Lamp: {type: switched, condition: 'Hinge.position < -10 deg'}\n";
  const auto check = [&](const std::string& condition) {
    return slewring({"check", "lamps.yaml", "--set", "Lamp.condition=" + condition});
  };
  EXPECT_EQ(check("Hinge.position < -10 deg").code, 0) << check("Hinge.position < -10 deg").err;
  const CommandResult bar = check("Hinge.position < 1 bar");
  EXPECT_EQ(bar.code, 2);
  EXPECT_TRUE(contains(bar.err, "Lamp.condition: 'Hinge.position' is in rad, not in bar")) << bar.err;
  const CommandResult other = check("Hinge.positon < 10 deg");
  EXPECT_EQ(other.code, 2);
  EXPECT_TRUE(contains(other.err, "did you mean 'Hinge.position'?")) << other.err;
  // and of fields of packets, whose unit a header names
  std::ofstream(work_.path() / "packet.yaml")
      << "include: first_steps.yaml\ndevices:\n  Dash: {type: udp_out, send: "
         "127.0.0.1:9, fields: [{name: a, variable: Hinge.position, unit: Pa}]}\n";
  const CommandResult pascal = slewring({"check", "packet.yaml"});
  EXPECT_EQ(pascal.code, 2);
  EXPECT_TRUE(contains(pascal.err, "Dash.a.variable: 'Hinge.position' is in rad, not in Pa")) << pascal.err;
}

TEST_F(Program, CheckAcceptsTheScenesOfTheRepository) {
  for (const char* scene :
       {"first_steps.yaml", "truck_crane.yaml", "truck_crane_flexible.yaml", "truck_crane_flexible_soft.yaml",
        "truck_crane_segmented.yaml", "four_bar.yaml", "slider_crank.yaml"}) {
    const CommandResult result = slewring({"check", scene_file(scene)});
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_TRUE(contains(result.out, "ok")) << result.out;
  }
  // its plots are there with frozen modes too, when it has no flex node
  const CommandResult frozen =
      slewring({"check", scene_file("truck_crane_flexible.yaml"), "--set", "Truck_JibBoom.flex_modes=none"});
  EXPECT_EQ(frozen.code, 0) << frozen.err;
}

TEST_F(Program, AMissingSceneIsNamed) {
  const CommandResult result = slewring({"run", "nowhere.yaml"});
  EXPECT_EQ(result.code, 2);
  EXPECT_TRUE(contains(result.err, "nowhere.yaml")) << result.err;
}

TEST_F(Program, DescribeCountsTheCrane) {
  const nlohmann::json json =
      nlohmann::json::parse(slewring({"describe", scene_file("truck_crane.yaml"), "--json"}).out);
  EXPECT_EQ(json.at("mechanics").at("degrees_of_freedom"), 6);
  EXPECT_EQ(json.at("mechanics").at("merged").size(), 2u);
  EXPECT_EQ(json.at("hydraulics").at("pressure_states"), 7);
  EXPECT_EQ(json.at("ports").size(), 3u);
  for (const nlohmann::json& node : json.at("nodes")) {
    EXPECT_EQ(node.at("needed").get<bool>(), node.at("role") != "flex" && node.at("role") != "sensor") << node;
    EXPECT_FALSE(node.at("reason").get<std::string>().empty());
  }
  const std::string pendulum = slewring({"describe", scene_file("first_steps.yaml")}).out;
  EXPECT_TRUE(contains(pendulum, "not needed: no volumes")) << pendulum;
}

// a cube of 2 m at 500 kg/m3, written as an .obj file
TEST_F(Program, DescribeShowsWhatAMeshGave) {
  std::ofstream(work_.path() / "cube.obj")
      << "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
         "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  const std::string scene = work_.path() / "cube.yaml";
  std::ofstream(scene) << "bodies:\n  Cube: {inertia: from_mesh, mesh: cube.obj, mesh_unit: 1 m, mesh_up: y,"
                          " density: 500 kg/m3}\njoints:\n  Free: {type: floating, body2: Cube}\n";
  const CommandResult text = slewring({"describe", scene});
  EXPECT_TRUE(contains(text.out,
                       "Cube from cube.obj: 8 m3 of 500 kg/m3, 4000 kg; centre of mass [0, 0, 0] m; about it "
                       "Ixx, Iyy, Izz [2666.67, 2666.67, 2666.67]"))
      << text.out << text.err;
  const nlohmann::json json = nlohmann::json::parse(slewring({"describe", scene, "--json"}).out);
  const nlohmann::json& cube = json.at("mechanics").at("mass_properties").at(0);
  EXPECT_EQ(cube.at("mass"), 4000);
  EXPECT_EQ(cube.at("mesh").at("file"), "cube.obj");
  EXPECT_NEAR(cube.at("inertia").at(2).get<double>(), 4000.0 / 12 * 8, 1e-6);
}

TEST_F(Program, DescribeShowsWhatShapesGave) {
  const std::string scene = scene_file("welded_boom.yaml");
  const CommandResult text = slewring({"describe", scene});
  EXPECT_TRUE(
      contains(text.out, "Boom from 4 parts: 0.0277639 m3 of 7850 kg/m3, 217.947 kg; centre of mass [1.49476, 0, 0]"))
      << text.out << text.err;
  const nlohmann::json json = nlohmann::json::parse(slewring({"describe", scene, "--json"}).out);
  const nlohmann::json& boom = json.at("mechanics").at("mass_properties").at(0);
  EXPECT_EQ(boom.at("shapes").at("solid"), "4 parts");
  EXPECT_NEAR(boom.at("shapes").at("density").get<double>(), 7850, 1e-9);
  EXPECT_FALSE(boom.contains("mesh"));
}

TEST_F(Program, ImportMakesASceneThatIsCheckedAndRuns) {
  const std::string urdf = std::string(SLEWRING_SOURCE_DIR) + "/examples/urdf/two_link_arm.urdf";
  const std::string scene = work_.path() / "arm.yaml";
  const CommandResult made = slewring({"import", "urdf", urdf, "-o", scene});
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_TRUE(contains(made.out, "2 bodies, 2 joints, 1 shape, 6 notes on what was not taken over")) << made.out;
  EXPECT_EQ(slewring({"check", scene}).code, 0);
  const CommandResult ran = slewring({"run", scene, "--in-process", "--pace", "free", "--duration", "1 s"});
  EXPECT_EQ(ran.code, 0) << ran.err;

  const CommandResult again = slewring({"import", "urdf", urdf, "-o", scene});
  EXPECT_EQ(again.code, 2);
  EXPECT_TRUE(contains(again.err, "is there already; nothing was written")) << again.err;
  EXPECT_EQ(slewring({"import", "urdf", urdf, "-o", scene, "--force"}).code, 0);
  EXPECT_EQ(slewring({"import", "urdf", urdf, "-o", "/no/such/folder/arm.yaml"}).code, 6);

  const nlohmann::json json = nlohmann::json::parse(slewring({"import", "urdf", urdf, "--json"}).out);
  EXPECT_EQ(json.at("bodies"), 2);
  EXPECT_EQ(json.at("notes").size(), 6u);
  std::ifstream in(scene);
  EXPECT_EQ(json.at("scene"), std::string(std::istreambuf_iterator<char>(in), {}));
}

TEST_F(Program, ImportNamesTheLineOfAnUnsupportedElement) {
  const std::string urdf = work_.path() / "bad.urdf";
  std::ofstream(urdf) << "<robot name=\"r\">\n<link name=\"a\"/>\n<link name=\"b\"/>\n"
                         "<joint name=\"j\" type=\"gear\"><parent link=\"a\"/><child link=\"b\"/></joint>\n</robot>\n";
  const CommandResult result = slewring({"import", "urdf", urdf});
  EXPECT_EQ(result.code, 2);
  EXPECT_TRUE(contains(result.err, "bad.urdf:4: joint 'j': the type 'gear' is unknown")) << result.err;
}

TEST_F(Program, VariablesOfASceneHaveUnits) {
  const CommandResult result =
      slewring({"variables", scene_file("truck_crane.yaml"), "--only", "Cyl_Lift.*", "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  bool has_force = false;
  for (const nlohmann::json& variable : nlohmann::json::parse(result.out)) {
    EXPECT_TRUE(variable.at("name").get<std::string>().starts_with("Cyl_Lift."));
    if (variable.at("name") == "Cyl_Lift.force") has_force = variable.at("unit") == "N";
  }
  EXPECT_TRUE(has_force);
}

TEST_F(Program, ParametersOfASceneAreListedAndSuggested) {
  const std::string scene = scene_file("truck_crane.yaml");
  EXPECT_TRUE(contains(slewring({"param", "get", "Bag.mass", "--scene", scene}).out, "Bag.mass = 500 kg"));
  const nlohmann::json list =
      nlohmann::json::parse(slewring({"param", "list", "Bag.*", "--live", "--json", "--scene", scene}).out);
  ASSERT_FALSE(list.empty());
  EXPECT_EQ(list.at(0).at("path"), "Bag.mass");
  const CommandResult typo = slewring({"param", "get", "Bag.mas", "--scene", scene});
  EXPECT_EQ(typo.code, 2);
  EXPECT_TRUE(contains(typo.err, "did you mean 'Bag.mass'?")) << typo.err;
}

TEST_F(Program, SchemaIsJson) {
  const nlohmann::json schema = nlohmann::json::parse(slewring({"schema"}).out);
  EXPECT_TRUE(schema.contains("$schema"));
  EXPECT_TRUE(schema.at("properties").contains("bodies"));
  const nlohmann::json flexible = nlohmann::json::parse(slewring({"schema", "--flexible"}).out);
  EXPECT_TRUE(flexible.at("properties").contains("materials"));
  EXPECT_TRUE(contains(slewring({"schema", "--flexible", "--table"}).out, "`youngs_modulus`"));
}

TEST_F(Program, DoctorJudgesThisMachine) {
  const CommandResult result = slewring({"doctor", "--json"});
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(result.code, json.at("fit").get<bool>() ? 0 : 7);
  EXPECT_GE(json.at("findings").size(), 8u);
  const CommandResult nowhere = slewring({"doctor", "--interface", "no_such_if"});
  EXPECT_EQ(nowhere.code, 7);
  EXPECT_TRUE(contains(nowhere.out, "no_such_if")) << nowhere.out;
}

TEST_F(Program, InfoNamesTheGapsOfARecording) {
  recording::SessionIdentity identity;
  identity.scene = "crane";
  identity.communication_step = milliseconds(1);
  std::unique_ptr<recording::Writer> writer;
  const std::filesystem::path path = work_.path() / "gaps.mcap";
  ASSERT_EQ(recording::Writer::create(path, identity, {}, writer).text, "");
  ASSERT_EQ(writer
                ->add_metadata(recording::kGapName, {{"cause", "the disk was slower than the session"},
                                                     {"epoch", "0"},
                                                     {"from_step", "400"},
                                                     {"to_step", "800"},
                                                     {"left_out.health", "3"},
                                                     {"left_out.variables", "123"}})
                .text,
            "");
  ASSERT_EQ(writer->close({{"exit_code", "6"}, {"end", "no room"}}).text, "");
  const CommandResult info = slewring({"info", "gaps.mcap"});
  EXPECT_EQ(info.code, 0) << info.err;
  EXPECT_TRUE(contains(
      info.out, "steps 400 to 800: 3 of health, 123 of variables left out, the disk was slower than the session"))
      << info.out;
  EXPECT_TRUE(contains(info.out, "closed before the session's end, which went on: no room")) << info.out;
}

TEST_F(Program, WhatIsNoRecordingIsRefused) {
  std::ofstream(work_.path() / "text.mcap") << "this is no recording\n";
  for (const char* verb : {"info", "recover", "replay", "export", "plot"}) {
    const CommandResult result = slewring({verb, "text.mcap"});
    EXPECT_EQ(result.code, 2) << verb << result.err;
    EXPECT_TRUE(contains(result.err, "text.mcap")) << verb << result.err;
  }
  EXPECT_NE(slewring({"info", "nowhere.mcap"}).code, 0);
}

TEST_F(Program, KeyboardNeedsATerminal) {
  const CommandResult result = slewring({"run", scene_file("truck_crane.yaml"), "--input", "keyboard", "--in-process"});
  EXPECT_EQ(result.code, 2);
  EXPECT_TRUE(contains(result.err, "standard input is not a terminal")) << result.err;
}

}  // namespace program_test
}  // namespace slew::testing
