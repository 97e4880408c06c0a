#include "cli/keys/key_store.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "cli/keys/openssl.h"
#include "cli/keys/security_documents.h"
#include "cli_support/carrier.h"
#include "cli_support/failure.h"
#include "cli_support/session_options.h"
#include "node/identity.h"
#include "transport/protection.h"

namespace slew::cli {
namespace {

namespace fs = std::filesystem;
using cli_support::Failure;
using wire::Role;

constexpr const char* kList = "identities.json";
constexpr Role kAllRoles[] = {Role::io,       Role::mechanics, Role::hydraulics, Role::flex,
                              Role::recorder, Role::observer,  Role::controller};
constexpr const char* kViewer = "viewer";

struct Allowed {
  transport::TopicSet writes, reads;
};

std::optional<Allowed> allowed_to(const std::string& role) {
  if (role == kViewer) return Allowed{{}, cli_support::topics_read(Role::observer)};
  for (const Role one : kAllRoles) {
    if (node::to_text(one) == role) return Allowed{cli_support::topics_written(one), cli_support::topics_read(one)};
  }
  return std::nullopt;
}

[[nodiscard]] Failure storage(const fs::path& path, const std::string& why) {
  return Failure(ExitCode::storage, fmt::format("{}: {}; nothing else was changed", path.string(), why));
}

void write_file(const fs::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw storage(path, "cannot be written");
}

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// for this user alone, whatever the umask
void make_private_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw storage(path, error.message());
  fs::permissions(path, fs::perms::owner_all, error);
  if (error) throw storage(path, error.message());
}

void make_private(const fs::path& path) {
  std::error_code error;
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write, error);
  if (error) throw storage(path, error.message());
}

std::string random_serial() {
  std::random_device random;
  return fmt::format("0x{:08x}{:08x}{:08x}{:08x}", random() >> 1, random(), random(), random());
}

std::string utc(std::chrono::system_clock::time_point time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}", fmt::gmtime(std::chrono::system_clock::to_time_t(time)));
}

void sign(const fs::path& document, const fs::path& to, const fs::path& store) {
  run_openssl({"smime", "-sign", "-in", document.string(), "-text", "-out", to.string(), "-signer",
               (store / transport::kPermissionsAuthority).string(), "-inkey",
               (store / transport::kPermissionsAuthorityKey).string()});
}

void make_key(const fs::path& to) {
  run_openssl({"ecparam", "-name", "prime256v1", "-genkey", "-noout", "-out", to.string()});
  make_private(to);
}

std::string trimmed(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text;
}

// "CN=mechanics,O=Slewring"
std::string subject_of(const fs::path& certificate) {
  const std::string said =
      trimmed(run_openssl({"x509", "-in", certificate.string(), "-noout", "-subject", "-nameopt", "RFC2253"}));
  return said.substr(said.find('=') + 1);
}

bool is_session_pattern(const std::string& text) {
  return !text.empty() && text.size() <= wire::kMaxNameLength &&
         text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.*?") ==
             std::string::npos;
}

void require_good(const KeyIdentity& identity) {
  if (const std::string problem = cli_support::problem_of_session_name(identity.name); !problem.empty()) {
    throw Failure(
        ExitCode::bad_input,
        fmt::format("'{}' is no name of an identity: it has 1 to 63 letters, digits, '_', '-' and '.'; nothing "
                    "was changed",
                    identity.name));
  }
  if (!is_session_pattern(identity.session)) {
    throw Failure(
        ExitCode::bad_input,
        fmt::format("'{}' names no sessions: letters, digits, '_', '-', '.', * and ? are allowed; nothing was "
                    "changed",
                    identity.session));
  }
}

constexpr const char* kOpensslConfig = R"([req]
distinguished_name = name
x509_extensions = authority
prompt = no
[name]
O = Slewring
[authority]
basicConstraints = critical, CA:TRUE, pathlen:0
keyUsage = critical, keyCertSign, digitalSignature
subjectKeyIdentifier = hash
)";

}  // namespace

const std::vector<std::string>& key_roles() {
  static const std::vector<std::string> roles = [] {
    std::vector<std::string> names;
    for (const Role role : kAllRoles) names.emplace_back(node::to_text(role));
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
  if (fs::exists(folder, error) && !fs::is_empty(folder, error)) {
    throw Failure(ExitCode::bad_input,
                  fmt::format("{} is there already and not empty; nothing was changed; name another folder, or see "
                              "'slewring keys add'",
                              folder.string()));
  }
  make_private_folder(folder);
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
    fs::remove_all(folder, error);
    throw;
  }
}

KeyStore KeyStore::open(const fs::path& folder) {
  const nlohmann::json list = nlohmann::json::parse(read_file(folder / kList), nullptr, false);
  if (!list.is_array() || !fs::exists(folder / transport::kIdentityAuthorityKey)) {
    throw Failure(
        ExitCode::bad_input,
        fmt::format("{} is no key store ({} and {} make one); nothing was changed; make one with 'slewring keys "
                    "create'",
                    folder.string(), kList, transport::kIdentityAuthorityKey));
  }
  KeyStore store(folder);
  for (const nlohmann::json& one : list) {
    const std::string role = one.value("role", "");
    if (!allowed_to(role)) throw storage(folder / kList, "has an identity without a role");
    store.identities_.push_back({one.value("name", ""), role, one.value("session", "*"), one.value("days", 0)});
  }
  return store;
}

