// SPDX-License-Identifier: Apache-2.0
#include "bridge/bridge.h"
#include "bridge/log_export.h"
#include "core/failure.h"

namespace slew::bridge {

struct Bridge::State final : observer::Receiver {};
struct LogExport::State {};

void require_lcm() {
  throw Failure(ExitCode::resources,
                "this program was built without LCM; nothing was started; install liblcm-dev and liblcm-bin, and build "
                "it again");
}

// require_lcm() is called before each of these
Bridge::Bridge(Settings) {
  require_lcm();
}
Bridge::~Bridge() = default;
observer::Receiver& Bridge::receiver() noexcept {
  return *state_;
}
bool Bridge::is_door() const noexcept {
  return false;
}
std::string Bridge::types(observer::Observer&) {
  return {};
}
void Bridge::run(observer::Observer&, const SceneView&, const std::function<void(const std::string&)>&) {}
Json Bridge::summary() const {
  return {};
}
std::string Bridge::summary_text() const {
  return {};
}
LogExport::LogExport(const Settings&, const std::string&, SceneView, std::function<void(std::string_view)>) {
  require_lcm();
}
LogExport::~LogExport() = default;
void LogExport::choose(std::uint64_t, std::uint64_t) {}
observer::Receiver& LogExport::receiver(const observer::SessionView&) {
  throw Failure(ExitCode::resources, "");
}
std::int64_t LogExport::events() const noexcept {
  return 0;
}
std::uint64_t LogExport::incomplete() const noexcept {
  return 0;
}
std::vector<std::string> LogExport::missing_inputs() const {
  return {};
}

}  // namespace slew::bridge
