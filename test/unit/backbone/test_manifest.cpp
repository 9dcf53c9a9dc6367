// Manifests: reading, and messages about mistakes.
#include <cmocka.hpp>
#include <folder.hpp>

#include "failure.hpp"
#include "manifest.hpp"
#include "manifest_path.hpp"

using namespace vdna;
using namespace vdna::backbone;

static const char *const whole = R"(name = "tiny"
model = "networks/tiny.onnx"
sha256 = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"
source = "drawn by hand"
licence = "MIT"
[input]
name = "image"
width = 320
height = 240
colour = "BGR"
mean = [123.675, 116.28, 0]
std = [58.395, 57.12, 1e-1]
resize = "stretch"
interpolation = "cubic"
[[taps]]
output = "tokens"
layout = "samples_neurons"
[[taps]]
output = "map"
layout = "neurons_samples"
[embedding]
output = "map"
l2_normalise = true
)";

// The text of the vdna::fail::Failure on reading `text` as a manifest; its status must be `status`.
static std::string failure_of(const std::string &text, vdna_status status = VDNA_ERR_FORMAT)
{
    const Folder folder;
    try {
        read_manifest(folder.write("m.toml", text));
    } catch (const vdna::fail::Failure &failure) {
        assert_int_equal(failure.status(), status);
        return failure.what();
    }
    return "accepted";
}

// Reading `text` fails in this line, for this reason.
static void assert_refused(const std::string &text, const std::string &line,
                           const std::string &reason)
{
    const std::string failure = failure_of(text);
    if (failure.find("m.toml:" + line + ": " + reason) == std::string::npos)
        fail_msg("expected line %s: %s; found: %s", line.c_str(), reason.c_str(), failure.c_str());
}

static void every_field_is_read(void **)
{
    const Folder folder;
    const Manifest manifest = read_manifest(folder.write("m.toml", whole));
    assert_string_equal(manifest.name.c_str(), "tiny");
    assert_string_equal(manifest.model.c_str(), (folder.path() / "networks/tiny.onnx").c_str());
    assert_int_equal(manifest.sha256.size(), 64);
    assert_string_equal(manifest.input.name.c_str(), "image");
    assert_int_equal(manifest.input.width, 320);
    assert_int_equal(manifest.input.height, 240);
    assert_true(manifest.input.bgr);
    assert_true(manifest.input.mean[1] == 116.28 && manifest.input.mean[2] == 0.0);
    assert_true(manifest.input.std[2] == 0.1);
    assert_true(manifest.input.interpolation == picture::Interpolation::cubic);
    assert_int_equal(manifest.taps.size(), 2);
    assert_string_equal(manifest.taps[1].output.c_str(), "map");
    assert_int_equal(manifest.taps[1].layout, VDNA_LAYOUT_NEURONS_SAMPLES);
    assert_string_equal(manifest.embedding.output.c_str(), "map");
    assert_true(manifest.embedding.l2_normalise);
    assert_true(!manifest.embedding.grid && !manifest.embedding.centre);
    assert_string_equal(manifest.embedding.last_layer.c_str(), "");
}

static void the_preprocessing_has_one_canonical_text(void **)
{
    const Folder folder;
    const Manifest manifest = read_manifest(folder.write("m.toml", whole));
    assert_string_equal(preprocessing_text(manifest).c_str(),
                        "320x240 BGR mean=123.675,116.28,0 std=58.395,57.12,0.1 "
                        "resize=stretch/cubic l2=1");
}

static void pictures_are_decoded_in_full_unless_a_manifest_says_otherwise(void **)
{
    const Folder folder;
    const auto text_of = [&](const std::string &decode) {
        return preprocessing_text(
            read_manifest(folder.write("m.toml", with(whole, "[[taps]]\noutput = \"tokens\"",
                                                      decode + "[[taps]]\noutput = \"tokens\""))));
    };
    // Maps of before compare with what says the same in words.
    assert_string_equal(text_of("").c_str(), text_of("decode = \"full\"\n").c_str());
    assert_string_equal(text_of("decode = \"reduced\"\n").c_str(),
                        "320x240 BGR mean=123.675,116.28,0 std=58.395,57.12,0.1 "
                        "resize=stretch/cubic decode=reduced l2=1");
    assert_refused(with(whole, "resize =", "decode = \"half\"\nresize ="), "13",
                   "'decode' is 'half'; expected: full, reduced");
}