const KeyIdentity* KeyStore::find(const std::string& name) const {
  const auto found = std::find_if(identities_.begin(), identities_.end(),
                                  [&](const KeyIdentity& identity) { return identity.name == name; });
  return found != identities_.end() ? &*found : nullptr;
}

void KeyStore::make_authorities(int days) const {
  const fs::path config = folder_ / "openssl.cnf";
  write_file(config, kOpensslConfig);
  const auto make = [&](const char* what, const char* certificate, const char* key) {
    make_key(folder_ / key);
    run_openssl({"req", "-x509", "-new", "-config", config.string(), "-key", (folder_ / key).string(), "-out",
                 (folder_ / certificate).string(), "-days", std::to_string(days), "-set_serial", random_serial(),
                 "-subj", fmt::format("/O=Slewring/CN=authority of {} {}", what, random_serial().substr(2, 16))});
  };
  make("identities", transport::kIdentityAuthority, transport::kIdentityAuthorityKey);
  make("permissions", transport::kPermissionsAuthority, transport::kPermissionsAuthorityKey);
  const fs::path governance = folder_ / "governance.xml";
  write_file(governance, governance_xml());
  sign(governance, folder_ / transport::kGovernance, folder_);
}

void KeyStore::make_identity(const KeyIdentity& identity) const {
  const fs::path folder = folder_ / identity.name, request = folder / "request.pem",
                 certificate = folder / transport::kCertificate, permissions = folder / "permissions.xml";
  make_private_folder(folder);
  make_key(folder / transport::kPrivateKey);
  run_openssl({"req", "-new", "-config", (folder_ / "openssl.cnf").string(), "-key",
               (folder / transport::kPrivateKey).string(), "-out", request.string(), "-subj",
               "/O=Slewring/CN=" + identity.name});
  run_openssl({"x509", "-req", "-in", request.string(), "-CA", (folder_ / transport::kIdentityAuthority).string(),
               "-CAkey", (folder_ / transport::kIdentityAuthorityKey).string(), "-set_serial", random_serial(), "-days",
               std::to_string(identity.days), "-out", certificate.string()});
  fs::remove(request);
  // clocks of other machines may be behind
  const auto now = std::chrono::system_clock::now();
  const Allowed allowed = allowed_to(identity.role).value();
  Grant grant{identity.name,
              subject_of(certificate),
              identity.session,
              allowed.writes,
              allowed.reads,
              utc(now - std::chrono::hours(24)),
              utc(now + std::chrono::hours(24) * identity.days)};
  write_file(permissions, permissions_xml(grant));
  sign(permissions, folder / transport::kPermissions, folder_);
}

void KeyStore::write_list() const {
  nlohmann::json list = nlohmann::json::array();
  for (const KeyIdentity& one : identities_) {
    list.push_back({{"name", one.name}, {"role", one.role}, {"session", one.session}, {"days", one.days}});
  }
  const fs::path next = folder_ / (std::string(kList) + ".new");
  write_file(next, list.dump(2) + "\n");
  fs::rename(next, folder_ / kList);
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
  try {
    make_identity(identity);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(folder_ / identity.name, ignored);
    throw;
  }
  identities_.push_back(identity);
  write_list();
}

