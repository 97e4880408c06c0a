// Includes go downwards only, along the edges of edges.txt.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
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

TEST(Architecture, EveryLibraryIsListed) {
  const fs::path root = SLEWRING_SOURCE_DIR;
  const Edges edges = read_edges(root / "tests/architecture/edges.txt");
  for (const auto& entry : fs::directory_iterator(root / "libs")) {
    if (fs::is_empty(entry.path())) continue;
    EXPECT_TRUE(edges.allowed.contains(entry.path().filename())) << entry.path().filename();
  }
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
