#include "serve/page_server.hpp"

#include <algorithm>
#include <chrono>

#include <arpa/inet.h>
#include <httplib.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>

#include "page_files.hpp"

namespace vdna::serve
{

namespace
{

using namespace std::chrono_literals;
using httplib::Request;
using httplib::Response;

constexpr auto pace = 200ms;  // between the events of a viewer
constexpr auto patience = 5s; // without events, before a sign of life
constexpr int forbidden = 403;

void refuse(Response &response, int status, const std::string &sentence)
{
    response.status = status;
    response.set_content(sentence + "\n", "text/plain; charset=utf-8");
}

// "127.0.0.1:8070" is 127.0.0.1; "[::1]:8070" is ::1.
std::string without_port(const std::string &host)
{
    if (!host.empty() && host[0] == '[')
        return host.substr(1, host.find(']') - 1);
    return host.substr(0, host.find(':'));
}

// An address cannot be made to point elsewhere, as a foreign name can.
bool names_us(const std::string &host)
{
    const std::string name = without_port(host);
    unsigned char binary[sizeof(in6_addr)];
    return name == "localhost" || inet_pton(AF_INET, name.c_str(), binary) == 1 ||
           inet_pton(AF_INET6, name.c_str(), binary) == 1;
}

bool is_foreign(const Request &request)
{
    return request.has_header("Origin") &&
           request.get_header_value("Origin") != "http://" + request.get_header_value("Host");
}

// Takes the same time wherever they differ.
bool equal(const std::string &a, const std::string &b)
{
    unsigned char difference = a.size() != b.size();
    for (size_t i = 0; i < std::min(a.size(), b.size()); i++)
        difference |= static_cast<unsigned char>(a[i] ^ b[i]);
    return difference == 0;
}

httplib::Server::HandlerResponse check_sender(const Request &request, Response &response)
{
    if (!names_us(request.get_header_value("Host")))
        refuse(response, forbidden, "the host is not an address; open the page by its address");
    else if (is_foreign(request))
        refuse(response, forbidden, "the request comes from another page; open our own");
    else
        return httplib::Server::HandlerResponse::Unhandled;
    return httplib::Server::HandlerResponse::Handled;
}

// The names of the commands and what they do, for the page's buttons.
std::string commands_json()
{
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const telemetry::Command &command : telemetry::commands())
        json.push_back({{"name", command.name},
                        {"argument", telemetry::text_of(command.argument)},
                        {"does", command.does}});
    return json.dump();
}

// A second server on our port must fail. What a viewer does not read waits in the system, at most
// this much of it, before it counts as gone.
void set_options(int listening)
{
    const int yes = 1, unread_bytes = 64 * 1024;
    setsockopt(listening, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    setsockopt(listening, SOL_SOCKET, SO_SNDBUF, &unread_bytes, sizeof unread_bytes);
}

void configure(httplib::Server &server)
{
    server.set_socket_options(set_options);
    server.new_task_queue = [] { return new httplib::ThreadPool(3 * PageServer::viewers_max); };
    server.set_tcp_nodelay(true);
    server.set_keep_alive_timeout(2);
    server.set_keep_alive_max_count(1000);
    server.set_payload_max_length(4096);
    server.set_pre_routing_handler(check_sender);
    server.set_default_headers(
        {{"Content-Security-Policy", "default-src 'none'; script-src 'self'; style-src 'self'; "
                                     "img-src 'self' data:; connect-src 'self'; base-uri 'none'; "
                                     "form-action 'none'; frame-ancestors 'none'"},
         {"Cross-Origin-Resource-Policy", "same-origin"},
         {"Referrer-Policy", "no-referrer"},
         {"X-Content-Type-Options", "nosniff"},
         {"Cache-Control", "no-store"}});
}

} // namespace

PageServer::PageServer(ServerSettings settings, LiveState &state)
    : settings_(std::move(settings)), state_(state), server_(std::make_unique<httplib::Server>())
{
    state_.put("commands", commands_json());
    state_.put("map", settings_.map_pictures ? R"({"shown": true})" : R"({"shown": false})");
    configure(*server_);
    serve_page();
    server_->Get("/events", [this](const Request &, Response &r) { serve_events(r); });
    server_->Get("/picture", [this](const Request &, Response &r) { serve_picture(r); });
    server_->Get(R"(/map/([A-Za-z0-9._-]{1,63})/([0-9]{1,9})\.jpg)",
                 [this](const Request &q, Response &r) { serve_map_picture(q, r); });
    server_->Post("/command", [this](const Request &q, Response &r) { take_command(q, r); });

    const std::string &address = settings_.address;
    port_ = settings_.port;
    if (port_ == 0)
        port_ = server_->bind_to_any_port(address);
    else if (!server_->bind_to_port(address, port_))
        port_ = -1;
    if (port_ < 0)
        throw Error(address + ": cannot listen on port " + std::to_string(settings_.port) +
                    "; choose a free one by --port, and an address of this machine by --address");
    thread_ = std::thread([this] {
        server_->listen_after_bind();
        ended_ = true;
    });
}

PageServer::~PageServer()
{
    state_.close();
    while (!server_->is_running() && !ended_) // stop() before that is lost
        std::this_thread::sleep_for(1ms);
    server_->stop();
    thread_.join();
}

void PageServer::serve_page()
{
    const auto add = [&](const char *path, const char *content, const char *type) {
        server_->Get(path, [content, type](const Request &, Response &response) {
            response.set_content(content, type);
        });
    };
    add("/", page_html, "text/html; charset=utf-8");
    add("/page.css", page_css, "text/css; charset=utf-8");
    add("/page.js", page_js, "text/javascript; charset=utf-8");
}

void PageServer::serve_events(Response &response)
{
    if (viewers_.fetch_add(1) >= viewers_max) {
        viewers_--;
        return refuse(response, 503, "too many viewers; close one of them");
    }
    const auto leave = [this](bool) { viewers_--; };
    const auto send = [this, seen = uint64_t{0}](size_t, httplib::DataSink &sink) mutable {
        LiveState::News news = state_.news_after(seen, patience);
        if (state_.is_closed())
            return false;
        seen = news.seen;
        if (news.text.empty())
            news.text = ":\n\n"; // a comment
        if (!sink.write(news.text.data(), news.text.size()))
            return false;
        state_.pause(pace);
        return true;
    };
    response.set_chunked_content_provider("text/event-stream", send, leave);
}

void PageServer::serve_picture(Response &response)
{
    const LiveState::Picture picture = state_.picture();
    if (!picture)
        return refuse(response, 404, "there is no picture");
    response.set_content(*picture, "image/jpeg");
}

void PageServer::serve_map_picture(const Request &request, Response &response)
{
    const std::string name = request.matches[1], frame = request.matches[2];
    std::optional<std::string> jpeg;
    if (settings_.map_pictures)
        jpeg = settings_.map_pictures->jpeg(name, static_cast<uint32_t>(std::stoul(frame)));
    if (!jpeg)
        return refuse(response, 404, "there is no such thumbnail");
    response.set_content(*jpeg, "image/jpeg");
}

void PageServer::take_command(const Request &request, Response &response)
{
    if (!request.has_header("Origin"))
        return refuse(response, forbidden, "the request does not tell its origin");
    if (!equal(request.get_header_value("X-Vdna-Token"), settings_.token))
        return refuse(response, forbidden, "the token is wrong; open the address that was printed");
    const size_t space = std::min(request.body.find(' '), request.body.size());
    const telemetry::Command *const command =
        telemetry::find_command(request.body.substr(0, space));
    if (!command)
        return refuse(response, 400, "there is no such command");
    // The daemon judges it; LCM's strings end at a NUL.
    const std::string argument = request.body.substr(std::min(space + 1, request.body.size()));
    if (argument.find('\0') != std::string::npos)
        return refuse(response, 400, "the argument has a NUL");
    try {
        const std::lock_guard<std::mutex> lock(sending_);
        settings_.send(*command, argument);
        response.status = 204;
    } catch (const Error &error) {
        refuse(response, 503, error.what());
    }
}

} // namespace vdna::serve