void KeyStore::revoke(const std::string& name) {
  const KeyIdentity* const revoked = find(name);
  if (revoked == nullptr) {
    throw Failure(
        ExitCode::bad_input,
        fmt::format("there is no identity '{}'; nothing was changed; 'slewring keys check' lists them", name));
  }
  int days = revoked->days;
  KeyStore next(folder_.string() + ".new");
  std::error_code error;
  fs::remove_all(next.folder_, error);
  for (const KeyIdentity& one : identities_) {
    days = std::max(days, one.days);
    if (one.name != name) next.identities_.push_back(one);
  }
  try {
    make_private_folder(next.folder_);
    next.make_authorities(days);
    for (const KeyIdentity& one : next.identities_) next.make_identity(one);
    next.write_list();
  } catch (...) {
    fs::remove_all(next.folder_, error);
    throw;
  }
  const fs::path old = folder_.string() + ".old";
  fs::remove_all(old, error);
  fs::rename(folder_, old, error);
  if (!error) {
    fs::rename(next.folder_, folder_, error);
    std::error_code ignored;
    if (error) fs::rename(old, folder_, ignored);
  }
  if (error) {
    const Failure failure = storage(folder_, "the store could not be replaced (" + error.message() + ")");
    fs::remove_all(next.folder_, error);
    throw failure;
  }
  fs::remove_all(old, error);
  identities_ = next.identities_;
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
  if (fs::exists(authority) && read_file(authority) != read_file(folder_ / transport::kIdentityAuthority)) {
    throw Failure(ExitCode::bad_input,
                  fmt::format("{} holds keys of another authority, or of this one before a revocation; nothing was "
                              "copied; remove it, or name another folder",
                              folder.string()));
  }
  make_private_folder(folder);
  const auto copy = [&](const fs::path& file) {
    std::error_code error;
    fs::copy_file(folder_ / file, folder / file, fs::copy_options::overwrite_existing, error);
    if (error) throw storage(folder / file, error.message());
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

// ---- check ------------------------------------------------------------------------------------------------------

namespace {

bool others_may_read(const fs::path& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && (status.st_mode & (S_IRWXG | S_IRWXO)) != 0;
}

// openssl's own words, on one line
std::string reason_of(const std::string& said) {
  const std::size_t from = said.find("error ");
  std::string line = said.substr(from == std::string::npos ? 0 : from);
  line = line.substr(0, line.find('\n'));
  return line;
}

std::string problem_of_signature(const std::string& document, const std::string& authority) {
  std::string said;
  const bool is_good =
      try_openssl({"smime", "-verify", "-in", document, "-CAfile", authority, "-text", "-out", "/dev/null"}, said);
  return is_good ? "" : fmt::format("{} is not signed by {}", document, authority);
}

// Of a signed document: whether it says what is signed today, line ends apart.
std::string problem_of_governance(const fs::path& document) {
  std::string text = read_file(document);
  std::erase(text, '\r');
  if (text.find(governance_xml()) != std::string::npos) return "";
  return fmt::format(
      "{} is that of another version and protects otherwise; 'slewring keys create' makes a store anew, to be exported "
      "to every machine",
      document.string());
}

// As the document writes times, of which the later one is the greater text; empty: it names none.
std::string permissions_end(const std::string& document) {
  constexpr std::string_view kBegin = "<not_after>";
  const std::size_t from = document.find(kBegin);
  if (from == std::string::npos) return "";
  return document.substr(from + kBegin.size(), document.find('<', from + 1) - from - kBegin.size());
}

KeyFinding check_identity(const fs::path& folder, const std::string& name) {
  KeyFinding finding{name, "", ""};
  transport::CycloneNetwork network;
  cli_support::require(transport::protect(network, {folder.string(), name}));
  const transport::CycloneSecurity& files = *network.security;
  std::string said;
  if (!try_openssl({"verify", "-CAfile", files.identity_authority, files.certificate}, said)) {
    finding.problem = fmt::format("the certificate is not good: {}", reason_of(said));
    return finding;
  }
  finding.expires = trimmed(run_openssl({"x509", "-in", files.certificate, "-noout", "-enddate"}));
  finding.expires = finding.expires.substr(finding.expires.find('=') + 1);
  const std::string of_certificate = run_openssl({"x509", "-in", files.certificate, "-noout", "-pubkey"});
  const std::string of_key = run_openssl({"pkey", "-in", files.private_key, "-pubout"});
  if (of_certificate != of_key) {
    finding.problem = "the private key is not that of the certificate";
  } else if (others_may_read(files.private_key)) {
    finding.problem = fmt::format("other users may read the private key; chmod 600 {}", files.private_key);
  } else {
    finding.problem = problem_of_signature(files.permissions, files.permissions_authority);
  }
  if (!finding.problem.empty()) return finding;
  const std::string subject = "<subject_name>" + subject_of(files.certificate) + "</subject_name>";
  const std::string permissions = read_file(files.permissions);
  if (permissions.find(subject) == std::string::npos) {
    finding.problem = "the permissions are those of another certificate";
  } else if (permissions_end(permissions) < utc(std::chrono::system_clock::now())) {
    finding.problem = "the permissions have expired";
  }
  return finding;
}

}  // namespace

std::vector<KeyFinding> check_keys(const fs::path& folder) {
  const fs::path authority = folder / transport::kIdentityAuthority;
  std::vector<std::string> names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (fs::exists(entry.path() / transport::kCertificate)) names.push_back(entry.path().filename().string());
  }
  if (!fs::exists(authority) || names.empty()) {
    throw Failure(ExitCode::bad_input, fmt::format("{} holds no keys: {} and a folder for each identity are expected",
                                                   folder.string(), transport::kIdentityAuthority));
  }
  std::sort(names.begin(), names.end());
  KeyFinding whole{"", "", ""};
  for (const char* key : {transport::kIdentityAuthorityKey, transport::kPermissionsAuthorityKey}) {
    if (!others_may_read(folder / key)) continue;
    whole.problem = fmt::format("other users may read an authority's key; chmod 600 {}", (folder / key).string());
  }
  if (whole.problem.empty()) {
    whole.problem = problem_of_signature((folder / transport::kGovernance).string(),
                                         (folder / transport::kPermissionsAuthority).string());
  }
  if (whole.problem.empty()) whole.problem = problem_of_governance(folder / transport::kGovernance);
  whole.expires = trimmed(run_openssl({"x509", "-in", authority.string(), "-noout", "-enddate"}));
  whole.expires = whole.expires.substr(whole.expires.find('=') + 1);
  std::vector<KeyFinding> findings = {whole};
  for (const std::string& name : names) findings.push_back(check_identity(folder, name));
  return findings;
}

}  // namespace slew::cli
