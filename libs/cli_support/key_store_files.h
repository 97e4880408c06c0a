// Where the files of a key store are; the same in the store and in what was exported of it.
//
//   DIR/ca.pem, DIR/governance.p7s              whom to believe, and what is protected how
//   DIR/<identity>/certificate.pem, private_key.pem, permissions.p7s
//   DIR/ca.key                                  in the store alone: makes and renews identities
#pragma once

#include <filesystem>
#include <string>

#include "transport/cyclone_domain.h"

namespace slew::cli_support {

inline constexpr const char* kAuthority = "ca.pem";
inline constexpr const char* kAuthorityKey = "ca.key";
inline constexpr const char* kGovernance = "governance.p7s";
inline constexpr const char* kCertificate = "certificate.pem";
inline constexpr const char* kPrivateKey = "private_key.pem";
inline constexpr const char* kPermissions = "permissions.p7s";

[[nodiscard]] transport::CycloneSecurity key_files(const std::filesystem::path& store, const std::string& identity);

// The same when all of them can be read. Throws Failure (bad_input) with the file that cannot.
[[nodiscard]] transport::CycloneSecurity readable_key_files(const std::filesystem::path& store,
                                                            const std::string& identity);

}  // namespace slew::cli_support
