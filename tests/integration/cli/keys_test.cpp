// SPDX-License-Identifier: Apache-2.0
// Key stores: made, checked, exported, revoked; sessions with keys, and those who have none.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "command.h"
#include "tests/support/nightly.h"
#include "tests/support/test_domain.h"

namespace slew::testing {
namespace keys_test {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class Keys : public ::testing::Test {
 protected:
  CommandResult keys(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "keys");
    return run("slewring", arguments, folder());
  }
  // problem of each identity in check's output; empty: good
  std::map<std::string, std::string> problems(const std::string& store = "plant") {
    const CommandResult result = keys({"check", store, "--json"});
    std::map<std::string, std::string> found;
    for (const auto& one : nlohmann::json::parse(result.out, nullptr, false)) found[one.at("what")] = one.at("problem");
    return found;
  }
  const fs::path& folder() const { return work_.path(); }
  [[nodiscard]] std::string domain() const { return std::to_string(domain_.number()); }

  WorkFolder work_;
  TestDomain domain_;
};

TEST_F(Keys, StoreHasKeysForEveryRoleThatOthersCannotRead) {
  const CommandResult made = keys({"create", "plant"});
  ASSERT_EQ(made.code, 0) << made.err;
  const CommandResult checked = keys({"check", "plant"});
  EXPECT_EQ(checked.code, 0) << checked.out << checked.err;
  for (const char* role :
       {"io", "mechanics", "hydraulics", "flex", "recorder", "sensor", "observer", "controller", "viewer"}) {
    EXPECT_NE(checked.out.find(std::string("ok  ") + role), std::string::npos) << checked.out;
    const fs::perms mode = fs::status(folder() / "plant" / role / "private_key.pem").permissions();
    EXPECT_EQ(mode & (fs::perms::group_all | fs::perms::others_all), fs::perms::none) << role;
  }
  const std::string authority = text_of(folder() / "plant/identity_ca.pem");
  const CommandResult again = keys({"create", "plant"});
  EXPECT_EQ(again.code, 2);
  EXPECT_NE(again.err.find("nothing was changed"), std::string::npos) << again.err;
  EXPECT_EQ(text_of(folder() / "plant/identity_ca.pem"), authority);
}

TEST_F(Keys, CheckFindsWhatIsNotInOrder) {
  ASSERT_EQ(keys({"create", "plant"}).code, 0);
  ASSERT_EQ(keys({"create", "other"}).code, 0);
  const auto copy = [&](const char* from, const char* to) {
    fs::copy_file(folder() / from, folder() / to, fs::copy_options::overwrite_existing);
  };
  copy("plant/flex/private_key.pem", "plant/io/private_key.pem");
  copy("other/mechanics/certificate.pem", "plant/mechanics/certificate.pem");
  copy("plant/flex/permissions.p7s", "plant/hydraulics/permissions.p7s");
  copy("other/recorder/permissions.p7s", "plant/recorder/permissions.p7s");
  fs::permissions(folder() / "plant/observer/private_key.pem", fs::perms::others_read, fs::perm_options::add);
  // a permission that was widened by hand
  std::string granted = text_of(folder() / "plant/controller/permissions.p7s");
  granted.replace(granted.find("slewring/controller_input"), 25, "slewring/control_requests");
  std::ofstream(folder() / "plant/controller/permissions.p7s", std::ios::binary) << granted;
  auto found = problems();
  EXPECT_EQ(found["io"], "the private key is not that of the certificate");
  EXPECT_NE(found["mechanics"].find("the certificate is not good"), std::string::npos) << found["mechanics"];
  EXPECT_EQ(found["hydraulics"], "the permissions are those of another certificate");
  EXPECT_NE(found["recorder"].find("is not signed by"), std::string::npos) << found["recorder"];
  EXPECT_NE(found["observer"].find("other users may read"), std::string::npos) << found["observer"];
  EXPECT_NE(found["controller"].find("is not signed by"), std::string::npos) << found["controller"];
  EXPECT_EQ(found["flex"], "");
  EXPECT_EQ(keys({"check", "plant"}).code, 1);
  EXPECT_EQ(keys({"check", "nowhere"}).code, 2);
}

TEST_F(Keys, ExportTakesWhatHoldersNeedAndRevocationMakesItWorthless) {
  ASSERT_EQ(keys({"create", "plant"}).code, 0);
  ASSERT_EQ(keys({"add", "plant", "--name", "joystick", "--session", "truck_*"}).code, 0);
  EXPECT_EQ(keys({"add", "plant", "--name", "joystick"}).code, 2);
  EXPECT_EQ(keys({"add", "plant", "--name", "a/b"}).code, 2);
  EXPECT_EQ(keys({"export", "plant", "absent", "--to", "out"}).code, 2);
  EXPECT_FALSE(fs::exists(folder() / "out"));
  ASSERT_EQ(keys({"export", "plant", "joystick", "hydraulics", "--to", "out"}).code, 0);
  EXPECT_FALSE(fs::exists(folder() / "out/identity_ca.key"));
  EXPECT_FALSE(fs::exists(folder() / "out/permissions_ca.key"));
  EXPECT_FALSE(fs::exists(folder() / "out/mechanics"));
  EXPECT_EQ(problems("out")["joystick"], "");
  const CommandResult revoked = keys({"revoke", "plant", "joystick"});
  ASSERT_EQ(revoked.code, 0) << revoked.err;
  EXPECT_FALSE(fs::exists(folder() / "plant/joystick"));
  EXPECT_EQ(keys({"check", "plant"}).code, 0);
  // the exported keys belong to the former authority
  const CommandResult mixed = keys({"export", "plant", "hydraulics", "--to", "out"});
  EXPECT_EQ(mixed.code, 2);
  EXPECT_NE(mixed.err.find("before a revocation"), std::string::npos) << mixed.err;
  EXPECT_EQ(keys({"revoke", "plant", "joystick"}).code, 2);
}

TEST_F(Keys, AreRevokedHoweverTheStoreIsNamed) {
  ASSERT_EQ(keys({"create", "plant/"}).code, 0);
  fs::create_directory_symlink(folder() / "plant", folder() / "linked");
  std::vector<std::string> names = {"./plant//", "linked/"};
  if (is_nightly()) names.insert(names.end(), {"plant/", "linked"});
  for (const std::string& store : names) {
    ASSERT_EQ(keys({"add", store, "--name", "joystick"}).code, 0) << store;
    const std::string authority = text_of(folder() / "plant/identity_ca.pem");
    const CommandResult revoked = keys({"revoke", store, "joystick"});
    EXPECT_EQ(revoked.code, 0) << store << revoked.err;
    EXPECT_FALSE(fs::exists(folder() / "plant/joystick")) << store;
    EXPECT_NE(text_of(folder() / "plant/identity_ca.pem"), authority) << store;
    EXPECT_EQ(keys({"check", store}).code, 0) << store;
  }
  // nothing is left beside the store or in it
  for (const auto& entry : fs::recursive_directory_iterator(folder())) {
    const std::string end = entry.path().extension();
    EXPECT_TRUE(end != ".new" && end != ".old") << entry.path();
  }
  EXPECT_EQ(keys({"export", "plant/", "flex", "--to", "out/"}).code, 0);
  EXPECT_EQ(problems("out/")["flex"], "");
}

TEST_F(Keys, LeaveFoldersAndFilesOfOthersAsTheyAre) {
  constexpr fs::perms kOpen = fs::perms::owner_all | fs::perms::group_read | fs::perms::group_exec;
  const auto mode = [&](const char* path) { return fs::status(folder() / path).permissions(); };
  const auto make_folder = [&](const char* path) {
    fs::create_directory(folder() / path);
    fs::permissions(folder() / path, kOpen);
  };
  // an empty folder that is there keeps its mode; keys are private in it
  make_folder("plant");
  ASSERT_EQ(keys({"create", "plant"}).code, 0);
  EXPECT_EQ(mode("plant"), kOpen);
  for (const char* key : {"plant/identity_ca.key", "plant/permissions_ca.key", "plant/io/private_key.pem"}) {
    EXPECT_EQ(mode(key), fs::perms::owner_read | fs::perms::owner_write) << key;
  }
  // one with something else in it is refused, also the store itself
  make_folder("home");
  std::ofstream(folder() / "home/letter") << "dear";
  for (const char* to : {"home", "home/letter", "plant"}) {
    const CommandResult refused = keys({"export", "plant", "io", "--to", to});
    EXPECT_EQ(refused.code, 2) << to;
    EXPECT_NE(refused.err.find("nothing was copied"), std::string::npos) << refused.err;
  }
  EXPECT_EQ(keys({"create", "home/letter"}).code, 2);
  EXPECT_EQ(mode("home"), kOpen);
  EXPECT_FALSE(fs::exists(folder() / "home/io"));
  make_folder("out");
  ASSERT_EQ(keys({"export", "plant", "io", "--to", "out"}).code, 0);
  EXPECT_EQ(mode("out"), kOpen);
  EXPECT_EQ(mode("out/io/private_key.pem"), fs::perms::owner_read | fs::perms::owner_write);
  // foreign files beside the store and in it survive a revocation
  for (const char* path : {"plant.old", "plant.new", "plant/notes"}) {
    make_folder(path);
    std::ofstream(folder() / path / "text") << path;
  }
  ASSERT_EQ(keys({"revoke", "plant", "flex"}).code, 0);
  for (const char* path : {"plant.old", "plant.new", "plant/notes"}) {
    EXPECT_EQ(text_of(folder() / path / "text"), path);
  }
  EXPECT_EQ(mode("plant"), kOpen);
  EXPECT_FALSE(fs::exists(folder() / "plant/flex"));
  EXPECT_EQ(keys({"check", "plant"}).code, 0);
  for (const auto& entry : fs::directory_iterator(folder())) {
    EXPECT_FALSE(entry.path().filename().string().starts_with("plant.") && entry.path().extension() != ".old" &&
                 entry.path().extension() != ".new")
        << entry.path();
  }
}

TEST_F(Keys, AreNotAddedUnderANameThatIsSomethingElse) {
  ASSERT_EQ(keys({"create", "plant"}).code, 0);
  fs::create_directory(folder() / "plant/notes");
  fs::create_symlink("nowhere", folder() / "plant/link");
  std::map<std::string, std::string> before;
  const auto all = [&] {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder() / "plant")) {
      files[entry.path()] = entry.is_regular_file() ? text_of(entry.path()) : "";
    }
    return files;
  };
  before = all();
  for (const std::string name : {"identity_ca.key", "permissions_ca.pem", "governance.p7s", "identities.json", "..",
                                 ".", ".next", "notes", "link"}) {
    const CommandResult refused = keys({"add", "plant", "--name", name});
    EXPECT_EQ(refused.code, 2) << name;
    EXPECT_NE(refused.err.find("nothing was changed"), std::string::npos) << refused.err;
    EXPECT_EQ(all(), before) << name;
  }
  EXPECT_EQ(keys({"check", "plant"}).code, 0);
}

