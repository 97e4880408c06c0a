#include "node/assets.h"

#include <openssl/evp.h>

#include <fstream>
#include <memory>

namespace slew::node {

Status describe_asset(const std::filesystem::path& directory, const std::string& name, wire::Asset& asset) {
  std::ifstream file(directory / name, std::ios::binary);
  if (!file) {
    return Status::error(ExitCode::bad_input, "asset '" + name + "' is not in " + directory.string() +
                                                  "; copy it there or name its directory with --assets");
  }
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> digest(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  EVP_DigestInit_ex(digest.get(), EVP_sha256(), nullptr);
  asset.name = name;
  asset.size = 0;
  std::vector<char> block(1 << 16);
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0) {
    EVP_DigestUpdate(digest.get(), block.data(), static_cast<std::size_t>(file.gcount()));
    asset.size += static_cast<std::uint64_t>(file.gcount());
  }
  unsigned length = 0;
  EVP_DigestFinal_ex(digest.get(), asset.sha256.data(), &length);
  return Status::ok();
}

Status check_assets(const std::filesystem::path& directory, std::span<const wire::Asset> manifest) {
  std::string differing;
  for (const wire::Asset& expected : manifest) {
    wire::Asset found;
    const Status status = describe_asset(directory, expected.name, found);
    if (!status.is_ok()) {
      differing += (differing.empty() ? "" : "; ") + status.text;
    } else if (found.sha256 != expected.sha256) {
      differing += (differing.empty() ? "" : "; ") + std::string("asset '") + expected.name +
                   "' differs from the session's (" + std::to_string(found.size) + " bytes here, " +
                   std::to_string(expected.size) + " there)";
    }
  }
  if (differing.empty()) return Status::ok();
  return Status::error(ExitCode::bad_input,
                       differing + "; this node does not take part; copy the session's files here");
}

}  // namespace slew::node
