// SPDX-License-Identifier: Apache-2.0
// Keys, certificates and signed documents of a key store, with libcrypto: EC P-256 and SHA-256, PEM files.
// Functions that make something throw Failure when they cannot.
#pragma once

#include <filesystem>
#include <string>

namespace slew::keys {

// Begin and end of the validity of keys. It begins a day ago, since the clocks of other machines may be behind.
struct Validity {
  std::string from, to;  // 2026-11-23T00:00:00, UTC
};
[[nodiscard]] Validity validity_of(int days);
[[nodiscard]] std::string utc_now();  // as above

// Makes a key in a file that only its owner may read.
void make_key(const std::filesystem::path& to);

struct CertificateFiles {
  std::filesystem::path certificate;
  std::filesystem::path key;  // of its subject
};
// Makes a certificate of O=Slewring, CN=`name` for a key that exists; an authority's signs itself.
void make_authority(const CertificateFiles& files, const std::string& name, const Validity& validity);
void make_certificate(const CertificateFiles& files, const CertificateFiles& authority, const std::string& name,
                      const Validity& validity);

// Signs a document (S/MIME).
void sign(const std::filesystem::path& document, const std::filesystem::path& to, const CertificateFiles& signer);

// "CN=mechanics,O=Slewring" (RFC 2253)
[[nodiscard]] std::string subject_of(const std::filesystem::path& certificate);
// End of the validity, "Nov 23 00:00:00 2027 GMT".
[[nodiscard]] std::string end_of(const std::filesystem::path& certificate);

// Why a certificate is not one of this authority that is valid now; empty: it is.
[[nodiscard]] std::string problem_of_certificate(const std::filesystem::path& certificate,
                                                 const std::filesystem::path& authority);
[[nodiscard]] bool is_key_of(const std::filesystem::path& key, const std::filesystem::path& certificate);
[[nodiscard]] bool is_signed_by(const std::filesystem::path& document, const std::filesystem::path& authority);

// 1 to 39 random hexadecimal digits that were not drawn before.
[[nodiscard]] std::string random_number();

}  // namespace slew::keys
