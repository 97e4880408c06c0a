// The example controller, built as a user builds it (a project of its own, from idl/ and Cyclone DDS alone), closes its
// loop on a real session.
#include <gtest/gtest.h>

#include "build_paths.h"
#include "direct_chain.h"
#include "session.h"

namespace slew::testing {
namespace {

using wire::Role;

constexpr std::int64_t kBuildNs = 120'000'000'000;

// kept between runs, so that a second one has nothing to compile
constexpr const char* kFolder = SLEWRING_BINARY_DIR "/example_controller";

void build_example() {
  const ScratchFolder output;
  Program configure(SLEWRING_CMAKE, {"-S", SLEWRING_SOURCE_DIR "/examples/controller", "-B", kFolder},
                    output.path() / "configure");
  ASSERT_EQ(configure.wait(kBuildNs), 0) << configure.out() << configure.err();
  Program build(SLEWRING_CMAKE, {"--build", kFolder}, output.path() / "build");
  ASSERT_EQ(build.wait(kBuildNs), 0) << build.out() << build.err();
}

// The example alone, without a session.
class ControllerExampleOptions : public ::testing::Test {
 protected:
  void SetUp() override { build_example(); }
  std::unique_ptr<Program> controller(const std::vector<std::string>& arguments) {
    return std::make_unique<Program>(std::string(kFolder) + "/position_controller", arguments,
                                     output.path() / "controller");
  }
  ScratchFolder output;
};

TEST_F(ControllerExampleOptions, HelpHasAnExample) {
  const auto program = controller({"--help"});
  EXPECT_EQ(program->wait(), 0) << program->err();
  EXPECT_NE(program->out().find("usage: position_controller --session"), std::string::npos) << program->out();
  EXPECT_NE(program->out().find("Example"), std::string::npos) << program->out();
}

TEST_F(ControllerExampleOptions, WhatIsNoNumberMovesNothing) {
  for (const char* option : {"--target", "--tolerance", "--gain", "--overlap", "--seconds", "--domain"}) {
    for (const char* value : {"abc", "", "0.8m", "nan", "inf"}) {
      const auto program = controller({"--session", "nobody", option, value});
      EXPECT_EQ(program->wait(), 2) << option << " '" << value << "' " << program->out();
      EXPECT_NE(program->err().find(std::string("position_controller: ") + option), std::string::npos)
          << program->err();
    }
  }
}

TEST_F(ControllerExampleOptions, WhatIsMissingOrUnknownIsNamed) {
  const struct {
    std::vector<std::string> arguments;
    const char* problem;
  } cases[] = {{{}, "--session: expected the name"},
               {{"--session"}, "--session: expected a value"},
               {{"--session", "nobody", "--domain", "231"}, "--domain: expected a whole number, 0 to 230"},
               {{"--session", "nobody", "--domain", "1.5"}, "--domain: expected a whole number, 0 to 230"},
               {{"--session", "nobody", "--taget", "1"}, "--taget: unknown option"}};
  for (const auto& c : cases) {
    const auto program = controller(c.arguments);
    EXPECT_EQ(program->wait(), 2) << c.problem;
    EXPECT_NE(program->err().find(c.problem), std::string::npos) << program->err();
  }
}

class ControllerExample : public ::testing::Test {
 protected:
  void SetUp() override {
    build_example();
    if (HasFatalFailure()) return;
    session.start_all();
    ASSERT_TRUE(session.observer().wait_for_step(50)) << session.said();
  }
  std::unique_ptr<Program> controller() {
    const std::vector<std::string> arguments = {
        "--session",   session.name(), "--domain",  std::to_string(session.domain()),
        "--target",    "0.84",         "--gain",    "80",
        "--tolerance", "0.002",        "--seconds", "25"};
    return std::make_unique<Program>(std::string(kFolder) + "/position_controller", arguments,
                                     session.folder() / "controller");
  }
  void stop() {
    EXPECT_TRUE(session.observer().request(wire::ControlAction::stop).is_accepted);
    EXPECT_EQ(session.wait_all(), all_ok()) << session.said();
  }

  Session session{{"--pace", "real", "--duration", "60s", "--input", "none"}};
};

TEST_F(ControllerExample, ReachesItsTargetAndTheTicksReproduceTheRun) {
  const std::optional<double> before = [this] {
    static_cast<void>(
        session.observer().wait_until([this] { return session.observer().variable("Cyl_Lift.stroke").has_value(); }));
    return session.observer().variable("Cyl_Lift.stroke");
  }();
  ASSERT_TRUE(before.has_value());
  EXPECT_GT(std::abs(*before - 0.84), 0.005) << "it is there before it has begun";
  const auto program = controller();
  EXPECT_EQ(program->wait(), 0) << program->out() << program->err();
  EXPECT_NE(program->out().find("reached"), std::string::npos) << program->out();
  stop();
  const RecordedSession recorded = session.recorded();
  const scene::Scene scene = load_scene(SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml", "60s");
  EXPECT_EQ(first_difference(chain_of_ticks(scene, recorded.ticks.at(0)), physics_only(recorded.chain())), "");
}

TEST_F(ControllerExample, SaysWhoHoldsTheChannelWhenItIsRefused) {
  ASSERT_TRUE(session.observer().acquire("somebody_else", "Input_Lift").is_granted);
  const auto program = controller();
  EXPECT_EQ(program->wait(), 1) << program->out();
  EXPECT_NE(program->err().find("held by 'somebody_else'"), std::string::npos) << program->err();
  stop();
}

}  // namespace
}  // namespace slew::testing
