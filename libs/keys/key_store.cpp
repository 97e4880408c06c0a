// SPDX-License-Identifier: Apache-2.0
#include "keys/key_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "core/failure.h"
#include "core/json.h"
#include "keys/certificates.h"
#include "keys/key_files.h"
#include "keys/security_documents.h"
#include "node/identity.h"
#include "node/session_options.h"
#include "transport/protection.h"
#include "transport/roles.h"

namespace slew::keys {
namespace {

namespace fs = std::filesystem;
using wire::Role;

constexpr const char* kList = "identities.json";
constexpr const char* kGovernanceText = "governance.xml";  // as it was signed
constexpr const char* kOldConfig = "openssl.cnf";          // in stores of version 0.1.0
constexpr const char* kViewer = "viewer";

struct Allowed {
  transport::TopicSet writes, reads;
};

std::optional<Allowed> allowed_to(const std::string& role) {
  if (role == kViewer) return Allowed{{}, transport::traits(Role::observer).reads};
  if (const std::optional<Role> one = transport::role_of(role)) {
    return Allowed{transport::traits(*one).writes, transport::topics_readable(*one)};
  }
  return std::nullopt;
}

bool is_session_pattern(const std::string& text) {
  return !text.empty() && text.size() <= wire::kMaxNameLength &&
         text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.*?") ==
             std::string::npos;
}

void require_good(const KeyIdentity& identity) {
  if (const std::string problem = node::problem_of_session_name(identity.name); !problem.empty()) {
    throw Failure(
        ExitCode::bad_input,
        fmt::format("'{}' is no name of an identity: it has 1 to 63 letters, digits, '_', '-' and '.'; nothing "
                    "was changed",
                    identity.name));
  }
  if (identity.name.front() == '.') {
    throw Failure(
        ExitCode::bad_input,
        fmt::format("'{}' is no name of an identity: it begins with a dot; nothing was changed", identity.name));
  }
  if (!is_session_pattern(identity.session)) {
    throw Failure(
        ExitCode::bad_input,
        fmt::format("'{}' names no sessions: letters, digits, '_', '-', '.', * and ? are allowed; nothing was "
                    "changed",
                    identity.session));
  }
}

}  // namespace

const std::vector<std::string>& key_roles() {
  static const std::vector<std::string> roles = [] {
    std::vector<std::string> names;
    for (const transport::RoleTraits& role : transport::roles()) names.emplace_back(role.name);
    names.emplace_back(kViewer);
    return names;
  }();
  return roles;
}

KeyStore::KeyStore(const fs::path& folder) : folder_(fs::weakly_canonical(fs::absolute(folder))) {
  if (!folder_.has_filename()) folder_ = folder_.parent_path();
}

KeyStore KeyStore::create(const fs::path& folder, const std::string& session, int days) {
  KeyIdentity first{"io", "io", session, days};
  require_good(first);
  std::error_code error;
  if (fs::exists(folder, error) && (!fs::is_directory(folder, error) || !fs::is_empty(folder, error))) {
    throw Failure(ExitCode::bad_input,
                  fmt::format("{} is there already and not empty; nothing was changed; name another folder, or see "
                              "'slewring keys add'",
                              folder.string()));
  }
  const Folder found = make_private_folder(folder);
  try {
    KeyStore store(folder);
    store.make_authorities(days);
    for (const std::string& role : key_roles()) {
      store.identities_.push_back({role, role, session, days});
      store.make_identity(store.identities_.back());
    }
    store.write_list();
    return store;
  } catch (...) {
    // the folder was empty: this call made all files in it
    for (const auto& entry : fs::directory_iterator(folder, error)) fs::remove_all(entry.path(), error);
    if (found == Folder::made) fs::remove(folder, error);
    throw;
  }
}

KeyStore KeyStore::open(const fs::path& folder) {
  const Json list = Json::parse(read_file(folder / kList)).value_or(Json());
  if (!list.is_array() || !fs::exists(folder / transport::kIdentityAuthorityKey)) {
    throw Failure(
        ExitCode::bad_input,
        fmt::format("{} is no key store ({} and {} make one); nothing was changed; make one with 'slewring keys "
                    "create'",
                    folder.string(), kList, transport::kIdentityAuthorityKey));
  }
  KeyStore store(folder);
  for (const Json& one : list.items()) {
    const std::string role = one.text_or("role", "");
    if (!allowed_to(role)) throw storage_failure(folder / kList, "has an identity without a role");
    const Json* days = one.find("days");
    store.identities_.push_back({one.text_or("name", ""), role, one.text_or("session", "*"),
                                 days == nullptr ? 0 : static_cast<int>(days->integer())});
  }
  return store;
}

const KeyIdentity* KeyStore::find(const std::string& name) const {
  const auto found = std::find_if(identities_.begin(), identities_.end(),
                                  [&](const KeyIdentity& identity) { return identity.name == name; });
  return found != identities_.end() ? &*found : nullptr;
}

CertificateFiles KeyStore::authority(const char* certificate, const char* key) const {
  return {folder_ / certificate, folder_ / key};
}

CertificateFiles KeyStore::identity_authority() const {
  return authority(transport::kIdentityAuthority, transport::kIdentityAuthorityKey);
}

CertificateFiles KeyStore::permissions_authority() const {
  return authority(transport::kPermissionsAuthority, transport::kPermissionsAuthorityKey);
}

void KeyStore::make_authorities(int days) const {
  const auto make = [&](const char* what, const CertificateFiles& files) {
    make_key(files.key);
    make_authority(files, fmt::format("authority of {} {}", what, random_number()), validity_of(days));
  };
  make("identities", identity_authority());
  make("permissions", permissions_authority());
  const fs::path governance = folder_ / kGovernanceText;
  write_file(governance, governance_xml());
  sign(governance, folder_ / transport::kGovernance, permissions_authority());
}

void KeyStore::make_identity(const KeyIdentity& identity) const {
  const fs::path folder = folder_ / identity.name, certificate = folder / transport::kCertificate,
                 permissions = folder / "permissions.xml";
  if (make_private_folder(folder) == Folder::was_there) throw storage_failure(folder, "it is there already");
  try {
    const CertificateFiles files{certificate, folder / transport::kPrivateKey};
    const Validity validity = validity_of(identity.days);
    make_key(files.key);
    make_certificate(files, identity_authority(), identity.name, validity);
    const Allowed allowed = allowed_to(identity.role).value();
    write_file(permissions, permissions_xml({identity.name, subject_of(certificate), identity.session, allowed.writes,
                                             allowed.reads, validity.from, validity.to}));
    sign(permissions, folder / transport::kPermissions, permissions_authority());
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    throw;
  }
}

void KeyStore::write_list() const {
  Json list = Json::array();
  for (const KeyIdentity& one : identities_) {
    list.push_back({{"name", one.name}, {"role", one.role}, {"session", one.session}, {"days", one.days}});
  }
  const UniqueFolder next(folder_ / ".next");
  write_file(next.path() / kList, list.dump(2) + "\n");
  std::error_code error;
  fs::rename(next.path() / kList, folder_ / kList, error);
  if (error) throw storage_failure(folder_ / kList, error.message());
}

void KeyStore::add(const KeyIdentity& identity) {
  require_good(identity);
  if (find(identity.name) != nullptr) {
    throw Failure(
        ExitCode::bad_input,
        fmt::format("there is an identity '{}' already; nothing was changed; revoke it first, or choose another "
                    "name with --name",
                    identity.name));
  }
  if (fs::exists(fs::symlink_status(folder_ / identity.name))) {
    throw Failure(
        ExitCode::bad_input,
        fmt::format(
            "'{}' is no name of an identity: {} is something else; nothing was changed; choose another name with "
            "--name",
            identity.name, (folder_ / identity.name).string()));
  }
  make_identity(identity);
  identities_.push_back(identity);
  try {
    write_list();
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(folder_ / identity.name, ignored);
    identities_.pop_back();
    throw;
  }
}

void KeyStore::revoke(const std::string& name) {
  const KeyIdentity* const revoked = find(name);
  if (revoked == nullptr) {
    throw Failure(
        ExitCode::bad_input,
        fmt::format("there is no identity '{}'; nothing was changed; 'slewring keys check' lists them", name));
  }
  int days = revoked->days;
  // both beside the store and under unused names: the new store changes place with the old one
  const UniqueFolder made(folder_);
  UniqueFolder old(folder_);
  KeyStore next(made.path());
  for (const KeyIdentity& one : identities_) {
    days = std::max(days, one.days);
    if (one.name != name) next.identities_.push_back(one);
  }
  next.make_authorities(days);
  for (const KeyIdentity& one : next.identities_) next.make_identity(one);
  next.write_list();
  std::error_code error;
  fs::permissions(made.path(), fs::status(folder_).permissions(), error);
  if (!error) fs::rename(folder_, old.path(), error);
  if (!error) {
    fs::rename(made.path(), folder_, error);
    std::error_code stuck;
    if (error) fs::rename(old.path(), folder_, stuck);
    if (stuck) old.keep();  // the only copy of the store
  }
  if (error) throw storage_failure(folder_, "the store could not be replaced (" + error.message() + ")");
  take_over_foreign(old);
  identities_ = next.identities_;
}

// Moves foreign files of the former store's folder into the new one.
void KeyStore::take_over_foreign(UniqueFolder& former) const {
  std::set<std::string> own = {kList,
                               kGovernanceText,
                               kOldConfig,
                               transport::kGovernance,
                               transport::kIdentityAuthority,
                               transport::kIdentityAuthorityKey,
                               transport::kPermissionsAuthority,
                               transport::kPermissionsAuthorityKey};
  for (const KeyIdentity& one : identities_) own.insert(one.name);
  std::vector<fs::path> foreign;
  for (const auto& entry : fs::directory_iterator(former.path())) {
    if (!own.contains(entry.path().filename().string())) foreign.push_back(entry.path());
  }
  for (const fs::path& path : foreign) {
    std::error_code error;
    fs::rename(path, folder_ / path.filename(), error);
    if (!error) continue;
    former.keep();
    throw storage_failure(path, "the store is new, and this could not be moved into it (" + error.message() + ")");
  }
}

void KeyStore::export_to(const fs::path& folder, const std::vector<std::string>& names) const {
  for (const std::string& name : names) {
    if (find(name) == nullptr) {
      throw Failure(
          ExitCode::bad_input,
          fmt::format("there is no identity '{}'; nothing was copied; 'slewring keys check' lists them", name));
    }
  }
  const fs::path authority = folder / transport::kIdentityAuthority;
  std::error_code error;
  const bool is_there = fs::exists(folder, error);
  const auto refuse = [&](const char* why) {
    return Failure(ExitCode::bad_input,
                   fmt::format("{} {}; nothing was copied; name another folder", folder.string(), why));
  };
  if (is_there && !fs::is_directory(folder, error)) throw refuse("is no folder");
  if (fs::exists(folder / transport::kIdentityAuthorityKey, error)) throw refuse("is a key store itself");
  if (fs::exists(authority, error) && read_file(authority) != read_file(identity_authority().certificate)) {
    throw Failure(ExitCode::bad_input,
                  fmt::format("{} holds keys of another authority, or of this one before a revocation; nothing was "
                              "copied; remove it, or name another folder",
                              folder.string()));
  }
  if (is_there && !fs::exists(authority, error) && !fs::is_empty(folder, error)) {
    throw refuse("is not empty and holds no keys");
  }
  make_private_folder(folder);
  const auto copy = [&](const fs::path& file) {
    fs::copy_file(folder_ / file, folder / file, fs::copy_options::overwrite_existing, error);
    if (error) throw storage_failure(folder / file, error.message());
  };
  copy(transport::kIdentityAuthority);
  copy(transport::kPermissionsAuthority);
  copy(transport::kGovernance);
  for (const std::string& name : names) {
    make_private_folder(folder / name);
    for (const char* file : {transport::kCertificate, transport::kPrivateKey, transport::kPermissions}) {
      copy(fs::path(name) / file);
    }
  }
}

}  // namespace slew::keys
