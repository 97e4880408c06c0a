// SPDX-License-Identifier: Apache-2.0
// Protection of a session from foreign processes: the keys of a store, or a network without foreign processes.
//
// Files of a key store, the same in the store and in what was exported of it:
//   DIR/identity_ca.pem, DIR/permissions_ca.pem, DIR/governance.p7s    trusted authorities, and what is protected how
//   DIR/<identity>/certificate.pem, private_key.pem, permissions.p7s
//   DIR/identity_ca.key, DIR/permissions_ca.key                        in the store alone: they make and renew
//   identities
//
// Two authorities, since the packaged DDS (Cyclone 0.10.2, CVE-2023-24011) takes permissions that are signed by any
// certificate of the authority of permissions: with one for both, every holder of keys could grant itself anything.
#pragma once

#include <filesystem>
#include <string>

#include "core/status.h"
#include "transport/network.h"

namespace slew::transport {

inline constexpr const char* kIdentityAuthority = "identity_ca.pem";
inline constexpr const char* kIdentityAuthorityKey = "identity_ca.key";
inline constexpr const char* kPermissionsAuthority = "permissions_ca.pem";
inline constexpr const char* kPermissionsAuthorityKey = "permissions_ca.key";
inline constexpr const char* kGovernance = "governance.p7s";
inline constexpr const char* kCertificate = "certificate.pem";
inline constexpr const char* kPrivateKey = "private_key.pem";
inline constexpr const char* kPermissions = "permissions.p7s";

[[nodiscard]] SecurityFiles key_files(const std::filesystem::path& store, const std::string& identity);

struct Protection {
  std::string keys;              // folder of a key store; empty: none
  std::string identity;          // name of the identity whose keys are used
  bool is_insecure_lan = false;  // sends beyond this machine without keys
};

// Gives the network its keys. Error bad_input: a file cannot be read; or there are no keys, and the network's interface
// leaves this machine without permission.
[[nodiscard]] Status protect(Network& network, const Protection& protection);

}  // namespace slew::transport
