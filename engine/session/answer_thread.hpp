// Answers questions on a separate thread, the newest question first. The asking thread never waits.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "base/system/parallel.hpp"
#include "base/system/start_thread.hpp"
#include "session/threads.hpp"

namespace palpa::session {

/// An Answer has a `number`, which is that of its question (0: no question yet), and a `fault`. If `fault` is not
/// empty, it is the error message and the answer has no other content. The thread and the threads that it starts yield
/// to all others (threads.hpp).
template <typename Question, typename Answer>
class AnswerThread {
 public:
  /// Called on the separate thread. It may throw GivenUp soon after `give_up` became true.
  using Work = std::function<Answer(const Question&, const std::atomic<bool>& give_up)>;

  explicit AnswerThread(Work work)
      : work_(std::move(work)), thread_(start_thread("a preview", [this] { answer_all(); })) {}
  /// Ends the thread. If an answer is being computed, waits until it gives up.
  ~AnswerThread() {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }
  AnswerThread(const AnswerThread&) = delete;
  AnswerThread& operator=(const AnswerThread&) = delete;

  /// Replaces a waiting question. Never blocks. Returns the question's number: 1, 2, ...
  std::uint64_t ask(Question question) {
    std::uint64_t number = 0;
    {
      const std::lock_guard lock(mutex_);
      waiting_ = std::move(question);
      number = ++asked_;
    }
    wake_.notify_one();
    return number;
  }
  /// The newest answer. Replaced questions have no answer.
  std::shared_ptr<const Answer> newest() const {
    const std::lock_guard lock(mutex_);
    return newest_;
  }
  /// Whether there is a newer question than the one that newest() answers.
  bool stale() const {
    const std::lock_guard lock(mutex_);
    return newest_->number != asked_;
  }

 private:
  void answer_all() {
    take_no_signals();
    give_way();
    std::unique_lock lock(mutex_);
    for (;;) {
      wake_.wait(lock, [this] { return ends_ || waiting_; });
      if (ends_) return;
      const Question question = std::move(*waiting_);
      waiting_.reset();
      const std::uint64_t number = asked_;
      lock.unlock();
      auto next = std::make_shared<Answer>();
      try {
        *next = work_(question, ends_);
      } catch (const GivenUp&) {
        return;
      } catch (const std::exception& error) {
        next->fault = error.what();
      }
      next->number = number;
      lock.lock();
      newest_ = std::move(next);
    }
  }

  Work work_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<Question> waiting_;
  std::uint64_t asked_ = 0;
  std::atomic<bool> ends_{false};
  std::shared_ptr<const Answer> newest_ = std::make_shared<Answer>();
  std::thread thread_;
};

}  // namespace palpa::session
