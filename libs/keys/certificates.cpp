// SPDX-License-Identifier: Apache-2.0
#include "keys/certificates.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <memory>

#include "keys/key_files.h"

namespace slew::keys {
namespace {

namespace fs = std::filesystem;

template <auto kFree>
struct Free {
  template <typename T>
  void operator()(T* object) const noexcept {
    kFree(object);
  }
};
using Bio = std::unique_ptr<BIO, Free<BIO_free_all>>;
using Key = std::unique_ptr<EVP_PKEY, Free<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Free<X509_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, Free<X509_EXTENSION_free>>;
using Signature = std::unique_ptr<PKCS7, Free<PKCS7_free>>;
using Store = std::unique_ptr<X509_STORE, Free<X509_STORE_free>>;
using Context = std::unique_ptr<X509_STORE_CTX, Free<X509_STORE_CTX_free>>;

constexpr std::chrono::hours kBackdated{24};
constexpr int kSmime = PKCS7_DETACHED | PKCS7_TEXT | PKCS7_STREAM;

std::string utc(std::chrono::system_clock::time_point time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}", fmt::gmtime(std::chrono::system_clock::to_time_t(time)));
}

// Throws what libcrypto reports.
void need(bool is_done, const char* what) {
  if (is_done) return;
  std::array<char, 256> reason{};
  ERR_error_string_n(ERR_peek_last_error(), reason.data(), reason.size());
  ERR_clear_error();
  throw Failure(ExitCode::failed, fmt::format("{} failed ({})", what, reason.data()));
}

Bio text_bio(const std::string& text) {
  Bio bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
  need(bio != nullptr, "a buffer");
  return bio;
}

Bio output_bio() {
  Bio bio(BIO_new(BIO_s_mem()));
  need(bio != nullptr, "a buffer");
  return bio;
}

std::string text_of(const Bio& bio) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &data);
  return {data, static_cast<std::size_t>(std::max(size, 0L))};
}

// Null when the file holds none.
Certificate certificate_in(const fs::path& path) {
  const std::string text = read_file(path);
  Certificate certificate(PEM_read_bio_X509(text_bio(text).get(), nullptr, nullptr, nullptr));
  ERR_clear_error();
  return certificate;
}

Key key_in(const fs::path& path) {
  const std::string text = read_file(path);
  Key key(PEM_read_bio_PrivateKey(text_bio(text).get(), nullptr, nullptr, nullptr));
  ERR_clear_error();
  return key;
}

template <typename Object>
Object of_file(Object object, const fs::path& path, const char* what) {
  if (object == nullptr) throw storage_failure(path, fmt::format("holds no {}", what));
  return object;
}

Certificate good_certificate(const fs::path& path) {
  return of_file(certificate_in(path), path, "certificate");
}

Key good_key(const fs::path& path) {
  return of_file(key_in(path), path, "private key");
}

Store store_of(const fs::path& authority) {
  const Certificate certificate = certificate_in(authority);
  Store store(X509_STORE_new());
  need(store != nullptr, "a store of certificates");
  if (certificate != nullptr) need(X509_STORE_add_cert(store.get(), certificate.get()) == 1, "an authority");
  return store;
}

// 2026-11-23T00:00:00 to 20261123000000Z
std::string asn1_time(std::string time) {
  std::erase_if(time, [](char c) { return c < '0' || c > '9'; });
  return time + 'Z';
}

void add_extension(X509& certificate, int kind, const char* value) {
  X509V3_CTX context{};
  X509V3_set_ctx(&context, &certificate, &certificate, nullptr, nullptr, 0);
  const Extension extension(X509V3_EXT_conf_nid(nullptr, &context, kind, value));
  need(extension != nullptr && X509_add_ext(&certificate, extension.get(), -1) == 1, "an extension");
}

// With what signed certificates have in common; issuer, extensions and signature are not in it.
Certificate begin_certificate(EVP_PKEY& key, const std::string& name, const Validity& validity) {
  constexpr int kSerialBytes = 16;
  Certificate certificate(X509_new());
  need(certificate != nullptr && X509_set_version(certificate.get(), X509_VERSION_3) == 1, "a certificate");
  std::array<unsigned char, kSerialBytes> serial{};
  need(RAND_bytes(serial.data(), kSerialBytes) == 1, "a serial number");
  serial[0] = static_cast<unsigned char>((serial[0] & 0x7FU) | 0x40U);  // positive, of full length
  const std::unique_ptr<BIGNUM, Free<BN_free>> number(BN_bin2bn(serial.data(), kSerialBytes, nullptr));
  need(number != nullptr && BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate.get())) != nullptr,
       "a serial number");
  need(ASN1_TIME_set_string_X509(X509_getm_notBefore(certificate.get()), asn1_time(validity.from).c_str()) == 1 &&
           ASN1_TIME_set_string_X509(X509_getm_notAfter(certificate.get()), asn1_time(validity.to).c_str()) == 1,
       "a validity");
  X509_NAME* const subject = X509_get_subject_name(certificate.get());
  const auto add = [&](const char* field, const std::string& value) {
    const auto* const bytes = reinterpret_cast<const unsigned char*>(value.c_str());
    need(X509_NAME_add_entry_by_txt(subject, field, MBSTRING_UTF8, bytes, -1, -1, 0) == 1, "a name");
  };
  add("O", "Slewring");
  add("CN", name);
  need(X509_set_pubkey(certificate.get(), &key) == 1, "a public key");
  return certificate;
}

