// SPDX-License-Identifier: Apache-2.0
// Answers to HTTP requests that the door lets in: the page, its workspace, the session's description and its meshes.
//
// A file FILE of the page is sent as FILE.gz to clients that take it, if that one lies beside it and is not older.
// Every answer with a content has an entity tag and is revalidated by it; files whose name has a hash of their content
// (page-3F2A9C1B.js, as bundlers write them) are kept for a year.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "gateway/door.h"
#include "gateway/gateway.h"
#include "view_node/entity_tag.h"
#include "view_node/server_def.h"
#include "view_node/workspace_file.h"

namespace slew::view_node {

struct HttpRequest {
  std::string_view method;
  std::string_view accept_encoding;
  Conditions conditions;
  std::string body;
};

struct HttpAnswer {
  unsigned status = 200;
  std::shared_ptr<const std::string> content{};  // null: none
  std::string_view type = "text/plain; charset=utf-8";
  std::string_view cache = "no-store";
  std::string entity_tag{};          // empty: none
  bool is_compressed = false;        // gzip
  bool depends_on_encoding = false;  // another Accept-Encoding may have another answer
};

class HttpAnswers {
 public:
  // Both outlive this.
  HttpAnswers(const ServerDef& def, const gateway::Gateway& gateway)
      : def_(def), gateway_(gateway), workspace_(def.workspace) {}

  // verdict: not of a WebSocket. Those of a scene are refused: see scene_editing.h.
  [[nodiscard]] HttpAnswer answer(const gateway::Verdict& verdict, const HttpRequest& request) const;

 private:
  [[nodiscard]] HttpAnswer file(const std::string& path, const HttpRequest& request) const;
  [[nodiscard]] HttpAnswer workspace(const HttpRequest& request) const;

  const ServerDef& def_;
  const gateway::Gateway& gateway_;
  WorkspaceFile workspace_;
};

[[nodiscard]] bool is_of_scene(gateway::Service service) noexcept;

// A refusal, or what was done, as a sentence.
[[nodiscard]] HttpAnswer sentence(unsigned status, std::string text);

// gzip is in the list of Accept-Encoding, and not with the weight 0 (RFC 9110, 12.5.3).
[[nodiscard]] bool accepts_gzip(std::string_view accept_encoding) noexcept;

// The file's name has a hash of its content: NAME-HASH.ENDING, eight letters or digits.
[[nodiscard]] bool has_hash_in_name(std::string_view path) noexcept;

}  // namespace slew::view_node
