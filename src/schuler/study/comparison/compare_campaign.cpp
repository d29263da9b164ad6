#include "schuler/study/comparison/compare_campaign.h"

#include "schuler/core/parallel.h"
#include "schuler/report/outcome.h"
#include "schuler/report/outputs.h"
#include "schuler/report/result_folder.h"
#include "schuler/settings/request.h"
#include "schuler/settings/scenario/comparison.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/fuse.h"
#include "schuler/solution/ignored.h"
#include "schuler/solution/ignored_here.h"
#include "schuler/study/comparison/compare.h"
#include "schuler/study/montecarlo/montecarlo.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <iterator>
#include <set>
#include <span>

namespace schuler::study {
namespace {

constexpr std::size_t kept_of_a_run = 500;  ///< number of NEES values kept of each run

/// Data kept from one run of one scheme.
struct Kept {
    ComparedRun run;
    std::vector<std::array<double, 3>> nees;  ///< position, velocity, attitude, settled
    SquaredCourse course;
    bool report_wanted = false;
    std::vector<solution::Ignored> ignored;  ///< of the first seed: settings without effect on the scheme
    WarningLog warnings;
    std::string failure;
};

/// `asked`: keys of given settings that are checked for an effect.
Kept kept_of(const settings::ScenarioConfig& flight, const settings::SettingList& over, const std::set<std::string>& asked,
             const sim::ExactFlight* flown) {
    Kept out;
    solution::ResultBundle bundle = solution::simulated_bundle(flight, over, out.warnings, nullptr, flown);
    const bool unsmoothed = fuse_compared(bundle, out.warnings, flight.sim.reference_rate);
    bundle.command = "montecarlo";
    if (!asked.empty()) out.ignored = solution::ignored_of(bundle, asked);
    out.run = compared_run(bundle, flight);
    out.run.unsmoothed = unsmoothed;
    out.run.course = {};
    out.run.receiver = {};
    out.course.add(bundle.evaluation.errors, flight.sim.origin, flight.sim.duration);
    out.report_wanted = bundle.data.config.output.wants("report");
    std::vector<std::array<double, 3>> all;
    for (const solution::StateErrors& e : bundle.evaluation.states)
        if (e.time >= bundle.evaluation.settled) all.push_back({e.nees[0], e.nees[1], e.nees[2]});
    const std::size_t stride = (all.size() + kept_of_a_run - 1) / kept_of_a_run;
    for (std::size_t i = 0; i < all.size(); i += stride) out.nees.push_back(all[i]);
    return out;
}

/// One row per run; runs that end early leave NaN.
analysis::EnsembleConsistency nees_of(std::span<const Kept> runs, std::size_t block) {
    std::size_t epochs = 0;
    for (const Kept& k : runs) epochs = std::max(epochs, k.nees.size());
    analysis::RunsByEpochs values =
        analysis::RunsByEpochs::Constant(static_cast<Eigen::Index>(runs.size()), static_cast<Eigen::Index>(epochs), not_given);
    for (std::size_t r = 0; r < runs.size(); ++r)
        for (std::size_t k = 0; k < runs[r].nees.size(); ++k)
            values(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(k)) = runs[r].nees[k][block];
    return analysis::ensemble_consistency(values, 3.0);
}

/// Settings without effect on any scheme, with the reason of the first one that has a filter.
std::vector<solution::Ignored> common_to_schemes(const CompareCampaign& c, std::span<const Kept> all, std::size_t runs) {
    const auto has_filter = [](const SchemeCampaign& s) {
        return std::string_view(s.scheme->name) != "gnss" && s.failures.empty();
    };
    const auto first = std::ranges::find_if(c.schemes, has_filter);
    const auto leading = static_cast<std::size_t>(first == c.schemes.end() ? 0 : first - c.schemes.begin());
    std::vector<solution::Ignored> out = all[leading * runs].ignored;
    for (std::size_t i = 0; i < c.schemes.size(); ++i) {
        const Kept& kept = all[i * runs];
        if (!kept.failure.empty()) continue;  // it shows no effect of anything
        std::erase_if(out, [&](const solution::Ignored& x) {
            return std::ranges::find(kept.ignored, x.key, &solution::Ignored::key) == kept.ignored.end();
        });
    }
    return out;
}

}  // namespace

CompareCampaign compare_campaign(const settings::ProcessRequest& request, std::size_t runs, int jobs) {
    CompareCampaign c = compare_campaign(settings::scenario_settings(request.input, request.seed), request.over({}), runs, jobs,
                                         request.progress);
    c.version = request.version;
    return c;
}

CompareCampaign compare_campaign(const settings::SettingList& base, const settings::SettingList& above, std::size_t runs,
                                 int jobs, const std::function<void(double)>& progress) {
    const auto begin = std::chrono::steady_clock::now();
    const settings::ScenarioConfig scenario = settings::scenario_from(base);
    CompareCampaign c;
    c.name = scenario.name;
    c.windows = scenario.windows;
    c.rules = scenario.window_rules;
    c.outages = scenario.outages;
    c.duration = scenario.sim.duration;
    c.settings = settings::to_toml(base, settings::scenario_table().specs(), false);
    for (std::size_t k = 0; k < runs; ++k) c.seeds.push_back(scenario.sim.seed + k);
    std::vector<std::optional<std::size_t>> counts(scenario.compared_satellites.begin(), scenario.compared_satellites.end());
    if (counts.empty()) counts.emplace_back();
    for (const std::optional<std::size_t> satellites : counts) {
        for (const std::string& name : scenario.compared) {
            SchemeCampaign& s = c.schemes.emplace_back();
            s.scheme = &settings::known_scheme(name);
            s.satellites = satellites;
        }
    }
    std::set<std::string> asked;
    for (const settings::Setting& s : above) asked.insert(s.key);
    std::vector<Kept> all(c.schemes.size() * runs);
    const auto flown = sim::exact_flight(scenario.sim);  // of all schemes and seeds, unless the path varies
    for_each_run(
        all.size(), jobs,
        [&](std::size_t job) {
            const SchemeCampaign& s = c.schemes[job / runs];
            const std::uint64_t seed = c.seeds[job % runs];
            settings::SettingList over = above, drawn;
            over.insert(over.end(), s.scheme->settings.begin(), s.scheme->settings.end());
            try {
                all[job] = kept_of(
                    with_satellites(settings::scenario_from(settings_of_run(base, scenario.vary, seed, job % runs, drawn)),
                                    s.satellites),
                    over, job % runs == 0 ? asked : std::set<std::string>{}, flown.get());
            } catch (const Error& e) {
                if (job == 0) throw;
                all[job].failure = fmt::format("seed {}: {}", seed, e.what());
            }
        },
        progress);
    for (std::size_t i = 0; i < c.schemes.size(); ++i) {
        SchemeCampaign& s = c.schemes[i];
        const std::span<const Kept> own(all.data() + i * runs, runs);
        for (std::size_t run = 0; run < runs; ++run) {
            const Kept& k = own[run];
            s.warnings.add(run, c.seeds[run], k.warnings);
            s.course.add(k.course);
            s.numbers.push_back(k.run.numbers);
            s.windows.push_back(k.run.windows);
            std::array<double, 3>& mean = s.run_nees.emplace_back();
            for (std::size_t block = 0; block < 3; ++block) {
                double sum = 0.0;
                for (const std::array<double, 3>& e : k.nees) sum += e[block];
                mean[block] = k.nees.empty() ? not_given : sum / (3.0 * static_cast<double>(k.nees.size()));
            }
            s.unsmoothed |= k.run.unsmoothed;
            if (!k.failure.empty()) s.failures.push_back(k.failure);
        }
        for (std::size_t block = 0; block < 3; ++block) s.nees[block] = nees_of(own, block);
    }
    c.ignored = common_to_schemes(c, all, runs);
    c.report_wanted = all.front().report_wanted;
    c.wall_s = solution::seconds_since(begin);
    return c;
}

std::vector<std::string> CompareCampaign::warnings() const {
    std::vector<const settings::KnownScheme*> without_smoother;
    for (const SchemeCampaign& s : schemes)
        if (s.unsmoothed) without_smoother.push_back(s.scheme);
    std::vector<std::string> out = warning_of_unsmoothed(without_smoother);
    for (const SchemeCampaign& s : schemes) {
        const std::string label = s.satellites ? fmt::format("{}, {} satellites", s.scheme->name, *s.satellites) : s.scheme->name;
        for (const std::string& line : s.warnings.lines(seeds.size() - s.failures.size()))
            out.push_back(fmt::format("{}: {}", label, line));
    }
    return out;
}

report::Outcome montecarlo_of_schemes(const settings::ProcessRequest& request, std::size_t runs, int jobs) {
    CompareCampaign c = compare_campaign(request, runs, jobs);
    solution::add_unmade_check(c.ignored, request.above);
    report::Outcome out;
    report::ResultFolder files(out,
                               request.output.empty() ? std::filesystem::path("out") / (c.name + "-montecarlo") : request.output);
    out.json = campaign_json(c);
    out.tables = campaign_tables(c);
    files.write("runs.csv", campaign_runs_csv(c));
    if (c.report_wanted) files.write("report.html", report::render(campaign_report(c)));
    files.write("summary.json", out.json);
    files.publish();
    WarningLog without_effect;
    solution::warn_of_ignored_here(c.ignored, request.above, without_effect);
    out.warnings = without_effect.summary();
    std::ranges::copy(c.warnings(), std::back_inserter(out.warnings));
    for (const SchemeCampaign& s : c.schemes)
        for (const std::string& failure : s.failures) out.warnings.push_back(fmt::format("{}, {}", s.scheme->name, failure));
    for (const SchemeCampaign& s : c.schemes) {
        if (s.failures.size() < c.seeds.size()) continue;
        out.usable = false;
        out.verdict = fmt::format("do not use: every run of scheme {} failed", s.scheme->name);
        break;
    }
    return out;
}

}  // namespace schuler::study
