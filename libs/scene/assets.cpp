#include "scene/assets.h"

#include <openssl/evp.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

namespace slew::scene {
namespace {

constexpr std::size_t kReadBytes = 1 << 16;

struct AssetCloser {
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
  const std::unique_ptr<std::FILE, AssetCloser> file(std::fopen(path.c_str(), "rb"));
  if (!file) return {std::nullopt, std::string("cannot be read: ") + std::strerror(errno)};
  Asset asset{.name = name};
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> hash(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  bool is_hashed = hash && EVP_DigestInit_ex(hash.get(), EVP_sha256(), nullptr) == 1;
  std::vector<std::uint8_t> bytes(kReadBytes);
  while (const std::size_t count = std::fread(bytes.data(), 1, bytes.size(), file.get())) {
    is_hashed = is_hashed && EVP_DigestUpdate(hash.get(), bytes.data(), count) == 1;
    asset.size += count;
  }
  if (std::ferror(file.get()) != 0) return {std::nullopt, std::string("cannot be read: ") + std::strerror(errno)};
  if (!is_hashed || EVP_DigestFinal_ex(hash.get(), asset.sha256.data(), nullptr) != 1) {
    return {std::nullopt, "cannot be hashed: OpenSSL has no SHA-256"};
  }
  return {std::move(asset), ""};
}

}  // namespace

std::optional<Asset> measure_asset(const std::string& name, const std::string& path, std::string& fault) {
  Measured measured = measure(name, path);
  fault = measured.problem;
  return std::move(measured.asset);
}

bool is_inside_folder(const std::string& name) {
  const std::filesystem::path path(name);
  if (path.is_absolute()) return false;
  for (const std::filesystem::path& part : path) {
    if (part == "..") return false;
  }
  return true;
}

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
    if (item.text.size() > kMaxAssetNameLength) {
      report.add(item.mark, "assets",
                 {"a file's name has " + std::to_string(item.text.size()) + " characters",
                  "at most " + std::to_string(kMaxAssetNameLength), ""});
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
    differences += "asset '" + wanted.name + "' ";
    if (!found.asset) {
      differences += found.problem;
    } else {
      differences += "differs from the session's (" + std::to_string(found.asset->size) + " bytes here, " +
                     std::to_string(wanted.size) + " there)";
    }
  }
  if (differences.empty()) return Status::ok();
  return Status::error(ExitCode::bad_input, differences +
                                                "; this node does not take part; copy the session's files to " +
                                                folder + ", or name their folder with --assets");
}

}  // namespace slew::scene
