// SPDX-License-Identifier: Apache-2.0
#include "gateway/foxglove_schemas.h"

#include <initializer_list>
#include <utility>

#include "core/json.h"

namespace slew::gateway {
namespace {

Json typed(const char* type) {
  return {{"type", type}};
}

Json object(std::initializer_list<Json::Member> properties) {
  return {{"type", "object"}, {"properties", Json(properties)}};
}

Json list_of(Json items) {
  return {{"type", "array"}, {"items", std::move(items)}};
}

// sec and nsec, as Foxglove recognises a time or a duration
Json time_schema(const char* title) {
  Json schema = object({{"sec", typed("integer")}, {"nsec", typed("integer")}});
  schema["title"] = title;
  return schema;
}

Json numbers(std::initializer_list<const char*> names) {
  Json properties = Json::object();
  for (const char* name : names) properties[name] = typed("number");
  return {{"type", "object"}, {"properties", std::move(properties)}};
}

Json vector_schema() {
  return numbers({"x", "y", "z"});
}

Json quaternion_schema() {
  return numbers({"x", "y", "z", "w"});
}

Json pose_schema() {
  return object({{"position", vector_schema()}, {"orientation", quaternion_schema()}});
}

Json color_schema() {
  return numbers({"r", "g", "b", "a"});
}

std::string text_of(Json schema, const char* title) {
  schema["title"] = title;
  return schema.dump(-1, Json::Order::as_put);
}

}  // namespace

std::string frame_transforms_schema() {
  return text_of(object({{"transforms", list_of(object({{"timestamp", time_schema("time")},
                                                        {"parent_frame_id", typed("string")},
                                                        {"child_frame_id", typed("string")},
                                                        {"translation", vector_schema()},
                                                        {"rotation", quaternion_schema()}}))}}),
                 "foxglove.FrameTransforms");
}

std::string scene_update_schema() {
  const Json solid = object({{"pose", pose_schema()}, {"size", vector_schema()}, {"color", color_schema()}});
  const Json cylinder = object({{"pose", pose_schema()},
                                {"size", vector_schema()},
                                {"bottom_scale", typed("number")},
                                {"top_scale", typed("number")},
                                {"color", color_schema()}});
  const Json line = object({{"type", typed("integer")},
                            {"pose", pose_schema()},
                            {"thickness", typed("number")},
                            {"scale_invariant", typed("boolean")},
                            {"points", list_of(vector_schema())},
                            {"color", color_schema()},
                            {"colors", list_of(color_schema())},
                            {"indices", list_of(typed("integer"))}});
  const Json triangles = object({{"pose", pose_schema()},
                                 {"points", list_of(vector_schema())},
                                 {"color", color_schema()},
                                 {"colors", list_of(color_schema())},
                                 {"indices", list_of(typed("integer"))}});
  const Json model = object({{"pose", pose_schema()},
                             {"scale", vector_schema()},
                             {"color", color_schema()},
                             {"override_color", typed("boolean")},
                             {"url", typed("string")},
                             {"media_type", typed("string")},
                             {"data", {{"type", "string"}, {"contentEncoding", "base64"}}}});
  const Json entity = object({{"timestamp", time_schema("time")},
                              {"frame_id", typed("string")},
                              {"id", typed("string")},
                              {"lifetime", time_schema("duration")},
                              {"frame_locked", typed("boolean")},
                              {"metadata", list_of(object({{"key", typed("string")}, {"value", typed("string")}}))},
                              {"arrows", list_of(object({}))},
                              {"cubes", list_of(solid)},
                              {"spheres", list_of(solid)},
                              {"cylinders", list_of(cylinder)},
                              {"lines", list_of(line)},
                              {"triangles", list_of(triangles)},
                              {"texts", list_of(object({}))},
                              {"models", list_of(model)}});
  const Json deletion =
      object({{"timestamp", time_schema("time")}, {"type", typed("integer")}, {"id", typed("string")}});
  return text_of(object({{"deletions", list_of(deletion)}, {"entities", list_of(entity)}}), "foxglove.SceneUpdate");
}

std::string log_schema() {
  return text_of(object({{"timestamp", time_schema("time")},
                         {"level", typed("integer")},
                         {"message", typed("string")},
                         {"name", typed("string")},
                         {"file", typed("string")},
                         {"line", typed("integer")}}),
                 "foxglove.Log");
}

}  // namespace slew::gateway