static void a_network_is_fp32_and_an_original_unless_it_says_otherwise(void **)
{
    const Folder folder;
    Manifest manifest = read_manifest(folder.write("m.toml", whole));
    assert_string_equal(manifest.precision.c_str(), "fp32");
    assert_string_equal(manifest.quantised_from.c_str(), "");
    const std::string hash(64, 'a');
    const std::string quantised = with(whole, "[input]",
                                       "precision = \"int8\"\n[quantised]\nfrom_sha256 = \"" +
                                           hash + "\"\nmethod = \"by hand\"\n[input]");
    manifest = read_manifest(folder.write("q.toml", quantised));
    assert_string_equal(manifest.precision.c_str(), "int8");
    assert_string_equal(manifest.quantised_from.c_str(), hash.c_str());
    assert_refused(with(quantised, "\"int8\"", "\"int4\""), "6", "'precision' is 'int4'");
    assert_refused(with(quantised, "method", "methods"), "9", "unknown key 'methods'");
    assert_refused(with(quantised, hash, "a"), "8", "'from_sha256' must be 64");
}

// The definition of the embedding with `keys` beside the output, in a manifest that begins with
// `first`.
static std::string definition_of(const std::string &keys, const std::string &first = "")
{
    const Folder folder;
    const std::string text = first + with(whole, "[embedding]\noutput = \"map\"",
                                          "[embedding]\noutput = \"map\"\n" + keys);
    return embedding_text(read_manifest(folder.write("m.toml", text)).embedding);
}

static void an_embedding_has_one_canonical_definition(void **)
{
    assert_string_equal(definition_of("").c_str(), "");
    assert_string_equal(definition_of("centre = false").c_str(), "");
    assert_string_equal(definition_of("centre = true").c_str(), "map centred");
    assert_string_equal(definition_of("grid = 3").c_str(), "map grid=3x3");
    assert_string_equal(definition_of("grid = [3, 1]").c_str(), "map grid=3x1");
    assert_string_equal(definition_of("last_layer = \"mean\"").c_str(), "map last=mean");
    assert_string_equal(
        definition_of("centre = true\nlast_layer = \"mean\"\ngrid = [3, 3]").c_str(),
        "map grid=3x3 last=mean centred");
}

static void how_embeddings_are_stored_is_not_part_of_their_definition(void **)
{
    const Folder folder;
    const auto is_int8 = [&](const char *storage) {
        const std::string text =
            with(whole, "l2_normalise =", std::string(storage) + "l2_normalise =");
        const Embedding embedding = read_manifest(folder.write("m.toml", text)).embedding;
        assert_string_equal(embedding_text(embedding).c_str(), "");
        return embedding.int8;
    };
    assert_false(is_int8(""));
    assert_false(is_int8("dims = 2\n"));
    assert_false(is_int8("storage = \"float32\"\n"));
    assert_true(is_int8("storage = \"int8\"\n"));
    assert_refused(with(whole, "l2_normalise =", "storage = \"int4\"\nl2_normalise ="), "23",
                   "'storage' is 'int4'; expected: float32, int8");
}

static void the_papers_protocol_keeps_one_layer_for_both(void **)
{
    const Folder folder;
    const std::string ours = with(whole, "output = \"map\"\nl2",
                                  "output = \"map\"\ngrid = 3\ncentre = true\n"
                                  "last_layer = \"mean\"\nl2");
    const Manifest manifest =
        read_manifest(folder.write("m.toml", "protocol = \"paper\"\n" + ours));
    assert_string_equal(manifest.embedding.output.c_str(), "mean");
    assert_true(manifest.embedding.l2_normalise);
    assert_string_equal(embedding_text(manifest.embedding).c_str(), "");
    // A manifest of before means the same with and without it.
    assert_string_equal(definition_of("", "protocol = \"paper\"\n").c_str(), "");
    assert_refused("protocol = \"paper\"\n" +
                       with(whole, "l2_normalise =", "grid = 3\nl2_normalise ="),
                   "22", "protocol 'paper' localises by the last layer; name its output");
    assert_refused("protocol = \"papers\"\n" + std::string(whole), "1",
                   "'protocol' is 'papers'; expected: paper");
}