TEST_F(Keys, AreGoodFromADayBeforeTheyWereMade) {
  ASSERT_EQ(keys({"create", "plant", "--days", "30"}).code, 0);
  const auto now = std::chrono::system_clock::now();
  for (const char* file : {"identity_ca.pem", "permissions_ca.pem", "io/certificate.pem", "viewer/certificate.pem"}) {
    const auto is_good = [&](std::chrono::hours later) {
      const auto at = std::chrono::system_clock::to_time_t(now + later);
      return run("/usr/bin/openssl",
                 {"verify", "-attime", std::to_string(at), "-CAfile",
                  (folder() / "plant" / (file[0] == 'p' ? "permissions_ca.pem" : "identity_ca.pem")).string(),
                  (folder() / "plant" / file).string()},
                 folder())
                 .code == 0;
    };
    EXPECT_FALSE(is_good(std::chrono::hours(-25))) << file;
    EXPECT_TRUE(is_good(std::chrono::hours(-23))) << file;
    EXPECT_TRUE(is_good(std::chrono::hours(24 * 30 - 1))) << file;
    EXPECT_FALSE(is_good(std::chrono::hours(24 * 30 + 1))) << file;
  }
}

TEST_F(Keys, ThatHaveExpiredAreRefusedAndReported) {
  ASSERT_EQ(keys({"create", "plant"}).code, 0);
  const fs::path io = folder() / "plant/io", store = folder() / "plant";
  const auto openssl = [&](const std::vector<std::string>& arguments) {
    const CommandResult result = run("/usr/bin/openssl", arguments, folder());
    ASSERT_EQ(result.code, 0) << result.err;
  };
  const auto start = [&] {
    return run("slewring",
               {"node", "io", scene_file("first_steps.yaml"), "--session", "t", "--domain", domain(), "--keys", "plant",
                "--join-timeout", "1"},
               folder());
  };
  const auto expect_refused = [&] {
    const CommandResult refused = start();
    EXPECT_EQ(refused.code, 2) << refused.err;
    EXPECT_NE(refused.err.find("the keys of this process are not valid; nothing was started; 'slewring keys check' "
                               "lists their problems"),
              std::string::npos)
        << refused.err;
  };
  EXPECT_EQ(start().code, 1) << "valid keys, and no other process";
  // permissions whose time is over
  const std::string permissions = text_of(io / "permissions.p7s");
  std::string over = text_of(io / "permissions.xml");
  const std::size_t at = over.find("<not_after>") + std::string("<not_after>").size();
  over.replace(at, 4, "2020");
  over.replace(over.find("<not_before>") + std::string("<not_before>").size(), 4, "2019");
  std::ofstream(io / "over.xml", std::ios::binary) << over;
  openssl({"smime", "-sign", "-in", (io / "over.xml").string(), "-text", "-out", (io / "permissions.p7s").string(),
           "-signer", (store / "permissions_ca.pem").string(), "-inkey", (store / "permissions_ca.key").string()});
  expect_refused();
  EXPECT_EQ(problems()["io"], "the permissions have expired");
  std::ofstream(io / "permissions.p7s", std::ios::binary) << permissions;
  EXPECT_EQ(problems()["io"], "");
  // a certificate whose time is over
  std::ofstream(folder() / "openssl.cnf") << "[req]\nprompt = no\ndistinguished_name = name\n[name]\nO = Slewring\n";
  openssl({"req", "-new", "-config", (folder() / "openssl.cnf").string(), "-key", (io / "private_key.pem").string(),
           "-out", (io / "request.pem").string(), "-subj", "/O=Slewring/CN=io"});
  openssl({"x509", "-req", "-in", (io / "request.pem").string(), "-CA", (store / "identity_ca.pem").string(), "-CAkey",
           (store / "identity_ca.key").string(), "-set_serial", "0x77", "-days", "-1", "-out",
           (io / "certificate.pem").string()});
  expect_refused();
  EXPECT_NE(problems()["io"].find("certificate has expired"), std::string::npos) << problems()["io"];
}

