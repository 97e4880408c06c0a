// SPDX-License-Identifier: Apache-2.0
#include "view_node/window_options.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "gateway/door.h"

namespace slew::view_node {
namespace {

std::string problem_of_origin(const std::string& origin) {
  if (gateway::is_origin(origin)) return "";
  return "'" + origin +
         "' is no origin as browsers send it: scheme and name, and a port unless it is the scheme's own, such as "
         "https://app.foxglove.dev";
}

std::string problem_of_page(const std::string& folder) {
  std::error_code error;
  if (std::filesystem::is_regular_file(std::filesystem::path(folder) / "index.html", error)) return "";
  return "'" + folder + "' has no index.html";
}

}  // namespace

void add_window_options(options::Command& verb, WindowOptions& options) {
  verb.option("--port", options.port, "TCP port of the page and of the Foxglove protocol; 0: any free one")
      .between(std::uint32_t{0}, std::uint32_t{65535})
      .value_name("PORT")
      .show_default()
      .group("Window");
  verb.option("--listen", options.listen, "address to listen on; one beyond this machine needs --token-file")
      .value_name("ADDRESS")
      .show_default()
      .group("Window");
  verb.option("--token-file", options.token_file, "file whose first line clients must add to the address as ?token=...")
      .value_name("FILE")
      .group("Window");
  verb.option("--host", options.hosts, "accept this name of the machine in addresses; repeat for more")
      .one_value_each()
      .value_name("NAME")
      .group("Window");
  verb.option("--allow-origin", options.origins,
              "accept pages of this origin, such as https://app.foxglove.dev; repeat for more")
      .check(problem_of_origin, "origin")
      .one_value_each()
      .value_name("ORIGIN")
      .group("Window");
  verb.flag("--browser,!--no-browser", options.opens_browser,
            "open the page in the browser of the desktop, where there is one (default; not with --json)")
      .group("Window");
  verb.flag("--view-only", options.is_looking_only, "no parameters, no services, no inputs").group("Window");
  verb.option("--saves", options.saves, "folder in which clients save and load states of the session")
      .value_name("DIR")
      .show_default()
      .group("Window");
  verb.option("--assets", options.assets,
              "folder with the scene's meshes for the eye; without it that of the scene or recording, else this one")
      .value_name("DIR")
      .group("Window");
  verb.option("--beside", options.beside,
              "with a recording: show the curves of this one as well in its plots; repeat for more")
      .one_value_each()
      .value_name("REC")
      .group("Window");
  verb.option("--web", options.web, "folder of the page; without it the installed one")
      .check(problem_of_page, "folder")
      .value_name("DIR")
      .group("Window");
}

std::vector<std::string> window_arguments(const WindowOptions& options) {
  std::vector<std::string> arguments = {
      "--port",       std::to_string(options.port), "--listen",
      options.listen, "--session-timeout",          fmt::format("{}", options.session_timeout)};
  const auto add = [&](const char* name, const std::string& value) {
    if (!value.empty()) arguments.insert(arguments.end(), {name, value});
  };
  add("--token-file", options.token_file);
  for (const std::string& host : options.hosts) add("--host", host);
  for (const std::string& origin : options.origins) add("--allow-origin", origin);
  for (const std::string& recording : options.beside) add("--beside", recording);
  add("--web", options.web);
  add("--saves", options.saves);
  add("--assets", options.assets);
  add("--scene", options.scene);
  for (const std::string& setting : options.set) add("--set", setting);
  if (!options.opens_browser) arguments.emplace_back("--no-browser");
  if (options.is_looking_only) arguments.emplace_back("--view-only");
  if (options.is_json) arguments.emplace_back("--json");
  if (!options.recording.empty()) arguments.push_back(options.recording);
  // of a recording: for a live session that goes on from it
  add("--session", options.session.session);
  const std::vector<std::string> network = node::network_arguments(options.session);
  arguments.insert(arguments.end(), network.begin(), network.end());
  return arguments;
}

}  // namespace slew::view_node
