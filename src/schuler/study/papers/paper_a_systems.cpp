// Paper A, tables 1.1.1, 1.2.1 and 1.4.2: couplings, receiver, inertial unit.
#include "schuler/analysis/ensemble.h"
#include "schuler/core/units.h"
#include "schuler/filter/states/model.h"
#include "schuler/math/random.h"
#include "schuler/receiver/search.h"
#include "schuler/report/result_table.h"
#include "schuler/sensor/grades.h"
#include "schuler/settings/scenario/comparison.h"
#include "schuler/solution/fuse.h"
#include "schuler/study/comparison/compare.h"
#include "schuler/study/comparison/compare_campaign.h"
#include "schuler/study/papers/item.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::study {
namespace {

// --- table 1.1.1 ---

constexpr std::array schemes{"separate", "loose-15", "tight", "medium", "deep"};

/// Root mean square of a number over the runs of a scheme.
double over_runs(const SchemeCampaign& scheme, std::string_view key) {
    const std::vector<report::TableColumn>& columns = compared_columns();
    const auto i = std::ranges::find(columns, key, &report::TableColumn::key) - columns.begin();
    std::vector<double> values;
    for (const std::vector<double>& numbers : scheme.numbers)
        if (!numbers.empty()) values.push_back(numbers[static_cast<std::size_t>(i)]);
    return paper_rms(values);
}

PaperResult table_111(const PaperWork& w) {
    settings::ValueList list;
    for (const char* name : schemes) list.push_back({std::string(name)});
    const CompareCampaign campaign = compare_campaign(
        paper_settings("presets.toml", w.seed, {{"compare.schemes", {std::move(list)}, {}}}), {}, w.runs, w.jobs, w.progress);
    PaperResult out;
    report::ResultTable table{"one flight through five couplings, from 60 s on",
                              {{"coupling", "coupling"},
                               {"horizontal_m", "horizontal", "m"},
                               {"up_m", "up", "m"},
                               {"velocity_m_s", "velocity", "m/s"},
                               {"heading_deg", "heading", "deg"}}};
    for (const SchemeCampaign& s : campaign.schemes) {
        std::vector<report::Cell>& row = table.rows.emplace_back();
        row.emplace_back(std::string(s.scheme->title));
        for (const char* key : {"horizontal_m", "up_m", "velocity_m_s", "heading_deg"}) row.emplace_back(over_runs(s, key));
    }
    out.tables.push_back(std::move(table));
    out.tables.push_back(nees_table(campaign));
    WarningLog unheard;
    const solution::ResultBundle deep =
        solution::simulated_bundle(paper_scenario("presets.toml", w.seed), settings::known_scheme("deep").settings, unheard);
    const auto ratio = [&](std::size_t one, std::size_t other, std::string_view key) {
        return over_runs(campaign.schemes[one], key) / over_runs(campaign.schemes[other], key);
    };
    out.numbers = {{"loose/separate", ratio(1, 0, "horizontal_m")},
                   {"tight/separate", ratio(2, 0, "horizontal_m")},
                   {"tight/loose velocity", ratio(2, 1, "velocity_m_s")},
                   {"deep/tight velocity", ratio(4, 2, "velocity_m_s")},
                   {"states of deep",
                    static_cast<double>(filter::make_layout(deep.data.config.filter, deep.data.recording).without_slots())}};
    out.notes =
        "With a full sky and without jamming loose and tight see the same satellites: the position, which common slow errors of the ranges rule, is\n"
        "the same, and the order of the table shows in the velocity.\n";
    return out;
}

// --- table 1.2.1 ---

/// Median time to find the fourth of eight satellites, each searched in a separate channel anywhere in the window, s.
double start_time(const receiver::SearchWindow& window, std::uint64_t seed) {
    const receiver::SignalStructure signal = receiver::gps_l1_ca();
    const receiver::CorrelatorModel model(receiver::CorrelationPeak(signal.chip_rate), 0.5);
    std::vector<double> fourth;
    for (std::uint64_t trial = 0; trial < 21; ++trial) {
        math::Random random(seed + trial, "start");
        std::vector<double> found;
        for (int satellite = 0; satellite < 8; ++satellite) {
            receiver::LineOfSight truth{2.2e7, 0.0, 0.0, 0.0};
            receiver::Replica centre = receiver::aligned_replica(signal, truth);
            centre.code_phase += 0.9 * (2.0 * random.uniform() - 1.0) * window.code;
            centre.carrier_frequency += 0.9 * (2.0 * random.uniform() - 1.0) * window.frequency;
            receiver::Search search(signal, model, {}, window, centre);
            while (!search.step(truth, receiver::cn0_from_db(45.0), random) && search.elapsed() < 60.0)
                truth = truth.after(search.dwell());
            found.push_back(search.elapsed());
        }
        std::ranges::sort(found);
        fourth.push_back(found[3]);
    }
    return analysis::quantiles_of(fourth).median;
}

PaperResult table_121(const PaperWork& w) {
    const settings::ScenarioConfig s = settings::scenario_from({{"name", {std::string("duostar1000")}, {}},
                                                                {"trajectory.type", {std::string("paper_a")}, {}},
                                                                {"gnss.receiver", {std::string("duostar1000")}, {}}});
    const sim::GnssSettings& g = s.sim.gnss;
    const receiver::SignalStructure signal = receiver::gps_l1_ca();
    const double cold = start_time(receiver::cold_window(signal, 5000.0, 1e-6), w.seed),
                 hot = start_time(receiver::predicted_window(signal, 3000.0, 60.0), w.seed);
    const double aided = start_time(receiver::predicted_window(signal, 30.0, 0.5), w.seed);
    PaperResult out;
    out.numbers = {{"position", std::hypot(g.white_position.x(), g.errors.correlated_position.x())},
                   {"velocity", std::hypot(g.white_velocity.x(), g.errors.correlated_velocity.x())},
                   {"rate", g.rate},
                   {"hot start", hot},
                   {"cold start", cold}};
    report::ResultTable table{"fourth of eight satellites found, 45 dB-Hz",
                              {{"", "start"}, {"start", ""}, {"time_s", "time", "s"}}};
    table.rows = {{"cold: whole code, 5 kHz and 1 ppm", "cold", cold},
                  {"hot: 3 km, 60 m/s", "hot", hot},
                  {"inertially aided: 30 m, 0.5 m/s", "aided", aided}};
    out.tables.push_back(std::move(table));
    out.notes =
        "Ours: [gnss] receiver = \"duostar1000\", and the search of the receiver in the loop; what its channels can take of dynamics is docs/receiver.md.\n"
        "30 ns of time are 9 m of range; a fix that is stamped so is late by 9 um at 300 m/s, and is taken as exact.\n"
        "A cold start also waits up to 30 s for ephemerides, which the table's 30 s must contain.\n";
    return out;
}

// --- tables 1.4.2 and 1.4.3 ---

PaperResult table_142(const PaperWork&) {
    const sensor::ImuErrorModel m = sensor::imu_grade("hg9900");
    PaperResult out;
    const double drift = std::hypot(m.gyro_bias, m.gyro_turn_on_bias) / units::deg_per_hour,
                 bias = std::hypot(m.accel_bias, m.accel_turn_on_bias) / units::ug;
    // clang-format off
    out.numbers = {{"gyro drift", drift}, {"gyro walk", m.gyro_noise / units::deg_per_sqrt_hour}, {"gyro scale", m.gyro_scale / units::ppm},
                   {"accel bias", bias}, {"accel scale", m.accel_scale / units::ppm}};
    // clang-format on
    out.notes = fmt::format(
        "Ours: the unit \"hg9900\" of [imu] grade. The random walk of the accelerometers is given in the unit of gyros (0.002 deg/sqrt(h)): a misprint;\n"
        "ours is {:.3g} m/s/sqrt(h).\n",
        m.accel_noise / units::m_s_per_sqrt_hour);
    return out;
}

}  // namespace

std::vector<PaperItem> paper_a_systems() {
    return {{"A", "table-1.1.1", "five couplings on one flight", 4, 1.5, table_111},
            {"A", "table-1.2.1", "the receiver DuoStar-1000", 0, 0.1, table_121},
            {"A", "table-1.4.2", "the inertial unit HG9900", 0, 0.1, table_142}};
}

}  // namespace schuler::study