static void a_grid_that_is_none_is_refused(void **)
{
    const auto refuse = [](const char *grid) {
        assert_refused(with(whole, "l2_normalise =", std::string(grid) + "\nl2_normalise ="), "23",
                       "'grid' must be a number of cells per side, 1 to 4096, or [rows, columns]");
    };
    for (const char *grid : {"grid = 0", "grid = -3", "grid = 4097", "grid = 3.0", "grid = \"3\"",
                             "grid = []", "grid = [3]", "grid = [3, 0]", "grid = [3, 3, 3]",
                             "grid = [0, 3]", "grid = [3, true]", "grid = [[3], 3]"})
        refuse(grid);
    for (const char *dims : {"0", "-1", "64.0", "\"64\"", "4294967296"})
        assert_refused(
            with(whole, "l2_normalise =", "dims = " + std::string(dims) + "\nl2_normalise ="), "23",
            "'dims' must be how many numbers of each embedding a map keeps, from 1 to all");
    assert_refused(with(whole, "l2_normalise =", "dim = 64\nl2_normalise ="), "23",
                   "unknown key 'dim'; expected: output, grid, dims, centre, last_layer");
    assert_refused(with(whole, "l2_normalise =", "last_layer = \"a b\"\nl2_normalise ="), "23",
                   "'last_layer' must be a name without blanks");
    assert_refused(with(whole, "\"map\"\nl2", "\"m ap\"\nl2"), "22",
                   "'output' must be a name without blanks");
    assert_refused(with(whole, "l2_normalise =", "centre = 1\nl2_normalise ="), "23",
                   "'centre' must be true or false");
}

// `whole` with this section [golden]; its first line is 25.
static std::string with_golden(const std::string &lines)
{
    return whole + ("[golden]\n" + lines);
}

static const std::string known = "tolerance = 0.01\ntaps = [[1, -2.5], [3]]\nembedding = [4.5]\n";

static void golden_numbers_are_read_if_there_are_any(void **)
{
    const Folder folder;
    assert_false(read_manifest(folder.write("m.toml", whole)).golden.has_value());
    const Manifest manifest = read_manifest(folder.write("g.toml", with_golden(known)));
    assert_true(manifest.golden->tolerance == 0.01);
    assert_true(manifest.golden->taps == (std::vector<std::vector<double>>{{1, -2.5}, {3}}));
    assert_true(manifest.golden->embedding == std::vector<double>{4.5});
    assert_true(manifest.golden->last_layer.empty());
    // They change nothing that maps are compared by.
    assert_string_equal(preprocessing_text(manifest).c_str(),
                        preprocessing_text(read_manifest(folder.path() / "m.toml")).c_str());
}

static void golden_numbers_of_the_last_layer_belong_to_one(void **)
{
    const Folder folder;
    const std::string layered = with(with_golden(known + "last_layer = [6]\n"),
                                     "l2_normalise =", "last_layer = \"tokens\"\nl2_normalise =");
    assert_true(read_manifest(folder.write("m.toml", layered)).golden->last_layer ==
                std::vector<double>{6});
    // Of the paper's protocol only the taps are the same.
    const Golden papers =
        *read_manifest(folder.write("p.toml", "protocol = \"paper\"\n" + layered)).golden;
    assert_true(papers.taps.size() == 2 && papers.embedding.empty() && papers.last_layer.empty());
    assert_refused(with(layered, "last_layer = [6]", ""), "25", "'last_layer' is missing");
    assert_refused(with_golden(known + "last_layer = [6]\n"), "28",
                   "'last_layer' is not in [embedding]; remove it");
}