void finish_certificate(X509& certificate, EVP_PKEY& issuer_key, const fs::path& to) {
  need(X509_sign(&certificate, &issuer_key, EVP_sha256()) > 0, "a signature");
  const Bio out = output_bio();
  need(PEM_write_bio_X509(out.get(), &certificate) == 1, "a certificate");
  write_file(to, text_of(out));
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
  const Key key(EVP_EC_gen("P-256"));
  const Bio out = output_bio();
  need(key != nullptr && PEM_write_bio_PrivateKey(out.get(), key.get(), nullptr, nullptr, 0, nullptr, nullptr) == 1,
       "a key");
  write_private_file(to, text_of(out));
}

void make_authority(const CertificateFiles& files, const std::string& name, const Validity& validity) {
  const Key key = good_key(files.key);
  const Certificate certificate = begin_certificate(*key, name, validity);
  need(X509_set_issuer_name(certificate.get(), X509_get_subject_name(certificate.get())) == 1, "an issuer");
  add_extension(*certificate, NID_basic_constraints, "critical,CA:TRUE,pathlen:0");
  add_extension(*certificate, NID_key_usage, "critical,keyCertSign,digitalSignature");
  add_extension(*certificate, NID_subject_key_identifier, "hash");
  finish_certificate(*certificate, *key, files.certificate);
}

void make_certificate(const CertificateFiles& files, const CertificateFiles& authority, const std::string& name,
                      const Validity& validity) {
  const Certificate issuer = good_certificate(authority.certificate);
  const Key issuer_key = good_key(authority.key);
  const Certificate certificate = begin_certificate(*good_key(files.key), name, validity);
  need(X509_set_issuer_name(certificate.get(), X509_get_subject_name(issuer.get())) == 1, "an issuer");
  finish_certificate(*certificate, *issuer_key, files.certificate);
}

void sign(const fs::path& document, const fs::path& to, const CertificateFiles& signer) {
  const std::string text = read_file(document);
  const Bio in = text_bio(text), out = output_bio();
  const Signature signature(
      PKCS7_sign(good_certificate(signer.certificate).get(), good_key(signer.key).get(), nullptr, in.get(), kSmime));
  need(signature != nullptr && SMIME_write_PKCS7(out.get(), signature.get(), in.get(), kSmime) == 1, "a signature");
  write_file(to, text_of(out));
}

std::string subject_of(const fs::path& certificate) {
  const Certificate one = good_certificate(certificate);
  const Bio out = output_bio();
  need(X509_NAME_print_ex(out.get(), X509_get_subject_name(one.get()), 0, XN_FLAG_RFC2253) >= 0, "a subject");
  return text_of(out);
}

std::string end_of(const fs::path& certificate) {
  const Certificate one = good_certificate(certificate);
  const Bio out = output_bio();
  need(ASN1_TIME_print(out.get(), X509_get0_notAfter(one.get())) == 1, "a time");
  return text_of(out);
}

std::string problem_of_certificate(const fs::path& certificate, const fs::path& authority) {
  const Certificate one = certificate_in(certificate);
  if (one == nullptr) return fmt::format("{} holds no certificate", certificate.string());
  const Store store = store_of(authority);
  const Context context(X509_STORE_CTX_new());
  need(context != nullptr && X509_STORE_CTX_init(context.get(), store.get(), one.get(), nullptr) == 1, "a check");
  const bool is_good = X509_verify_cert(context.get()) == 1;
  ERR_clear_error();
  return is_good ? "" : X509_verify_cert_error_string(X509_STORE_CTX_get_error(context.get()));
}

bool is_key_of(const fs::path& key, const fs::path& certificate) {
  const Key private_key = key_in(key);
  const Certificate one = certificate_in(certificate);
  const bool fits =
      private_key != nullptr && one != nullptr && X509_check_private_key(one.get(), private_key.get()) == 1;
  ERR_clear_error();
  return fits;
}

bool is_signed_by(const fs::path& document, const fs::path& authority) {
  const std::string text = read_file(document);
  BIO* content = nullptr;
  const Signature signature(SMIME_read_PKCS7(text_bio(text).get(), &content));
  const Bio signed_text(content);
  const Store store = store_of(authority);
  const bool is_good = signature != nullptr && PKCS7_verify(signature.get(), nullptr, store.get(), signed_text.get(),
                                                            output_bio().get(), PKCS7_TEXT) == 1;
  ERR_clear_error();
  return is_good;
}

std::string random_number() {
  std::uint64_t number = 0;
  need(RAND_bytes(reinterpret_cast<unsigned char*>(&number), sizeof number) == 1, "a random number");
  return fmt::format("{:016x}", number);
}

}  // namespace slew::keys
