// `slewring keys create|add|revoke|check|export`: who may take part in sessions that leave this machine.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/display.h"
#include "cli/keys/key_store.h"
#include "cli/verbs.h"
#include "cli_support/session_options.h"

namespace slew::cli {
namespace {

constexpr int kUsualDays = 730, kMostDays = 3650;

struct Options {
  std::string store, name, role = "controller", session = "*", to;
  std::vector<std::string> names;
  int days = kUsualDays;
  bool is_json = false;
};

ExitCode create(const Options& options) {
  const KeyStore store = KeyStore::create(options.store, options.session, options.days);
  fmt::print("{}: authorities, and keys for {} roles, valid for {} days\n", options.store, store.identities().size(),
             options.days);
  fmt::print("next: slewring keys export {} hydraulics --to DIR, and DIR to the machine that computes the hydraulics\n",
             options.store);
  return ExitCode::ok;
}

ExitCode add(const Options& options) {
  KeyIdentity identity{options.name.empty() ? options.role : options.name, options.role, options.session, options.days};
  KeyStore store = KeyStore::open(options.store);
  store.add(identity);
  fmt::print("{}: keys for '{}' as {}, for sessions '{}'\n", options.store, identity.name, options.role,
             identity.session);
  return ExitCode::ok;
}

ExitCode revoke(const Options& options) {
  KeyStore store = KeyStore::open(options.store);
  store.revoke(options.name);
  fmt::print(
      "{}: '{}' is revoked: there are new authorities, and the keys of the {} others are new\n"
      "next: export them to every machine again; sessions that run go on with the old ones until they end\n",
      options.store, options.name, store.identities().size());
  return ExitCode::ok;
}

ExitCode check(const Options& options) {
  const std::vector<KeyFinding> findings = check_keys(options.store);
  std::vector<std::vector<std::string>> rows;
  nlohmann::json json = nlohmann::json::array();
  bool is_good = true;
  for (const KeyFinding& finding : findings) {
    const std::string what = finding.identity.empty() ? "authorities" : finding.identity;
    is_good = is_good && finding.problem.empty();
    json.push_back({{"what", what}, {"problem", finding.problem}, {"expires", finding.expires}});
    const std::string text = finding.problem.empty() ? "until " + finding.expires : finding.problem;
    rows.push_back({finding.problem.empty() ? "ok" : "BAD", what, text});
  }
  fmt::print("{}", options.is_json ? json.dump(2) + '\n' : table_text(rows, ""));
  return is_good ? ExitCode::ok : ExitCode::failed;
}

ExitCode export_keys(const Options& options) {
  KeyStore::open(options.store).export_to(options.to, options.names);
  fmt::print("{}: {} for --keys there; the authorities' own keys stay in {}\n", options.to,
             fmt::join(options.names, ", "), options.store);
  return ExitCode::ok;
}

}  // namespace

void add_keys(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand("keys", "keys for sessions over a network: who may take part");
  verb->require_subcommand(1);
  const auto options = std::make_shared<Options>();  // lives as long as the command line's callbacks
  const auto sub = [&](const char* name, const char* text, ExitCode (*act)(const Options&), const char* example) {
    CLI::App* one = verb->add_subcommand(name, text);
    one->footer(fmt::format("Example:\n  slewring keys {} {}", name, example));
    one->add_option("store", options->store, "folder of the key store")->required()->type_name("STORE");
    one->callback([&action, options, act] { action = [options, act] { return act(*options); }; });
    return one;
  };
  const auto add_validity = [&](CLI::App* one) {
    one->add_option("--days", options->days, "validity")
        ->check(CLI::Range(1, kMostDays))
        ->type_name("N")
        ->capture_default_str();
    one->add_option("--session", options->session, "sessions that the keys are for, with * and ?")
        ->type_name("PATTERN")
        ->capture_default_str();
  };
  add_validity(sub("create", "a new store with keys for every role", create, "plant_keys --days 365"));
  CLI::App* adding =
      sub("add", "keys for one more: a second controller, somebody who only looks on, a guest for one session", add,
          "plant_keys --role controller --name joystick --session 'truck_*'");
  adding->add_option("--role", options->role, "what it may say and hear")
      ->check(CLI::IsMember(key_roles()))
      ->type_name("ROLE")
      ->capture_default_str();
  adding->add_option("--name", options->name, "its name; without it the role's")->type_name("NAME");
  add_validity(adding);
  CLI::App* revoking =
      sub("revoke", "lets one take part no longer, and makes all other keys anew", revoke, "plant_keys joystick");
  revoking->add_option("name", options->name, "whose keys")->required()->type_name("NAME");
  CLI::App* checking =
      sub("check", "signatures, validity and permissions of a store or of what was exported", check, "plant_keys");
  checking->add_flag("--json", options->is_json, "print JSON and nothing else");
  CLI::App* exporting = sub("export", "copies what the holders of these keys need", export_keys,
                            "plant_keys hydraulics recorder --to for_crane2");
  exporting->add_option("names", options->names, "whose keys")->required()->type_name("NAME");
  exporting->add_option("--to", options->to, "folder to copy into")->required()->type_name("DIR");
  verb->footer(
      "What is protected and what is not: docs/security.md.\n\n"
      "Examples:\n"
      "  slewring keys create plant_keys\n"
      "  slewring keys export plant_keys hydraulics recorder --to for_crane2\n"
      "  slewring run scenes/truck_crane.yaml --keys plant_keys --interface eth0 --peer 192.168.1.20 --remote "
      "hydraulics\n"
      "  slewring keys add plant_keys --role controller --name joystick --session 'truck_*'");
}

}  // namespace slew::cli
