// vdna_selectord: camera frames in, chosen experience and positions out, over LCM.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <memory>
#include <numeric>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <signal.h>

#include <vdna/cpp/backbone.hpp>
#include <vdna/cpp/connection.hpp>
#include <vdna/cpp/error.hpp>
#include <vdna/cpp/map.hpp>

#include "program/exit_code.hpp"
#include "selectord/backbone_child.hpp"
#include "selectord/backbone_process.hpp"
#include "selectord/command_line.hpp"
#include "selectord/daemon.hpp"
#include "selectord/lost_pages.hpp"
#include "selectord/memory_statement.hpp"
#include "selectord/output.hpp"
#include "selectord/processor.hpp"
#include "selectord/resident_memory.hpp"
#include "selectord/service_manager.hpp"
#include "selectord/start_check.hpp"
#include "selectord/stop.hpp"

namespace
{

using namespace vdna;
using namespace vdna::selectord;

// The parts of a list with commas.
std::vector<std::string> split(const std::string &list)
{
    std::vector<std::string> parts;
    std::istringstream in(list);
    for (std::string part; std::getline(in, part, ',');)
        parts.push_back(part);
    return parts;
}

// Borrows from all.
vdna_transport_config transport_config(const Config &config, const Daemon &daemon,
                                       const std::vector<const char *> &sources)
{
    vdna_transport_config transport;
    vdna_transport_config_init(&transport);
    transport.url = url_or_default(config.url);
    transport.max_image_bytes = config.max_image_bytes;
    transport.max_message_bytes = daemon.message_size_max();
    transport.camera_channel = config.camera_channel.c_str();
    transport.command_channel = config.command_channel.c_str();
    if (config.standby && !vdna_transport_is_log(config.url.c_str()))
        transport.peer_channel = config.status_channel.c_str();
    transport.sources = sources.data();
    transport.source_count = sources.size();
    transport.require_protection = config.require_protection;
    return transport;
}

vdna_transport_memory memory_of(const vdna_transport_config &transport)
{
    vdna_transport_memory memory{};
    vdna_transport_memory_of(&transport, &memory); // cannot fail: our configuration is valid
    return memory;
}

// In a replay nobody needs answers in time, and the same log is to give the same ones.
bool wants_backbone_process(const Config &config)
{
    return config.backbone_process && !vdna_transport_is_log(config.url.c_str());
}

void say_ok(const Config &config, const std::vector<vdna_experience> &all, const Backbone &backbone)
{
    const uint64_t frames = std::accumulate(
        all.begin(), all.end(), uint64_t{0},
        [](uint64_t sum, const vdna_experience &experience) { return sum + experience.frames; });
    std::cout << "OK: " << config.map_directory << ": " << all.size() << " experiences, " << frames
              << " frames; backbone " << backbone.info().identity.backbone << " fits, on "
              << backbone.info().runtime << std::endl;
}

void say_large_map(const MemoryStatement &memory)
{
    const std::string sentence = memory.about_large_map();
    if (!sentence.empty())
        std::fprintf(stderr, "vdna_selectord: %s\n", sentence.c_str());
}

void say_ready(const Config &config, const std::vector<vdna_experience> &all,
               const Backbone &backbone)
{
    const char *url = config.url.empty() ? std::getenv("LCM_DEFAULT_URL") : config.url.c_str();
    std::cout << "vdna_selectord: READY map=" << config.map_directory
              << " experiences=" << all.size() << " backbone=" << backbone.info().identity.backbone
              << " url=" << (url ? url : "default") << std::endl;
}

program::ExitCode run(int argc, char **argv)
{
    // The command line. Nothing is opened yet.
    const std::optional<Invocation> invocation = read_command_line(argc, argv);
    if (!invocation)
        return program::exit_ok;
    const Config &config = invocation->config;
    if (invocation->print_config) {
        print_config(config, std::cout);
        return program::exit_ok;
    }

    // Processors and priority, which later threads inherit. From here on a signal ends the process
    // within a moment. The loss of who reads our output must not, nor a limit on the size of files.
    take_processors(config);
    return_large_blocks();
    StopOnSignal stop;
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);

    const ServiceManager manager(std::getenv("NOTIFY_SOCKET"));

    StartUp start_up;
    const ResidentMemory resident;
    start_up.program = resident.read();

    // The map, while the network opens in its process.
    const bool will_run = !invocation->print_memory && !invocation->check;
    std::optional<BackboneProcess> process;
    if (wants_backbone_process(config))
        process.emplace(config, config.lock_memory && will_run);
    if (!config.copy_map)
        survive_lost_pages();
    OpenedMap opened = open_map(config);
    start_up.map = resident.read();

    // The network and the loop's memory: the large allocations end here.
    const Backbone backbone = process ? process->open()
                                      : Backbone(config.manifest, config.threads, config.runtime,
                                                 config.max_image_pixels);
    opened.map->require_backbone(backbone.info());
    require_repeatable(backbone);
    start_up.backbone = resident.read();
    if (process) {
        start_up.process = process->resident();
        start_up.mailbox = process->shared_bytes();
    }
    Daemon daemon(config, std::move(opened), backbone, process ? &*process : nullptr);
    const std::vector<std::string> addresses = split(config.sources);
    std::vector<const char *> sources;
    for (const std::string &address : addresses)
        sources.push_back(address.c_str());
    const vdna_transport_config transport = transport_config(config, daemon, sources);
    const MemoryStatement memory(config, start_up, backbone, daemon, memory_of(transport));
    if (invocation->print_memory) {
        invocation->json ? memory.print_json(std::cout) : memory.print(std::cout);
        return program::exit_ok;
    }
    memory.require_budget();
    if (invocation->check) {
        say_ok(config, daemon.session().experiences(), backbone);
        return program::exit_ok;
    }

    // A replay is to give the same answers again, so it has one map.
    if (!vdna_transport_is_log(config.url.c_str()))
        daemon.reload_when(stop.reload_requested(), memory.held_beside_map());

    // One-way door: from here on we are visible to others, and wait for nobody.
    never_wait_for_readers();
    if (!invocation->answers.empty())
        daemon.keep_answers(invocation->answers);
    const StopOnSignal::Cancels cancels(stop, backbone.get());
    const Connection connection = connect(transport);
    if (config.lock_memory)
        lock_memory();
    say_large_map(memory);
    daemon.session().say_no_trust();
    say_ready(config, daemon.session().experiences(), backbone);

    daemon.run(connection.get(), stop.requested(), manager);

    // Everything closes itself in reverse order: connection, signals, selector, backbone, map.
    if (stop.requested())
        std::fprintf(stderr, "vdna_selectord: stopped by a signal\n");
    return program::exit_ok;
}

} // namespace

int main(int argc, char **argv)
{
    if (is_backbone_child(argc, argv))
        return run_backbone_child();
    try {
        return run(argc, argv);
    } catch (const vdna::Error &error) {
        std::fprintf(stderr, "vdna_selectord: %s\n", error.what());
        return vdna::program::exit_code_of(error);
    } catch (const std::exception &error) {
        std::fprintf(stderr,
                     "vdna_selectord: %s; this is a defect or the system is out of memory\n",
                     error.what());
        return vdna::program::exit_failed;
    }
}
