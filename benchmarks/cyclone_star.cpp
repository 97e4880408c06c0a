// SPDX-License-Identifier: Apache-2.0
// How many steps per second the exchange alone allows: the session's messages among three processes, without physics.
//
// The master publishes tick n when both nodes' samples n-W+1 are there; a node publishes sample n+1 when it has tick n
// and its partner's sample n. Messages are as large as the truck crane's: 8 channels, 3 ports. Two ways in one run:
//   bare       generated C types, dds_write and dds_take with a waitset, Cyclone's serialiser
//   transport  our codec and cyclone_transport
// and with `fastdds` two more, where Fast DDS is installed: our codec over Fast DDS, by UDP and in shared memory.
// The distributed crane in `free` pace is compared with these figures.
//
//   cyclone_star [STEPS=20000] [REPEATS=3] [fastdds]
#include <dds/dds.h>
#include <fmt/format.h>
#include <signal.h>
#include <slewring.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <string_view>
#include <vector>

#include "core/time.h"
#include "tests/support/test_domain.h"
#include "transport/cdr/codec.h"
#include "transport/cyclone/cyclone_domain.h"
#include "transport/network.h"

namespace {

using namespace slew;
using namespace slew::transport;
using wire::Topic;

constexpr std::size_t kPorts = 3;
constexpr std::size_t kChannels = 8;
constexpr std::int64_t kGiveUp = 20'000'000'000;  // ns without any message
constexpr std::int64_t kJoinPeriod = 2'000'000;   // ns between two join probes
constexpr StepIndex kHello = -2;                  // "I am here"
constexpr StepIndex kReceivedAll = -1;            // all others have been received

constexpr std::array<Topic, 3> kTopics = {Topic::tick, Topic::mechanism, Topic::actuators};

[[noreturn]] void fail(const std::string& text) {
  fmt::print(stderr, "cyclone_star: {}\n", text);
  std::exit(1);
}

// One process's connection: a step number out, step numbers in.
class Link {
 public:
  virtual ~Link() = default;
  virtual void send(StepIndex step) = 0;
  virtual bool take(Topic& topic, StepIndex& step) = 0;
  virtual void wait_until(std::int64_t monotonic_deadline_ns) = 0;
};

TopicSet all_but(Topic own) {
  TopicSet set;
  for (const Topic topic : kTopics) {
    if (topic != own) set.insert(topic);
  }
  return set;
}

class TransportLink final : public Link {
 public:
  TransportLink(Middleware middleware, std::uint32_t domain, Topic own) : own_(own) {
    const Status status = open_transport(Network{domain, "lo", {}, {}, middleware},
                                         {"star", traits(own).name, {own}, all_but(own)}, transport_);
    if (!status.is_ok()) fail(status.text);
    tick_.controls.resize(kChannels);
    tick_.age.resize(kChannels);
    coupling::resize(mechanism_.sample, kPorts);
    coupling::resize(actuators_.sample, kPorts);
  }

  void send(StepIndex step) override {
    if (own_ == Topic::tick) publish(tick_, step);
    if (own_ == Topic::mechanism) publish(mechanism_, step);
    if (own_ == Topic::actuators) publish(actuators_, step);
  }

  bool take(Topic& topic, StepIndex& step) override {
    Received message;
    if (!transport_->take(message)) return false;
    topic = message.topic;
    if (topic == Topic::tick) step = read(message.bytes, tick_);
    if (topic == Topic::mechanism) step = read(message.bytes, mechanism_);
    if (topic == Topic::actuators) step = read(message.bytes, actuators_);
    return true;
  }

  void wait_until(std::int64_t deadline) override { transport_->wait_until(deadline); }

 private:
  template <typename M>
  void publish(M& message, StepIndex step) {
    message.header.step = step + kFirstOnWire;
    if (!encode(message, buffer_)) fail("encoding failed");
    if (const Status status = transport_->publish(own_, buffer_); !status.is_ok()) fail(status.text);
  }
  template <typename M>
  static StepIndex read(Bytes bytes, M& message) {
    if (!decode(bytes, message)) fail("decoding failed");
    return message.header.step - kFirstOnWire;
  }

