#include "record/map_trust.hpp"

#include <cmath>

#include <vdna/cpp/trust.hpp>

#include "program/print.hpp"
#include "record/experiences.hpp"
#include "record/trust_tables.hpp"

namespace vdna::record
{

namespace
{

// What the file knows, if it was made as it is to be made now.
KnownTables known_tables(const MapTrust &file, const std::vector<uint8_t> &is_known,
                         uint32_t localiser, std::optional<double> tolerance)
{
    KnownTables known;
    if (!file || file->localiser != localiser ||
        tolerance.value_or(file->tolerance) != file->tolerance)
        return known;
    known.tables = file->tables;
    for (size_t i = 0; i < is_known.size(); i++)
        if (is_known[i])
            known.runs.push_back(i);
    return known;
}

std::string runs_text(uint32_t count)
{
    return std::to_string(count) + (count == 1 ? " experience" : " experiences");
}

std::string skill_text(const vdna_trust_fit &fit)
{
    if (fit.labelled < VDNA_TRUST_SKILL_RUNS_MIN)
        return std::to_string(VDNA_TRUST_SKILL_RUNS_MIN) +
               " are needed to tell how well distances predict it";
    const std::string skill = "skill " + program::fixed(fit.skill, 2);
    return fit.skill > 0 ? skill : skill + ": here distances say nothing about it";
}

std::string sentence_of(const Trust &trust)
{
    if (!trust.why_no_predictions().empty())
        return "no predicted recall: " + trust.why_no_predictions();
    const vdna_trust_fit &fit = trust.fit();
    return "predicted recall from " + std::to_string(fit.labelled) + " labelled of " +
           runs_text(static_cast<uint32_t>(trust.runs().size())) + "; " + skill_text(fit);
}

} // namespace

void renew_map_trust(const std::string &map, std::optional<double> tolerance)
{
    require_few_for_tables(experience_files(map).size());
    const Map open(map);
    const std::vector<vdna_experience> &experiences = open.experiences();
    const uint32_t localiser = trust_localiser_of(experiences.front());
    std::vector<uint8_t> is_known;
    const MapTrust before(map, experiences, is_known);
    const KnownTables known = known_tables(before, is_known, localiser, tolerance);

    Members members;
    for (const vdna_experience &experience : experiences)
        members.push_back(&experience);
    vdna_map_trust trust{};
    trust.tolerance =
        tolerance.value_or(known.runs.empty() ? trust_tolerance_default : before->tolerance);
    const TrustTables tables =
        make_trust_tables(members, trust.tolerance, distance_of_codes(members), known);
    trust.tables = tables.view();
    trust.runs = static_cast<uint32_t>(experiences.size());
    trust.localiser = localiser;
    vdna_error error{};
    require(vdna_map_trust_write(map.c_str(), experiences.data(), &trust, &error), error);
}

SelfKnowledge self_knowledge_of(const std::string &map,
                                const std::vector<vdna_experience> &experiences)
{
    SelfKnowledge self{"", {}, 0, std::nan("")};
    const Trust trust(map, experiences);
    self.sentence = sentence_of(trust);
    const MapTrust known(map, experiences.data(), experiences.size());
    if (!known)
        return self;
    self.tolerance = known->tolerance;
    self.labelled = known->runs > 1 ? trust.fit().labelled : 0;
    self.skill = trust.fit().skill;
    return self;
}

} // namespace vdna::record
