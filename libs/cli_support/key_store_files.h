// Where the files of a key store are; the same in the store and in what was exported of it.
//
//   DIR/identity_ca.pem, DIR/permissions_ca.pem, DIR/governance.p7s    whom to believe, and what is protected how
//   DIR/<identity>/certificate.pem, private_key.pem, permissions.p7s
//   DIR/identity_ca.key, DIR/permissions_ca.key                        in the store alone: make and renew identities
//
// Two authorities, since the packaged DDS (Cyclone 0.10.2, CVE-2023-24011) takes permissions that are signed by any
// certificate of the authority of permissions: with one for both, every holder of keys could grant itself anything.
#pragma once

#include <filesystem>
#include <string>

#include "transport/cyclone_domain.h"

namespace slew::cli_support {

inline constexpr const char* kIdentityAuthority = "identity_ca.pem";
inline constexpr const char* kIdentityAuthorityKey = "identity_ca.key";
inline constexpr const char* kPermissionsAuthority = "permissions_ca.pem";
inline constexpr const char* kPermissionsAuthorityKey = "permissions_ca.key";
inline constexpr const char* kGovernance = "governance.p7s";
inline constexpr const char* kCertificate = "certificate.pem";
inline constexpr const char* kPrivateKey = "private_key.pem";
inline constexpr const char* kPermissions = "permissions.p7s";

[[nodiscard]] transport::CycloneSecurity key_files(const std::filesystem::path& store, const std::string& identity);

// The same when all of them can be read. Throws Failure (bad_input) with the file that cannot.
[[nodiscard]] transport::CycloneSecurity readable_key_files(const std::filesystem::path& store,
                                                            const std::string& identity);

}  // namespace slew::cli_support
