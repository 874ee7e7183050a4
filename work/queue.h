// work/queue.h — tasks that wait on a NATS server (JetStream) for whichever machine takes them.
//
// Stream NAME holds NAME.task.KEY until the task is done; each waits there once. Stream NAME-faults keeps the last
// fault of a task, NAME.fault.KEY, and tasks that were given up, NAME.dead.KEY. Both lie on the server's disk.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace freshet::work {

struct QueueOptions {
  /// nats://[USER:PASSWORD@]HOST[:PORT][/NAME], or tls://; NAME of letters, digits, '-' and '_' [freshet].
  std::string url;
  std::chrono::milliseconds ack_wait{
      30'000};  // a task that nobody has spoken of for so long is given to another
  std::chrono::milliseconds patience{10'000};  // for the server, at first; it may go and come later
};

/// What went wrong with a task, and how often.
struct Fault {
  std::uint64_t times = 0;
  std::string message;  // the last
};

struct DeadTask {
  std::string text;
  Fault fault;
};

struct QueueStatus {
  std::uint64_t waiting = 0, in_hand = 0;
  std::uint64_t dead = 0;
  std::vector<DeadTask> dead_tasks;  // the first 100
};

/// A task in hand: another machine gets it when this one is silent for longer than ack_wait. still_working() may be
/// called from another thread.
class Delivery {
 public:
  struct Message;
  explicit Delivery(std::unique_ptr<Message> message);
  Delivery(Delivery&&) noexcept;
  ~Delivery();

  const std::string& text() const;
  /// How often it was given to a machine, this time included.
  std::uint64_t times() const;
  void still_working() const;
  /// It waits no more. False when the server did not say so in time: the task then comes again.
  [[nodiscard]] bool done();
  /// It waits again, for any machine, from then on.
  void hand_back(std::chrono::milliseconds delay = {});

 private:
  friend class Queue;
  std::unique_ptr<Message> message_;
};

/// One connection. It outlives a server that goes and comes again: calls then fail or wait, and later ones work.
class Queue {
 public:
  /// Makes the streams where they are not there.
  /// Throws Error{kUsage} for a url that is none; Error{kIo} where no server answers, one without JetStream does, or
  /// this program was built without libnats.
  static Queue open(const QueueOptions& options);
  Queue(Queue&&) noexcept;
  ~Queue();

  /// False where it waits already, or is in some machine's hand. Its faults are forgotten.
  /// All below throw Error{kIo} where the server does not answer.
  bool put(const std::string& key, const std::string& text);
  /// Nothing when there is none to be had in this time, or the server is away.
  std::optional<Delivery> next(std::chrono::milliseconds patience);
  /// How many tasks are neither done nor dead.
  std::uint64_t left() const;
  QueueStatus status() const;
  /// One fault more of a task that was put in.
  Fault add_fault(const std::string& key, const Delivery& delivery, const std::string& message);
  /// Gives a task up: it is kept with its fault, and waits no more.
  void bury(const std::string& key, Delivery& delivery, const Fault& fault);

 private:
  struct Connection;
  explicit Queue(std::unique_ptr<Connection> connection);
  std::unique_ptr<Connection> connection_;
};

}  // namespace freshet::work
