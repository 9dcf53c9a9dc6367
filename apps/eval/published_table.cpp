#include "eval/published_table.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include <vdna/cpp/error.hpp>

#include "eval/methods.hpp"

namespace vdna::eval
{

namespace
{

constexpr double no_pair = std::numeric_limits<double>::quiet_NaN();

// A member of the JSON text, with its path for complaints: "FILE: recall.fall.winter".
struct Member {
    const program::Json &json;
    std::string path;

    [[noreturn]] void fail(const std::string &expected) const
    {
        throw Error(
            path + ": is " +
            json.dump(-1, ' ', false, program::Json::error_handler_t::replace).substr(0, 60) +
            ", expected " + expected);
    }

    void require_object(const std::string &expected) const
    {
        if (!json.is_object())
            fail(expected);
    }
};

// Keep a complaint on one line, whatever names the file contains.
std::string printable(std::string name)
{
    std::replace_if(
        name.begin(), name.end(),
        [](char c) { return std::iscntrl(static_cast<unsigned char>(c)); }, '?');
    return name;
}

std::vector<Member> members_of(const Member &object)
{
    std::vector<Member> members;
    for (const auto &[name, value] : object.json.items())
        members.push_back({value, object.path + "." + printable(name)});
    return members;
}

std::vector<std::string> names_in(const program::Json &object)
{
    std::vector<std::string> names;
    for (const auto &item : object.items())
        names.push_back(item.key());
    return names;
}

// The names of all references, in order of appearance.
std::vector<std::string> references_in(const program::Json &recall)
{
    std::vector<std::string> references;
    for (const program::Json &row : recall)
        for (const std::string &name : names_in(row))
            if (name != "all" &&
                std::find(references.begin(), references.end(), name) == references.end())
                references.push_back(name);
    return references;
}

// Convert {query: {reference: number or null}} to a table of these queries and references.
std::vector<double> table_of(const Member &object, const std::vector<std::string> &queries,
                             const std::vector<std::string> &references)
{
    object.require_object("an object of queries");
    for (const Member &row : members_of(object)) {
        row.require_object("an object of references");
        for (const Member &cell : members_of(row))
            if (!cell.json.is_number() && !cell.json.is_null())
                cell.fail("a number");
    }
    std::vector<double> table;
    for (const std::string &query : queries)
        for (const std::string &reference : references) {
            const bool there = object.json.contains(query) &&
                               object.json[query].contains(reference) &&
                               !object.json[query][reference].is_null();
            table.push_back(there ? object.json[query][reference].get<double>() : no_pair);
        }
    return table;
}

Member member_of(const program::Json &json, const char *name, const std::string &where)
{
    if (!json.is_object() || !json.contains(name))
        throw Error(where + ": no member \"" + name +
                    "\", expected an object with \"recall\" and \"distance\" as `vdna eval --json` "
                    "writes it");
    return {json[name], where + ": " + name};
}

} // namespace

std::vector<MethodResult> judge_published(const program::Json &json, const std::string &where)
{
    const Member recall_member = member_of(json, "recall", where);
    const Member distance_member = member_of(json, "distance", where);
    recall_member.require_object("an object of queries");
    distance_member.require_object("an object of methods");
    for (const Member &row : members_of(recall_member))
        row.require_object("an object of references");

    const std::vector<std::string> queries = names_in(recall_member.json);
    const std::vector<std::string> references = references_in(recall_member.json);
    const std::vector<double> recall = table_of(recall_member, queries, references);
    const auto judge = [&](const std::string &name, const std::string &path,
                           const std::vector<double> &distance) {
        std::vector<double> common = recall;
        for (size_t i = 0; i < distance.size(); i++)
            if (std::isnan(distance[i]))
                common[i] = no_pair;
        if (std::all_of(common.begin(), common.end(), [](double r) { return std::isnan(r); }))
            throw Error(path + ": has no query and reference in common with recall");
        const vdna_ranking_table table = {
            common.data(), distance.empty() ? nullptr : distance.data(),
            static_cast<uint32_t>(queries.size()), static_cast<uint32_t>(references.size())};
        return MethodResult{name, distance, judge_ranking(table, path)};
    };
    std::vector<MethodResult> results;
    for (const auto &[name, value] : distance_member.json.items()) {
        const Member method{value, distance_member.path + "." + printable(name)};
        results.push_back(judge(name, method.path, table_of(method, queries, references)));
    }
    const std::string chance = methods.back().key;
    const auto is_random = [&](const MethodResult &result) { return result.name == chance; };
    if (std::any_of(results.begin(), results.end(), is_random))
        throw Error(distance_member.path + ".random: is given, but random is the expectation over "
                                           "all rankings; remove it");
    results.push_back(judge(chance, recall_member.path, {}));
    return results;
}

} // namespace vdna::eval
