// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/python/python_session.h"

#include <chrono>
#include <future>
#include <thread>

namespace sinew::python {

namespace {

/// How long Ctrl-C may go unseen while something is computed.
constexpr std::chrono::milliseconds look_for_signals{50};

} // namespace

class PythonSession::Watch : public engine::Observer {
  public:
    Watch(py::object on_event, py::object on_warning)
        : on_event_(std::move(on_event))
        , on_warning_(std::move(on_warning)) {}

    void computed(const std::string& node, double frame, double seconds) override {
        tell("computed", node, frame, seconds, 1, {});
    }
    void stepped(const std::string& node, double frame, double seconds) override {
        tell("stepped", node, frame, seconds, 1, {});
    }
    void reused(const std::string& node, double frame) override { tell("reused", node, frame, 0, 1, {}); }
    void progress(const std::string& node, double done, std::string_view what) override {
        tell("progress", node, 0, 0, done, what);
    }
    void warning(const engine::Diagnostic& d) override {
        if (on_warning_.is_none()) {
            const std::lock_guard lock(mutex_);
            warnings_.push_back(d);
            return;
        }
        call([&] {
            on_warning_.get()(d);
            return false;
        });
    }

    std::vector<engine::Diagnostic> take_warnings() {
        const std::lock_guard lock(mutex_);
        return std::exchange(warnings_, {});
    }
    /// What a callback threw, once.
    std::exception_ptr take_error() {
        const std::lock_guard lock(mutex_);
        return std::exchange(error_, nullptr);
    }
    int traverse(visitproc visit, void* arg) const {
        if (const int stop = on_event_.traverse(visit, arg)) return stop;
        return on_warning_.traverse(visit, arg);
    }
    void clear() {
        on_event_.clear();
        on_warning_.clear();
    }
    embed::Session* session = nullptr;

  private:
    /// Of True and False alone, NumPy's too: a callback that happens to end in a number of bytes written shall not
    /// cancel.
    static bool says_stop(const py::object& answer) {
        if (answer.is_none()) return false;
        const std::string type = Py_TYPE(answer.ptr())->tp_name;
        if (!py::isinstance<py::bool_>(answer) && type != "numpy.bool_" && type != "numpy.bool")
            throw py::type_error("on_event gave back a value of type " + type +
                                 ": True cancels what runs, None and False let it go on");
        return answer.cast<bool>();
    }
    void tell(const char* kind, const std::string& node, double frame, double seconds, double done,
              std::string_view what) {
        if (on_event_.is_none()) return;
        call([&] {
            const py::object answer = on_event_.get()(Event{kind, node, frame, seconds, done, std::string(what)});
            return says_stop(answer);
        });
    }
    template <class Call>
    void call(Call&& python) {
        bool stop = true;
        {
            if (interpreter_goes()) return session ? session->cancel() : void();
            const py::gil_scoped_acquire lock;
            try {
                stop = python();
            } catch (...) {
                const std::lock_guard guard(mutex_);
                if (!error_) error_ = std::current_exception();
            }
        }
        if (stop && session) session->cancel();
    }
    const Kept on_event_, on_warning_;
    std::mutex mutex_;
    std::vector<engine::Diagnostic> warnings_;
    std::exception_ptr error_;
};

PythonSession::PythonSession(embed::Options options, py::object on_event, py::object on_warning, std::vector<Kept> kept,
                             std::shared_ptr<Ending> ending)
    : watch_(std::make_unique<Watch>(std::move(on_event), std::move(on_warning)))
    , kept_(std::move(kept))
    , ending_(std::move(ending)) {
    const py::gil_scoped_release free;
    session_ = std::make_unique<embed::Session>(std::move(options), watch_.get());
    watch_->session = session_.get();
}

PythonSession::~PythonSession() {
    std::optional<py::gil_scoped_release> free; // workers may wait for it
    if (!keeps_lock() && !interpreter_goes()) free.emplace();
    session_.reset();
}

bool PythonSession::keeps_lock() const {
    return ended_by_ && (*ended_by_ != std::this_thread::get_id() || interpreter_goes());
}

void PythonSession::end() {
    ended_by_ = std::this_thread::get_id();
    for (bool again = outside_ > 0; again;) {
        again = outside_ > 0; // once more when they are back: then they do in Python what is to be done after it
        {
            const py::gil_scoped_release free;
            session_->cancel();
            std::this_thread::sleep_for(look_for_signals);
        }
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    }
}

int PythonSession::traverse(visitproc visit, void* arg) const {
    for (const Kept& k : kept_)
        if (const int stop = k.traverse(visit, arg)) return stop;
    return watch_->traverse(visit, arg);
}

void PythonSession::clear() {
    for (const Kept& k : kept_) k.clear();
    watch_->clear();
}

void PythonSession::throw_of_callback() {
    if (const std::exception_ptr thrown = watch_->take_error()) std::rethrow_exception(thrown);
}

embed::Frame PythonSession::evaluate(double frame, const std::string& plug) {
    if (keeps_lock()) throw engine::Cancelled();
    session_->refuse_in_callback();
    std::exception_ptr interrupted, failed;
    std::optional<embed::Frame> out;
    {
        const Free free(*this);
        std::stop_source stop;
        std::promise<void> done;
        const std::future<void> end = done.get_future();
        const std::jthread worker([&] {
            try {
                out = session_->evaluate(frame, plug, stop.get_token());
            } catch (...) {
                failed = std::current_exception();
            }
            done.set_value();
        });
        while (end.wait_for(look_for_signals) != std::future_status::ready) {
            if (interrupted) continue; // it ends with the Newton iteration that it is in
            const py::gil_scoped_acquire lock;
            if (PyErr_CheckSignals() == 0) continue;
            interrupted = std::make_exception_ptr(py::error_already_set());
            stop.request_stop();
        }
    }
    if (interrupted) std::rethrow_exception(interrupted);
    throw_of_callback();
    if (const std::exception_ptr thrown = ending_->take()) std::rethrow_exception(thrown);
    if (failed) std::rethrow_exception(failed);
    return std::move(*out);
}

std::vector<engine::Diagnostic> PythonSession::take_warnings() { return watch_->take_warnings(); }

} // namespace sinew::python