TEST_F(Keys, AViewerLooksOnAndCanDoNothing) {
  ASSERT_EQ(keys({"create", "plant"}).code, 0);
  ASSERT_EQ(keys({"export", "plant", "viewer", "--to", "glass"}).code, 0);
  Command session("slewring",
                  {"run", scene_file("truck_crane.yaml"), "--keys", "plant", "--domain", domain(), "--session", "t",
                   "--duration", "0", "--step", "10 ms", "--json"},
                  folder());
  const auto run_verb = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--session", "t", "--domain", domain(), "--keys", "glass", "--identity", "viewer"});
    return run("slewring", more, folder());
  };
  ASSERT_TRUE(wait_until([&] {
    return run_verb({"watch", "Bag.position.y", "--count", "2"}).code == 0;
  })) << session.err();
  const CommandResult named = run_verb({"variables"});
  EXPECT_EQ(named.code, 0) << named.err;
  EXPECT_NE(named.out.find("Bag.position.y"), std::string::npos) << named.out;
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"control", "stop"}, {"control", "reset"}, {"param", "set", "Bag.mass=900"}}) {
    const CommandResult refused = run_verb(arguments);
    EXPECT_EQ(refused.code, 2) << arguments.back() << refused.err;
    EXPECT_NE(refused.err.find("the keys of this process do not allow it"), std::string::npos) << refused.err;
  }
  EXPECT_FALSE(session.has_ended());
  const CommandResult stopped =
      run("slewring", {"control", "stop", "--session", "t", "--domain", domain(), "--keys", "plant"}, folder());
  EXPECT_EQ(stopped.code, 0) << stopped.err;
  EXPECT_EQ(session.wait().code, 0);
}

