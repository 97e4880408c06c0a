// SPDX-License-Identifier: Apache-2.0
// Includes go downwards only, along the edges of edges.txt.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "build_paths.h"

namespace edges_test {

namespace fs = std::filesystem;

struct Edges {
  std::map<std::string, std::set<std::string>> allowed;               // part -> parts
  std::vector<std::pair<std::string, std::set<std::string>>> system;  // header prefix -> parts
};

Edges read_edges(const fs::path& file) {
  Edges edges;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string first, word;
    words >> first;
    std::set<std::string> names;
    if (first == "system") {
      words >> first;
      while (words >> word) names.insert(word);
      edges.system.emplace_back(first, names);
    } else {
      first.pop_back();  // the colon
      while (words >> word) names.insert(word);
      edges.allowed[first] = names;
    }
  }
  return edges;
}

std::vector<std::string> includes_of(const fs::path& file) {
  std::vector<std::string> headers;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const auto hash = line.find_first_not_of(" \t");
    if (hash == std::string::npos || line.compare(hash, 8, "#include") != 0) continue;
    const auto open = line.find_first_of("<\"", hash);
    const auto close = line.find_first_of(">\"", open + 1);
    if (open != std::string::npos && close != std::string::npos) {
      headers.push_back(line.substr(open + 1, close - open - 1));
    }
  }
  return headers;
}

// every violation of the edges in one part's folder
std::vector<std::string> violations(const Edges& edges, const std::string& part, const fs::path& folder) {
  std::vector<std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension();
    if (extension != ".h" && extension != ".cpp" && extension != ".in") continue;
    for (const std::string& header : includes_of(entry.path())) {
      const std::string where = fs::relative(entry.path(), SLEWRING_SOURCE_DIR).string() + " includes " + header;
      const std::string head = header.substr(0, header.find('/'));
      if (head != part && edges.allowed.contains(head) && !edges.allowed.at(part).contains(head))
        found.push_back(where);
      for (const auto& [prefix, parts] : edges.system) {
        if (header.starts_with(prefix) && !parts.contains(part)) found.push_back(where);
      }
    }
  }
  return found;
}

TEST(Architecture, IncludesFollowTheListedEdges) {
  const fs::path root = SLEWRING_SOURCE_DIR;
  const Edges edges = read_edges(root / "tests/architecture/edges.txt");
  ASSERT_GT(edges.allowed.size(), 10u);
  for (const auto& [part, allowed] : edges.allowed) {
    const fs::path folder = fs::exists(root / "libs" / part) ? root / "libs" / part : root / part;
    if (!fs::exists(folder)) continue;
    for (const std::string& violation : violations(edges, part, folder)) ADD_FAILURE() << violation;
  }
}

// Folders of the sources that are no tests, benchmarks, examples or pages: those of libs/, and those beside it.
std::vector<fs::path> rooms() {
  std::vector<fs::path> found;
  const std::set<std::string> others = {"tests", "benchmarks", "examples", "build", "libs", "web"};
  for (const fs::path& above : {fs::path(SLEWRING_SOURCE_DIR), fs::path(SLEWRING_SOURCE_DIR) / "libs"}) {
    for (const auto& entry : fs::directory_iterator(above)) {
      const std::string name = entry.path().filename();
      const bool is_ours = !others.contains(name) && name[0] != '.';
      if (is_ours && fs::exists(entry.path() / "CMakeLists.txt")) found.push_back(entry.path());
    }
  }
  return found;
}

TEST(Architecture, EveryRoomIsListed) {
  const Edges edges = read_edges(fs::path(SLEWRING_SOURCE_DIR) / "tests/architecture/edges.txt");
  const std::vector<fs::path> found = rooms();
  EXPECT_GT(found.size(), 20u);
  for (const fs::path& room : found) EXPECT_TRUE(edges.allowed.contains(room.filename())) << room;
  EXPECT_EQ(found.size(), edges.allowed.size()) << "edges.txt lists a part that is not there";
}

struct Linked {
  std::string room;
  std::vector<std::string> depends;  // names of libraries
};

// slewring_library(NAME ... DEPENDS ...) and slewring_program(...) of one list, by name.
std::map<std::string, Linked> linked(const fs::path& list, const std::string& room) {
  std::map<std::string, Linked> found;
  std::ifstream in(list);
  std::stringstream whole;
  whole << in.rdbuf();
  const std::string text = whole.str();
  for (const std::string command : {"slewring_library(", "slewring_program(", "add_library(slewring_"}) {
    for (std::size_t at = text.find(command); at != std::string::npos; at = text.find(command, at + 1)) {
      const std::size_t from = at + command.size();
      std::istringstream words(text.substr(from, text.find(')', from) - from));
      std::string word;
      words >> word;
      // a program may have the name of its library
      Linked& entry = found[command == "slewring_program(" ? word + " (program)" : word];
      entry.room = room;
      bool is_depends = false;
      while (words >> word) {
        const bool is_keyword =
            std::all_of(word.begin(), word.end(), [](unsigned char c) { return std::isupper(c) != 0 || c == '_'; });
        if (is_keyword) {
          is_depends = word == "DEPENDS";
        } else if (is_depends) {
          entry.depends.push_back(word);
        }
      }
    }
  }
  return found;
}