  // the encoder takes steps from -1 on, "I am here" comes before
  static constexpr StepIndex kFirstOnWire = kJoinStep - kHello;

  Topic own_;
  std::unique_ptr<Transport> transport_;
  wire::Tick tick_;
  wire::MechanismMessage mechanism_;
  wire::ActuatorMessage actuators_;
  ByteBuffer buffer_;
};

// generated samples with sequences of the crane's lengths
struct GeneratedSamples {
  GeneratedSamples() {
    set(tick.controls, kChannels);
    tick.age._buffer = ages.data();
    tick.age._length = tick.age._maximum = kChannels;
    for (auto* s : {&mechanism.sample.x, &mechanism.sample.v}) set(*s, kPorts);
    set(mechanism.sample.a, kPorts);
    set(mechanism.sample.a_free, kPorts);
    set(mechanism.sample.W, kPorts * kPorts);
    set(mechanism.sample.F_used, kPorts);
    set(mechanism.sample.F_line, kPorts);
    set(mechanism.sample.work, kPorts);
    set(mechanism.sample.impulse, kPorts);
    set(mechanism.sample.v_mean, kPorts);
    auto& a = actuators.sample;
    for (auto* s : {&a.F, &a.F_dot, &a.K, &a.lambda, &a.D, &a.x_ref, &a.v_ref, &a.friction_scale, &a.work, &a.impulse,
                    &a.p_A, &a.p_B, &a.Q_A, &a.Q_B}) {
      set(*s, kPorts);
    }
  }

  slewring_Tick tick{};
  slewring_MechanismMessage mechanism{};
  slewring_ActuatorMessage actuators{};

 private:
  template <typename Sequence>
  void set(Sequence& sequence, std::size_t length) {
    sequence._buffer = numbers.data();
    sequence._length = sequence._maximum = static_cast<std::uint32_t>(length);
  }

  std::array<double, kPorts * kPorts> numbers{};
  std::array<std::uint32_t, kChannels> ages{};
};

class BareLink final : public Link {
 public:
  BareLink(std::uint32_t domain, Topic own) : own_(own) {
    if (const Status status = CycloneDomain::open({domain, "lo", {}}, domain_); !status.is_ok()) fail(status.text);
    participant_ = dds_create_participant(domain, nullptr, nullptr);
    waitset_ = dds_create_waitset(participant_);
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(20));
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 64);
    for (const Topic topic : kTopics) {
      const dds_entity_t handle = dds_create_topic(participant_, &type_of(topic), traits(topic).name, nullptr, nullptr);
      if (topic == own) {
        writer_ = dds_create_writer(participant_, handle, qos, nullptr);
        continue;
      }
      readers_.push_back({topic, dds_create_reader(participant_, handle, qos, nullptr)});
      dds_set_status_mask(readers_.back().entity, DDS_DATA_AVAILABLE_STATUS);
      dds_waitset_attach(waitset_, readers_.back().entity, 0);
    }
    dds_delete_qos(qos);
  }
  ~BareLink() override { dds_delete(participant_); }
  BareLink(const BareLink&) = delete;
  BareLink& operator=(const BareLink&) = delete;

  void send(StepIndex step) override {
    samples_.tick.header.step = samples_.mechanism.header.step = samples_.actuators.header.step = step;
    const void* sample = own_ == Topic::tick        ? static_cast<const void*>(&samples_.tick)
                         : own_ == Topic::mechanism ? static_cast<const void*>(&samples_.mechanism)
                                                    : static_cast<const void*>(&samples_.actuators);
    if (dds_write(writer_, sample) != DDS_RETCODE_OK) fail("dds_write failed");
  }

  bool take(Topic& topic, StepIndex& step) override {
    for (const Reader& reader : readers_) {
      void* sample = nullptr;
      dds_sample_info_t about{};
      if (dds_take(reader.entity, &sample, &about, 1, 1) != 1) continue;
      topic = reader.topic;
      // every message starts with its header
      step = static_cast<const slewring_Header*>(sample)->step;
      const bool is_data = about.valid_data;
      dds_return_loan(reader.entity, &sample, 1);
      if (is_data) return true;
    }
    return false;
  }

  void wait_until(std::int64_t deadline) override {
    dds_attach_t triggered[2];
    dds_waitset_wait(waitset_, triggered, 2, std::max<std::int64_t>(0, deadline - monotonic_ns()));
  }

 private:
  struct Reader {
    Topic topic;
    dds_entity_t entity;
  };
  static const dds_topic_descriptor_t& type_of(Topic topic) {
    if (topic == Topic::tick) return slewring_Tick_desc;
    return topic == Topic::mechanism ? slewring_MechanismMessage_desc : slewring_ActuatorMessage_desc;
  }

  Topic own_;
  std::shared_ptr<CycloneDomain> domain_;
  dds_entity_t participant_ = 0;
  dds_entity_t waitset_ = 0;
  dds_entity_t writer_ = 0;
  std::vector<Reader> readers_;
  GeneratedSamples samples_;
};

