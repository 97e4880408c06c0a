// SPDX-License-Identifier: Apache-2.0
// Files of the page: those of its folder, and no others.
#include "view_node/page_files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace page_files_test {

using namespace slew::view_node;
namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& content) {
  std::ofstream(path) << content;
}

TEST(PageFiles, AreThoseOfTheFolderWithTheirTypes) {
  const slew::testing::TemporaryFolder folder("page");
  const fs::path page = folder.path() / "page";
  fs::create_directories(page / "assets");
  write(page / "index.html", "<p>");
  write(page / "assets" / "a.js", "1");
  ASSERT_TRUE(read_page_file(page.string(), "index.html").has_value());
  EXPECT_EQ(read_page_file(page.string(), "index.html")->type, "text/html; charset=utf-8");
  EXPECT_EQ(read_page_file(page.string(), "assets/a.js")->content, "1");
  EXPECT_FALSE(read_page_file(page.string(), "assets").has_value());
  EXPECT_FALSE(read_page_file(page.string(), "none.html").has_value());
}

TEST(PageFiles, LinksAndPathsOutOfTheFolderLeadNowhere) {
  const slew::testing::TemporaryFolder folder("page");
  const fs::path page = folder.path() / "page";
  fs::create_directories(page);
  fs::create_directories(folder.path() / "page_of_others");
  write(folder.path() / "secret", "s");
  write(folder.path() / "page_of_others" / "secret", "s");
  fs::create_symlink(folder.path() / "secret", page / "link");
  fs::create_directory_symlink(folder.path() / "page_of_others", page / "others");
  for (const char* const path : {"link", "../secret", "others/secret", "../page_of_others/secret", "/etc/passwd"})
    EXPECT_FALSE(read_page_file(page.string(), path).has_value()) << path;
}

TEST(PageFiles, WithoutAFolderThePageIsTheBuiltInOne) {
  EXPECT_NE(read_page_file("", "index.html")->content.find("page.js"), std::string::npos);
  EXPECT_TRUE(read_page_file("", "page.js").has_value());
  EXPECT_FALSE(read_page_file("", "other.js").has_value());
}

}  // namespace page_files_test
