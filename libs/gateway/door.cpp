// SPDX-License-Identifier: Apache-2.0
#include "gateway/door.h"

#include <arpa/inet.h>

#include <algorithm>
#include <iterator>

#include "core/comma_list.h"

namespace slew::gateway {
namespace {

constexpr std::size_t kMaxTarget = 2048;
constexpr std::string_view kTokenKey = "token=";
constexpr std::string_view kAssetFolder = "assets/", kAssetEnding = ".glb";

// Paths that are no files of the page, and what they take beside GET and HEAD; those with a method alone take no other.
struct OwnPath {
  std::string_view path;
  Service service;
  std::string_view method;
  bool is_read = true;
};
constexpr OwnPath kOwnPaths[] = {
    {"session.json", Service::session, ""},        {"workspace.json", Service::workspace, "PUT"},
    {"circuit.svg", Service::circuit, ""},         {"scene.json", Service::scene, "POST"},
    {"scene.yaml", Service::saving, "PUT", false}, {"restart", Service::restart, "POST", false}};

Verdict error(unsigned status, std::string text) {
  Verdict verdict;
  verdict.status = status;
  verdict.text = std::move(text);
  return verdict;
}

// "127.0.0.1:8765" and "[::1]:8765" without the port.
std::string_view name_of(std::string_view host) noexcept {
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    return end == std::string_view::npos ? std::string_view() : host.substr(1, end - 1);
  }
  return host.substr(0, host.find(':'));
}

bool is_accepted_host(const DoorDef& door, std::string_view host) {
  const std::string_view name = name_of(host);
  return is_address(name) || name == "localhost" || std::ranges::find(door.hosts, name) != door.hosts.end();
}

bool is_accepted_origin(const DoorDef& door, const Request& request) {
  if (!request.has_origin || std::ranges::find(door.origins, request.origin) != door.origins.end()) return true;
  constexpr std::string_view kHttp = "http://", kHttps = "https://";
  const std::string_view scheme = request.origin.starts_with(kHttps) ? kHttps : kHttp;
  return request.origin.starts_with(scheme) && request.origin.substr(scheme.size()) == request.host;
}

// The time does not depend on the place of the first difference.
bool is_same(std::string_view a, std::string_view b) noexcept {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    difference |= static_cast<unsigned>(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  return difference == 0;
}

std::string_view token_of(std::string_view query) noexcept {
  while (!query.empty()) {
    const std::string_view part = query.substr(0, query.find('&'));
    if (part.starts_with(kTokenKey)) return part.substr(kTokenKey.size());
    query.remove_prefix(std::min(query.size(), part.size() + 1));
  }
  return {};
}

// A relative path of plain names: no "..", no hidden file, no encoded character. None: it is another one.
std::optional<std::string> plain_path(std::string_view path) {
  if (!path.starts_with('/') || path.find("..") != std::string_view::npos) return std::nullopt;
  path.remove_prefix(1);
  bool is_begin = true;  // of a name
  for (const char c : path) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!is_letter && c != '-' && c != '_' && c != '.' && c != '/') return std::nullopt;
    if (is_begin && (c == '.' || c == '/')) return std::nullopt;
    is_begin = c == '/';
  }
  return path.empty() || path.ends_with('/') ? std::string(path) + "index.html" : std::string(path);
}

std::optional<Subprotocol> chosen_subprotocol(std::string_view offered) {
  std::optional<Subprotocol> chosen;
  while (!offered.empty()) {
    const std::string_view one = take_listed(offered);
    if (one == to_text(Subprotocol::sdk_v1)) return Subprotocol::sdk_v1;
    if (one == to_text(Subprotocol::websocket_v1)) chosen = Subprotocol::websocket_v1;
  }
  return chosen;
}

Verdict judge_upgrade(const Request& request) {
  const auto subprotocol = chosen_subprotocol(request.subprotocols);
  if (!subprotocol) {
    return error(400,
                 "the WebSocket's subprotocol is not supported; no connection was made; offer foxglove.sdk.v1 or "
                 "foxglove.websocket.v1");
  }
  Verdict verdict;
  verdict.service = Service::websocket;
  verdict.status = 101;
  verdict.subprotocol = *subprotocol;
  return verdict;
}

}  // namespace

