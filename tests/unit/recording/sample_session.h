// SPDX-License-Identifier: Apache-2.0
// A small recording with known content and its read-back, for comparison in the tests of the format.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "recording/reader.h"
#include "recording/writer.h"

namespace slew::recording {

// An empty directory that is removed with everything in it.
class ScratchDirectory {
 public:
  ScratchDirectory();
  ~ScratchDirectory();
  ScratchDirectory(const ScratchDirectory&) = delete;
  ScratchDirectory& operator=(const ScratchDirectory&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

struct KnownMessage {
  std::string topic;
  std::uint64_t log_time_ns = 0;
  std::uint32_t sequence = 0;
  std::string payload;
  bool operator==(const KnownMessage&) const = default;
};

inline constexpr const char* kTickTopic = "session/tick";
inline constexpr const char* kStateTopic = "mechanics/sample";
inline constexpr const char* kAttachmentName = "scene.yaml";
inline constexpr const char* kAttachmentText = "scene: {name: sample}\nbodies: {}\n";

[[nodiscard]] SessionIdentity sample_identity();
[[nodiscard]] WriterLimits small_limits();  // chunks of a few messages

// Payload whose bytes depend on the arguments and hardly compress.
[[nodiscard]] std::string sample_payload(std::uint64_t seed, std::size_t size);

// Writes attachment, two channels and the given number of steps, and closes by default.
enum class Ending { closed, open };
[[nodiscard]] std::unique_ptr<Writer> write_sample(const std::filesystem::path& path, StepIndex steps, Ending ending,
                                                   const WriterLimits& limits = small_limits());
[[nodiscard]] std::vector<KnownMessage> sample_messages(StepIndex steps);

[[nodiscard]] std::vector<KnownMessage> read_all(const Reader& reader, Status* status = nullptr,
                                                 const MessageFilter& filter = {});

// Bytes of each chunk of an intact file, and the number of messages in front of it.
struct ChunkPlace {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::size_t first_message = 0;
  std::size_t messages = 0;
};
[[nodiscard]] std::vector<ChunkPlace> chunks_of(const std::filesystem::path& path);

[[nodiscard]] std::string file_content(const std::filesystem::path& path);
void write_file(const std::filesystem::path& path, std::string_view content);

}  // namespace slew::recording
