// SPDX-License-Identifier: Apache-2.0
#include "io_node/saved_session.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <bitset>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string_view>

#include "core/input_file.h"
#include "core/state_hash.h"

namespace slew::io_node {
namespace {

constexpr char kMagic[] = {'S', 'L', 'E', 'W', 'S', 'A', 'V', 'E'};

std::uint64_t check_of(std::span<const std::byte> bytes) {
  StateHash hash;
  hash.add_bytes(bytes.data(), bytes.size());
  return hash.digest();
}

class Bytes {
 public:
  template <typename T>
  void number(T value) {
    raw(&value, sizeof value);
  }
  void raw(const void* from, std::size_t size) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + size);
    if (size > 0) std::memcpy(bytes_.data() + at, from, size);
  }
  template <typename List>
  void sized(const List& list) {
    number(static_cast<std::uint64_t>(list.size()));
    raw(list.data(), list.size());
  }
  [[nodiscard]] const std::vector<std::byte>& all() const noexcept { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

class Fields {
 public:
  explicit Fields(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <typename T>
  [[nodiscard]] T number() {
    T value{};
    raw(&value, sizeof value);
    return value;
  }
  void raw(void* to, std::size_t size) {
    if (size > rest_.size()) is_good_ = false;
    if (!is_good_ || size == 0) return;
    std::memcpy(to, rest_.data(), size);
    rest_ = rest_.subspan(size);
  }
  template <typename List>
  void sized(List& list) {
    const auto size = number<std::uint64_t>();
    if (size > rest_.size()) is_good_ = false;
    if (!is_good_) return;
    list.resize(size);
    raw(list.data(), size);
  }
  [[nodiscard]] bool is_good() const noexcept { return is_good_; }
  [[nodiscard]] bool is_through() const noexcept { return is_good_ && rest_.empty(); }

 private:
  std::span<const std::byte> rest_;
  bool is_good_ = true;
};

std::vector<std::byte> bytes_of(const SavedSession& saved) {
  Bytes bytes;
  bytes.raw(kMagic, sizeof kMagic);
  bytes.number(kSavedFormat);
  for (const std::string* text : {&saved.build, &saved.session_name, &saved.scene_name, &saved.scene_text}) {
    bytes.sized(*text);
  }
  bytes.number(saved.communication_step.ns);
  bytes.number(saved.step);
  bytes.number(static_cast<std::uint32_t>(saved.assets.size()));
  for (const wire::Asset& asset : saved.assets) {
    bytes.sized(asset.name);
    bytes.number(asset.size);
    bytes.raw(asset.sha256.data(), asset.sha256.size());
  }
  bytes.number(static_cast<std::uint32_t>(saved.states.size()));
  for (const SavedState& of_role : saved.states) {
    bytes.number(static_cast<std::uint32_t>(of_role.role));
    bytes.number(of_role.state.state_hash);
    bytes.sized(of_role.state.bytes);
  }
  bytes.number(check_of(bytes.all()));
  return bytes.all();
}

// behind magic and version, in front of the check
bool take_fields(std::span<const std::byte> bytes, SavedSession& saved) {
  Fields fields(bytes);
  for (std::string* text : {&saved.build, &saved.session_name, &saved.scene_name, &saved.scene_text}) {
    fields.sized(*text);
  }
  saved.communication_step.ns = fields.number<std::int64_t>();
  saved.step = fields.number<std::int64_t>();
  const auto assets = fields.number<std::uint32_t>();
  if (assets > wire::kMaxAssets) return false;
  saved.assets.assign(assets, {});
  for (wire::Asset& asset : saved.assets) {
    fields.sized(asset.name);
    asset.size = fields.number<std::uint64_t>();
    fields.raw(asset.sha256.data(), asset.sha256.size());
  }
  const auto states = fields.number<std::uint32_t>();
  if (states > wire::kRoles) return false;
  saved.states.assign(states, {});
  std::bitset<wire::kRoles> roles;
  for (SavedState& of_role : saved.states) {
    const auto role = fields.number<std::uint32_t>();
    if (role >= wire::kRoles || roles.test(role)) return false;
    roles.set(role);
    of_role.role = static_cast<wire::Role>(role);
    of_role.state.step = saved.step;
    of_role.state.state_hash = fields.number<std::uint64_t>();
    fields.sized(of_role.state.bytes);
  }
  return fields.is_through() && saved.communication_step.ns > 0 && saved.step >= 0 && saved.step <= wire::kMaxStep;
}

Status failed(const std::filesystem::path& path, int error) {
  return Status::error(ExitCode::storage, path.string() + ": the session cannot be saved (" + std::strerror(error) +
                                              "); nothing was kept, and the session goes on; free space, or choose "
                                              "another place");
}

int write_and_close(int file, std::span<const std::byte> bytes) {
  int error = 0;
  while (!bytes.empty() && error == 0) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written >= 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  if (error == 0 && fsync(file) != 0) error = errno;
  if (close(file) != 0 && error == 0) error = errno;
  return error;
}

}  // namespace

const node::Checkpoint* SavedSession::find(wire::Role role) const noexcept {
  const auto found =
      std::find_if(states.begin(), states.end(), [role](const SavedState& state) { return state.role == role; });
  return found == states.end() ? nullptr : &found->state;
}

Status write_saved(const std::filesystem::path& path, const SavedSession& saved, Replace replace) {
  std::error_code ignored;
  if (replace == Replace::never && std::filesystem::exists(path, ignored)) {
    return Status::error(ExitCode::bad_input, path.string() +
                                                  ": the file exists already; it was left as it is; choose another "
                                                  "name, or replace it with --force");
  }
  const std::string part = path.string() + ".part" + std::to_string(getpid());
  const int file = open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (file < 0) return failed(path, errno);
  int error = write_and_close(file, bytes_of(saved));
  // a file written in the meantime is not replaced either, if the file system supports the check
  const unsigned how = replace == Replace::never ? RENAME_NOREPLACE : 0;
  if (error == 0 && renameat2(AT_FDCWD, part.c_str(), AT_FDCWD, path.c_str(), how) != 0) {
    const bool is_unsupported = how != 0 && errno == EINVAL;
    error = is_unsupported && rename(part.c_str(), path.c_str()) == 0 ? 0 : errno;
  }
  if (error != 0) unlink(part.c_str());
  return error == 0 ? Status::ok() : failed(path, error);
}

Status read_saved(const std::filesystem::path& path, SavedSession& saved) {
  const auto refuse = [&](const std::string& what) {
    return Status::error(ExitCode::bad_input, path.string() + ": " + what);
  };
  std::string text;
  if (const auto fault = read_input(path, kMaxAssetBytes, text)) return refuse(fault->text() + "; nothing was done");
  if (!text.starts_with(std::string_view(kMagic, sizeof kMagic))) {
    return refuse("is no saved session; nothing was done; expected a file of 'slewring control save'");
  }
  const std::span<const std::byte> bytes = std::as_bytes(std::span(text));
  const std::size_t size = bytes.size();
  constexpr std::size_t kFront = sizeof kMagic + sizeof kSavedFormat, kBack = sizeof(std::uint64_t);
  std::uint32_t format = 0;
  if (size >= kFront) std::memcpy(&format, bytes.data() + sizeof kMagic, sizeof format);
  if (size >= kFront && format != kSavedFormat) {
    return refuse("the session was saved in format version " + std::to_string(format) + ", this program reads " +
                  std::to_string(kSavedFormat) + "; use the slewring that wrote it");
  }
  std::uint64_t check = 0;
  if (size >= kFront + kBack) std::memcpy(&check, bytes.data() + size - kBack, kBack);
  const bool is_whole = size >= kFront + kBack && check == check_of(bytes.first(size - kBack)) &&
                        take_fields(bytes.subspan(kFront, size - kFront - kBack), saved);
  if (!is_whole) return refuse("is cut or damaged; nothing was done; look for an intact copy of the file");
  return Status::ok();
}

}  // namespace slew::io_node
