#include "scene/assets.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "scene/sha256.h"

namespace slew::scene {
namespace {

constexpr std::size_t kReadBytes = 1 << 16;

struct FileCloser {
  void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};

// Size and hash of a file, or why it cannot be read.
struct Measured {
  std::optional<Asset> asset;
  std::string problem;
};

Measured measure(const std::string& name, const std::string& path) {
  std::error_code error;
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error)) {
    return {std::nullopt, "is not a regular file"};
  }
  const std::unique_ptr<std::FILE, FileCloser> file(std::fopen(path.c_str(), "rb"));
  if (!file) return {std::nullopt, std::string("cannot be read: ") + std::strerror(errno)};
  Asset asset{.name = name};
  Sha256Stream hash;
  std::vector<std::uint8_t> bytes(kReadBytes);
  while (const std::size_t count = std::fread(bytes.data(), 1, bytes.size(), file.get())) {
    hash.add({bytes.data(), count});
    asset.size += count;
  }
  if (std::ferror(file.get()) != 0) return {std::nullopt, std::string("cannot be read: ") + std::strerror(errno)};
  asset.sha256 = hash.finish();
  return {std::move(asset), ""};
}

// Names stay inside the scene's folder, so that they mean the same on every machine.
bool is_inside_folder(const std::string& name) {
  const std::filesystem::path path(name);
  if (path.is_absolute()) return false;
  for (const std::filesystem::path& part : path) {
    if (part == "..") return false;
  }
  return true;
}

}  // namespace

void read_assets(const Node& section, const Surroundings& surroundings, Scene& scene, Report& report) {
  if (section.kind != Node::Kind::sequence || section.items.size() > kMaxAssets) {
    const bool is_list = section.kind == Node::Kind::sequence;
    report.add(section.mark, "assets",
               {is_list ? "holds " + std::to_string(section.items.size()) + " files" : "is " + describe(section),
                is_list ? "at most " + std::to_string(kMaxAssets) : "a list of files", ""});
    return;
  }
  for (const Node& item : section.items) {
    if (item.kind != Node::Kind::scalar || item.text.empty() || !is_inside_folder(item.text)) {
      report.add(item.mark, "assets", {"an entry is " + describe(item), "a file in the scene's folder", ""});
      continue;
    }
    if (!surroundings.has_folder) {
      scene.assets.push_back({.name = item.text});
      continue;
    }
    Measured measured = measure(item.text, surroundings.path_of(item.text));
    if (measured.asset) {
      scene.assets.push_back(std::move(*measured.asset));
    } else {
      report.add(item.mark, "assets", {describe(item) + " " + measured.problem, "", ""});
    }
  }
}

Status check_assets(std::span<const Asset> manifest, const std::string& folder) {
  const Surroundings surroundings{true, folder};
  std::string differences;
  for (const Asset& wanted : manifest) {
    const Measured found = measure(wanted.name, surroundings.path_of(wanted.name));
    if (found.asset == wanted) continue;
    differences += differences.empty() ? "" : "; ";
    differences += wanted.name;
    if (!found.asset) {
      differences += " " + found.problem;
    } else if (found.asset->size != wanted.size) {
      differences +=
          " has " + std::to_string(found.asset->size) + " bytes, the session's has " + std::to_string(wanted.size);
    } else {
      differences += " has other contents than the session's";
    }
  }
  if (differences.empty()) return Status::ok();
  return Status::error(ExitCode::bad_input, "assets differ from the session's: " + differences +
                                                "; copy the scene's folder to this machine and start again");
}

}  // namespace slew::scene
