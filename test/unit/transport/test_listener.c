// The listener on LCM's in-process network (memq://) and on log files. What it hears is published
// by a transport, or sent as bytes; memq:// has no other end, so the log files carry it.
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>
#include <vdna_messages.h>

#include <vdna/listener.h>
#include <vdna/transport.h>

#include "cmocka_all.h"
#include "lcm_samples.h"

// A log that a test writes and a listener then reads.
typedef struct log_file {
    char path[64];
    char url[128];
    lcm_t *writer;
} log_file;

static int make_log(void **state)
{
    static log_file log;
    strcpy(log.path, "/tmp/vdna_test_listener_XXXXXX");
    const int descriptor = mkstemp(log.path);
    if (descriptor < 0)
        return -1;
    close(descriptor);
    snprintf(log.url, sizeof log.url, "file://%s?mode=w", log.path);
    log.writer = lcm_create(log.url);
    snprintf(log.url, sizeof log.url, "file://%s?speed=0", log.path);
    *state = &log;
    return log.writer ? 0 : -1;
}

static int remove_log(void **state)
{
    log_file *log = *state;
    if (log->writer)
        lcm_destroy(log->writer);
    unlink(log->path);
    return 0;
}

static void send_raw(log_file *log, const char *channel, const void *data, size_t size)
{
    assert_int_equal(lcm_publish(log->writer, channel, data, (unsigned)size), 0);
}

static void send_ranking(log_file *log, const char *channel)
{
    vdna_msg_ranking_t_publish(log->writer, channel, &sample_ranking);
}

static void send_localisation(log_file *log, const char *channel, int64_t utime)
{
    vdna_msg_localisation_t message = sample_localisation;
    message.utime = utime;
    vdna_msg_localisation_t_publish(log->writer, channel, &message);
}

static vdna_listener *open_with(const vdna_listener_config *config)
{
    vdna_listener *listener = NULL;
    vdna_error error = {""};
    if (vdna_listener_open(config, &error, &listener) != VDNA_OK)
        fail_msg("%s", error.text);
    return listener;
}

// Listen to the log as written so far.
static vdna_listener *listen_to(log_file *log, const vdna_listener_channel *channels,
                                uint32_t count)
{
    lcm_destroy(log->writer);
    log->writer = NULL;
    vdna_listener_config config;
    vdna_listener_config_init(&config);
    config.url = log->url;
    config.channels = channels;
    config.channel_count = count;
    return open_with(&config);
}

static vdna_listener_message next(vdna_listener *listener)
{
    vdna_listener_message message;
    // A log also has messages that are not for us.
    do
        assert_int_equal(vdna_listener_poll(listener, 100, &message), VDNA_OK);
    while (!message.type);
    return message;
}

static void assert_ended(vdna_listener *listener)
{
    for (int again = 0; again < 2; again++) {
        vdna_listener_message message;
        assert_int_equal(vdna_listener_poll(listener, 100, &message), VDNA_ERR_IO);
    }
    vdna_listener_close(listener);
}

static int64_t monotonic_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

static const vdna_listener_channel both[] = {{"RANKING", &vdna_message_ranking},
                                             {"LOCALISATION", &vdna_message_localisation}};

static void every_message_comes_decoded_and_in_order(void **state)
{
    log_file *log = *state;
    send_localisation(log, "LOCALISATION", 1);
    send_ranking(log, "RANKING");
    send_localisation(log, "LOCALISATION", 2);
    const int64_t before_us = monotonic_us();
    vdna_listener *listener = listen_to(log, both, 2);

    vdna_listener_message message = next(listener);
    assert_ptr_equal(message.type, &vdna_message_localisation);
    assert_string_equal(message.channel, "LOCALISATION");
    assert_null(message.rejected);
    assert_int_equal(message.size, vdna_msg_localisation_t_encoded_size(&sample_localisation));
    assert_in_range(message.received_us, before_us, monotonic_us());
    const vdna_msg_localisation_t *localisation = message.data;
    assert_int_equal(localisation->utime, 1);
    assert_string_equal(localisation->experience, "snow");

    message = next(listener);
    assert_ptr_equal(message.type, &vdna_message_ranking);
    const vdna_msg_ranking_t *ranking = message.data;
    assert_int_equal(ranking->count, 2);
    assert_string_equal(ranking->experience[1], "snow");

    message = next(listener);
    localisation = message.data;
    assert_int_equal(localisation->utime, 2);
    assert_ended(listener);
}

