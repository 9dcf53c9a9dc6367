// Counts the allocations of our own code: the linker sends its malloc, calloc and realloc here
// (see CMakeLists.txt). LCM, a shared library, keeps its own and is not counted.
#include <vdna_messages.h>

#include <vdna/transport.h>

#include "cmocka_all.h"
#include "lcm_samples.h"

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *block, size_t size);

static unsigned allocations;

void *__wrap_malloc(size_t size)
{
    allocations++;
    return __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    allocations++;
    return __real_calloc(count, size);
}

void *__wrap_realloc(void *block, size_t size)
{
    allocations++;
    return __real_realloc(block, size);
}

static vdna_transport *open_on_memq(void)
{
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    config.url = "memq://";
    config.camera_channel = "CAMERA";
    config.command_channel = "VDNA_COMMAND";
    vdna_transport *transport = NULL;
    assert_int_equal(vdna_transport_open(&config, NULL, &transport), VDNA_OK);
    return transport;
}

// One frame and one command in, one message of each kind out.
static void go_round(vdna_transport *transport, int64_t utime)
{
    static const uint8_t pixels[1000];
    const vdna_image image = {pixels, sizeof pixels, 100, 10, 0, VDNA_PIXEL_GREY};
    assert_int_equal(vdna_transport_publish_image(transport, "CAMERA", utime, &image), VDNA_OK);
    assert_int_equal(
        vdna_transport_publish(transport, "VDNA_COMMAND", &vdna_message_command, &sample_command),
        VDNA_OK);

    vdna_transport_frame frame;
    uint32_t events;
    assert_int_equal(vdna_transport_poll(transport, 0, &events, &frame), VDNA_OK);
    assert_int_equal(events, VDNA_TRANSPORT_FRAME | VDNA_TRANSPORT_COMMAND);
    assert_int_equal(frame.utime, utime);

    assert_int_equal(
        vdna_transport_publish(transport, "VDNA_RANKING", &vdna_message_ranking, &sample_ranking),
        VDNA_OK);
    assert_int_equal(vdna_transport_publish(transport, "VDNA_LOCALISATION",
                                            &vdna_message_localisation, &sample_localisation),
                     VDNA_OK);
    assert_int_equal(
        vdna_transport_publish(transport, "VDNA_STATUS", &vdna_message_status, &sample_status),
        VDNA_OK);
}

static void ten_thousand_messages_in_cost_no_allocation_of_ours(void **state)
{
    (void)state;
    allocations = 0;
    vdna_transport *transport = open_on_memq();
    assert_true(allocations > 0); // otherwise nothing is being counted
    go_round(transport, 0);

    allocations = 0;
    for (int64_t utime = 1; utime <= 5000; utime++)
        go_round(transport, utime);
    assert_int_equal(allocations, 0);
    assert_int_equal(vdna_transport_count(transport)->received, 5001);
    assert_int_equal(vdna_transport_count(transport)->commands, 5001);
    vdna_transport_close(transport);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ten_thousand_messages_in_cost_no_allocation_of_ours),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
