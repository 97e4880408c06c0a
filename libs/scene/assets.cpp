// SPDX-License-Identifier: Apache-2.0
#include "scene/assets.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <charconv>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/input_file.h"

namespace slew::scene {
namespace {

// Size and hash of a file, or the reason for a failed read.
struct Measured {
  std::optional<Asset> asset;
  std::string problem;
};

Measured measure(const std::string& name, const LoadContext& load_context) {
  if (const auto refusal = load_context.refusal_of(name)) return {std::nullopt, refusal->what};
  std::string bytes;
  const std::string path = load_context.path_of(name);
  if (const auto fault = read_input(path, kMaxAssetBytes, bytes)) return {std::nullopt, fault->text()};
  return {Asset{.name = name, .size = bytes.size(), .sha256 = sha256_of(bytes)}, ""};
}

}  // namespace

Sha256 sha256_of(std::string_view bytes) {
  Sha256 sum{};
  if (EVP_Digest(bytes.data(), bytes.size(), sum.data(), nullptr, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("files cannot be hashed: OpenSSL has no SHA-256");
  }
  return sum;
}

std::string hex_text(const Sha256& sum) {
  std::string text;
  for (const std::uint8_t byte : sum) text += fmt::format("{:02x}", byte);
  return text;
}

std::optional<Sha256> read_sha256(std::string_view text) {
  Sha256 sum{};
  if (text.size() != 2 * sum.size()) return std::nullopt;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const char* first = text.data() + 2 * i;
    const auto [end, error] = std::from_chars(first, first + 2, sum[i], 16);
    if (error != std::errc() || end != first + 2) return std::nullopt;
  }
  return sum;
}

std::optional<Asset> measure_asset(const std::string& name, const LoadContext& load_context, std::string& fault) {
  Measured measured = measure(name, load_context);
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

void read_assets(const Node& section, const LoadContext& load_context, Scene& scene, Report& report) {
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
    if (!load_context.has_folder) {
      scene.assets.push_back({.name = item.text});
      continue;
    }
    Measured measured = measure(item.text, load_context);
    if (measured.asset) {
      scene.assets.push_back(std::move(*measured.asset));
    } else {
      report.add(item.mark, "assets", {describe(item) + " " + measured.problem, "", ""});
    }
  }
}

Status check_assets(std::span<const Asset> manifest, const std::string& folder) {
  const LoadContext load_context{true, folder};
  std::string differences;
  for (const Asset& wanted : manifest) {
    const Measured found = measure(wanted.name, load_context);
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
