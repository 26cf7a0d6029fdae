// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/live/server.h"

#include "tools/live/shell.h"

// As the packaged library was built.
#define CPPHTTPLIB_OPENSSL_SUPPORT
#define CPPHTTPLIB_ZLIB_SUPPORT
#define CPPHTTPLIB_BROTLI_SUPPORT
#include <httplib.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>
#include <thread>

namespace sinew::live {

using Json = nlohmann::ordered_json;

namespace {

/// News come in bursts; a browser need not hear more often.
constexpr std::chrono::milliseconds between_news{30};
/// The largest body that a request may have: an attribute's value.
constexpr std::size_t most_body = std::size_t{1} << 20;

/// Of JSON that a request may hold: as deep as a graph file may be.
constexpr int most_depth = 64;
/// Requests at once; each open `news` is one.
constexpr std::size_t most_requests = 64;
/// Keys lie within these frames.
constexpr int most_frame = 10'000'000;

/// The request asks for what cannot be.
struct BadRequest : std::runtime_error {
    using std::runtime_error::runtime_error;
};

Json parsed(const std::string& text) {
    try {
        return Json::parse(text, [](int depth, Json::parse_event_t, Json&) {
            if (depth > most_depth)
                throw BadRequest("nested too deeply: more than " + std::to_string(most_depth) +
                                 " brackets in each other");
            return true;
        });
    } catch (const Json::parse_error& error) {
        throw BadRequest(text.empty() ? "the request has no body: send JSON"
                                      : "the body is no JSON at its byte " + std::to_string(error.byte));
    }
}

/// Throws BadRequest for what is no change.
Change change_in(const std::string& body) {
    const Json json = parsed(body);
    const auto word = [&](const char* key) {
        const auto at = json.find(key);
        if (at == json.end() || !at->is_string() || !json.contains("value"))
            throw BadRequest(R"(a change is { "node": "…", "attribute": "…", "value": … }, with a "frame" for a key)");
        return at->get<std::string>();
    };
    Change out{{word("node"), word("attribute")}, json.at("value").dump(), {}};
    const auto frame = json.find("frame");
    if (frame == json.end()) return out;
    if (!frame->is_number_integer() || std::abs(frame->get<double>()) > most_frame)
        throw BadRequest("\"frame\" is a whole number from -" + std::to_string(most_frame) + " to " +
                         std::to_string(most_frame));
    out.frame = frame->get<int>();
    return out;
}

std::string random_token() {
    std::random_device random; // the system's own
    std::string out;
    for (int k = 0; k < 4; ++k) {
        char part[9];
        std::snprintf(part, sizeof part, "%08x", random());
        out += part;
    }
    return out;
}

std::string refusal(const engine::Failure& failure) {
    Json list = Json::array();
    for (const engine::Diagnostic& d : failure.diagnostics()) {
        list.push_back(Json::parse(engine::to_json(d)));
        list.back()["text"] = engine::to_text(d);
    }
    return Json{{"diagnostics", list}}.dump(-1, ' ', false, Json::error_handler_t::replace);
}

constexpr const char* shell_policy =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
    "connect-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'";

} // namespace

struct Server::Impl {
    Session& session;
    httplib::Server http;
    std::string token = random_token();
    int port = 0;
    std::atomic<bool> over = false;

    explicit Impl(Session& s)
        : session(s) {}

    /// A page from elsewhere that has a name of its own lead here (DNS rebinding) asks for that name. Any port will do:
    /// behind a tunnel it is another one.
    static bool is_for_us(const httplib::Request& request) {
        const std::string host = request.get_header_value("Host");
        return std::regex_match(host, std::regex(R"((127\.0\.0\.1|localhost|\[::1\])(:\d{1,5})?)"));
    }

