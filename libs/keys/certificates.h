// Keys, certificates and signed documents of a key store (EC P-256), made with the openssl command line.
#pragma once

#include <filesystem>
#include <string>

namespace slew::keys {

// Since when keys are good and until when: from a day ago on, for the clocks of other machines may be behind.
struct Validity {
  std::string from, to;  // 2026-11-23T00:00:00, UTC
};
[[nodiscard]] Validity validity_of(int days);
[[nodiscard]] std::string utc_now();  // as above

// A file that its owner alone may read.
void make_key(const std::filesystem::path& to);

// What makes certificates, in a temporary folder of its own.
struct CertificateFiles {
  std::filesystem::path certificate;  // is made
  std::filesystem::path key;          // of the subject
};
// Signs its own. `subject`: /O=Slewring/CN=...
void make_authority(const CertificateFiles& files, const std::string& subject, const Validity& validity);
// Signed by an authority.
void make_certificate(const CertificateFiles& files, const CertificateFiles& authority, const std::string& subject,
                      const Validity& validity);

// "CN=mechanics,O=Slewring"
[[nodiscard]] std::string subject_of(const std::filesystem::path& certificate);

// S/MIME
void sign(const std::filesystem::path& document, const std::filesystem::path& to, const CertificateFiles& signer);

// 1 to 39 hexadecimal digits that nobody has guessed before.
[[nodiscard]] std::string random_number();

}  // namespace slew::keys
