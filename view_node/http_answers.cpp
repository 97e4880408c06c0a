// SPDX-License-Identifier: Apache-2.0
#include "view_node/http_answers.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "core/comma_list.h"
#include "view_node/page_files.h"

namespace slew::view_node {
namespace {

using gateway::Service;

constexpr std::string_view kRevalidated = "no-cache", kKept = "public, max-age=31536000, immutable";
constexpr std::string_view kJson = "application/json", kGlb = "model/gltf-binary", kSvg = "image/svg+xml";
constexpr std::size_t kHashLength = 8;  // esbuild's

// The content, or 304 for a client that has it.
HttpAnswer content_of(std::shared_ptr<const std::string> content, std::string_view type, const HttpRequest& request) {
  HttpAnswer answer;
  answer.type = type;
  answer.cache = kRevalidated;
  answer.entity_tag = entity_tag(*content);
  if (has_tag(request.conditions.if_none_match, answer.entity_tag)) {
    answer.status = 304;
  } else {
    answer.content = std::move(content);
  }
  return answer;
}

}  // namespace

bool is_of_scene(Service service) noexcept {
  return service == Service::scene || service == Service::saving || service == Service::restart;
}

HttpAnswer sentence(unsigned status, std::string text) {
  HttpAnswer answer;
  answer.status = status;
  answer.content = std::make_shared<const std::string>(std::move(text) + "\n");
  return answer;
}

bool accepts_gzip(std::string_view accept_encoding) noexcept {
  while (!accept_encoding.empty()) {
    const std::string_view one = take_listed(accept_encoding);
    std::string_view name = one.substr(0, one.find(';'));
    const std::string_view weight = one.substr(name.size());
    while (name.ends_with(' ')) name.remove_suffix(1);
    if (name != "gzip") continue;
    const std::size_t equals = weight.find('=');
    return equals == std::string_view::npos || weight.find_first_not_of("0. ", equals + 1) != std::string_view::npos;
  }
  return false;
}

bool has_hash_in_name(std::string_view path) noexcept {
  const std::string_view name = path.substr(path.rfind('/') + 1);
  const std::size_t dash = name.rfind('-');
  if (dash == std::string_view::npos) return false;
  const std::string_view hash = name.substr(dash + 1, name.find('.', dash) - dash - 1);
  return hash.size() == kHashLength &&
         std::ranges::all_of(hash, [](unsigned char c) { return std::isdigit(c) != 0 || std::isupper(c) != 0; });
}

HttpAnswer HttpAnswers::answer(const gateway::Verdict& verdict, const HttpRequest& request) const {
  if (verdict.service == Service::error) return sentence(verdict.status, verdict.text);
  const bool takes_body = verdict.service == Service::workspace || is_of_scene(verdict.service);
  if (!takes_body && !request.body.empty())
    return sentence(413, "a request has no body here; nothing was changed; use GET");
  switch (verdict.service) {
    case Service::error:
    case Service::websocket:
      break;
    case Service::session:
      return content_of(std::make_shared<const std::string>(def_.description().dump() + "\n"), kJson, request);
    case Service::asset:
      if (const auto asset = gateway_.asset(verdict.path)) return content_of(asset, kGlb, request);
      return sentence(404, "the session has no such mesh; /session.json lists them as 'graphics'");
    case Service::circuit:
      if (def_.circuit != nullptr) return content_of(def_.circuit, kSvg, request);
      return sentence(404, "the scene has no hydraulic components, so there is no diagram of a circuit");
    case Service::workspace:
      return workspace(request);
    case Service::scene:
    case Service::saving:
    case Service::restart:
      if (def_.is_looking_only) return sentence(403, "this window is for onlookers (--view-only); nothing was changed");
      return sentence(
          404,
          "this window has not started its session from a scene, whose file it therefore does not edit, nor "
          "does it restart the session; nothing was changed; open one with 'slewring window SCENE'");
    case Service::file:
      return file(verdict.path, request);
  }
  return sentence(verdict.status, verdict.text);
}

HttpAnswer HttpAnswers::file(const std::string& path, const HttpRequest& request) const {
  std::optional<PageFile> file =
      read_page_file(def_.web, path, accepts_gzip(request.accept_encoding) ? Packing::gzip : Packing::none);
  if (!file) return sentence(404, "there is no such file");
  HttpAnswer answer = content_of(std::make_shared<const std::string>(std::move(file->content)), file->type, request);
  if (has_hash_in_name(path)) answer.cache = kKept;
  answer.is_compressed = file->packing == Packing::gzip;
  answer.depends_on_encoding = true;
  return answer;
}

HttpAnswer HttpAnswers::workspace(const HttpRequest& request) const {
  if (request.method != "PUT") {
    std::optional<std::string> text = workspace_.read();
    if (!text) return sentence(404, "no workspace was saved for this scene; PUT saves one");
    return content_of(std::make_shared<const std::string>(std::move(*text)), kJson, request);
  }
  if (def_.is_looking_only) return sentence(403, "this window is for onlookers (--view-only); nothing was written");
  WorkspaceFile::Result result = workspace_.replace(request.body, request.conditions);
  HttpAnswer answer =
      result.problem.empty() ? HttpAnswer{.status = result.status} : sentence(result.status, std::move(result.problem));
  answer.entity_tag = std::move(result.entity_tag);
  return answer;
}

}  // namespace slew::view_node
