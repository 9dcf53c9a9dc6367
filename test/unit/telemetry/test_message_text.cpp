// Messages as text. Samples are made from the tables of their types.
#include <algorithm>
#include <set>
#include <string>

#include "cmocka.hpp"
#include "message_sample.h"
#include "telemetry/message_text.hpp"

namespace
{

using vdna::telemetry::View;
using vdna::telemetry::views;

// The number that a sample has in each int64_t.
constexpr int64_t sample_number = 0x3131313131313131;

void every_kind_of_message_is_shown_as_the_type_that_it_is(void **)
{
    for (const View &view : views()) {
        void *const message = sample_new(view.type);
        const nlohmann::ordered_json json = view.json(message);
        assert_string_equal(json["type"].get<std::string>().c_str(), view.name);
        assert_int_equal(json["utime"].get<int64_t>(), sample_number);
        assert_int_equal(view.text(message).find(view.name), 0);
        sample_free(view.type, message);
    }
}

// Is there a member whose values have names in the .lcm file?
bool has_named_values(const vdna_message_type &type)
{
    const std::set<std::string> named{"state", "validity"};
    return std::any_of(
        type.members, type.members + type.member_count,
        [&](const vdna_message_member &member) { return named.count(member.name) > 0; });
}

void a_value_of_a_later_version_is_shown_as_unknown(void **)
{
    for (const View &view : views()) {
        if (!has_named_values(*view.type))
            continue;
        void *const message = sample_new(view.type);
        assert_true(view.text(message).find("UNKNOWN") != std::string::npos);
        assert_true(view.json(message).dump().find("\"UNKNOWN\"") != std::string::npos);
        sample_free(view.type, message);
    }
}

void every_kind_of_message_has_a_type_a_name_and_a_channel_of_its_own(void **)
{
    std::set<const vdna_message_type *> types;
    std::set<std::string> names, channels;
    for (const View &view : views()) {
        types.insert(view.type);
        names.insert(view.name);
        channels.insert(view.channel);
    }
    assert_int_equal(types.size(), views().size());
    assert_int_equal(names.size(), views().size());
    assert_int_equal(channels.size(), views().size());
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_message_is_shown_as_the_type_that_it_is),
        cmocka_unit_test(a_value_of_a_later_version_is_shown_as_unknown),
        cmocka_unit_test(every_kind_of_message_has_a_type_a_name_and_a_channel_of_its_own),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
