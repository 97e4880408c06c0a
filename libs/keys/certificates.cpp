// SPDX-License-Identifier: Apache-2.0
#include "keys/certificates.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <random>

#include "keys/key_files.h"
#include "keys/openssl.h"

namespace slew::keys {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::hours kBackdated{24};

// `openssl x509` and `req` of OpenSSL 3.0 cannot backdate, `ca` can; it needs a database for it
constexpr const char* kConfig = R"([req]
distinguished_name = name
prompt = no
[name]
O = Slewring
[ca]
default_ca = here
[here]
database = {0}/index.txt
new_certs_dir = {0}
rand_serial = yes
default_md = sha256
policy = any
[any]
organizationName = supplied
commonName = supplied
[authority]
basicConstraints = critical, CA:TRUE, pathlen:0
keyUsage = critical, keyCertSign, digitalSignature
subjectKeyIdentifier = hash
)";

std::string utc(std::chrono::system_clock::time_point time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}", fmt::gmtime(std::chrono::system_clock::to_time_t(time)));
}

// 20261123000000Z
std::string as_openssl_writes_it(std::string time) {
  std::erase_if(time, [](char c) { return c < '0' || c > '9'; });
  return time + 'Z';
}

void make(const CertificateFiles& files, const std::vector<std::string>& how, const std::string& subject,
          const Validity& validity) {
  const UniqueFolder work(fs::temp_directory_path() / "slewring_keys");
  const std::string config = work.path() / "openssl.cnf", request = work.path() / "request.pem";
  write_file(config, fmt::format(kConfig, work.path().string()));
  write_file(work.path() / "index.txt", "");
  run_openssl({"req", "-new", "-config", config, "-key", files.key.string(), "-out", request, "-subj", subject});
  std::vector<std::string> arguments = {"ca",         "-batch",
                                        "-notext",    "-preserveDN",
                                        "-config",    config,
                                        "-in",        request,
                                        "-out",       files.certificate.string(),
                                        "-startdate", as_openssl_writes_it(validity.from),
                                        "-enddate",   as_openssl_writes_it(validity.to)};
  arguments.insert(arguments.end(), how.begin(), how.end());
  run_openssl(arguments);
}

}  // namespace

Validity validity_of(int days) {
  const auto now = std::chrono::system_clock::now();
  return {utc(now - kBackdated), utc(now + std::chrono::hours(24) * days)};
}

std::string utc_now() {
  return utc(std::chrono::system_clock::now());
}

void make_key(const fs::path& to) {
  run_openssl({"ecparam", "-name", "prime256v1", "-genkey", "-noout", "-out", to.string()});
  std::error_code error;
  fs::permissions(to, fs::perms::owner_read | fs::perms::owner_write, error);
  if (error) throw storage_failure(to, error.message());
}

void make_authority(const CertificateFiles& files, const std::string& subject, const Validity& validity) {
  make(files, {"-selfsign", "-keyfile", files.key.string(), "-extensions", "authority"}, subject, validity);
}

void make_certificate(const CertificateFiles& files, const CertificateFiles& authority, const std::string& subject,
                      const Validity& validity) {
  make(files, {"-cert", authority.certificate.string(), "-keyfile", authority.key.string()}, subject, validity);
}

std::string subject_of(const fs::path& certificate) {
  std::string subject_line =
      run_openssl({"x509", "-in", certificate.string(), "-noout", "-subject", "-nameopt", "RFC2253"});
  while (!subject_line.empty() && (subject_line.back() == '\n' || subject_line.back() == ' ')) subject_line.pop_back();
  return subject_line.substr(subject_line.find('=') + 1);
}

void sign(const fs::path& document, const fs::path& to, const CertificateFiles& signer) {
  run_openssl({"smime", "-sign", "-in", document.string(), "-text", "-out", to.string(), "-signer",
               signer.certificate.string(), "-inkey", signer.key.string()});
}

std::string random_number() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}", random(), random());
}

}  // namespace slew::keys
