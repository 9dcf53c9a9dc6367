// The page over HTTP: who may look, who may command, and what a viewer costs.
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <httplib.h>
#include <malloc.h>
#include <sys/socket.h>
#include <unistd.h>

#include "cmocka.hpp"
#include "serve/page_server.hpp"

namespace
{

using namespace std::chrono_literals;
using vdna::serve::LiveState;
using vdna::serve::PageServer;

// A server on a free port, and what it sent to the daemon.
struct Served {
    std::vector<std::string> sent;
    bool fails = false;
    LiveState state;
    PageServer server{
        {"127.0.0.1", 0, "secret",
         [this](const vdna::telemetry::Command &command, const std::string &argument) {
             if (fails)
                 throw vdna::Error("no network");
             sent.push_back(command.name + (":" + argument));
         }},
        state};
    httplib::Client client{"127.0.0.1", server.port()};
    std::string ours = "http://127.0.0.1:" + std::to_string(server.port());

    int get(const char *path, const httplib::Headers &headers = {})
    {
        return client.Get(path, headers)->status;
    }
    int command(const httplib::Headers &headers, const char *name = "reset")
    {
        return client.Post("/command", headers, name, "text/plain")->status;
    }
};

// A viewer that asks for the events and reads nothing by itself.
class Viewer
{
  public:
    explicit Viewer(int port) : socket_(socket(AF_INET, SOCK_STREAM, 0))
    {
        const int small = 4096;
        setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(static_cast<uint16_t>(port));
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        assert_int_equal(connect(socket_, reinterpret_cast<sockaddr *>(&address), sizeof address),
                         0);
        const std::string request = "GET /events HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n";
        assert_int_equal(write(socket_, request.data(), request.size()), request.size());
    }
    Viewer(const Viewer &) = delete;
    ~Viewer() { close(socket_); }

    // Reads until `text` has come, or the server ends.
    bool reads(const std::string &text)
    {
        char data[4096];
        for (ssize_t size; heard_.find(text) == std::string::npos;
             heard_.append(data, size_t(size)))
            if ((size = read(socket_, data, sizeof data)) <= 0)
                return false;
        return true;
    }

    // Reads until the server ends; how many bytes that were.
    size_t unread()
    {
        char data[4096];
        size_t total = 0;
        for (ssize_t size; (size = read(socket_, data, sizeof data)) > 0;)
            total += static_cast<size_t>(size);
        return total;
    }

