// Threads that answer questions from the database, so that the network never waits for the disk.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "service/history/stored_readers.hpp"
#include "service/history/summary.hpp"
#include "service/support/mutex.hpp"
#include "service/web/http.hpp"
#include "service/web/work_queue.hpp"

namespace reident::web {

/// What a question is answered from: the database as it is now, opened for reading alone. Each call
/// of a reader is a snapshot of its own, so that no question keeps the log from being folded.
class Stored {
 public:
  Stored(storage::Database& file, history::PieceMemory& memory,
         std::chrono::steady_clock::time_point deadline)
      : database(file),
        pieces(memory),
        registry(file),
        history_(file),
        telemetry_(file),
        history(history_),
        telemetry(telemetry_),
        deadline_(deadline) {}
  Stored(const Stored&) = delete;
  Stored& operator=(const Stored&) = delete;

  /// To be called between parts of a long answer. Throws TooSlow behind the deadline.
  void check_time() const;

  storage::Database& database;
  history::PieceMemory& pieces;  // of all questions
  const storage::Registry registry;

 private:
  history::StoredHistory history_;
  history::StoredTelemetry telemetry_;

 public:
  const history::HistoryReader& history;
  const history::TelemetryReader& telemetry;

 private:
  std::chrono::steady_clock::time_point deadline_;
};

/// A question that cannot be answered as it was asked; the message says what is wrong and what
/// would mend it.
class BadRequest : public std::runtime_error {
 public:
  explicit BadRequest(const std::string& message, int with_status = 400)
      : std::runtime_error(message), status(with_status) {}
  int status;
};

/// An answer took too long.
class TooSlow : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Processor time that questions may have before the service's own work: a burst, and a small share
/// in the long run. Any thread.
class Allowance {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr double burst_s = 2, share = 0.05;

  explicit Allowance(Clock::time_point now) : counted_(now) {}
  bool is_left(Clock::time_point now);
  void take(double seconds);

 private:
  Mutex mutex_;
  double left_s_ REIDENT_GUARDED_BY(mutex_) = burst_s;
  Clock::time_point counted_ REIDENT_GUARDED_BY(mutex_);
};

class QueryPool {
 public:
  using Question = std::function<HttpResponse(const Stored& stored)>;

  /// The database is opened for each question: whatever became of the file in between is seen.
  /// `threads` and `queue`: within the allowance, and as many beyond it.
  QueryPool(std::filesystem::path database, unsigned threads, std::size_t queue);
  /// Ends the threads; questions that wait get no answer.
  ~QueryPool();
  QueryPool(const QueryPool&) = delete;
  QueryPool& operator=(const QueryPool&) = delete;

  /// Answers on another thread; what is thrown becomes an answer that says so. `compressed`: where
  /// it is worth it. A full queue answers at once with 503. Whoever asks without end gets what the
  /// service leaves of the processor: beyond the allowance other threads answer, of least priority.
  void ask(Question question, bool compressed, Respond respond);

 private:
  struct Waiting {
    Question question;
    bool compressed;
    Respond respond;
  };

  struct Lane {
    explicit Lane(std::size_t queue) : waiting(queue) {}
    WorkQueue<Waiting> waiting;
    std::vector<std::thread> threads;
  };

  void run(Lane& lane);
  HttpResponse answer(const Question& question);

  const std::filesystem::path database_;
  history::PieceMemory pieces_;
  Allowance allowance_;
  Lane usual_, last_;
};

}  // namespace reident::web
