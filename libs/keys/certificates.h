// SPDX-License-Identifier: Apache-2.0
// Keys, certificates and signed documents of a key store (EC P-256), made with the openssl command line.
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

// Files of a certificate, made in a temporary folder of its own.
struct CertificateFiles {
  std::filesystem::path certificate;  // the certificate that is made
  std::filesystem::path key;          // key of the subject
};
// Makes a certificate that signs itself. `subject`: /O=Slewring/CN=...
void make_authority(const CertificateFiles& files, const std::string& subject, const Validity& validity);
// Makes a certificate that an authority signs.
void make_certificate(const CertificateFiles& files, const CertificateFiles& authority, const std::string& subject,
                      const Validity& validity);

// "CN=mechanics,O=Slewring"
[[nodiscard]] std::string subject_of(const std::filesystem::path& certificate);

// Signs a document (S/MIME).
void sign(const std::filesystem::path& document, const std::filesystem::path& to, const CertificateFiles& signer);

// 1 to 39 random hexadecimal digits that were not drawn before.
[[nodiscard]] std::string random_number();

}  // namespace slew::keys
