// A session for a browser on this machine: one page that shows the newest run, hears of news and sends changes.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/live/session.h"

#include <memory>
#include <stop_token>
#include <string>

namespace sinew::live {

/// Listens on the loopback interface alone. Everything lies below an address that holds a random token of 128 bits, so
/// that neither other users of the machine nor pages of the network can reach it; requests that name another host
/// (pages that point a name of theirs to this machine) are refused as well.
class Server {
  public:
    /// \param port 0: one that is free
    /// Throws engine::Failure (IO405) if it cannot listen there.
    Server(Session& session, int port);
    ~Server();
    /// "http://127.0.0.1:PORT/TOKEN/".
    std::string address() const;
    /// Serves until it is asked to stop.
    void serve(const std::stop_token& stop);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace sinew::live