// a session whose processes get no time for a while, as on a busy machine
TEST_F(Keys, SessionsThatAnswerLateAreListed) {
  ASSERT_EQ(keys({"create", "plant"}).code, 0);
  Command session("slewring",
                  {"run", scene_file("first_steps.yaml"), "--keys", "plant", "--domain", domain(), "--session", "late",
                   "--duration", "0", "--step", "10 ms", "--no-record", "--set", "session.give_up_after=60s"},
                  folder());
  const std::vector<std::string> list = {"sessions", "--keys", "plant", "--domain", domain(), "--json"};
  ASSERT_TRUE(wait_until([&] { return run("slewring", list, folder()).out.find("late") != std::string::npos; }))
      << session.err();
  std::vector<pid_t> nodes;
  for (const char* program : {"io_node", "mechanics_node"}) {
    nodes.push_back(child_of(session.pid(), program));
    ASSERT_GT(nodes.back(), 0) << program;
  }
  for (const pid_t node : nodes) ASSERT_EQ(kill(node, SIGSTOP), 0);
  Command late("slewring", list, folder());
  const auto begin = std::chrono::steady_clock::now();
  static_cast<void>(wait_until(
      [&] { return late.has_ended() || std::chrono::steady_clock::now() - begin > std::chrono::seconds(2); }));
  EXPECT_FALSE(late.has_ended());
  for (const pid_t node : nodes) ASSERT_EQ(kill(node, SIGCONT), 0);
  const CommandResult listed = late.wait();
  EXPECT_NE(listed.out.find("late"), std::string::npos) << listed.out << listed.err << session.err();
  session.send(SIGINT);
}

