// SPDX-License-Identifier: Apache-2.0
// A key store: the authorities of a set of machines, and an identity with keys for every role that takes part. Nodes
// read it through transport/protection.h.
//
// The packaged DDS has no list of revoked certificates: to revoke an identity, the authorities and all other identities
// are made again, and their holders need the new ones.
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
  std::string role;           // one of key_roles()
  std::string session = "*";  // sessions that it may take part in, with * and ?
  int days = 0;               // validity
};

struct KeyFinding {
  std::string identity;  // empty: the store as a whole
  std::string problem;   // empty: good
  std::string expires;   // "Nov 23 00:00:00 2027 GMT"; empty: unknown
};

class KeyStore {
 public:
  // Makes the authorities and an identity for every role. An existing folder keeps its mode. Throws Failure when it
  // holds any file; nothing is left behind then.
  static KeyStore create(const std::filesystem::path& folder, const std::string& session, int days);
  // Throws Failure (bad_input) when there is no store.
  static KeyStore open(const std::filesystem::path& folder);

  [[nodiscard]] const std::vector<KeyIdentity>& identities() const noexcept { return identities_; }

  // Throws Failure (bad_input) when an identity has this name, or another file of the store.
  void add(const KeyIdentity& identity);
  // Makes new authorities and all other identities again. Until that is done, the store is as it was; other files in
  // its folder stay.
  void revoke(const std::string& name);
  // Copies the files that holders of these identities need into a folder, which may hold others of the same authority.
  // Never copies the authorities' own keys. Throws Failure when the folder belongs to another authority, is a store or
  // holds other files, or an identity is unknown.
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

// Checks a store or exported keys: signatures, validity, keys that fit their certificates, files that others may read.
// One entry for the folder and one for each identity. Throws Failure when the folder holds no keys.
[[nodiscard]] std::vector<KeyFinding> check_keys(const std::filesystem::path& folder);

}  // namespace slew::keys
