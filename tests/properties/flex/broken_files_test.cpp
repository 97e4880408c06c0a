// SPDX-License-Identifier: Apache-2.0
// Files with random damage are read or refused in words, never anything else.
#include <gtest/gtest.h>

#include <random>

#include "flex/flexible_files.h"
#include "flex/imported_model.h"
#include "tests/support/flex_beams.h"
#include "tests/support/temporary_folder.h"

namespace slew::flex {
namespace broken_files_test {

using namespace testing;
using slew::testing::TemporaryFolder;

// a byte changed, taken out, put in, a piece copied, or the end cut off
std::string damaged(std::string text, std::mt19937_64& random) {
  constexpr std::string_view kBytes = "0123456789.-+eE \n#;,=x\t\0nan";
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % (n == 0 ? 1 : n)); };
  for (std::size_t i = 0, count = 1 + below(4); i < count; ++i) {
    const std::size_t at = below(text.size());
    const char byte = kBytes[below(kBytes.size())];
    switch (below(5)) {
      case 0:
        text[at] = byte;
        break;
      case 1:
        text.erase(at, 1 + below(8));
        break;
      case 2:
        text.insert(at, 1, byte);
        break;
      case 3:
        text.insert(at, text.substr(below(text.size()), below(40)));
        break;
      default:
        text.resize(at);
        break;
    }
    if (text.empty()) return text;
  }
  return text;
}

TEST(BrokenFiles, FlexibleFilesAreReadOrRefused) {
  const TemporaryFolder folder("flex_broken");
  const FlexibleFileSet set{folder.path(), "M", "F"};
  ReductionDef def = with_modes(0);
  def.stiffening = GeometricStiffening::straight_beam;
  const std::vector<int> two = {1, 2};
  write_flexible_files(set, select(reduce(build_beam(jib_boom(3)), def), two));
  std::mt19937_64 random(5);
  int refused = 0, count = 0;
  for (const std::string& matrix : flexible_matrices()) {
    const std::string name = flexible_file(set, matrix).filename(), whole = folder.read(name);
    for (int i = 0; i < 150; ++i, ++count) {
      (void)folder.write(name, damaged(whole, random));
      if (!error_of([&] { (void)read_flexible_files(set); }).empty()) ++refused;
    }
    (void)folder.write(name, whole);
  }
  EXPECT_GT(refused, count / 2);
  EXPECT_EQ(error_of([&] { (void)read_flexible_files(set); }), "");
}

TEST(BrokenFiles, MatricesAndTablesAreReadOrRefused) {
  const TemporaryFolder folder("flex_broken_import");
  const ImportDef files{"Body", folder.path() / "m.mtx", folder.path() / "k.mtx", folder.path() / "nodes.csv"};
  export_model(at_nodes(build_beam(jib_boom(3))), files);
  std::mt19937_64 random(6);
  int refused = 0, count = 0;
  for (const auto& file : {files.mass, files.stiffness, files.nodes}) {
    const std::string whole = folder.read(file.filename());
    for (int i = 0; i < 200; ++i, ++count) {
      (void)folder.write(file.filename(), damaged(whole, random));
      if (!error_of([&] { (void)import_model(files); }).empty()) ++refused;
    }
    (void)folder.write(file.filename(), whole);
  }
  EXPECT_GT(refused, count / 2);
  EXPECT_EQ(error_of([&] { (void)import_model(files); }), "");
}

}  // namespace broken_files_test
}  // namespace slew::flex
