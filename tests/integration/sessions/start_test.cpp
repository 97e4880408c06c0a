// SPDX-License-Identifier: Apache-2.0
// Programs that cannot take part in a session: nothing is started; the message has the cause and the remedy.
#include <gtest/gtest.h>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "namespaces.h"
#include "session.h"

namespace slew::testing {
namespace start_test {

using wire::Role;

TEST(Start, ANodeThatTheSceneDoesNotNeedLeaves) {
  Session session({"--pace", "real", "--duration", "20s"});
  session.start(Role::io);
  Program& flex = session.start(Role::flex);
  EXPECT_EQ(flex.wait(), 2);
  EXPECT_NE(flex.err().find("needs no flex node; nothing to do here"), std::string::npos) << flex.err();
  EXPECT_TRUE(session.node(Role::io).is_running()) << session.errors();
}

TEST(Start, AnInterfaceThatIsNotThereIsNamedBesideThoseThatAre) {
  Session session;
  Program& io = session.start(Role::io, {"--interface", "nosuch0"});
  EXPECT_EQ(io.wait(), 7);
  EXPECT_NE(
      io.err().find("network interface 'nosuch0' does not exist or has no IPv4 address; there are: lo (127.0.0.1)"),
      std::string::npos)
      << io.err();
  EXPECT_NE(io.err().find("; choose one with --interface"), std::string::npos) << io.err();
}

TEST(Start, AnInterfaceThatIsDownIsNamed) {
  NamespacePair cable;
  if (!cable.problem().empty()) GTEST_SKIP() << "network namespaces are not possible here: " << cable.problem();
  cable.unplug();
  const std::string& interface = cable.left().interface;
  Session session;
  session.run_under(Role::io, cable.left().command(), {"--interface", interface, "--insecure-lan"});
  Program& io = session.start(Role::io);
  EXPECT_EQ(io.wait(), 7);
  EXPECT_NE(io.err().find("network interface '" + interface + "' is down; bring it up (ip link set " + interface +
                          " up) or choose another with --interface"),
            std::string::npos)
      << io.err();
}

TEST(Start, AStateThatCannotBeIsRefusedNamingWhatToChange) {
  const std::pair<std::vector<std::string>, std::string> cases[] = {
      {{"--set", "hydraulics.solver=rk4", "--set", "hydraulics.max_substep=1ms"},
       "hydraulics: hydraulics.solver: rk4 with sub-steps of 1 ms would be unstable: Cyl_Jib moves "},
      {{"--set", "Bag.mass=100000kg"}, "hydraulics: hydraulics.start: equilibrium requires "},
  };
  for (const auto& [more, sentence] : cases) {
    const ScratchFolder folder;
    std::vector<std::string> arguments = {
        "run", SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml", "--pace", "free", "--in-process", "--no-record"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Program run(program_path("slewring"), arguments, folder.path() / "run");
    EXPECT_EQ(run.wait(), 1) << run.err();
    EXPECT_NE(run.err().find(sentence), std::string::npos) << run.err();
  }
}

// UDP ports of this host that no other program can have.
class TakenPorts {
 public:
  TakenPorts(std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t port = first; port < first + count; ++port) {
      const int file = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_port = htons(static_cast<std::uint16_t>(port));
      if (file < 0 || bind(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
        throw std::runtime_error("cannot take port " + std::to_string(port));
      }
      files_.push_back(file);
    }
  }
  ~TakenPorts() {
    for (const int file : files_) close(file);
  }
  TakenPorts(const TakenPorts&) = delete;
  TakenPorts& operator=(const TakenPorts&) = delete;

 private:
  std::vector<int> files_;
};

TEST(Start, WithoutAPlaceInTheDomainReportsTheNumberOfPlaces) {
  Session session;
  // two for each process, see RTPS 2.5, 9.6.2
  const TakenPorts taken(7400 + 250 * session.domain() + 10, 2 * 61);
  Program& io = session.start(Role::io);
  EXPECT_EQ(io.wait(), 7);
  EXPECT_NE(io.err().find("cannot join DDS domain " + std::to_string(session.domain()) + " on lo: "), std::string::npos)
      << io.err();
  EXPECT_NE(io.err().find("; 60 processes use DDS domain " + std::to_string(session.domain()) +
                          " on this host: end some or choose another with --domain"),
            std::string::npos)
      << io.err();
}

TEST(Start, ARecorderThatCannotWriteEndsTheSessionBeforeItBegins) {
  Session session({"--pace", "real", "--duration", "20s"});
  session.start(Role::io);
  session.start(Role::mechanics);
  session.start(Role::hydraulics);
  Program recorder(
      program_path("recorder_node"),
      {"--session", session.name(), "--domain", std::to_string(session.domain()), "--out", "/proc/slewring"},
      session.folder() / "recorder_without_folder");
  EXPECT_EQ(recorder.wait(), 6);
  EXPECT_NE(recorder.err().find("/proc/slewring"), std::string::npos) << recorder.err();
  EXPECT_NE(recorder.err().find("--out"), std::string::npos) << recorder.err();
  for (const auto& [role, code] : session.wait_all()) EXPECT_EQ(code, 6) << session.errors();
}

}  // namespace start_test
}  // namespace slew::testing
