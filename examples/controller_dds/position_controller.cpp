// SPDX-License-Identifier: Apache-2.0
// Closes a position loop on a cylinder of a running session, from outside: it reads the variables that the nodes
// publish and writes one input channel. It depends only on idl/slewring.idl and Cyclone DDS; examples/controller is the
// same with Slewring's client library.
//
//   position_controller --session crane --variable Cyl_Lift.stroke --channel Input_Lift --target 0.86
//
// Steps: find the variable's owner and index in the directory, acquire the channel, then answer every value of the
// variable, in order, with a stick value; release the channel at the end. A lockstep channel needs no more than that.
#include <dds/dds.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "slewring.h"

namespace {

constexpr std::size_t kMostWaiting = 128;  // values that a writer keeps

struct Options {
  std::string session;
  std::string variable = "Cyl_Lift.stroke";
  std::string channel = "Input_Lift";
  std::string name = "position_controller";
  double target = 0.86;     // unit of the variable
  double tolerance = 1e-3;  // unit of the variable
  double gain = 20;         // stick per unit of error
  double overlap = 0.32;    // the valve does nothing below this stick value
  double seconds = 15;      // gives up after this wall time
  unsigned domain = 0;
};
constexpr double kLastDomain = 230;  // DDS: a port is 7400 + 250 domain + ...

constexpr char kUsage[] =
    "usage: position_controller --session NAME [--variable Cyl_Lift.stroke] [--channel Input_Lift]\n"
    "         [--target 0.86] [--tolerance 0.001] [--gain 20] [--overlap 0.32] [--seconds 15]\n"
    "         [--name position_controller] [--domain 0]\n"
    "Example, with `slewring run scenes/truck_crane.yaml --input none --duration 0` in another terminal:\n"
    "  position_controller --session truck_crane --variable Cyl_Lift.stroke --channel Input_Lift --target 0.86\n";

// the whole text as a finite number
bool read_number(const char* text, double& number) {
  char* end = nullptr;
  number = std::strtod(text, &end);
  return end != text && *end == '\0' && std::isfinite(number);
}

// Fills the options; reports a problem with the expected value.
bool parse(int argc, char** argv, Options& options) {
  const auto refuse = [](const char* key, const char* problem) {
    std::fprintf(stderr, "position_controller: %s: %s; nothing was moved\n%s", key, problem, kUsage);
    return false;
  };
  const struct {
    const char* key;
    double* number;
  } numbers[] = {{"--target", &options.target},
                 {"--tolerance", &options.tolerance},
                 {"--gain", &options.gain},
                 {"--overlap", &options.overlap},
                 {"--seconds", &options.seconds}};
  const struct {
    const char* key;
    std::string* text;
  } texts[] = {{"--session", &options.session},
               {"--variable", &options.variable},
               {"--channel", &options.channel},
               {"--name", &options.name}};
  for (int i = 1; i < argc; i += 2) {
    const char* key = argv[i];
    const auto is_key = [key](const auto& option) { return std::strcmp(option.key, key) == 0; };
    const auto number = std::find_if(std::begin(numbers), std::end(numbers), is_key);
    const auto text = std::find_if(std::begin(texts), std::end(texts), is_key);
    const bool is_domain = std::strcmp(key, "--domain") == 0;
    if (number == std::end(numbers) && text == std::end(texts) && !is_domain) return refuse(key, "unknown option");
    if (i + 1 == argc) return refuse(key, "expected a value");
    const char* value = argv[i + 1];
    if (text != std::end(texts)) *text->text = value;
    if (number != std::end(numbers) && !read_number(value, *number->number)) return refuse(key, "expected a number");
    if (is_domain) {
      double domain = 0;
      if (!read_number(value, domain) || domain < 0 || domain > kLastDomain || domain != std::floor(domain)) {
        return refuse(key, "expected a whole number, 0 to 230");
      }
      options.domain = static_cast<unsigned>(domain);
    }
  }
  if (options.session.empty()) return refuse("--session", "expected the name of a running session");
  return true;
}

// loopback only, unicast, with timers that repair a lost packet within milliseconds
constexpr char kConfiguration[] =
    "<CycloneDDS><Domain Id=\"any\"><General><Interfaces><NetworkInterface name=\"lo\" "
    "multicast=\"false\"/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>60</MaxAutoParticipantIndex><SPDPInterval>500ms</SPDPInterval>"
    "<LeaseDuration>2s</LeaseDuration><Peers><Peer Address=\"127.0.0.1\"/></Peers></Discovery>"
    "<Internal><HeartbeatInterval min=\"2ms\" minsched=\"2ms\" max=\"20ms\">5ms</HeartbeatInterval>"
    "<NackDelay>0ms</NackDelay><PreEmptiveAckDelay>1ms</PreEmptiveAckDelay></Internal></Domain></CycloneDDS>";

struct Endpoints {
  dds_entity_t participant, directory, variables, lease, input;
};

dds_entity_t checked(dds_entity_t entity, const char* what) {
  if (entity < 0) {
    std::fprintf(stderr, "position_controller: cannot create %s: %s\n", what, dds_strretcode(-entity));
    std::exit(1);
  }
  return entity;
}

Endpoints connect(const Options& options) {
  checked(dds_create_domain(options.domain, kConfiguration), "the domain");
  Endpoints e{};
  e.participant = checked(dds_create_participant(options.domain, nullptr, nullptr), "a participant");
  // every topic of a session is in the partition slewring/<session>
  const std::string partition = "slewring/" + options.session;
  const char* partitions[] = {partition.c_str()};
  dds_qos_t* group = dds_create_qos();
  dds_qset_partition(group, 1, partitions);
  const dds_entity_t subscriber = checked(dds_create_subscriber(e.participant, group, nullptr), "a subscriber");
  const dds_entity_t publisher = checked(dds_create_publisher(e.participant, group, nullptr), "a publisher");
  dds_delete_qos(group);

  dds_qos_t* lasting = dds_create_qos();
  dds_qset_reliability(lasting, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_history(lasting, DDS_HISTORY_KEEP_LAST, 64);
  dds_qset_durability(lasting, DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qos_t* streaming = dds_create_qos();
  dds_qset_reliability(streaming, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_history(streaming, DDS_HISTORY_KEEP_LAST, 1024);

  const auto topic = [&](const dds_topic_descriptor_t* type, const char* name) {
    return checked(dds_create_topic(e.participant, type, name, nullptr, nullptr), name);
  };
  e.directory =
      checked(dds_create_reader(subscriber, topic(&slewring_VariableDirectory_desc, "slewring/variable_directory"),
                                lasting, nullptr),
              "the directory's reader");
  // also the last blocks from before this reader was discovered: those of step 0, which a lockstep channel's first tick
  // needs
  dds_qset_history(lasting, DDS_HISTORY_KEEP_LAST, 1024);
  e.variables = checked(
      dds_create_reader(subscriber, topic(&slewring_VariableBlock_desc, "slewring/variables"), lasting, nullptr),
      "the variables' reader");
  e.lease = checked(dds_create_reader(subscriber, topic(&slewring_ControllerLease_desc, "slewring/controller_lease"),
                                      streaming, nullptr),
                    "the leases' reader");
  e.input = checked(dds_create_writer(publisher, topic(&slewring_ControllerInput_desc, "slewring/controller_input"),
                                      streaming, nullptr),
                    "the input's writer");
  dds_delete_qos(lasting);
  dds_delete_qos(streaming);
  return e;
}

// takes every sample that is there and hands it to `use`
template <typename Sample, typename Use>
void take_all(dds_entity_t reader, Use use) {
  void* samples[1] = {nullptr};
  dds_sample_info_t information[1];
  while (dds_take(reader, samples, information, 1, 1) > 0) {
    if (information[0].valid_data) use(*static_cast<const Sample*>(samples[0]));
    dds_return_loan(reader, samples, 1);
  }
}

// place of the variable: writer's role and position in that node's blocks
struct Place {
  bool is_known = false;
  slewring_Role role = slewring_ROLE_MECHANICS;
  unsigned index = 0;
};

class Loop {
 public:
  Loop(const Options& options, const Endpoints& endpoints) : options_(options), e_(endpoints) {}

  void find_variable() {
    take_all<slewring_VariableDirectory>(e_.directory, [&](const slewring_VariableDirectory& d) {
      for (unsigned i = 0; i < d.entries._length; ++i) {
        if (options_.variable == d.entries._buffer[i].name) place_ = {true, d.header.role, d.first + i};
      }
    });
  }

  // Keeps the new values of the variable with their steps, until they are answered. They may arrive before the
  // directory that names them and before the lease that was granted first: a lockstep channel needs them from step 0
  // on.
  void read_variable() {
    if (!place_.is_known) return;
    take_all<slewring_VariableBlock>(e_.variables, [&](const slewring_VariableBlock& block) {
      if (block.header.role != place_.role) return;
      if (place_.index < block.first || place_.index >= block.first + block.values._length) return;
      waiting_.emplace_back(block.header.step, block.values._buffer[place_.index - block.first]);
    });
    // in mid-run only the newest is used
    const std::size_t most = has_lease_ ? (is_begun_late_ ? 1 : waiting_.size()) : kMostWaiting;
    while (waiting_.size() > most) waiting_.erase(waiting_.begin());
    if (has_lease_) is_begun_late_ = false;
  }

  // answers the oldest waiting value; false when there is none
  bool answer() {
    if (waiting_.empty()) return false;
    std::tie(step_, value_) = waiting_.front();
    waiting_.erase(waiting_.begin());
    send(slewring_CONTROLLER_WRITE, stick());
    return true;
  }

  void read_lease() {
    take_all<slewring_ControllerLease>(e_.lease, [&](const slewring_ControllerLease& lease) {
      if (options_.name != lease.controller || options_.channel != lease.channel) return;
      // the lease may answer or inform another process of this name
      const bool is_notice = lease.answers == 0;
      if (is_notice ? !has_lease_ : lease.answers < requested_from_ || lease.answers > sequence_) return;
      const bool is_taken_away = has_lease_ && !lease.is_granted && *lease.holder == '\0';
      const bool had_lease = has_lease_;
      has_lease_ = lease.is_granted && options_.name == lease.holder;
      if (has_lease_ && !had_lease) is_begun_late_ = lease.header.step > 0;
      if (is_taken_away) {
        std::fprintf(stderr, "position_controller: %s\n", lease.reason);
        requested_from_ = sequence_ + 1;
      } else if (!lease.is_granted) {
        refusal_ = lease.reason;
      }
    });
  }

  void send(slewring_ControllerAction action, double stick) {
    slewring_ControllerInput input{};
    std::snprintf(input.session, sizeof input.session, "%s", options_.session.c_str());
    std::snprintf(input.controller, sizeof input.controller, "%s", options_.name.c_str());
    std::snprintf(input.channel, sizeof input.channel, "%s", options_.channel.c_str());
    input.action = action;
    input.value = stick;
    input.sequence_number = ++sequence_;
    input.based_on_step = step_;
    dds_write(e_.input, &input);
  }

  // proportional, with a jump over the valve's overlap and a rest within half the tolerance
  [[nodiscard]] double stick() const {
    const double error = options_.target - value_;
    if (std::fabs(error) < 0.5 * options_.tolerance) return 0;
    const double share = std::min(1.0, std::fabs(options_.gain * error));
    return std::copysign(options_.overlap + (1 - options_.overlap) * share, error);
  }

  [[nodiscard]] bool has_place() const { return place_.is_known; }
  [[nodiscard]] bool has_lease() const { return has_lease_; }
  [[nodiscard]] const std::string& refusal() const { return refusal_; }
  [[nodiscard]] double value() const { return value_; }
  [[nodiscard]] bool is_there() const { return std::fabs(options_.target - value_) < options_.tolerance; }

 private:
  const Options& options_;
  Endpoints e_;
  Place place_;
  bool has_lease_ = false;
  bool is_begun_late_ = false;  // the lease was granted in mid-run, and nothing has been answered since
  std::string refusal_;
  std::vector<std::pair<std::int64_t, double>> waiting_;  // step and value
  double value_ = 0;
  std::int64_t step_ = -1;
  std::uint64_t sequence_ = std::random_device()() * (std::uint64_t{1} << 31);  // no other process's numbers
  std::uint64_t requested_from_ = sequence_ + 1;  // first message that may request the channel
};

}  // namespace

int main(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--help") != 0 && std::strcmp(argv[i], "-h") != 0) continue;
    std::fputs(kUsage, stdout);
    return 0;
  }
  if (!parse(argc, argv, options)) return 2;
  const Endpoints endpoints = connect(options);
  const dds_entity_t waitset = dds_create_waitset(endpoints.participant);
  for (const dds_entity_t reader : {endpoints.directory, endpoints.variables, endpoints.lease}) {
    dds_set_status_mask(reader, DDS_DATA_AVAILABLE_STATUS);
    dds_waitset_attach(waitset, reader, 0);
  }

  Loop loop(options, endpoints);
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  auto requested = begin - std::chrono::seconds(1);
  int steady = 0;  // values in a row within the tolerance
  bool had_lease = false;
  while (std::chrono::duration<double>(Clock::now() - begin).count() < options.seconds && steady < 100) {
    dds_waitset_wait(waitset, nullptr, 0, DDS_MSECS(20));
    loop.find_variable();  // also empties the reader, which would wake the waitset again and again
    loop.read_lease();
    if (!loop.refusal().empty()) {
      std::fprintf(stderr, "position_controller: refused: %s\n", loop.refusal().c_str());
      return 1;
    }
    loop.read_variable();
    had_lease |= loop.has_lease();
    if (!loop.has_lease()) {
      // repeats the request until the session answers
      if (loop.has_place() && Clock::now() - requested > std::chrono::milliseconds(100)) {
        requested = Clock::now();
        loop.send(slewring_CONTROLLER_ACQUIRE, 0);
      }
      continue;
    }
    while (steady < 100 && loop.answer()) steady = loop.is_there() ? steady + 1 : 0;
  }
  if (loop.has_lease()) loop.send(slewring_CONTROLLER_RELEASE, 0);
  dds_delete(endpoints.participant);
  if (!loop.has_place()) {
    std::fprintf(stderr, "position_controller: no session '%s' in domain %u publishes %s\n", options.session.c_str(),
                 options.domain, options.variable.c_str());
    return 1;
  }
  if (!had_lease) {
    std::fprintf(stderr,
                 "position_controller: session '%s' did not answer for channel %s within %g s; nothing was moved\n",
                 options.session.c_str(), options.channel.c_str(), options.seconds);
    return 1;
  }
  std::printf("%s = %.5f, target %.5f: %s\n", options.variable.c_str(), loop.value(), options.target,
              steady >= 100 ? "reached" : "not reached");
  return steady >= 100 ? 0 : 1;
}