TEST_F(Keys, SessionWithKeysGivesTheBitsOfOneWithout) {
  ASSERT_EQ(keys({"create", "plant"}).code, 0);
  const CommandResult result = run("slewring",
                                   {"run", scene_file("truck_crane.yaml"), "--keys", "plant", "--domain", domain(),
                                    "--duration", "1", "--pace", "free", "--json"},
                                   folder());
  ASSERT_EQ(result.code, 0) << result.err;
  const CommandResult replayed = run("slewring", {"replay", work_.recording().string(), "--verify"}, folder());
  EXPECT_EQ(replayed.code, 0) << replayed.out << replayed.err;
}

// The observer of a run that is not recorded reads the samples; key stores of an earlier version did not let it.
TEST_F(Keys, FlagsAreReportedWithoutARecordingOrAsMissing) {
  std::ofstream(folder() / "closed.yaml")
      << "volumes:\n  Vol_P: {rigid_volume: 1 l}\n  Vol_T: {initial_pressure: 1 bar, fixed: true}\n"
         "components:\n  Pump: {type: ls_pump, port_a: Vol_P, port_b: Vol_T, speed: 1500 rpm, displacement: 28 cc/rev, "
         "standby_pressure: 10000 bar, time_constant: 1 ms}\n"
         "session: {duration: 0.5 s, pace: free}\n";
  ASSERT_EQ(keys({"create", "plant"}).code, 0);
  const auto notes = [&] {
    const CommandResult result =
        run("slewring",
            {"run", "closed.yaml", "--input", "none", "--keys", "plant", "--domain", domain(), "--no-record", "--json"},
            folder());
    EXPECT_EQ(result.code, 0) << result.err;
    return nlohmann::json::parse(result.out, nullptr, false)["notes"].dump();
  };
  // an observer whose handshake ends after the first ticks reports what it has missed, here perhaps all that was
  // flagged
  bool has_flags = false;
  for (int i = 0; i < 20 && !has_flags; ++i) {
    const std::string reported = notes();
    has_flags = reported.find("Vol_P: a pressure was beyond the range of the oil's law") != std::string::npos;
    EXPECT_TRUE(has_flags || reported.find("did not arrive here") != std::string::npos) << reported;
  }
  EXPECT_TRUE(has_flags);
  const fs::path observer = folder() / "plant/observer";
  std::string narrower = text_of(observer / "permissions.xml");
  for (const std::string topic : {"slewring/mechanism", "slewring/actuators"}) {
    const std::size_t at = narrower.find("<topic>" + topic + "</topic>");
    ASSERT_NE(at, std::string::npos) << narrower;
    narrower.erase(at, topic.size() + 15);
  }
  std::ofstream(observer / "permissions.xml", std::ios::binary) << narrower;
  const CommandResult made =
      run("/usr/bin/openssl",
          {"smime", "-sign", "-in", (observer / "permissions.xml").string(), "-text", "-out",
           (observer / "permissions.p7s").string(), "-signer", (folder() / "plant/permissions_ca.pem").string(),
           "-inkey", (folder() / "plant/permissions_ca.key").string()},
          folder());
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_NE(notes().find("the flags of the steps are missing"), std::string::npos) << notes();
}

