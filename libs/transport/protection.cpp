// SPDX-License-Identifier: Apache-2.0
#include "transport/protection.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace slew::transport {

SecurityFiles key_files(const std::filesystem::path& store, const std::string& identity) {
  // absolute path: a child process in another folder reads it too
  const std::filesystem::path folder = std::filesystem::absolute(store).lexically_normal();
  const std::filesystem::path own = folder / identity;
  return {folder / kIdentityAuthority, folder / kPermissionsAuthority,
          folder / kGovernance,        own / kCertificate,
          own / kPrivateKey,           own / kPermissions};
}

Status protect(Network& network, const Protection& protection) {
  if (!protection.keys.empty()) {
    const SecurityFiles files = key_files(protection.keys, protection.identity);
    for (const std::string& file : {files.identity_authority, files.permissions_authority, files.governance,
                                    files.certificate, files.private_key, files.permissions}) {
      if (::access(file.c_str(), R_OK) == 0) continue;
      return Status::error(
          ExitCode::bad_input,
          fmt::format("the key store {} has no keys of '{}': {}: {}; nothing was started; make them with "
                      "'slewring keys add', or bring them with 'slewring keys export'",
                      protection.keys, protection.identity, file, std::strerror(errno)));
    }
    network.security = files;
    return Status::ok();
  }
  if (protection.is_insecure_lan || !leaves_machine(network.interface)) return Status::ok();
  return Status::error(
      ExitCode::bad_input,
      fmt::format(
          "--interface {} leaves this machine, and without keys every program on that network can read and steer the "
          "session; nothing was started; name a key store with --keys ('slewring keys create' makes one), or add "
          "--insecure-lan",
          network.interface));
}

}  // namespace slew::transport
