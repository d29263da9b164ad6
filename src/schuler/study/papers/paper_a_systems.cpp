// Paper A, tables 1.1.1, 1.2.1 and 1.4.2: couplings, receiver, inertial unit.
#include "schuler/analysis/ensemble.h"
#include "schuler/core/parallel.h"
#include "schuler/core/units.h"
#include "schuler/filter/states/model.h"
#include "schuler/math/random.h"
#include "schuler/receiver/search.h"
#include "schuler/report/result_table.h"
#include "schuler/sensor/grades.h"
#include "schuler/settings/scenario/comparison.h"
#include "schuler/solution/fuse.h"
#include "schuler/study/papers/item.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::study {
namespace {

// --- table 1.1.1 ---

struct Coupling {
    const char* scheme;
    const char* name;
};
constexpr std::array<Coupling, 5> couplings{
    {{"separate", "separate"}, {"loose-15", "loose"}, {"tight", "tight"}, {"medium", "intermediate"}, {"deep", "deep"}}};

struct Scored {
    double horizontal = 0, up = 0, velocity = 0, heading = 0;  ///< mean squares
    std::array<double, 3> nees{};
    double states = 0;
};

Scored scored(const char* scheme, std::uint64_t seed) {
    WarningLog unheard;
    const settings::ScenarioConfig scenario = paper_scenario("presets.toml", seed);
    solution::ResultBundle b = solution::simulated_bundle(scenario, settings::known_scheme(scheme).settings, unheard);
    solution::fuse_and_evaluate(b, unheard, scenario.sim.reference_rate, {});
    Scored s;
    double n = 0.0;
    for (const analysis::ErrorRow& e : b.evaluation.errors) {
        if (e.time < b.evaluation.settled) continue;
        s.horizontal += e.position.head<2>().squaredNorm();
        s.up += e.position.z() * e.position.z();
        s.velocity += e.velocity.squaredNorm();
        s.heading += e.rpy.z() * e.rpy.z();
        n += 1.0;
    }
    for (double* x : {&s.horizontal, &s.up, &s.velocity, &s.heading}) *x /= n;
    if (b.evaluation.consistency)
        s.nees = {b.evaluation.consistency->position.mean, b.evaluation.consistency->velocity.mean,
                  b.evaluation.consistency->attitude.mean};
    return s;
}

PaperResult table_111(const PaperWork& w) {
    std::array<Scored, couplings.size()> sum{};
    std::vector<Scored> all(couplings.size() * w.runs);
    for_each_run(
        all.size(), w.jobs,
        [&](std::size_t job) { all[job] = scored(couplings[job % couplings.size()].scheme, w.seed + job / couplings.size()); },
        w.progress);
    const auto runs = static_cast<double>(w.runs);
    PaperResult out;
    // clang-format off
    report::ResultTable table{"one flight through five couplings, from 60 s on", {{"coupling", "coupling"}, {"horizontal_m", "horizontal", "m"}, {"up_m", "up", "m"},
                              {"velocity_m_s", "velocity", "m/s"}, {"heading_deg", "heading", "deg"}, {"nees_position", "NEES of position"},
                              {"nees_velocity", "of velocity"}, {"nees_attitude", "of attitude"}}};
    // clang-format on
    for (std::size_t k = 0; k < couplings.size(); ++k) {
        Scored& s = sum[k];
        for (std::size_t run = 0; run < w.runs; ++run) {
            const Scored& one = all[run * couplings.size() + k];
            s.horizontal += one.horizontal / runs;
            s.up += one.up / runs;
            s.velocity += one.velocity / runs;
            s.heading += one.heading / runs;
            for (std::size_t i = 0; i < 3; ++i) s.nees[i] += one.nees[i] / runs;
        }
        for (double* x : {&s.horizontal, &s.up, &s.velocity, &s.heading}) *x = std::sqrt(*x);
        table.rows.push_back(
            {couplings[k].name, s.horizontal, s.up, s.velocity, s.heading / units::deg, s.nees[0], s.nees[1], s.nees[2]});
    }
    out.tables.push_back(std::move(table));
    WarningLog unheard;
    const solution::ResultBundle deep =
        solution::simulated_bundle(paper_scenario("presets.toml", w.seed), settings::known_scheme("deep").settings, unheard);
    out.numbers = {{"loose/separate", sum[1].horizontal / sum[0].horizontal},
                   {"tight/separate", sum[2].horizontal / sum[0].horizontal},
                   {"tight/loose velocity", sum[2].velocity / sum[1].velocity},
                   {"deep/tight velocity", sum[4].velocity / sum[2].velocity},
                   {"states of deep",
                    static_cast<double>(filter::make_layout(deep.data.config.filter, deep.data.recording).without_slots())}};
    out.notes =
        "With a full sky and without jamming loose and tight see the same satellites: the position, which common slow errors of the ranges rule, is\n"
        "the same, and the order of the table shows in the velocity. NEES: 3 expected; the campaign `schuler montecarlo examples/presets.toml` has bounds.\n";
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