// CVE-2023-24011: Cyclone 0.10.2 takes permissions that any certificate of the authority has signed
TEST_F(Keys, HoldersCannotGrantThemselvesMore) {
  ASSERT_EQ(keys({"create", "plant"}).code, 0);
  ASSERT_EQ(keys({"add", "plant", "--role", "io", "--name", "guest", "--session", "foo_*"}).code, 0);
  const fs::path guest = folder() / "plant/guest";
  std::string wider = text_of(guest / "permissions.xml");
  for (std::size_t at = wider.find("foo_*"); at != std::string::npos; at = wider.find("foo_*"))
    wider.replace(at, 5, "*");
  std::ofstream(guest / "wider.xml", std::ios::binary) << wider;
  const auto start = [&] {
    return run("slewring",
               {"node", "io", scene_file("first_steps.yaml"), "--session", "t", "--domain", domain(), "--keys", "plant",
                "--identity", "guest", "--join-timeout", "1"},
               folder());
  };
  EXPECT_EQ(start().code, 2);
  const CommandResult signs = run(
      "/usr/bin/openssl",
      {"smime", "-sign", "-in", (guest / "wider.xml").string(), "-text", "-out", (guest / "permissions.p7s").string(),
       "-signer", (guest / "certificate.pem").string(), "-inkey", (guest / "private_key.pem").string()},
      folder());
  ASSERT_EQ(signs.code, 0) << signs.err;
  EXPECT_NE(problems()["guest"].find("is not signed by"), std::string::npos);
  const CommandResult forged = start();
  EXPECT_EQ(forged.code, 2) << forged.err;
  EXPECT_NE(forged.err.find("the keys of this process are not valid"), std::string::npos) << forged.err;
}

TEST_F(Keys, AProcessWithWrongOnesOrNoneIsIgnoredAndReported) {
  ASSERT_EQ(keys({"create", "plant"}).code, 0);
  ASSERT_EQ(keys({"create", "other"}).code, 0);
  ASSERT_EQ(keys({"add", "plant", "--role", "hydraulics", "--name", "guest", "--session", "foo_*"}).code, 0);
  Command session("slewring",
                  {"run", scene_file("truck_crane.yaml"), "--keys", "plant", "--domain", domain(), "--session", "t",
                   "--remote", "hydraulics", "--duration", "1", "--pace", "free", "--json", "--join-timeout", "60"},
                  folder());
  // all at once, while the session waits for its hydraulics
  const auto hydraulics = [&](const char* timeout, std::vector<std::string> more) {
    more.insert(more.begin(),
                {"node", "hydraulics", "--session", "t", "--domain", domain(), "--session-timeout", timeout});
    return std::make_unique<Command>("slewring", more, folder());
  };
  const auto with_none = hydraulics("2", {}), with_others = hydraulics("60", {"--keys", "other"}),
             as_guest = hydraulics("60", {"--keys", "plant", "--identity", "guest"}),
             as_absent = hydraulics("2", {"--keys", "plant", "--identity", "absent"});
  const CommandResult none = with_none->wait();
  EXPECT_EQ(none.code, 1);
  EXPECT_NE(none.err.find("no session was found within 2 s"), std::string::npos) << none.err;
  EXPECT_NE(none.err.find("--keys"), std::string::npos) << none.err;
  const auto prints = [](const Command& command, const char* text) {
    return wait_until([&] { return command.err().find(text) != std::string::npos; });
  };
  EXPECT_TRUE(prints(*with_others, "Certificate not valid")) << with_others->err();
  with_others->send(SIGINT);
  EXPECT_NE(with_others->wait().code, 0);
  const CommandResult guest = as_guest->wait();
  EXPECT_EQ(guest.code, 2);
  EXPECT_NE(guest.err.find("the keys of this process do not allow it"), std::string::npos) << guest.err;
  const CommandResult unknown = as_absent->wait();
  EXPECT_EQ(unknown.code, 2);
  EXPECT_NE(unknown.err.find("has no keys of 'absent'"), std::string::npos) << unknown.err;
  // the one that came with a certificate is named
  EXPECT_TRUE(prints(session, "/O=Slewring/CN=hydraulics")) << session.err();
  session.send(SIGINT);
  EXPECT_NE(session.wait().code, 0);
}

}  // namespace keys_test
}  // namespace slew::testing