// What the linker is given follows the same list as the includes.
std::vector<std::string> forbidden_links(const Edges& edges, const std::map<std::string, Linked>& all) {
  std::vector<std::string> found;
  for (const auto& [name, own] : all) {
    for (const std::string& library : own.depends) {
      const auto other = all.find(library);
      const std::string room = other != all.end() ? other->second.room : "";
      if (room == own.room || (edges.allowed.contains(own.room) && edges.allowed.at(own.room).contains(room))) continue;
      found.push_back(name + " in " + own.room + " depends on " + library +
                      (room.empty() ? ", which is not there" : ""));
    }
  }
  return found;
}

std::map<std::string, Linked> linked_by_all() {
  std::map<std::string, Linked> all;
  for (const fs::path& room : rooms()) {
    for (const auto& entry : fs::recursive_directory_iterator(room)) {
      if (entry.path().filename() == "CMakeLists.txt") all.merge(linked(entry.path(), room.filename()));
    }
  }
  return all;
}

TEST(Architecture, LinksFollowTheListedEdges) {
  const Edges edges = read_edges(fs::path(SLEWRING_SOURCE_DIR) / "tests/architecture/edges.txt");
  const std::map<std::string, Linked> all = linked_by_all();
  EXPECT_GT(all.size(), 20u);
  for (const std::string& violation : forbidden_links(edges, all)) ADD_FAILURE() << violation;
}

// Every library that one links, itself included.
std::set<std::string> closure(const std::map<std::string, Linked>& all, const std::string& library) {
  std::set<std::string> found;
  std::vector<std::string> open = {library};
  while (!open.empty()) {
    const std::string next = open.back();
    open.pop_back();
    if (!found.insert(next).second || !all.contains(next)) continue;
    open.insert(open.end(), all.at(next).depends.begin(), all.at(next).depends.end());
  }
  return found;
}

// The command line is of the mains and the verbs; a program that only links a node needs none.
TEST(Architecture, NodesAndSessionsLinkNoCommandLine) {
  const std::map<std::string, Linked> all = linked_by_all();
  for (const char* library : {"node", "scene", "mechanics_node", "hydraulics_node", "flex_node", "sensor_node",
                              "io_node", "recorder_node", "device_node", "session", "analysis", "keys", "gateway"}) {
    EXPECT_TRUE(all.contains(library)) << library;
    EXPECT_FALSE(closure(all, library).contains("options")) << library;
  }
  EXPECT_TRUE(closure(all, "mechanics_node (program)").contains("options"));
}

TEST(Architecture, ScannerFindsAForbiddenLink) {
  const fs::path list = fs::temp_directory_path() / ("slewring_links_" + std::to_string(::getpid()));
  std::ofstream(list) << "slewring_library(math\n  SOURCES a.cpp\n  DEPENDS core scene\n  LINK fmt::fmt)\n";
  Edges edges;
  edges.allowed = {{"math", {"core"}}, {"core", {}}, {"scene", {"math"}}};
  std::map<std::string, Linked> all = linked(list, "math");
  all["core"] = {"core", {}};
  all["scene"] = {"scene", {}};
  EXPECT_EQ(forbidden_links(edges, all), std::vector<std::string>{"math in math depends on scene"});
  fs::remove(list);
}

TEST(Architecture, AllowedEdgesHaveNoCycle) {
  const Edges edges = read_edges(fs::path(SLEWRING_SOURCE_DIR) / "tests/architecture/edges.txt");
  // remove parts without open edges until nothing is left
  std::map<std::string, std::set<std::string>> open = edges.allowed;
  for (bool any = true; any && !open.empty();) {
    any = false;
    for (auto it = open.begin(); it != open.end();) {
      const bool is_free = std::none_of(it->second.begin(), it->second.end(),
                                        [&](const std::string& part) { return open.contains(part); });
      it = is_free ? open.erase(it) : std::next(it);
      any |= is_free;
    }
  }
  for (const auto& [part, rest] : open) ADD_FAILURE() << part << " is part of a cycle";
}

// the scanner must see a violation when there is one
TEST(Architecture, ScannerFindsAForbiddenInclude) {
  const fs::path folder = fs::temp_directory_path() / ("slewring_edges_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  std::ofstream(folder / "bad.h") << "#include \"scene/scene.h\"\n#include <dds/dds.h>\n#include \"core/time.h\"\n";
  Edges edges;
  edges.allowed = {{"math", {"core"}}, {"core", {}}, {"scene", {"math"}}};
  edges.system = {{"dds/", {"transport"}}};
  std::vector<std::string> found;
  for (const std::string& header : includes_of(folder / "bad.h")) found.push_back(header);
  EXPECT_EQ(found.size(), 3u);
  EXPECT_EQ(violations(edges, "math", folder).size(), 2u);
  fs::remove_all(folder);
}

}  // namespace edges_test
