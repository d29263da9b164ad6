#include "schuler/study/montecarlo/montecarlo.h"

#include "schuler/core/parallel.h"
#include "schuler/math/random.h"
#include "schuler/report/outputs.h"
#include "schuler/report/result_folder.h"
#include "schuler/settings/config/config.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/fuse.h"
#include "schuler/solution/ignored.h"
#include "schuler/solution/ignored_here.h"
#include "schuler/study/comparison/compare_campaign.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <mutex>
#include <set>

namespace schuler::study {
namespace {

namespace fs = std::filesystem;
using settings::Variation;

constexpr std::size_t default_runs = 100;
constexpr std::size_t kept_epochs = 1000;  ///< of each run

/// Every n-th element, so that at most kept_epochs are left.
template <class Row>
std::vector<Row> sparse(const std::vector<Row>& rows) {
    const std::size_t stride = (rows.size() + kept_epochs - 1) / kept_epochs;
    std::vector<Row> out;
    for (std::size_t i = 0; i < rows.size(); i += stride) out.push_back(rows[i]);
    return out;
}

/// The first row in each step.
std::vector<solution::StateErrors> one_a_step(const std::vector<solution::StateErrors>& rows, Time origin, double step) {
    std::vector<solution::StateErrors> out;
    double last = -1e300;
    for (const solution::StateErrors& row : rows) {
        const double index = std::floor(((row.time - origin).seconds() + 1e-6) / step);
        if (index != last) out.push_back(row);
        last = index;
    }
    return out;
}

/// Epoch interval of epochs.csv: the longest flight has a thousand epochs.
double epoch_step(const settings::ScenarioConfig& scenario) {
    double longest = scenario.sim.duration;
    for (const Variation& v : scenario.vary) {
        if (v.key != "duration_s") continue;
        longest = std::max({longest, v.second, v.first + (v.kind == Variation::Kind::Normal ? 6.0 * v.second : 0.0)});
        for (const settings::Value& value : v.values) longest = std::max(longest, value.number());
    }
    return std::max(1.0, std::ceil(longest / static_cast<double>(kept_epochs)));
}

void fill(MonteCarloRun& run, const settings::ScenarioConfig& scenario, const settings::SettingList& over, double step,
          const sim::ExactFlight* flown) {
    solution::ResultBundle bundle = solution::simulated_bundle(scenario, over, run.warnings, nullptr, flown);
    solution::fuse_and_evaluate(bundle, run.warnings, scenario.sim.reference_rate, {});
    const settings::Config& c = bundle.data.config;
    run.scheme = settings::scheme_name(c.scheme);
    run.mechanization = c.filter.mechanization == fusion::Mechanization::Geographic ? "geographic" : "ecef";
    run.loop = settings::loop_name(c.filter.loop);
    run.smoothed = c.filter.smooth;
    run.origin = bundle.data.origin;
    solution::Evaluation& e = bundle.evaluation;
    run.settled_s = bundle.relative(e.settled);
    run.summary = e.summary;
    std::vector<analysis::ErrorRow> settled;
    std::ranges::copy_if(e.errors, std::back_inserter(settled), [&](const auto& row) { return row.time >= e.settled; });
    run.errors = sparse(settled);
    run.states = one_a_step(e.states, run.origin, step);
    run.measurements = std::move(e.measurements);
    run.outages = std::move(e.outages);
}

/// Settings without effect on the scenario: run once more, so that the result does not depend on the runs made here.
std::vector<solution::Ignored> without_effect(const settings::ScenarioConfig& scenario, const settings::SettingList& over,
                                              const sim::ExactFlight* flown) {
    const std::set<std::string> asked = settings::keys_of_processing(scenario, over);
    if (asked.empty()) return {};
    WarningLog unheard;
    try {
        solution::ResultBundle bundle = solution::simulated_bundle(scenario, over, unheard, nullptr, flown);
        solution::fuse_and_evaluate(bundle, unheard, scenario.sim.reference_rate, {});
        bundle.command = "montecarlo";
        return solution::ignored_of(bundle, asked);
    } catch (const Error&) {  // one of the failed runs
        return {};
    }
}

std::uint64_t grid_point(const std::vector<Variation>& vary, std::uint64_t run) { return run % settings::grid_points(vary); }

/// Index in its list of the value of a sweep at a grid point; the last key of the file varies fastest.
std::size_t place_in_sweep(const std::vector<Variation>& vary, const Variation& sweep, std::uint64_t point) {
    for (auto it = vary.rbegin(); it != vary.rend(); ++it) {
        if (it->kind != Variation::Kind::Sweep) continue;
        if (&*it == &sweep) return point % it->values.size();
        point /= it->values.size();
    }
    return 0;
}

/// Identifies campaigns that differ only in the number of runs.
std::string identity_of(const settings::SettingList& base, const settings::SettingList& over, const std::string& version) {
    std::string out = version + "\n";
    for (const settings::SettingList* list : {&base, &over}) {
        for (const settings::Setting& s : *list)
            if (s.key != "montecarlo.runs") out += s.key + " = " + settings::to_toml(s.value) + "\n";
        out += "--\n";
    }
    return out;
}

/// Runs still to be made, handed out in order, in spans that become smaller towards the end; thread-safe.
class WorkList {
public:
    WorkList(RunSet done, std::uint64_t first, std::uint64_t end, std::size_t workers)
        : done_(std::move(done)), next_(first), end_(end), workers_(workers) {}
    /// Stops handing out runs.
    void stop() {
        const std::lock_guard<std::mutex> lock(mutex_);
        next_ = end_;
    }
    WorkSpan next() {
        const std::lock_guard<std::mutex> lock(mutex_);
        next_ = done_.first_missing(next_);
        if (next_ >= end_) return {};
        const std::uint64_t share = std::clamp<std::uint64_t>((end_ - next_) / (8 * workers_), 1, 64);
        const std::uint64_t stop = std::min({next_ + share, end_, done_.next_present(next_, end_)});
        const WorkSpan out{next_, stop - next_};
        next_ = stop;
        return out;
    }

private:
    std::mutex mutex_;
    RunSet done_;
    std::uint64_t next_, end_;
    std::size_t workers_;
};

/// Interval of checkpoints: frequent enough to lose little, rare enough to cost little.
class SaveClock {
public:
    [[nodiscard]] bool due() const {
        const double since = solution::seconds_since(last_);
        return since > std::max(std::clamp(0.1 * solution::seconds_since(begin_), 0.5, 5.0), 30.0 * cost_);
    }
    void save(CampaignPart& part) {
        const auto begin = std::chrono::steady_clock::now();
        part.save();
        last_ = std::chrono::steady_clock::now();
        cost_ = std::chrono::duration<double>(last_ - begin).count();
    }

private:
    const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
    std::chrono::steady_clock::time_point last_ = begin_;
    double cost_ = 0.0;
};

/// True unless a key of the path varies. A run compares its path anyway: this only spares flights that no run would use.
bool same_path(const std::vector<Variation>& vary) {
    return std::ranges::none_of(vary, [](const Variation& v) {
        return v.key.starts_with("trajectory.") || v.key.starts_with("earth.") || v.key == "duration_s" ||
               v.key == "reference_rate_hz" || v.key == "imu.rate_hz";
    });
}

struct Flights {
    const CampaignRequest& request;
    const settings::ScenarioConfig& scenario;
    const settings::SettingList &base, &over;
    double step;
    std::shared_ptr<const sim::ExactFlight> flown;  ///< of the scenario, or null; runs that fly another path make their own

