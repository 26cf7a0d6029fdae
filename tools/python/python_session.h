// A session for Python: callbacks into Python from worker threads, Ctrl-C, no lock of the interpreter while anything
// is computed.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/embed/session.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <pybind11/pybind11.h>
#include <thread>
#include <vector>

namespace sinew::python {

namespace py = pybind11;

/// Whether the interpreter is being taken down: who asks it for its lock then is ended in the middle of what it does.
inline bool interpreter_goes() {
#if PY_VERSION_HEX >= 0x030D0000
    return !Py_IsInitialized() || Py_IsFinalizing();
#else
    return !Py_IsInitialized() || _Py_IsFinalizing();
#endif
}

/// Keeps a Python object for code that runs without the interpreter's lock, and lets it go with the lock.
class Kept {
  public:
    explicit Kept(py::object object)
        : object_(std::make_shared<Holder>(std::move(object))) {}
    /// With the lock.
    const py::object& get() const { return object_->object; }
    bool is_none() const { return object_->none; }
    /// For the garbage collector: with the lock.
    int traverse(visitproc visit, void* arg) const {
        Py_VISIT(object_->object.ptr());
        return 0;
    }
    /// The same; from here on it is None.
    void clear() const {
        object_->none = true;
        const py::object before = std::exchange(object_->object, py::none());
    }

  private:
    struct Holder {
        explicit Holder(py::object o)
            : object(std::move(o))
            , none(object.is_none()) {}
        ~Holder() {
            // The interpreter has gone, or goes and gives its lock to nobody: its objects go with it.
            if (!Py_IsInitialized() || (interpreter_goes() && !PyGILState_Check())) {
                object.release();
                return;
            }
            const py::gil_scoped_acquire lock;
            object = py::object();
        }
        py::object object;
        std::atomic<bool> none;
    };
    std::shared_ptr<Holder> object_;
};

/// What a callback is told.
struct Event {
    const char* kind = ""; ///< "progress", "stepped", "computed", "reused"
    std::string node;
    double frame = 0, seconds = 0, done = 1;
    std::string what;
};

/// What ends a program (KeyboardInterrupt, SystemExit) and was raised in the compute of a node: no failure of the node.
/// The evaluation throws it in its own thread.
class Ending {
  public:
    void keep(std::exception_ptr thrown) {
        const std::lock_guard lock(mutex_);
        if (!thrown_) thrown_ = std::move(thrown);
    }
    /// Once.
    std::exception_ptr take() {
        const std::lock_guard lock(mutex_);
        return std::exchange(thrown_, nullptr);
    }

  private:
    std::mutex mutex_;
    std::exception_ptr thrown_;
};

class PythonSession {
  public:
    /// \param kept the functions that the node types of `options` call
    /// \param ending what these keep of what they raised
    PythonSession(embed::Options options, py::object on_event, py::object on_warning, std::vector<Kept> kept,
                  std::shared_ptr<Ending> ending);
    ~PythonSession();
    /// Of all that does not call Python: without the interpreter's lock.
    embed::Session& session() { return *session_; }
    /// In a thread of its own, so that this one can look for Ctrl-C. With the interpreter's lock; throws what a
    /// callback threw, and what of a node's compute ends the program.
    embed::Frame evaluate(double frame, const std::string& plug);
    /// Throws what a callback threw, once. With the interpreter's lock.
    void throw_of_callback();
    /// The program ends: stops the evaluations of all threads and waits until each thread is back in Python. From here
    /// on the other threads evaluate nothing and keep the interpreter's lock, so that none of them asks for it when
    /// nobody gets it any more. With the interpreter's lock; Ctrl-C ends the waiting.
    void end();
    /// For the garbage collector: all that the session holds of Python.
    int traverse(visitproc visit, void* arg) const;
    void clear();

    /// Gives the interpreter's lock up while it lives.
    class Free {
      public:
        explicit Free(PythonSession& session)
            : session_(session) {
            if (session_.keeps_lock()) return;
            ++session_.outside_;
            free_.emplace();
        }
        ~Free() {
            if (!free_) return;
            free_.reset();
            --session_.outside_;
        }
        Free(const Free&) = delete;

      private:
        PythonSession& session_;
        std::optional<py::gil_scoped_release> free_;
    };

    /// Warnings that no callback took.
    std::vector<engine::Diagnostic> take_warnings();

  private:
    class Watch;
    std::unique_ptr<Watch> watch_;
    bool keeps_lock() const;
    std::unique_ptr<embed::Session> session_;
    const std::vector<Kept> kept_;
    const std::shared_ptr<Ending> ending_;
    std::atomic<int> outside_ = 0;            ///< threads that gave up the lock for this session
    std::optional<std::thread::id> ended_by_; ///< the thread that ends the program; needs the lock
};

} // namespace sinew::python