static void golden_numbers_that_cannot_be_compared_are_refused(void **)
{
    const std::string is_list = "a list of 1 to 64 numbers was expected";
    for (const char *tolerance : {"0", "-0.1", "1", "nan", "\"0.01\""})
        assert_refused(with_golden(with(known, "0.01", tolerance)), "25",
                       "'tolerance' must be a number above 0 and below 1");
    for (const char *taps : {"[[1]]", "[[1], [2], [3]]", "3", "[]"})
        assert_refused(with_golden(with(known, "[[1, -2.5], [3]]", taps)), "26",
                       "'taps' must be 2 lists, one for each [[taps]]");
    for (const char *list : {"[]", "4.5", "[\"4.5\"]", "[nan]", "[1, inf]", "[[4.5]]"}) {
        assert_refused(with_golden(with(known, "[4.5]", list)), "27", is_list);
        assert_refused(with_golden(with(known, "[3]]", list + std::string("]"))), "26", is_list);
    }
    std::string many = "[4.5";
    for (int i = 1; i < 65; i++)
        many += ", 4.5";
    assert_refused(with_golden(with(known, "[4.5]", many + "]")), "27", is_list);
    assert_refused(with_golden(with(known, "embedding", "embeddings")), "27", "unknown key");
    assert_refused(with_golden(with(known, "embedding = [4.5]", "")), "24",
                   "'embedding' is missing");
    assert_refused("golden = 3\n" + std::string(whole), "1", "'golden' must be a section");
}

static void an_unknown_key_is_refused_in_every_section(void **)
{
    assert_refused(with(whole, "licence =", "license ="), "5", "unknown key 'license'; expected:");
    assert_refused(with(whole, "height =", "hieght ="), "9", "unknown key 'hieght'; expected:");
    assert_refused(with(whole, "layout =", "lay_out ="), "17", "unknown key 'lay_out'");
    assert_refused(with(whole, "l2_normalise =", "normalise ="), "23", "unknown key 'normalise'");
}

static void a_missing_key_is_told_at_its_section(void **)
{
    assert_refused(with(whole, "licence = \"MIT\"", ""), "1", "'licence' is missing");
    assert_refused(with(whole, "width = 320", ""), "6", "'width' is missing; expected a whole");
    assert_refused(with(whole, "output = \"map\"", ""), "18", "'output' is missing");
    assert_refused(with(whole, "l2_normalise = true", ""), "21", "'l2_normalise' is missing");
    assert_refused(with(whole, "[input]", "[source]"), "6", "");
}

static void a_value_of_the_wrong_type_is_told_at_its_line(void **)
{
    assert_refused(with(whole, "width = 320", "width = \"320\""), "8", "'width' must be a whole");
    assert_refused(with(whole, "width = 320", "width = 0"), "8", "'width' must be a whole");
    assert_refused(with(whole, "width = 320", "width = 4097"), "8", "'width' must be a whole");
    assert_refused(with(whole, "\"BGR\"", "\"GBR\""), "10", "'colour' is 'GBR'; expected: RGB");
    assert_refused(with(whole, "116.28, 0]", "116.28]"), "11", "'mean' must be three numbers");
    assert_refused(with(whole, "116.28, 0]", "nan, 0]"), "11", "'mean' must be three numbers");
    assert_refused(with(whole, "57.12", "0"), "12", "'std' is divided by");
    assert_refused(with(whole, "\"stretch\"", "\"crop\""), "13", "'resize' is 'crop'");
    assert_refused(with(whole, "l2_normalise = true", "l2_normalise = 1"), "23",
                   "'l2_normalise' must be true or false");
    assert_refused(with(whole, "sha256 = \"0123", "sha256 = \"ABCD"), "3", "'sha256' must be 64");
    assert_refused(with(whole, "name = \"tiny\"", "name = \"ti ny\""), "1", "'name' must be 1 to");
    assert_refused(with(whole, "name = \"tiny\"", "name = \"\""), "1", "'name' must be a text");
}

static void taps_must_be_there_and_differ(void **)
{
    assert_refused(with(whole, "output = \"map\"", "output = \"tokens\""), "19",
                   "'tokens' is tapped twice");
    assert_refused(with(whole, "\"tokens\"", "\"to:kens\""), "16", "'output' must be a name");
    const std::string cut(whole, std::string(whole).find("[[taps]]"));
    assert_refused("taps = 3\n" + cut, "1", "'taps' must be one or more");
    assert_refused(cut, "1", "'taps' is missing");
}

