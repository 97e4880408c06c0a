// A key store: the authorities of a set of machines, and an identity with keys for every role that takes part. Made and
// changed with the openssl command line; read by nodes through transport/protection.h.
//
// The packaged DDS knows no list of revoked certificates: to revoke an identity the authorities are made anew, and with
// them all other identities, whose holders need them again.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "keys/certificates.h"
#include "keys/key_files.h"

namespace slew::keys {

// Roles of a session, and "viewer": reads what an observer reads and writes nothing.
[[nodiscard]] const std::vector<std::string>& key_roles();

struct KeyIdentity {
  std::string name;           // 1 to 63 letters, digits, '_', '-', '.'
  std::string role;           // of key_roles()
  std::string session = "*";  // sessions that it may take part in, with * and ?
  int days = 0;               // validity
};

struct KeyFinding {
  std::string identity;  // empty: of the store as a whole
  std::string problem;   // empty: good
  std::string expires;   // as openssl writes it; empty: unknown
};

class KeyStore {
 public:
  // Makes the authorities and an identity for every role. A folder that is there keeps its mode. Throws Failure when it
  // holds anything; nothing is left behind then.
  static KeyStore create(const std::filesystem::path& folder, const std::string& session, int days);
  // Throws Failure (bad_input) when there is no store.
  static KeyStore open(const std::filesystem::path& folder);

  [[nodiscard]] const std::vector<KeyIdentity>& identities() const noexcept { return identities_; }

  // Throws Failure (bad_input) when there is one of the name, or anything else in the store.
  void add(const KeyIdentity& identity);
  // Makes the authorities and all other identities anew. Until that is done, the store is as it was; what is in its
  // folder beside them stays.
  void revoke(const std::string& name);
  // Copies what holders of these identities need into a folder, which may hold others of the same authority. Never the
  // authorities' own keys. Throws Failure when the folder belongs to another authority, is a store or holds something
  // else, or an identity is unknown.
  void export_to(const std::filesystem::path& folder, const std::vector<std::string>& names) const;

 private:
  explicit KeyStore(const std::filesystem::path& folder);
  [[nodiscard]] CertificateFiles authority(const char* certificate, const char* key) const;
  [[nodiscard]] CertificateFiles identity_authority() const;
  [[nodiscard]] CertificateFiles permissions_authority() const;
  void make_authorities(int days) const;
  void make_identity(const KeyIdentity& identity) const;  // leaves nothing behind when it throws
  void write_list() const;
  void take_over_foreign(UniqueFolder& former) const;
  [[nodiscard]] const KeyIdentity* find(const std::string& name) const;

  std::filesystem::path folder_;  // absolute, without links and a separator at its end: it has neighbours
  std::vector<KeyIdentity> identities_;
};

// Of a store or of what was exported: signatures, validity, keys that fit their certificates, files that others may
// read. One entry for the folder and one for each identity. Throws Failure when it is none.
[[nodiscard]] std::vector<KeyFinding> check_keys(const std::filesystem::path& folder);

}  // namespace slew::keys
