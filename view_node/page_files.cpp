// SPDX-License-Identifier: Apache-2.0
#include "view_node/page_files.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include "core/installation.h"
#include "view_node/built_in_page.h"

namespace slew::view_node {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostBytes = 64u << 20;
constexpr std::string_view kUnknownType = "application/octet-stream";
constexpr std::pair<std::string_view, std::string_view> kTypes[] = {{".html", "text/html; charset=utf-8"},
                                                                    {".js", "text/javascript; charset=utf-8"},
                                                                    {".css", "text/css; charset=utf-8"},
                                                                    {".json", "application/json"},
                                                                    {".svg", "image/svg+xml"},
                                                                    {".png", "image/png"},
                                                                    {".glb", "model/gltf-binary"},
                                                                    {".woff2", "font/woff2"},
                                                                    {".wasm", "application/wasm"},
                                                                    {".ico", "image/x-icon"},
                                                                    {".webmanifest", "application/manifest+json"}};

std::string_view type_of(std::string_view path) noexcept {
  for (const auto& [ending, type] : kTypes) {
    if (path.ends_with(ending)) return type;
  }
  return kUnknownType;
}

// A regular file inside the folder; links that lead out of it are not followed.
std::optional<fs::path> file_inside(const fs::path& root, const std::string& path) {
  std::error_code error;
  const fs::path file = fs::canonical(root / path, error);
  if (error || !fs::is_regular_file(file, error)) return std::nullopt;
  const auto [end, rest] = std::mismatch(root.begin(), root.end(), file.begin(), file.end());
  if (end != root.end() || fs::file_size(file, error) > kMostBytes || error) return std::nullopt;
  return file;
}

}  // namespace

std::optional<PageFile> read_page_file(const std::string& folder, const std::string& path, Packing packing) {
  if (folder.empty()) {
    const std::string_view content = path == "index.html" ? kBuiltInHtml : path == "page.js" ? kBuiltInScript : "";
    if (content.empty()) return std::nullopt;
    return PageFile{std::string(content), type_of(path)};
  }
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  if (error) return std::nullopt;
  std::optional<fs::path> file = file_inside(root, path);
  if (!file) return std::nullopt;
  bool is_packed = false;
  if (packing == Packing::gzip) {
    const std::optional<fs::path> packed = file_inside(root, path + ".gz");
    // one from before the file was changed is of another content
    is_packed = packed && fs::last_write_time(*packed, error) >= fs::last_write_time(*file, error) && !error;
    if (is_packed) file = packed;
  }
  std::ifstream stream(*file, std::ios::binary);
  if (!stream) return std::nullopt;
  return PageFile{{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()},
                  type_of(path),
                  is_packed ? Packing::gzip : Packing::none};
}

std::string find_page() {
  const std::string scenes = installed_scenes();
  const fs::path beside =
      scenes.empty() ? fs::path(sibling_program("view_node")).parent_path() / ".." : fs::path(scenes) / "..";
  const fs::path page = (beside / "web").lexically_normal();
  std::error_code error;
  return fs::is_regular_file(page / "index.html", error) ? page.string() : "";
}

}  // namespace slew::view_node