enum class Way { bare, transport, fastdds, fastdds_shared };
constexpr std::array<const char*, 4> kWays = {"bare", "transport", "fastdds", "fastdds-shm"};

std::unique_ptr<Link> connect(Way way, std::uint32_t domain, Topic own) {
  if (way == Way::bare) return std::make_unique<BareLink>(domain, own);
  const auto middleware = static_cast<Middleware>(static_cast<int>(way) - static_cast<int>(Way::transport));
  return std::make_unique<TransportLink>(middleware, domain, own);
}

// One process of the star: the last message received on every topic.
class Process {
 public:
  Process(Way way, std::uint32_t domain, Topic own)
      : own_(own), way_(kWays[static_cast<std::size_t>(way)]), link_(connect(way, domain, own)) {}

  // Publishes hello until a message of every other process has arrived, then a confirmation until all others have
  // published theirs.
  void join() {
    for (const StepIndex stage : {kHello, kReceivedAll}) {
      while (lowest_step() < stage) {
        link_->send(stage);
        const std::int64_t deadline = monotonic_ns() + kJoinPeriod;
        while (lowest_step() < stage && monotonic_ns() < deadline) receive(deadline);
      }
      link_->send(stage);
    }
  }

  void send(StepIndex step) { link_->send(step); }

  // Waits for the step or a later one on both other topics.
  void wait_for(Topic topic, StepIndex step) {
    const std::int64_t give_up = monotonic_ns() + kGiveUp;
    while (last_step(topic) < step) {
      if (monotonic_ns() > give_up) fail(fmt::format("{}: no message for 20 s", way_));
      receive(give_up);
    }
  }

 private:
  StepIndex& last_step(Topic topic) { return last_steps_[static_cast<std::size_t>(topic)]; }

  StepIndex lowest_step() {
    StepIndex lowest = kTopLimit;
    for (const Topic topic : kTopics) {
      if (topic != own_) lowest = std::min(lowest, last_step(topic));
    }
    return lowest;
  }

  void receive(std::int64_t deadline) {
    Topic topic{};
    StepIndex step = 0;
    bool is_empty = true;
    while (link_->take(topic, step)) {
      last_step(topic) = std::max(last_step(topic), step);
      is_empty = false;
    }
    if (is_empty) link_->wait_until(deadline);
  }

  static constexpr StepIndex kTopLimit = 1'000'000'000;
  static constexpr StepIndex kNothing = -3;

  Topic own_;
  const char* way_;
  std::unique_ptr<Link> link_;
  std::array<StepIndex, wire::kTopics> last_steps_ = [] {
    std::array<StepIndex, wire::kTopics> last_step{};
    last_step.fill(kNothing);
    return last_step;
  }();
};

