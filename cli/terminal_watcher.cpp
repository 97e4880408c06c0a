#include "cli/terminal_watcher.h"

#include "session/observer.h"

namespace slew::cli {

TerminalWatcher::TerminalWatcher(const session::RunOptions& options, const scene::Scene& scene)
    : mode_(status_mode(options.is_quiet || options.is_json)), status_(mode_), text_(scene) {
  if (options.scene.input == "keyboard") keyboard_.emplace(scene);
}

void TerminalWatcher::begin() {
  if (keyboard_) status_.print_line(keyboard_->levers().help());
}

bool TerminalWatcher::update(session::Observer& observer, std::int64_t now_ns, bool is_ending) {
  if (keyboard_) keyboard_->poll(observer, now_ns);
  text_.measure(observer.view(), now_ns);
  if (status_.is_due(now_ns) && !is_ending) status_.show(text_.text(observer.view()), now_ns);
  return true;
}

}  // namespace slew::cli
