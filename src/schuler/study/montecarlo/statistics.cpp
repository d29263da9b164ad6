#include "schuler/study/montecarlo/statistics.h"

#include "schuler/core/units.h"

#include <algorithm>
#include <cmath>

namespace schuler::study {
namespace {

using analysis::ErrorRow;
using analysis::ErrorSummary;

constexpr std::size_t horizontal_field = 3;

BlockAtEpoch& block_at(Epoch& epoch, std::size_t b) {
    if (epoch.block[b].empty()) epoch.block[b].resize(1);
    return epoch.block[b].front();
}

void merge_values(ValueStatistics& into, const ValueStatistics& other) {
    into.square.add(other.square);
    into.sketch.merge(other.sketch);
}

void merge_epoch(Epoch& into, const Epoch& other) {
    into.time_s = std::min(into.time_s, other.time_s);
    for (std::size_t b = 0; b < into.block.size(); ++b) {
        if (other.block[b].empty()) continue;
        BlockAtEpoch& to = block_at(into, b);
        const BlockAtEpoch& from = other.block[b].front();
        for (std::size_t axis = 0; axis < 3; ++axis) merge_values(to.error[axis], from.error[axis]);
        to.nees.add(from.nees);
        to.settled_nees.add(from.settled_nees);
        to.count += from.count;
        to.settled += from.settled;
    }
}

void merge_point(PointStatistics& into, const PointStatistics& other) {
    into.runs += other.runs;
    into.failed += other.failed;
    into.epochs += other.epochs;
    into.nees_runs += other.nees_runs;
    for (std::size_t i = 0; i < into.square.size(); ++i) into.square[i].add(other.square[i]);
    into.nees.add(other.nees);
    into.end_square.add(other.end_square);
    into.ends += other.ends;
}

void keep_lowest(std::map<std::uint64_t, Failure>& failures) {
    while (failures.size() > kept_failures) failures.erase(std::prev(failures.end()));
}

void add_states(CampaignStatistics& s, const MonteCarloRun& run) {
    const auto& names = solution::state_block_names();
    for (const solution::StateErrors& e : run.states) {
        const double t = (e.time - run.origin).seconds();
        const bool settled = t >= run.settled_s - 1e-9;
        Epoch* epoch = nullptr;
        for (std::size_t b = 0; b < solution::state_blocks; ++b) {
            if (!std::isfinite(e.nees[b])) continue;
            if (epoch == nullptr) {
                epoch = &s.epochs[static_cast<std::int64_t>(std::floor((t + 1e-6) / s.epoch_step))];
                epoch->time_s = std::min(epoch->time_s, t);
            }
            BlockAtEpoch& block = block_at(*epoch, b);
            for (std::size_t axis = 0; axis < static_cast<std::size_t>(names[b].dof); ++axis) {
                const double x = e.error[b][static_cast<Eigen::Index>(axis)] / names[b].si;
                block.error[axis].add(x);
                if (settled) s.components[b][axis].add(x);
            }
            block.nees.add(e.nees[b]);
            ++block.count;
            if (!settled) continue;
            block.settled_nees.add(e.nees[b]);
            ++block.settled;
            ++s.nees[b].epochs;
        }
    }
    const auto means = mean_nees(run);
    for (std::size_t b = 0; b < solution::state_blocks; ++b) {
        if (!std::isfinite(means[b])) continue;
        s.nees[b].sum.add(means[b]);
        s.nees[b].square.add(means[b] * means[b]);
        ++s.nees[b].runs;
    }
}

void add_measurements(CampaignStatistics& s, const MonteCarloRun& run) {
    for (const solution::MeasurementConsistency& a : run.measurements) {
        MeasurementStatistics& to = s.measurements[std::string(a.name)];
        to.rejected += a.nis.rejected;
        if (a.nis.accepted == 0) continue;
        const auto n = static_cast<double>(a.nis.accepted);
        to.accepted += a.nis.accepted;
        to.nis.add(n * a.nis.mean);
        to.dof.add(n * a.nis.dof);
        if (std::isfinite(a.nis.lag1)) to.lag1.add(n * a.nis.lag1);
    }
}

void add_outages(CampaignStatistics& s, const MonteCarloRun& run) {
    if (s.outages.size() < run.outages.size()) s.outages.resize(run.outages.size());
    for (std::size_t k = 0; k < run.outages.size(); ++k) {
        const analysis::OutageStatistics& o = run.outages[k];
        OutageOfRuns& to = s.outages[k];
        const double start = (o.span.start - run.origin).seconds();
        to.start_s = to.runs == 0 ? start : std::min(to.start_s, start);
        to.duration_s = std::max(to.duration_s, o.span.duration.seconds());
        const std::array size{o.end_horizontal, o.max_horizontal, o.end_vertical, o.max_3d, o.growth_horizontal};
        for (std::size_t i = 0; i < size.size(); ++i) to.size[i].add(size[i]);
        ++to.runs;
        to.inside += o.inside_3sigma ? 1 : 0;
    }
}

void add_point(PointStatistics& p, const MonteCarloRun& run) {
    ++p.runs;
    if (run.failed()) {
        ++p.failed;
        return;
    }
    p.epochs += run.summary.epochs;
    const auto n = static_cast<double>(run.summary.epochs);
    for (std::size_t i = 0; i < error_field_count; ++i) {
        const double rms = (run.summary.*error_fields()[i].of_run).rms / error_fields()[i].si;
        if (std::isfinite(rms)) p.square[i].add(n * rms * rms);
    }
    if (const double nees = mean_nees(run)[0]; std::isfinite(nees)) {
        p.nees.add(nees);
        ++p.nees_runs;
    }
    if (!run.outages.empty() && std::isfinite(run.outages.front().end_horizontal)) {
        p.end_square.add(run.outages.front().end_horizontal * run.outages.front().end_horizontal);
        ++p.ends;
    }
}

}  // namespace

const std::array<ErrorField, error_field_count>& error_fields() {
    using S = ErrorSummary;
    using R = const ErrorRow&;
    static const std::array<ErrorField, error_field_count> fields{{
        {"position_m", "east", "position east, m", &S::east, [](R r) { return r.position.x(); }, 1.0},
        {"position_m", "north", "position north, m", &S::north, [](R r) { return r.position.y(); }, 1.0},
        {"position_m", "up", "position up, m", &S::up, [](R r) { return r.position.z(); }, 1.0},
        {"position_m", "horizontal", "position horizontal, m", &S::horizontal, [](R r) { return r.position.head<2>().norm(); },
         1.0},
        {"position_m", "three_d", "position 3-d, m", &S::three_d, [](R r) { return r.position.norm(); }, 1.0},
        {"velocity_m_s", "east", "velocity east, m/s", &S::v_east, [](R r) { return r.velocity.x(); }, 1.0},
        {"velocity_m_s", "north", "velocity north, m/s", &S::v_north, [](R r) { return r.velocity.y(); }, 1.0},
        {"velocity_m_s", "up", "velocity up, m/s", &S::v_up, [](R r) { return r.velocity.z(); }, 1.0},
        {"attitude_deg", "roll", "roll, deg", &S::roll, [](R r) { return r.rpy.x(); }, units::deg},
        {"attitude_deg", "pitch", "pitch, deg", &S::pitch, [](R r) { return r.rpy.y(); }, units::deg},
        {"attitude_deg", "heading", "heading, deg", &S::heading, [](R r) { return r.rpy.z(); }, units::deg},
    }};
    static_assert(horizontal_field < error_field_count);
    return fields;
}

void ValueStatistics::add(double x) {
    if (!std::isfinite(x)) return;
    square.add(x * x);
    sketch.add(x);
}

analysis::Quantiles ValueStatistics::quantiles() const {
    analysis::Quantiles out;
    if (sketch.count() == 0) return out;
    out.rms = std::sqrt(square.value() / static_cast<double>(sketch.count()));
    out.q05 = sketch.quantile(0.05);
    out.median = sketch.quantile(0.5);
    out.q95 = sketch.quantile(0.95);
    return out;
}

std::array<double, solution::state_blocks> mean_nees(const MonteCarloRun& run) {
    std::array<double, solution::state_blocks> sum{}, count{};
    for (const solution::StateErrors& e : run.states) {
        if ((e.time - run.origin).seconds() < run.settled_s - 1e-9) continue;
        for (std::size_t b = 0; b < sum.size(); ++b) {
            if (!std::isfinite(e.nees[b])) continue;
            sum[b] += e.nees[b];
            count[b] += 1.0;
        }
    }
    for (std::size_t b = 0; b < sum.size(); ++b) sum[b] /= count[b];  // NaN if there is none
    return sum;
}

void CampaignStatistics::add(const MonteCarloRun& run) {
    ++runs;
    if (swept) add_point(points[run.point], run);
    if (run.failed()) {
        ++failed;
        failures[run.run] = {run.seed, run.failure};
        keep_lowest(failures);
        return;
    }
    if (run.run < first_run) {
        first_run = run.run;
        head = {run.scheme, run.mechanization, run.loop, run.smoothed, run.settled_s};
    }
    for (std::size_t i = 0; i < error_field_count; ++i) {
        const ErrorField& f = error_fields()[i];
        const analysis::Spread& spread = run.summary.*f.of_run;
        if (!std::isfinite(spread.rms)) continue;
        FieldStatistics& to = fields[i];
        const double rms = spread.rms / f.si;
        to.square.add(static_cast<double>(run.summary.epochs) * rms * rms);
        to.epochs += run.summary.epochs;
        to.largest = std::max(to.largest, spread.max / f.si);
        to.runs.add(rms);
        for (const ErrorRow& row : run.errors) to.size.add(std::abs(f.of_row(row) / f.si));
    }
    add_states(*this, run);
    add_measurements(*this, run);
    add_outages(*this, run);
    warnings.add(run.run, run.seed, run.warnings);
}

void CampaignStatistics::merge(const CampaignStatistics& other) {
    runs += other.runs;
    failed += other.failed;
    if (other.first_run < first_run) {
        first_run = other.first_run;
        head = other.head;
    }
    for (std::size_t i = 0; i < error_field_count; ++i) {
        FieldStatistics& to = fields[i];
        const FieldStatistics& from = other.fields[i];
        to.square.add(from.square);
        to.epochs += from.epochs;
        to.largest = std::max(to.largest, from.largest);
        merge_values(to.runs, from.runs);
        to.size.merge(from.size);
    }
    for (std::size_t b = 0; b < solution::state_blocks; ++b) {
        for (std::size_t axis = 0; axis < 3; ++axis) merge_values(components[b][axis], other.components[b][axis]);
        nees[b].sum.add(other.nees[b].sum);
        nees[b].square.add(other.nees[b].square);
        nees[b].runs += other.nees[b].runs;
        nees[b].epochs += other.nees[b].epochs;
    }
    for (const auto& [key, epoch] : other.epochs) merge_epoch(epochs[key], epoch);
    for (const auto& [name, from] : other.measurements) {
        MeasurementStatistics& to = measurements[name];
        to.nis.add(from.nis);
        to.dof.add(from.dof);
        to.lag1.add(from.lag1);
        to.accepted += from.accepted;
        to.rejected += from.rejected;
    }
    if (outages.size() < other.outages.size()) outages.resize(other.outages.size());
    for (std::size_t k = 0; k < other.outages.size(); ++k) {
        OutageOfRuns& to = outages[k];
        const OutageOfRuns& from = other.outages[k];
        if (from.runs == 0) continue;
        to.start_s = to.runs == 0 ? from.start_s : std::min(to.start_s, from.start_s);
        to.duration_s = std::max(to.duration_s, from.duration_s);
        for (std::size_t i = 0; i < to.size.size(); ++i) merge_values(to.size[i], from.size[i]);
        to.runs += from.runs;
        to.inside += from.inside;
    }
    for (const auto& [point, from] : other.points) merge_point(points[point], from);
    failures.insert(other.failures.begin(), other.failures.end());
    keep_lowest(failures);
    warnings.merge(other.warnings);
}

analysis::EnsembleConsistency CampaignStatistics::consistency(std::size_t b) const {
    const double dof = solution::state_block_names()[b].dof;
    analysis::EnsembleConsistency out;
    out.expected = dof;
    const NeesOfRuns& of = nees[b];
    if (of.runs == 0) return out;
    const auto n = static_cast<double>(of.runs);
    out.mean = of.sum.value() / n;
    out.worth = 1.0;
    if (of.runs > 2) {
        const double scatter = std::max(0.0, of.square.value() - n * out.mean * out.mean) / (n - 1.0);
        out.worth = std::clamp(2.0 * dof / scatter, 1.0, std::max(1.0, static_cast<double>(of.epochs) / n));
    }
    const analysis::Bounds whole = analysis::mean_bounds(dof, out.worth * n);
    out.low95 = whole.low95;
    out.high95 = whole.high95;
    double inside = 0.0, counted = 0.0;
    for (const auto& [key, epoch] : epochs) {
        if (epoch.block[b].empty() || epoch.block[b].front().settled == 0) continue;
        const auto m = static_cast<double>(epoch.block[b].front().settled);
        const double mean = epoch.block[b].front().settled_nees.value() / m;
        const analysis::Bounds bounds = analysis::mean_bounds(dof, m);
        inside += mean >= bounds.low95 && mean <= bounds.high95 ? 1.0 : 0.0;
        counted += 1.0;
    }
    out.inside = inside / counted;
    return out;
}

}  // namespace schuler::study
