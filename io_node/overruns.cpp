// io_node's part that does what the overrun policy and load shedding ask for.
#include "io_node/io_node.h"

namespace slew::io_node {

// A change that the overrun policy makes is an event: an answer that nobody asked for, in the recording; a hold and the
// first slip are told to the user.
void IoNode::obey(const std::optional<Verdict>& verdict, std::int64_t now_ns) {
  if (!verdict || verdict->why.empty()) return;
  const char* then = "";
  if (verdict->what == scene::OverrunPolicy::hold) then = "; it is paused; 'slewring control resume' lets it go on";
  if (verdict->what == scene::OverrunPolicy::stop) {
    then = "; it was ended, what was recorded is valid; take a larger session.step, --rt, or session.overrun: slip";
  }
  const std::string text = verdict->why + then;
  tell_event(text);
  if (verdict->is_for_recording_alone) return;
  if (verdict->what == scene::OverrunPolicy::hold || (verdict->what == scene::OverrunPolicy::slip && !has_told_slip_))
    member_.warn(text);
  has_told_slip_ |= verdict->what == scene::OverrunPolicy::slip;
  if (verdict->what == scene::OverrunPolicy::hold) {
    is_paused_ = true;
    single_steps_ = 0;
    show_running();
  }
  if (verdict->what == scene::OverrunPolicy::stop) begin_ending(ExitCode::losses, text, now_ns);
}

void IoNode::tell_event(const std::string& text) {
  const wire::ControlRequest nobody;
  answer(nobody, true, text, n_);
}

void IoNode::shed_load() {
  bool has_controllers = false;
  for (std::size_t i = 0; i < gate_.size(); ++i) {
    has_controllers |= gate_.is_held(i) || gate_.config(i).controller == scene::ControllerMode::lockstep;
  }
  const std::string event = shedding_.look(n_, timing().response.count(), timing().overruns,
                                           has_controllers ? Steering::controllers : Steering::nobody);
  if (event.empty()) return;
  tell_event(event);
  ++timing().transitions;
  const std::uint32_t level = 1u << static_cast<unsigned>(shedding_.level());
  if ((told_levels_ & level) == 0) member_.warn(event + "; the next time this is in the recording alone");
  told_levels_ |= level;
}

void IoNode::keep_books(std::int64_t now_ns) noexcept {
  if (config_.session.pace != Pace::real || stage_ >= Stage::ending) return;
  const bool is_held = is_paused_ || controllers_due_ns_ != 0 || is_saving_now() || is_replacing();
  if (is_held || stage_ != Stage::ticking) {
    clock_.excuse(n_, now_ns);
    for (std::int64_t& came_ns : input_ns_) {
      if (came_ns != 0) came_ns = now_ns;
    }
  }
  clock_.close(n_, now_ns);
}

}  // namespace slew::io_node