static void a_message_that_breaks_its_format_comes_with_the_reason(void **state)
{
    log_file *log = *state;
    uint8_t bytes[1024];
    const int size = vdna_msg_ranking_t_encode(bytes, 0, sizeof bytes, &sample_ranking);
    send_raw(log, "RANKING", bytes, (size_t)size - 1);
    send_raw(log, "RANKING", "", 0);
    send_localisation(log, "RANKING", 1);
    send_ranking(log, "RANKING");
    vdna_listener *listener = listen_to(log, both, 2);

    const size_t sizes[] = {(size_t)size - 1, 0,
                            (size_t)vdna_msg_localisation_t_encoded_size(&sample_localisation)};
    for (int i = 0; i < 3; i++) {
        const vdna_listener_message message = next(listener);
        assert_ptr_equal(message.type, &vdna_message_ranking);
        assert_string_equal(message.channel, "RANKING");
        assert_null(message.data);
        assert_string_equal(message.rejected, "a message of another type or version");
        assert_int_equal(message.size, sizes[i]);
    }
    assert_non_null(next(listener).data);
    assert_ended(listener);
}

static void a_channel_name_is_not_a_regular_expression(void **state)
{
    log_file *log = *state;
    const vdna_listener_channel odd[] = {{"R.k+[1]|\\d", &vdna_message_ranking}};
    const char *others[] = {"Rxk+[1]|\\d", "R.kk1", "R.k1", "xR.k+[1]|\\d", "R.k+[1]|\\dx", "d"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        send_ranking(log, others[i]);
    send_ranking(log, odd[0].name);
    vdna_listener *listener = listen_to(log, odd, 1);
    assert_string_equal(next(listener).channel, odd[0].name);
    assert_ended(listener);
}

static void a_channel_name_need_not_be_ascii(void **state)
{
    log_file *log = *state;
    const vdna_listener_channel channel = {"\xc3\x9c-1", &vdna_message_ranking};
    send_ranking(log, channel.name);
    vdna_listener *listener = listen_to(log, &channel, 1);
    assert_non_null(next(listener).data);
    assert_ended(listener);
}

static void a_channel_may_be_listened_to_as_several_types(void **state)
{
    log_file *log = *state;
    const vdna_listener_channel same[] = {{"SAME", &vdna_message_ranking},
                                          {"SAME", &vdna_message_localisation}};
    send_ranking(log, "SAME");
    send_localisation(log, "SAME", 1);
    vdna_listener *listener = listen_to(log, same, 2);
    const vdna_message_type *well_formed[] = {&vdna_message_ranking, &vdna_message_localisation};
    for (int sent = 0; sent < 2; sent++)
        for (int type = 0; type < 2; type++) {
            const vdna_listener_message message = next(listener);
            assert_ptr_equal(message.type, same[type].type);
            assert_true((message.data != NULL) == (message.type == well_formed[sent]));
        }
    assert_ended(listener);
}

static void messages_not_taken_are_dropped_on_closing(void **state)
{
    log_file *log = *state;
    const vdna_listener_channel same[] = {{"SAME", &vdna_message_ranking},
                                          {"SAME", &vdna_message_ranking}};
    send_ranking(log, "SAME");
    vdna_listener *listener = listen_to(log, same, 2);
    assert_non_null(next(listener).data);
    vdna_listener_close(listener); // LeakSanitizer sees leaks
}

static void a_listener_does_not_need_its_configuration_any_more(void **state)
{
    log_file *log = *state;
    send_ranking(log, "RANKING");
    char name[] = "RANKING";
    vdna_listener_channel channel = {name, &vdna_message_ranking};
    vdna_listener *listener = listen_to(log, &channel, 1);
    memset(name, 'x', sizeof name - 1);
    memset(&channel, 0, sizeof channel);
    assert_string_equal(next(listener).channel, "RANKING");
    vdna_listener_close(listener);
}

// --- without a log ---

static vdna_listener_config memq_config(void)
{
    vdna_listener_config config;
    vdna_listener_config_init(&config);
    config.url = "memq://";
    config.channels = both;
    config.channel_count = 2;
    return config;
}

static void an_idle_poll_waits_for_its_timeout_and_finds_nothing(void **state)
{
    (void)state;
    const vdna_listener_config config = memq_config();
    vdna_listener *listener = open_with(&config);
    vdna_listener_message message = {.type = &vdna_message_ranking};
    const int64_t begin_us = monotonic_us();
    assert_int_equal(vdna_listener_poll(listener, 50, &message), VDNA_OK);
    assert_true(monotonic_us() - begin_us >= 50000);
    assert_null(message.type);
    assert_null(message.data);
    vdna_listener_close(listener);
}

static void on_alarm(int signal)
{
    (void)signal;
}

static void a_signal_ends_a_poll_without_an_error(void **state)
{
    (void)state;
    const vdna_listener_config config = memq_config();
    vdna_listener *listener = open_with(&config);
    struct sigaction action = {.sa_handler = on_alarm}, before;
    assert_int_equal(sigaction(SIGALRM, &action, &before), 0);
    // Repeated, in case one arrives before the poll.
    const struct itimerval every_20_ms = {{0, 20000}, {0, 20000}}, never = {{0, 0}, {0, 0}};
    assert_int_equal(setitimer(ITIMER_REAL, &every_20_ms, NULL), 0);
    const int64_t begin_us = monotonic_us();
    vdna_listener_message message;
    const vdna_status status = vdna_listener_poll(listener, 1000, &message);
    const int64_t waited_us = monotonic_us() - begin_us;
    setitimer(ITIMER_REAL, &never, NULL);
    sigaction(SIGALRM, &before, NULL);

    assert_int_equal(status, VDNA_OK);
    assert_null(message.type);
    assert_true(waited_us < 900000);
    vdna_listener_close(listener);
}

static void a_poll_refuses_bad_arguments(void **state)
{
    (void)state;
    const vdna_listener_config config = memq_config();
    vdna_listener *listener = open_with(&config);
    vdna_listener_message message;
    assert_int_equal(vdna_listener_poll(NULL, 0, &message), VDNA_ERR_ARG);
    assert_int_equal(vdna_listener_poll(listener, -1, &message), VDNA_ERR_ARG);
    assert_int_equal(vdna_listener_poll(listener, VDNA_TIMEOUT_MS_MAX + 1, &message), VDNA_ERR_ARG);
    assert_int_equal(vdna_listener_poll(listener, 0, NULL), VDNA_ERR_ARG);
    vdna_listener_close(listener);
    vdna_listener_close(NULL);
}

static void the_defaults_are_lcm_s_own_network_and_a_long_queue(void **state)
{
    (void)state;
    vdna_listener_config config;
    memset(&config, 0xff, sizeof config);
    vdna_listener_config_init(&config);
    assert_int_equal(config.struct_size, sizeof config);
    assert_int_equal(config.queue_length, 1000);
    assert_null(config.url);
    assert_null(config.channels);
    assert_int_equal(config.channel_count, 0);
}

// Whether a configuration is refused in a sentence with these words.
static void assert_refused(const vdna_listener_config *config, vdna_status expected,
                           const char *words)
{
    vdna_listener *listener = NULL;
    vdna_error error = {""};
    assert_int_equal(vdna_listener_open(config, &error, &listener), expected);
    assert_null(listener);
    assert_non_null(strstr(error.text, words));
}

static void a_bad_configuration_is_refused(void **state)
{
    (void)state;
    vdna_listener_config config = memq_config();
    assert_refused(NULL, VDNA_ERR_ARG, "vdna_listener_config_init");
    assert_int_equal(vdna_listener_open(&config, NULL, NULL), VDNA_ERR_ARG);
    config.struct_size--;
    assert_refused(&config, VDNA_ERR_ARG, "vdna_listener_config_init");

    config = memq_config();
    config.queue_length = 0;
    assert_refused(&config, VDNA_ERR_ARG, "queue_length is 0");
    config.queue_length = 65537;
    assert_refused(&config, VDNA_ERR_ARG, "1..65536");

    config = memq_config();
    config.channel_count = 257;
    assert_refused(&config, VDNA_ERR_ARG, "channel_count is 257");
    config.channel_count = 1;
    config.channels = NULL;
    assert_refused(&config, VDNA_ERR_ARG, "channels is NULL");

    config = memq_config();
    config.url = "carrier-pigeon://loft";
    assert_refused(&config, VDNA_ERR_IO, "udpm://239.255.76.67:7667?ttl=0");
}

static void a_bad_channel_is_refused(void **state)
{
    (void)state;
    char name[65];
    memset(name, 'x', sizeof name);
    name[64] = 0;
    vdna_listener_channel channel = {name, &vdna_message_ranking};
    vdna_listener_config config = memq_config();
    config.channels = &channel;
    config.channel_count = 1;
    assert_refused(&config, VDNA_ERR_ARG, "64 bytes");
    channel.name = "";
    assert_refused(&config, VDNA_ERR_ARG, "0 bytes");
    channel.name = NULL;
    assert_refused(&config, VDNA_ERR_ARG, "NULL");
    channel.name = name + 1;
    vdna_listener_close(open_with(&config));
    channel.type = NULL;
    assert_refused(&config, VDNA_ERR_ARG, "no type");
}

#define ON_LOG(test) cmocka_unit_test_setup_teardown(test, make_log, remove_log)

int main(void)
{
    const struct CMUnitTest tests[] = {
        ON_LOG(every_message_comes_decoded_and_in_order),
        ON_LOG(a_message_that_breaks_its_format_comes_with_the_reason),
        ON_LOG(a_channel_name_is_not_a_regular_expression),
        ON_LOG(a_channel_name_need_not_be_ascii),
        ON_LOG(a_channel_may_be_listened_to_as_several_types),
        ON_LOG(messages_not_taken_are_dropped_on_closing),
        ON_LOG(a_listener_does_not_need_its_configuration_any_more),
        cmocka_unit_test(an_idle_poll_waits_for_its_timeout_and_finds_nothing),
        cmocka_unit_test(a_signal_ends_a_poll_without_an_error),
        cmocka_unit_test(a_poll_refuses_bad_arguments),
        cmocka_unit_test(the_defaults_are_lcm_s_own_network_and_a_long_queue),
        cmocka_unit_test(a_bad_configuration_is_refused),
        cmocka_unit_test(a_bad_channel_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
