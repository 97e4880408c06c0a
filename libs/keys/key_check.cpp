// SPDX-License-Identifier: Apache-2.0
// Lists the problems of a key store or of keys exported from one.
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>

#include "core/failure.h"
#include "keys/certificates.h"
#include "keys/key_files.h"
#include "keys/key_store.h"
#include "keys/security_documents.h"
#include "node/open_transport.h"
#include "transport/protection.h"

namespace slew::keys {
namespace {

namespace fs = std::filesystem;

bool others_may_read(const fs::path& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && (status.st_mode & (S_IRWXG | S_IRWXO)) != 0;
}

std::string problem_of_signature(const std::string& document, const std::string& authority) {
  return is_signed_by(document, authority) ? "" : fmt::format("{} is not signed by {}", document, authority);
}

// Problem of a signed governance document: it differs from the present text, line ends apart.
std::string problem_of_governance(const fs::path& document) {
  std::string text = read_file(document);
  std::erase(text, '\r');
  if (text.find(governance_xml()) != std::string::npos) return "";
  return fmt::format(
      "{} is of another version and has other protection rules; make a new store with 'slewring keys create' and "
      "export it "
      "to every machine",
      document.string());
}

// End of the validity as the document writes times, of which the later one is the greater text; empty: it has none.
std::string permissions_end(const std::string& document) {
  constexpr std::string_view kBegin = "<not_after>";
  const std::size_t from = document.find(kBegin);
  if (from == std::string::npos) return "";
  return document.substr(from + kBegin.size(), document.find('<', from + 1) - from - kBegin.size());
}

KeyFinding check_identity(const fs::path& folder, const std::string& name) {
  KeyFinding finding{name, "", ""};
  transport::Network network;
  require(transport::protect(network, {folder.string(), name}));
  const transport::SecurityFiles& files = *network.security;
  if (const std::string why = problem_of_certificate(files.certificate, files.identity_authority); !why.empty()) {
    finding.problem = fmt::format("the certificate is not good: {}", why);
    return finding;
  }
  finding.expires = end_of(files.certificate);
  if (!is_key_of(files.private_key, files.certificate)) {
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
  } else if (permissions_end(permissions) < utc_now()) {
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
  whole.expires = end_of(authority);
  std::vector<KeyFinding> findings = {whole};
  for (const std::string& name : names) findings.push_back(check_identity(folder, name));
  return findings;
}

}  // namespace slew::keys