std::string_view to_text(Subprotocol subprotocol) noexcept {
  return subprotocol == Subprotocol::sdk_v1 ? "foxglove.sdk.v1" : "foxglove.websocket.v1";
}

bool is_address(std::string_view text) noexcept {
  char name[INET6_ADDRSTRLEN] = {};
  if (text.empty() || text.size() >= sizeof name) return false;
  std::ranges::copy(text, name);
  unsigned char bytes[sizeof(in6_addr)];
  return inet_pton(AF_INET, name, bytes) == 1 || inet_pton(AF_INET6, name, bytes) == 1;
}

bool is_origin(std::string_view text) noexcept {
  constexpr std::string_view kMark = "://";
  if (text == "null" || text == "file://") return true;
  const auto is_of = [](std::string_view part, std::string_view more) {
    return !part.empty() && std::ranges::all_of(part, [&](char c) {
      return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || more.find(c) != std::string_view::npos;
    });
  };
  const std::size_t mark = text.find(kMark);
  if (mark == std::string_view::npos) return false;
  const std::string_view scheme = text.substr(0, mark);
  const std::string_view rest = text.substr(mark + kMark.size());
  const std::size_t end = rest.starts_with('[') ? rest.find(']') : rest.find(':');
  const bool is_v6 = rest.starts_with('[') && end != std::string_view::npos;
  const std::string_view host = is_v6 ? rest.substr(1, end - 1) : rest.substr(0, end);
  if (!is_of(scheme, "+-.") || !(is_v6 ? is_address(host) : is_of(host, "-._"))) return false;
  const std::string_view port = end == std::string_view::npos ? "" : rest.substr(is_v6 ? end + 1 : end);
  if (port.empty()) return true;
  const bool is_own = (scheme == "http" && port == ":80") || (scheme == "https" && port == ":443");
  return port.starts_with(':') && port.size() <= 6 && !is_own && port.find_first_not_of("0123456789", 1) == port.npos &&
         port.size() > 1;
}

bool is_loopback(std::string_view address) noexcept {
  return is_address(address) && (address.starts_with("127.") || address == "::1");
}

Verdict judge(const DoorDef& door, const Request& request) {
  if (!is_accepted_host(door, request.host)) {
    return error(403,
                 "the name in the Host header is not one of this gateway's; nothing was sent; use its address, or "
                 "start it with --host NAME");
  }
  if (!is_accepted_origin(door, request)) {
    return error(403,
                 "the page that made this request is not the gateway's own; nothing was sent; allow its origin with "
                 "--allow-origin, such as --allow-origin https://app.foxglove.dev");
  }
  if (request.target.size() > kMaxTarget) return error(414, "the address is too long; nothing was sent");
  const std::size_t mark = request.target.find('?');
  const std::optional<std::string> path = plain_path(request.target.substr(0, mark));
  if (!path) {
    return error(404, "there is no such file; paths have letters, digits, '-', '_', '.' and '/', and no hidden names");
  }
  const auto own = std::ranges::find(kOwnPaths, std::string_view(*path), &OwnPath::path);
  const bool is_own = own != std::end(kOwnPaths);
  const bool is_read = request.method == "GET" || request.method == "HEAD";
  if (is_read ? is_own && !own->is_read : !is_own || request.method != own->method) {
    return error(405,
                 "the method is not supported; nothing was changed; use GET, or PUT for /workspace.json and "
                 "/scene.yaml, or POST for /scene.json and /restart");
  }
  const std::string_view query = mark == std::string_view::npos ? std::string_view() : request.target.substr(mark + 1);
  const bool is_asset = path->starts_with(kAssetFolder) && path->ends_with(kAssetEnding);
  const bool needs_token = request.is_upgrade || is_asset || is_own;
  if (needs_token && !door.token.empty() && !is_same(token_of(query), door.token)) {
    return error(401, "the token is missing or wrong; nothing was sent; add ?token=... to the address");
  }
  if (request.is_upgrade) return judge_upgrade(request);
  Verdict verdict;
  verdict.status = 200;
  verdict.service = is_own ? own->service : is_asset ? Service::asset : Service::file;
  verdict.path = is_asset ? path->substr(kAssetFolder.size()) : *path;
  return verdict;
}

}  // namespace slew::gateway
