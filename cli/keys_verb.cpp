// SPDX-License-Identifier: Apache-2.0
// `slewring keys create|add|revoke|check|export`: keys of the processes that may take part in sessions beyond this
// machine.
#include <fmt/format.h>

#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/display.h"
#include "core/report_table.h"
#include "keys/key_store.h"
#include "node/session_options.h"

namespace slew::cli {
namespace {

constexpr int kUsualDays = 730, kMostDays = 3650;

struct KeysOptions {
  std::string store, name, role = "controller", session = "*", to;
  std::vector<std::string> names;
  int days = kUsualDays;
  bool is_json = false;
};

ExitCode create(const KeysOptions& options) {
  const keys::KeyStore store = keys::KeyStore::create(options.store, options.session, options.days);
  fmt::print("{}: authorities, and keys for {} roles, valid for {} days\n", options.store, store.identities().size(),
             options.days);
  fmt::print("next: slewring keys export {} hydraulics --to DIR, and DIR to the machine that computes the hydraulics\n",
             options.store);
  return ExitCode::ok;
}

ExitCode add(const KeysOptions& options) {
  keys::KeyIdentity identity{options.name.empty() ? options.role : options.name, options.role, options.session,
                             options.days};
  keys::KeyStore store = keys::KeyStore::open(options.store);
  store.add(identity);
  fmt::print("{}: keys for '{}' as {}, for sessions '{}'\n", options.store, identity.name, options.role,
             identity.session);
  return ExitCode::ok;
}

ExitCode revoke(const KeysOptions& options) {
  keys::KeyStore store = keys::KeyStore::open(options.store);
  store.revoke(options.name);
  fmt::print(
      "{}: '{}' is revoked: there are new authorities, and the keys of the {} others are new\n"
      "next: export them to every machine again; sessions that run go on with the old ones until they end\n",
      options.store, options.name, store.identities().size());
  return ExitCode::ok;
}

ExitCode check(const KeysOptions& options) {
  const std::vector<keys::KeyFinding> findings = keys::check_keys(options.store);
  constexpr std::size_t kNaming = 2;  // verdict, owner
  ReportTable table(
      {{.text = ""}, {.text = "", .json = "what"}, {.text = ""}, {.json = "problem"}, {.json = "expires"}}, kNaming);
  bool is_good = true;
  for (const keys::KeyFinding& finding : findings) {
    const std::string what = finding.identity.empty() ? "authorities" : finding.identity;
    is_good = is_good && finding.problem.empty();
    const std::string text = finding.problem.empty() ? "until " + finding.expires : finding.problem;
    table.add({finding.problem.empty() ? "ok" : "BAD", what, text, finding.problem, finding.expires});
  }
  if (options.is_json) {
    fmt::print("{}\n", table.json().dump(2));
  } else {
    print_table(table);
  }
  return is_good ? ExitCode::ok : ExitCode::failed;
}

ExitCode export_keys(const KeysOptions& options) {
  keys::KeyStore::open(options.store).export_to(options.to, options.names);
  fmt::print("{}: {} for --keys there; the authorities' own keys stay in {}\n", options.to,
             fmt::join(options.names, ", "), options.store);
  return ExitCode::ok;
}

}  // namespace

void add_keys(options::Command& program) {
  options::Command verb = program.command("keys", "keys for sessions over a network");
  verb.require_command();
  const auto options = std::make_shared<KeysOptions>();  // lives as long as the command line's callbacks
  const auto sub = [&](const char* name, const char* text, ExitCode (*act)(const KeysOptions&), const char* example) {
    options::Command one = verb.command(name, text);
    one.footer(fmt::format("Example:\n  slewring keys {} {}", name, example));
    one.option("store", options->store, "folder of the key store").required().value_name("STORE");
    one.action([options, act] { return act(*options); });
    return one;
  };
  const auto add_validity = [&](options::Command one) {
    one.option("--days", options->days, "validity").between(1, kMostDays).value_name("N").show_default();
    one.option("--session", options->session, "sessions that the keys are for, with * and ?")
        .value_name("PATTERN")
        .show_default();
  };
  add_validity(sub("create", "a new store with keys for every role", create, "plant_keys --days 365"));
  options::Command adding = sub("add", "keys for one more: a second controller, a viewer, a guest for one session", add,
                                "plant_keys --role controller --name joystick --session 'truck_*'");
  adding.option("--role", options->role, "decides what the holder may publish and receive")
      .one_of(keys::key_roles())
      .value_name("ROLE")
      .show_default();
  adding.option("--name", options->name, "its name; without it the role's").value_name("NAME");
  add_validity(adding);
  options::Command revoking =
      sub("revoke", "revokes the keys of one name, and makes new keys for all others", revoke, "plant_keys joystick");
  revoking.option("name", options->name, "name of the keys").required().value_name("NAME");
  options::Command checking =
      sub("check", "signatures, validity and permissions of a store or of exported keys", check, "plant_keys");
  checking.flag("--json", options->is_json, "print JSON and nothing else");
  options::Command exporting = sub("export", "copies the files that the holders of these keys need", export_keys,
                                   "plant_keys hydraulics recorder --to for_crane2");
  exporting.option("names", options->names, "names of the keys").required().value_name("NAME");
  exporting.option("--to", options->to, "folder to copy into").required().value_name("DIR");
  verb.footer(
      "Scope of the protection: docs/security.md.\n\n"
      "Examples:\n"
      "  slewring keys create plant_keys\n"
      "  slewring keys export plant_keys hydraulics recorder --to for_crane2\n"
      "  slewring run scenes/truck_crane.yaml --keys plant_keys --interface eth0 --peer 192.168.1.20 --remote "
      "hydraulics\n"
      "  slewring keys add plant_keys --role controller --name joystick --session 'truck_*'");
}

}  // namespace slew::cli