static void bytes_that_are_no_toml_are_told_at_their_line(void **)
{
    assert_refused(with(whole, "\"MIT\"", "\"MIT"), "5", "");
    assert_refused(with(whole, "\"MIT\"", "\"\xff\""), "5", "");
    assert_true(failure_of(std::string((1 << 16) + 1, '#')).find("65537 bytes") !=
                std::string::npos);
}

// What the parser takes for unreachable: see vdna_includes_toml() of lib/cmake/BuildFlags.cmake.
static void beyond_ascii_nothing_is_a_blank(void **)
{
    for (unsigned c = 0x80; c < 0x800; c++) {
        const char utf8[] = {static_cast<char>(0xC0 | c >> 6), static_cast<char>(0x80 | (c & 0x3F)),
                             '\0'};
        assert_refused(with(whole, "licence =", std::string("licence ") + utf8 + "="), "5", "");
    }
}

static void a_missing_file_or_a_folder_cannot_be_read(void **)
{
    const Folder folder;
    for (const char *name : {"", "absent.toml"})
        try {
            read_manifest(folder.path() / name);
            fail_msg("'%s' was read", name);
        } catch (const vdna::fail::Failure &failure) {
            assert_int_equal(failure.status(), VDNA_ERR_IO);
        }
}

static void a_bare_name_is_looked_up_and_a_path_is_not(void **)
{
    const Folder folder;
    folder.write("tiny.toml", whole);
    folder.write("other.toml", whole);
    setenv("VDNA_MODELS", folder.path().c_str(), 1);
    assert_string_equal(find_manifest("tiny").c_str(), (folder.path() / "tiny.toml").c_str());
    assert_string_equal(find_manifest("here/tiny").c_str(), "here/tiny");
    assert_string_equal(find_manifest("tiny.toml").c_str(), "tiny.toml");
    try {
        find_manifest("absent");
        fail_msg("%s", "'absent' was found");
    } catch (const vdna::fail::Failure &failure) {
        const std::string text = failure.what();
        assert_int_equal(failure.status(), VDNA_ERR_IO);
        assert_true(text.find(folder.path().string() + " (has other, tiny)") != std::string::npos);
        assert_true(text.find("/usr/share/vdna/models") != std::string::npos);
    }
    unsetenv("VDNA_MODELS");
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(every_field_is_read),
        cmocka_unit_test(the_preprocessing_has_one_canonical_text),
        cmocka_unit_test(pictures_are_decoded_in_full_unless_a_manifest_says_otherwise),
        cmocka_unit_test(a_network_is_fp32_and_an_original_unless_it_says_otherwise),
        cmocka_unit_test(an_embedding_has_one_canonical_definition),
        cmocka_unit_test(how_embeddings_are_stored_is_not_part_of_their_definition),
        cmocka_unit_test(the_papers_protocol_keeps_one_layer_for_both),
        cmocka_unit_test(a_grid_that_is_none_is_refused),
        cmocka_unit_test(golden_numbers_are_read_if_there_are_any),
        cmocka_unit_test(golden_numbers_of_the_last_layer_belong_to_one),
        cmocka_unit_test(golden_numbers_that_cannot_be_compared_are_refused),
        cmocka_unit_test(an_unknown_key_is_refused_in_every_section),
        cmocka_unit_test(a_missing_key_is_told_at_its_section),
        cmocka_unit_test(a_value_of_the_wrong_type_is_told_at_its_line),
        cmocka_unit_test(taps_must_be_there_and_differ),
        cmocka_unit_test(bytes_that_are_no_toml_are_told_at_their_line),
        cmocka_unit_test(beyond_ascii_nothing_is_a_blank),
        cmocka_unit_test(a_missing_file_or_a_folder_cannot_be_read),
        cmocka_unit_test(a_bare_name_is_looked_up_and_a_path_is_not),
    };
    return cmocka_run_group_tests_name("manifest", tests, nullptr, nullptr);
}