  private:
    int socket_;
    std::string heard_;
};

template <typename Condition>
bool comes_true(Condition condition)
{
    for (int i = 0; i < 6000 && !condition(); i++)
        std::this_thread::sleep_for(10ms);
    return condition();
}

void the_page_and_its_files_are_served(void **)
{
    Served served;
    for (const char *const path : {"/", "/page.css", "/page.js"}) {
        const httplib::Result result = served.client.Get(path);
        assert_int_equal(result->status, 200);
        assert_true(result->body.size() > 1000);
        // Nothing comes from another host.
        assert_true(result->body.find("https:") == std::string::npos);
        assert_true(
            result->get_header_value("Content-Security-Policy").find("default-src 'none'") == 0);
    }
    assert_int_equal(served.get("/nothing"), 404);
}

void only_an_address_is_a_host(void **)
{
    Served served;
    for (const char *const host : {"127.0.0.1", "localhost:8070", "[::1]:8070", "10.0.0.2:80"})
        assert_int_equal(served.get("/", {{"Host", host}}), 200);
    for (const char *const host : {"evil.example", "127.0.0.1.evil.example:8070", "[", ""})
        assert_int_equal(served.get("/", {{"Host", host}}), 403);
}

void another_page_gets_nothing(void **)
{
    Served served;
    assert_int_equal(served.get("/", {{"Origin", served.ours}}), 200);
    for (const char *const origin : {"http://evil.example", "null", "http://127.0.0.1:1"})
        for (const char *const path : {"/", "/events", "/picture"})
            assert_int_equal(served.get(path, {{"Origin", origin}}), 403);
    assert_int_equal(served.server.viewers(), 0);
}

void a_command_needs_the_token_and_our_own_page(void **)
{
    Served served;
    const httplib::Headers token{{"X-Vdna-Token", "secret"}}, origin{{"Origin", served.ours}};
    httplib::Headers both = token;
    both.insert(origin.begin(), origin.end());
    assert_int_equal(served.command(both), 204);
    assert_int_equal(served.sent.size(), 1);
    assert_string_equal(served.sent[0].c_str(), "reset:");
    assert_int_equal(served.command(both, "pin snow white"), 204);
    assert_string_equal(served.sent[1].c_str(), "pin:snow white");
    assert_int_equal(served.command(both, "pin "), 204);
    assert_string_equal(served.sent[2].c_str(), "pin:");

    assert_int_equal(served.command(token), 403);
    assert_int_equal(served.command(origin), 403);
    for (const char *const wrong : {"", "secre", "secret0", "Secret"})
        assert_int_equal(served.command({{"Origin", served.ours}, {"X-Vdna-Token", wrong}}), 403);
    assert_int_equal(
        served.command({{"Origin", "http://evil.example"}, {"X-Vdna-Token", "secret"}}), 403);
    assert_int_equal(served.command(both, "explode"), 400);
    assert_int_equal(served.command(both, ""), 400);
    assert_int_equal(served.sent.size(), 3);
}

void a_command_that_cannot_be_sent_is_told(void **)
{
    Served served;
    served.fails = true;
    const httplib::Result result = served.client.Post(
        "/command", {{"Origin", served.ours}, {"X-Vdna-Token", "secret"}}, "reset", "text/plain");
    assert_int_equal(result->status, 503);
    assert_string_equal(result->body.c_str(), "no network\n");
}

void the_newest_picture_is_served(void **)
{
    Served served;
    assert_int_equal(served.get("/picture"), 404);
    served.state.set_picture(std::make_shared<const std::string>("bytes"));
    const httplib::Result result = served.client.Get("/picture?1");
    assert_string_equal(result->body.c_str(), "bytes");
    assert_string_equal(result->get_header_value("Content-Type").c_str(), "image/jpeg");
    assert_string_equal(result->get_header_value("Cross-Origin-Resource-Policy").c_str(),
                        "same-origin");
}

void viewers_get_what_was_and_what_comes(void **)
{
    Served served;
    served.state.put("status", "{\"state\":1}");
    Viewer early(served.server.port());
    assert_true(early.reads("event: status\ndata: {\"state\":1}\n\n"));
    served.state.put("status", "{\"state\":2}");
    assert_true(early.reads("event: status\ndata: {\"state\":2}\n\n"));
    Viewer late(served.server.port());
    assert_true(late.reads("event: status\ndata: {\"state\":2}\n\n"));
}

void too_many_viewers_are_told_to_come_back(void **)
{
    Served served;
    std::vector<std::unique_ptr<Viewer>> viewers;
    for (size_t i = 0; i < PageServer::viewers_max; i++)
        viewers.push_back(std::make_unique<Viewer>(served.server.port()));
    assert_true(comes_true([&] { return served.server.viewers() == PageServer::viewers_max; }));
    assert_int_equal(served.get("/events"), 503);
    assert_int_equal(served.get("/"), 200); // is still served
    viewers.clear();
    for (int i = 0; served.server.viewers() > 0 && i < 1000; i++) {
        served.state.put("status", std::to_string(i));
        std::this_thread::sleep_for(10ms);
    }
    assert_int_equal(served.server.viewers(), 0);
}

// Events of `size` bytes until no viewer is left; the most bytes that our heap grew by.
size_t growth_by_events(Served &served, size_t size)
{
    const size_t before = mallinfo2().uordblks;
    size_t growth = 0;
    for (int i = 0; served.server.viewers() > 0 && i < 1200; i++) {
        served.state.put("status", std::to_string(i) + std::string(size, ' '));
        std::this_thread::sleep_for(50ms);
        growth = std::max(growth, mallinfo2().uordblks - before);
    }
    return growth;
}

void a_viewer_that_reads_nothing_costs_little_and_is_left(void **)
{
    Served served;
    std::vector<std::unique_ptr<Viewer>> viewers;
    for (size_t i = 0; i < PageServer::viewers_max; i++)
        viewers.push_back(std::make_unique<Viewer>(served.server.port()));
    assert_true(comes_true([&] { return served.server.viewers() == PageServer::viewers_max; }));
    constexpr size_t size = 100000;
    // Each may be writing one event, held as text and as chunk, in strings that grow by doubling;
    // the others of these seconds would be a hundred times as much.
    const size_t growth = growth_by_events(served, size);
    print_message("%zu bytes more\n", growth);
    assert_true(growth < 6 * size * PageServer::viewers_max);
    assert_int_equal(served.server.viewers(), 0);
    // What the system held for it; by itself it would hold megabytes.
    assert_in_range(viewers[0]->unread(), 1, 512 * 1024);
}

void a_port_in_use_is_refused(void **)
{
    Served served;
    LiveState state;
    try {
        const PageServer second({"127.0.0.1", served.server.port(), "", {}}, state);
        fail();
    } catch (const vdna::Error &error) {
        assert_true(std::string(error.what()).find("--port") != std::string::npos);
    }
}

} // namespace

int main()
{
    mallopt(M_ARENA_MAX, 1); // as vdna_serve does; and mallinfo2() then knows all of the heap
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_page_and_its_files_are_served),
        cmocka_unit_test(only_an_address_is_a_host),
        cmocka_unit_test(another_page_gets_nothing),
        cmocka_unit_test(a_command_needs_the_token_and_our_own_page),
        cmocka_unit_test(a_command_that_cannot_be_sent_is_told),
        cmocka_unit_test(the_newest_picture_is_served),
        cmocka_unit_test(viewers_get_what_was_and_what_comes),
        cmocka_unit_test(too_many_viewers_are_told_to_come_back),
        cmocka_unit_test(a_viewer_that_reads_nothing_costs_little_and_is_left),
        cmocka_unit_test(a_port_in_use_is_refused),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
