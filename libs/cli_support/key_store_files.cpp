#include "cli_support/key_store_files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "cli_support/failure.h"

namespace slew::cli_support {

transport::CycloneSecurity key_files(const std::filesystem::path& store, const std::string& identity) {
  // as a child process in another folder sees it as well
  const std::filesystem::path folder = std::filesystem::absolute(store).lexically_normal();
  const std::filesystem::path own = folder / identity;
  return {folder / kIdentityAuthority, folder / kPermissionsAuthority,
          folder / kGovernance,        own / kCertificate,
          own / kPrivateKey,           own / kPermissions};
}

transport::CycloneSecurity readable_key_files(const std::filesystem::path& store, const std::string& identity) {
  transport::CycloneSecurity files = key_files(store, identity);
  for (const std::string& file : {files.identity_authority, files.permissions_authority, files.governance,
                                  files.certificate, files.private_key, files.permissions}) {
    if (::access(file.c_str(), R_OK) == 0) continue;
    throw Failure(ExitCode::bad_input,
                  fmt::format("the key store {} has no keys of '{}': {}: {}; nothing was started; make them with "
                              "'slewring keys add', or bring them with 'slewring keys export'",
                              store.string(), identity, file, std::strerror(errno)));
  }
  return files;
}

}  // namespace slew::cli_support
