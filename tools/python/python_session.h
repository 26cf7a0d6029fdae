// A session for Python: callbacks into Python from worker threads, Ctrl-C, no lock of the interpreter while anything
// is computed.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/embed/session.h"

#include <condition_variable>
#include <mutex>
#include <pybind11/pybind11.h>

namespace sinew::python {

namespace py = pybind11;

/// Keeps a Python object for code that runs without the interpreter's lock, and lets it go with the lock.
class Kept {
  public:
    explicit Kept(py::object object)
        : object_(std::make_shared<Holder>(std::move(object))) {}
    /// With the lock.
    const py::object& get() const { return object_->object; }
    bool is_none() const { return object_->none; }

  private:
    struct Holder {
        explicit Holder(py::object o)
            : object(std::move(o))
            , none(object.is_none()) {}
        ~Holder() {
            if (!Py_IsInitialized()) { // the interpreter has gone, and its objects with it
                object.release();
                return;
            }
            const py::gil_scoped_acquire lock;
            object = py::object();
        }
        py::object object;
        const bool none;
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

class PythonSession {
  public:
    PythonSession(embed::Options options, py::object on_event, py::object on_warning);
    ~PythonSession();
    /// Of all that does not call Python: without the interpreter's lock.
    embed::Session& session() { return *session_; }
    /// In a thread of its own, so that this one can look for Ctrl-C. With the interpreter's lock; throws what a
    /// callback threw.
    embed::Frame evaluate(double frame, const std::string& plug);
    /// Warnings that no callback took.
    std::vector<engine::Diagnostic> take_warnings();

  private:
    class Watch;
    std::unique_ptr<Watch> watch_;
    std::unique_ptr<embed::Session> session_;
};

} // namespace sinew::python