    void route() {
        http.set_payload_max_length(most_body);
        http.set_tcp_nodelay(true);
        http.set_keep_alive_timeout(1);
        http.set_read_timeout(1); // a request that is never ended does not hold up the end
        http.new_task_queue = [] { return new httplib::ThreadPool(most_requests); }; // the library deletes it
        http.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
            response.set_header("Cache-Control", "no-store");
            response.set_header("X-Content-Type-Options", "nosniff");
            response.set_header("Referrer-Policy", "no-referrer");
            // Parts are not served: everything is answered whole, as any server may. The library would take a range
            // that has no bytes, or more than there are, at its word. What it passes on is no constant object.
            const_cast<httplib::Request&>(request).ranges.clear();
            // Within one machine packing takes longer than sending: half a second for a preview.
            const_cast<httplib::Request&>(request).headers.erase("Accept-Encoding");
            // A request that names no length has no body (RFC 9112, 6.3); the library would wait for one.
            if (!request.has_header("Content-Length") && !request.has_header("Transfer-Encoding"))
                const_cast<httplib::Request&>(request).headers.emplace("Content-Length", "0");
            if (is_for_us(request)) return httplib::Server::HandlerResponse::Unhandled;
            response.status = 403;
            return httplib::Server::HandlerResponse::Handled;
        });
        http.set_error_handler([](const httplib::Request&, httplib::Response& response) {
            if (response.status != 400 || !response.body.empty()) return;
            response.set_content(R"({"error":"the request cannot be read"})", "application/json"); // by the library
        });
        const std::string root = "/" + token + "/";
        http.Get(root, [](const httplib::Request&, httplib::Response& response) {
            response.set_header("Content-Security-Policy", shell_policy);
            response.set_content(std::string(shell_page()), "text/html; charset=utf-8");
        });
        // Numbered, so that a browser takes each anew; what comes is the newest.
        http.Get(root + R"(page/\d+)", [this](const httplib::Request&, httplib::Response& response) {
            const std::shared_ptr<const std::string> page = session.page();
            if (!page) {
                response.status = 404;
                return;
            }
            response.set_content_provider(page->size(), "text/html; charset=utf-8",
                                          [page](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
                                              sink.write(page->data() + offset, length);
                                              return true;
                                          });
        });
        http.Get(root + R"(preview/\d+)", [this](const httplib::Request&, httplib::Response& response) {
            const std::shared_ptr<const std::string> preview = session.preview();
            if (preview)
                response.set_content(*preview, "application/json");
            else
                response.status = 404;
        });
        http.Get(root + "nodes", [this](const httplib::Request&, httplib::Response& response) {
            response.set_content(session.nodes(), "application/json");
        });
        http.Get(root + "status", [this](const httplib::Request&, httplib::Response& response) {
            response.set_content(session.wait_status(0).second, "application/json");
        });
        http.Get(root + "news", [this](const httplib::Request&, httplib::Response& response) {
            // Server-sent events (HTML standard, section 9.2).
            response.set_chunked_content_provider(
                "text/event-stream", [this, seen = std::uint64_t{0}](std::size_t, httplib::DataSink& sink) mutable {
                    if (over) {
                        sink.done();
                        return true;
                    }
                    const auto [number, status] = session.wait_status(seen);
                    // Also without news: so it is found out when the browser has gone.
                    const std::string text = number > seen ? "data: " + status + "\n\n" : ":\n\n";
                    seen = number;
                    if (!sink.write(text.data(), text.size())) return false;
                    std::this_thread::sleep_for(between_news);
                    return true;
                });
        });
        http.Post(root + "change", [this](const httplib::Request& request, httplib::Response& response) {
            answer(response, [&] { session.change(change_in(request.body)); });
        });
        http.Post(root + "discard", [this](const httplib::Request&, httplib::Response& response) {
            answer(response, [&] { session.discard_changes(); });
        });
        http.Post(root + "save", [this](const httplib::Request&, httplib::Response& response) {
            answer(response, [&] { session.save_changes(); });
        });
    }

    template <class Action>
    static void answer(httplib::Response& response, const Action& action) {
        try {
            action();
            response.set_content("{}", "application/json");
        } catch (const engine::Failure& failure) {
            response.status = 422;
            response.set_content(refusal(failure), "application/json");
        } catch (const std::exception& error) { // no JSON, or not what is asked for
            response.status = 400;
            response.set_content(Json{{"error", error.what()}}.dump(-1, ' ', false, Json::error_handler_t::replace),
                                 "application/json");
        }
    }
};

Server::Server(Session& session, int port)
    : impl_(std::make_unique<Impl>(session)) {
    // Without SO_REUSEPORT, with which two programs could share a port.
    impl_->http.set_socket_options([](socket_t socket) {
        const int yes = 1;
        setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    const bool bound = port == 0 ? (impl_->port = impl_->http.bind_to_any_port("127.0.0.1")) > 0
                                 : impl_->http.bind_to_port("127.0.0.1", impl_->port = port);
    if (!bound) {
        engine::Diagnostic d;
        d.code = "IO405";
        d.message = "cannot listen on port " + std::to_string(port) + " of this machine";
        d.hint = "Another program may use it; give another --port, or none.";
        throw engine::Failure(d);
    }
    impl_->route();
}

Server::~Server() = default;

std::string Server::address() const {
    return "http://127.0.0.1:" + std::to_string(impl_->port) + "/" + impl_->token + "/";
}

void Server::serve(const std::stop_token& stop) {
    std::atomic<bool> ended = false;
    // What is not listening yet cannot be stopped, so it is asked until it has ended.
    const std::jthread stopper([&](const std::stop_token&) {
        while (!ended) {
            if (stop.stop_requested()) {
                impl_->over = true;
                impl_->http.stop();
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
    });
    if (!stop.stop_requested()) impl_->http.listen_after_bind();
    ended = true;
}

} // namespace sinew::live