    [[nodiscard]] MonteCarloRun fly(std::uint64_t k) const {
        MonteCarloRun run;
        run.run = k;
        run.seed = scenario.sim.seed + k;
        run.point = grid_point(scenario.vary, k);
        try {
            const settings::SettingList settings = settings_of_run(base, scenario.vary, run.seed, k, run.drawn);
            fill(run, settings::scenario_from(settings), over, step, flown.get());
        } catch (const Error& e) {
            if (k == request.first && e.kind() == ErrorKind::Input) throw;
            run.failure = e.what();
        }
        for (std::size_t i = 0; i < run.drawn.size(); ++i) {
            const settings::Value& value = run.drawn[i].value;
            const auto& list = scenario.vary[i].values;
            const auto same = [&](const settings::Value& v) { return settings::to_toml(v) == settings::to_toml(value); };
            run.numbers.push_back(value.is_number() ? value.number()
                                                    : static_cast<double>(std::ranges::find_if(list, same) - list.begin()));
        }
        return run;
    }
};

void work(const Flights& flights, CampaignPart& part, WorkList* list, Team* team, std::uint64_t goal) {
    std::mutex mutex, asking;
    SaveClock clock;
    std::size_t here = part.done().count();
    const auto next = [&]() -> WorkSpan {
        if (list != nullptr) return list->next();
        const std::lock_guard<std::mutex> lock(asking);
        return team->ask();
    };
    const auto runs = [&] {
        for (WorkSpan span = next(); span.count > 0; span = next()) {
            for (std::uint64_t k = span.first; k < span.first + span.count; ++k) {
                const MonteCarloRun run = flights.fly(k);
                const std::lock_guard<std::mutex> lock(mutex);
                part.add(run, numbers_of(run, flights.scenario.vary.size()));
                ++here;
                if (flights.request.common.progress)
                    flights.request.common.progress(static_cast<double>(here) / static_cast<double>(goal));
                if (clock.due()) clock.save(part);
            }
        }
    };
    const auto worker = [&] {
        try {
            runs();
        } catch (...) {
            if (list != nullptr) list->stop();
            throw;
        }
    };
    const bool serves = list != nullptr && team != nullptr;
    const auto threads = static_cast<std::size_t>(flights.request.jobs > 0 ? flights.request.jobs
                                                  : team != nullptr        ? 1
                                                                           : hardware_jobs());
    try {
        for_each_run(std::min<std::size_t>(threads, goal) + (serves ? 1 : 0), static_cast<int>(threads) + (serves ? 1 : 0),
                     [&](std::size_t i) {
                         if (serves && i == 0) {
                             team->serve([&] { return list->next(); });
                         } else {
                             worker();
                         }
                     },
                     {});
    } catch (...) {
        try {
            part.save();          // finished runs are kept
        } catch (const Error&) {  // NOLINT: the first error is the one to report
        }
        throw;
    }
    part.save();
}

}  // namespace

settings::SettingList settings_of_run(const settings::SettingList& base, const std::vector<Variation>& vary, std::uint64_t seed,
                                      std::uint64_t run, settings::SettingList& drawn) {
    settings::SettingList out = base;
    const std::uint64_t point = grid_point(vary, run);
    for (const Variation& v : vary) {
        math::Random random(seed, "vary." + v.key);
        settings::Value value;
        if (v.kind == Variation::Kind::Sweep) {
            value = v.values[place_in_sweep(vary, v, point)];
        } else if (v.kind == Variation::Kind::List) {
            value = v.values[std::min(v.values.size() - 1,
                                      static_cast<std::size_t>(random.uniform() * static_cast<double>(v.values.size())))];
        } else {
            const double x = v.kind == Variation::Kind::Normal ? v.first + v.second * random.normal()
                                                               : v.first + (v.second - v.first) * random.uniform();
            value = v.whole ? settings::Value{static_cast<std::int64_t>(std::llround(x))} : settings::Value{x};
        }
        drawn.push_back({v.key, value, {"montecarlo.vary", 0, 0, v.key}});
    }
    out.insert(out.end(), drawn.begin(), drawn.end());
    out.push_back({"seed", {static_cast<std::int64_t>(seed)}, {}});
    return out;
}

MonteCarlo montecarlo(const CampaignRequest& request) {
    const auto begin = std::chrono::steady_clock::now();
    const settings::SettingList base = settings::scenario_settings(request.common.input, request.common.seed);
    const settings::ScenarioConfig scenario = settings::scenario_from(base);  // invalid settings fail here, before any run
    const settings::SettingList over = request.common.over({});
    const std::size_t points = settings::grid_points(scenario.vary);
    MonteCarlo mc;
    mc.name = scenario.name;
    mc.version = request.common.version;
    mc.published = scenario.published;
    mc.vary = scenario.vary;
    mc.seed = scenario.sim.seed;
    mc.first = request.first;
    mc.runs = request.runs.value_or(
        static_cast<std::size_t>(scenario.montecarlo_runs.value_or(static_cast<int>(points > 1 ? points : default_runs))));
    mc.folder = request.common.output.empty() ? fs::path("out") / (mc.name + "-montecarlo") : request.common.output;
    const int rank = request.team ? request.team->rank() : 0;
    const std::uint64_t end = mc.first + mc.runs;

    CampaignStatistics empty;
    empty.epoch_step = epoch_step(scenario);
    empty.swept = points > 1;
    report::make_folder(mc.folder);
    mc.part = std::make_unique<CampaignPart>(mc.folder, rank, identity_of(base, over, mc.version),
                                             numbers_of({}, scenario.vary.size()).size(), empty);
    CampaignPart& part = *mc.part;
    if (rank == 0) {
        if (request.resume) {
            part.take_over();
        } else if (!CampaignPart::left_in(mc.folder).empty()) {
            throw input_error("holds a campaign that was interrupted", {.file = mc.folder.string()},
                              "add --resume to go on with it, or choose another folder with -o, or delete its checkpoint-*.bin");
        }
        const auto& spans = part.done().spans();
        if (!spans.empty() && (spans.begin()->first < mc.first || spans.rbegin()->second > end))
            throw input_error(fmt::format("the interrupted campaign has done runs {} to {} already", spans.begin()->first,
                                          spans.rbegin()->second - 1),
                              {.file = {}, .key = "-n"}, "give at least as many runs as before");
    }
    if (request.team) request.team->wait();  // no process writes before process 0 has adopted the previous files
    part.begin();
    const std::uint64_t before = part.done().count();
    const Flights flights{
        request, scenario,         base,
        over,    empty.epoch_step, same_path(scenario.vary) && mc.runs > 1 ? sim::exact_flight(scenario.sim) : nullptr};
    std::optional<WorkList> list;
    if (rank == 0) list.emplace(part.done(), mc.first, end, request.team ? static_cast<std::size_t>(request.team->size()) : 1000);
    try {
        work(flights, part, list ? &*list : nullptr, request.team.get(), mc.runs);
    } catch (const Error& e) {
        // Nothing to continue with: no run was done, or settings that no run can have were found in the first.
        const bool disk = e.place().file.starts_with(mc.folder.string());
        const bool settings = e.kind() == ErrorKind::Input && !disk && before == 0 && !part.done().contains(mc.first);
        if (part.done().count() == 0 || settings) {
            if (!request.team) CampaignPart::remove_from(mc.folder);
            throw;
        }
        throw Error(
            e.kind(), e.reason(), e.place(),
            fmt::format(
                "{}{}the runs of the last checkpoint are kept (of {} done, {} requested): the same command with --resume goes on",
                e.hint(), e.hint().empty() ? "" : "; ", part.done().count(), mc.runs));
    }
    if (request.team) {
        const std::string all = request.team->combined(part.packed(), [&](std::string a, std::string b) {
            CampaignPart sum(mc.folder, rank, {}, 0, empty);
            sum.merge(a);
            sum.merge(b);
            return sum.packed();
        });
        if (rank != 0) return mc;
        mc.part = std::make_unique<CampaignPart>(mc.folder, rank, identity_of(base, over, mc.version),
                                                 numbers_of({}, scenario.vary.size()).size(), empty);
        mc.part->merge(all);
    }
    mc.run_here = mc.part->done().count() - before;
    const CampaignStatistics& s = mc.statistics();
    if (s.failed == s.runs) {
        const Failure& first = s.failures.begin()->second;
        CampaignPart::remove_from(mc.folder);
        throw computation_error(fmt::format("no run went through; the first one: {}", first.reason),
                                fmt::format("try `schuler run` with --seed {}", first.seed));
    }
    mc.ignored = without_effect(scenario, over, flights.flown.get());
    solution::add_unmade_check(mc.ignored, request.common.above);
    mc.wall_s = solution::seconds_since(begin);
    return mc;
}

std::vector<std::string> warnings_of_runs(const MonteCarlo& mc) {
    return mc.statistics().warnings.lines(mc.runs - mc.statistics().failed);
}

report::Outcome run_montecarlo(const CampaignRequest& request) {
    const settings::ScenarioConfig scenario = settings::read_scenario(request.common.input, request.common.seed);
    if (!scenario.compared.empty() && !request.common.names_a_scheme()) {
        if (request.resume || request.team || request.first > 0)
            throw input_error("a comparison of schemes cannot be resumed, split or shared among processes",
                              {.file = {},
                               .key = request.resume      ? "--resume"
                                      : request.first > 0 ? "--first"
                                                          : "compare.schemes"},
                              "choose one scheme with --scheme");
        return montecarlo_of_schemes(
            request.common, request.runs.value_or(static_cast<std::size_t>(scenario.montecarlo_runs.value_or(default_runs))),
            request.jobs);
    }
    const MonteCarlo mc = montecarlo(request);
    report::Outcome out;
    if (request.team && request.team->rank() != 0) {
        request.team->wait();
        return out;
    }
    report::ResultFolder files(out, mc.folder);
    out.json = summary_json(mc);
    out.tables = summary_tables(mc);
    files.write("epochs.csv", epochs_csv(mc));
    if (mc.statistics().swept) files.write("sweep.csv", sweep_csv(mc));
    write_runs_csv(mc, files.add("runs.csv"));
    files.write("summary.json", out.json);
    files.publish();
    CampaignPart::remove_from(mc.folder);
    if (request.team) request.team->wait();
    WarningLog ignored;
    solution::warn_of_ignored_here(mc.ignored, request.common.above, ignored);
    out.warnings = ignored.summary();
    std::ranges::copy(warnings_of_runs(mc), std::back_inserter(out.warnings));
    constexpr std::size_t told = 20;
    const std::size_t most = out.warnings.size() + told;
    const auto& failures = mc.statistics().failures;
    for (const auto& [run, failure] : failures) {
        if (out.warnings.size() == most) break;
        out.warnings.push_back(fmt::format("seed {} (run {}): {}", failure.seed, run, failure.reason));
    }
    if (mc.statistics().failed > told)
        out.warnings.push_back(fmt::format("{} more runs failed; summary.json lists them", mc.statistics().failed - told));
    const CampaignStatistics& s = mc.statistics();
    if (std::ranges::all_of(s.fields, [](const FieldStatistics& f) { return f.epochs == 0; }))
        out.warnings.push_back(fmt::format(
            "no statistics of errors: they count from {:.0f} s on, when the filter has settled, and no run lasts that long; give a "
            "longer duration_s",
            s.head.settled_s));
    const std::size_t points = settings::grid_points(mc.vary);
    if (points > 1 && mc.runs % points != 0)
        out.warnings.push_back(fmt::format("{} runs over a grid of {} points: not every point has as many", mc.runs, points));
    return out;
}

}  // namespace schuler::study