void run_node(Way way, std::uint32_t domain, Topic own, Topic partner, StepIndex steps) {
  Process process(way, domain, own);
  process.join();
  process.send(0);
  for (StepIndex n = 0; n < steps; ++n) {
    process.wait_for(Topic::tick, n);
    process.wait_for(partner, n);
    process.send(n + 1);
  }
  // until the master has everything
  process.wait_for(Topic::tick, steps);
}

// steps per second
double run_master(Way way, std::uint32_t domain, StepIndex window, StepIndex steps) {
  Process process(way, domain, Topic::tick);
  process.join();
  process.wait_for(Topic::mechanism, 0);
  process.wait_for(Topic::actuators, 0);
  const std::int64_t start = monotonic_ns();
  for (StepIndex n = 0; n < steps; ++n) {
    process.wait_for(Topic::mechanism, n - window + 1);
    process.wait_for(Topic::actuators, n - window + 1);
    process.send(n);
  }
  process.wait_for(Topic::mechanism, steps);
  process.wait_for(Topic::actuators, steps);
  const std::int64_t end = monotonic_ns();
  process.send(steps);
  return static_cast<double>(steps) / (static_cast<double>(end - start) * 1e-9);
}

template <typename Body>
pid_t start_child(Body&& body) {
  std::fflush(nullptr);
  const pid_t pid = fork();
  if (pid != 0) return pid;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  body();
  _exit(0);
}

double run_star(Way way, StepIndex window, StepIndex steps) {
  const testing::TestDomain domain;
  const std::uint32_t number = domain.number();
  // all in children, since a process that has had a middleware must not fork
  auto* rate =
      static_cast<double*>(mmap(nullptr, sizeof(double), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  if (rate == MAP_FAILED) fail("no shared memory");
  const std::array<pid_t, 3> processes = {
      start_child([&] { run_node(way, number, Topic::mechanism, Topic::actuators, steps); }),
      start_child([&] { run_node(way, number, Topic::actuators, Topic::mechanism, steps); }),
      start_child([&] { *rate = run_master(way, number, window, steps); })};
  for (const pid_t process : processes) {
    int status = 0;
    waitpid(process, &status, 0);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail("a process of the star has failed");
  }
  const double found = *rate;
  munmap(rate, sizeof(double));
  return found;
}

}  // namespace

int main(int argc, char** argv) {
  const StepIndex steps = argc > 1 ? std::atoll(argv[1]) : 20'000;
  const int repeats = argc > 2 ? std::atoi(argv[2]) : 3;
  const bool has_fastdds = argc > 3 && std::string_view(argv[3]) == "fastdds";
  if (steps < 1 || repeats < 1 || (argc > 3 && !has_fastdds)) fail("usage: cyclone_star [STEPS] [REPEATS] [fastdds]");
  if (has_fastdds && !is_built(Middleware::fastdds)) fail("this build has no Fast DDS");
  const std::size_t ways = has_fastdds ? kWays.size() : 2;
  fmt::print("{} steps, median of {} runs, 3 processes on loopback\n", steps, repeats);
  fmt::print("{:<11} {:>7} {:>10}\n", "way", "window", "steps/s");
  for (const StepIndex window : {1, 4}) {
    std::array<std::vector<double>, kWays.size()> rates;
    // alternating, so that other load meets all of them
    for (int i = 0; i < repeats; ++i) {
      for (std::size_t way = 0; way < ways; ++way) {
        rates[way].push_back(run_star(static_cast<Way>(way), window, steps));
      }
    }
    for (std::size_t way = 0; way < ways; ++way) {
      std::ranges::sort(rates[way]);
      fmt::print("{:<11} {:>7} {:>10.0f}\n", kWays[way], window, rates[way][rates[way].size() / 2]);
    }
  }
  return 0;
}
