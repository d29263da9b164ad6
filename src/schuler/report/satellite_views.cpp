#include "schuler/report/satellite_views.h"

#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/math/quantile.h"
#include "schuler/report/carrier.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/result_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

namespace schuler::report {
namespace {

using dataset::SatelliteViews;
using gnss::EpochView;
using gnss::Fate;
using gnss::SatelliteView;

/// Root mean square of the added values.
class Squares {
public:
    void add(double x) {
        if (!std::isfinite(x)) return;
        sum_ += x;
        squares_ += x * x;
        ++count_;
    }
    [[nodiscard]] double mean() const { return count_ > 0 ? sum_ / static_cast<double>(count_) : not_given; }
    [[nodiscard]] double rms() const { return count_ > 0 ? std::sqrt(squares_ / static_cast<double>(count_)) : not_given; }

private:
    double sum_ = 0.0, squares_ = 0.0;
    std::size_t count_ = 0;
};

/// A field of a table; empty if there is no value.
void field(std::string& text, double x, int decimals) {
    if (std::isfinite(x)) fmt::format_to(std::back_inserter(text), ",{:.{}f}", x, decimals);
    else text += ',';
}

Time time_of(const EpochView& e) { return e.solution.status == gnss::SinglePointStatus::Solved ? e.solution.time : e.tag; }
bool solved(const EpochView& e) { return e.solution.status == gnss::SinglePointStatus::Solved; }

/// A position with sigmas and velocity in local axes.
struct LocalSolution {
    Geodetic position{not_given, not_given, not_given};
    Eigen::Vector3d std_position = not_given3(), velocity = not_given3(), std_velocity = not_given3();
};
LocalSolution local(const Ecef& position, const Eigen::Matrix3d& covariance, const Eigen::Vector3d& velocity,
                    const Eigen::Matrix3d& of_velocity) {
    LocalSolution out;
    out.position = earth::geodetic_from_ecef(earth::wgs84, position);
    const Eigen::Matrix3d C_ne = earth::C_en(out.position.lat, out.position.lon).transpose();
    out.std_position = (C_ne * covariance * C_ne.transpose()).diagonal().cwiseSqrt();
    if (!velocity.allFinite()) return out;
    out.velocity = C_ne * velocity;
    out.std_velocity = (C_ne * of_velocity * C_ne.transpose()).diagonal().cwiseSqrt();
    return out;
}

void solution_fields(std::string& text, const LocalSolution& s) {
    field(text, s.position.lat / units::deg, 10);
    field(text, s.position.lon / units::deg, 10);
    field(text, s.position.h, 4);
    for (const auto& [v, decimals] : {std::pair{s.velocity, 4}, std::pair{s.std_position, 4}, std::pair{s.std_velocity, 4}})
        for (int i = 0; i < 3; ++i) field(text, v[i], decimals);
}

/// The carrier-phase epoch of a tag; null if there is none. Tags are in time order.
class CarrierAt {
public:
    explicit CarrierAt(const SatelliteViews& views) : carrier_(views.carrier ? &*views.carrier : nullptr) {}
    const ppk::EpochSolution* operator()(Time tag) {
        if (carrier_ == nullptr) return nullptr;
        while (next_ < carrier_->epochs.size() && carrier_->epochs[next_].tag < tag) ++next_;
        return next_ < carrier_->epochs.size() && carrier_->epochs[next_].tag == tag ? &carrier_->epochs[next_] : nullptr;
    }

private:
    const dataset::CarrierPhase* carrier_;
    std::size_t next_ = 0;
};

/// Totals of all epochs for the summary.
struct Totals {
    std::map<gnss::SinglePointStatus, std::size_t> by_status;
    std::array<std::size_t, gnss::fate_count> fates{};
    std::vector<double> used, gdop, pdop, hdop, vdop, hpl, vpl;
    std::vector<double> north, east, down, std_north, std_east, std_down;  ///< from the first solution, m
    std::optional<Geodetic> first;
    std::map<ppk::Quality, std::size_t> by_quality;
    std::size_t slips = 0;
};

Totals totals_of(const SatelliteViews& views) {
    Totals t;
    Eigen::Matrix3d C_ne;
    Ecef origin;
    for (const EpochView& e : views.epochs) {
        ++t.by_status[e.solution.status];
        for (const SatelliteView& v : e.satellites) ++t.fates[static_cast<std::size_t>(v.fate)];
        t.used.push_back(e.solution.used());
        if (!solved(e)) continue;
        t.gdop.push_back(e.dilution.geometry);
        t.pdop.push_back(e.dilution.position);
        t.hdop.push_back(e.dilution.horizontal);
        t.vdop.push_back(e.dilution.vertical);
        t.hpl.push_back(e.protection.horizontal);
        t.vpl.push_back(e.protection.vertical);
        if (!t.first) {
            origin = e.solution.position;
            t.first = earth::geodetic_from_ecef(earth::wgs84, origin);
            C_ne = earth::C_en(t.first->lat, t.first->lon).transpose();
        }
        const Eigen::Vector3d d = C_ne * (e.solution.position.r - origin.r),
                              s = (C_ne * e.solution.covariance * C_ne.transpose()).diagonal().cwiseSqrt();
        t.north.push_back(d[0]);
        t.east.push_back(d[1]);
        t.down.push_back(d[2]);
        t.std_north.push_back(s[0]);
        t.std_east.push_back(s[1]);
        t.std_down.push_back(s[2]);
    }
    if (views.carrier) {
        for (const ppk::EpochSolution& e : views.carrier->epochs) ++t.by_quality[e.quality];
        for (const std::vector<bool>& epoch : slips_of(*views.carrier))
            t.slips += static_cast<std::size_t>(std::ranges::count(epoch, true));
    }
    return t;
}

/// The median position, and its spread compared with the stated sigma.
struct MedianPlace {
    Geodetic position;
    Eigen::Vector3d spread, sigma;  ///< north, east, down, m
};
std::optional<MedianPlace> median_place(const Totals& t) {
    if (!t.first) return std::nullopt;
    const Eigen::Matrix3d C_en = earth::C_en(t.first->lat, t.first->lon);
    MedianPlace out;
    const Eigen::Vector3d middle(math::median(t.north), math::median(t.east), math::median(t.down));
    out.position = earth::geodetic_from_ecef(earth::wgs84, {earth::ecef_from_geodetic(earth::wgs84, *t.first).r + C_en * middle});
    const auto spread = [](const std::vector<double>& x, double from) {
        Squares s;
        for (const double v : x) s.add(v - from);
        return s.rms();
    };
    out.spread = {spread(t.north, middle[0]), spread(t.east, middle[1]), spread(t.down, middle[2])};
    out.sigma = {math::median(t.std_north), math::median(t.std_east), math::median(t.std_down)};
    return out;
}

std::string reasons_of(const SatelliteSummary& s) {
    std::string out;
    for (std::size_t f = 1; f < gnss::fate_count; ++f)
        if (s.fates[f] > 0)
            out += fmt::format("{}{} {}", out.empty() ? "" : ", ", gnss::name_of(static_cast<Fate>(f)), s.fates[f]);
    return out;
}

ResultTable table_of_satellites(const SatelliteViews& views) {
    // clang-format off
    std::vector<ColumnOf<SatelliteSummary>> columns{
        {{"", "satellite"}, [](const SatelliteSummary& s) { return Cell(gnss::name_of(s.satellite)); }},
        {{"", "epochs"}, [](const SatelliteSummary& s) { return Cell(s.seen); }},
        {{"", "used"}, [](const SatelliteSummary& s) { return Cell(s.fates[0]); }},
        {{"", "C/N0", "dB-Hz"}, [](const SatelliteSummary& s) { return Cell(s.cn0); }},
        {{"", "mean", "m"}, [](const SatelliteSummary& s) { return Cell(s.mean); }},
        {{"", "RMS", "m"}, [](const SatelliteSummary& s) { return Cell(s.rms); }},
        {{"", "RMS/sigma"}, [](const SatelliteSummary& s) { return Cell(s.normalised); }},
        {{"", "rate", "m/s"}, [](const SatelliteSummary& s) { return Cell(s.rate_rms); }}};
    if (views.carrier) columns.push_back({{"", "slips"}, [](const SatelliteSummary& s) { return Cell(s.slips); }});
    columns.push_back({{"", "not used"}, [](const SatelliteSummary& s) { return Cell(reasons_of(s)); }});
    // clang-format on
    return table_of<SatelliteSummary>("", columns, satellites_of(views));
}

}  // namespace

std::vector<std::vector<bool>> slips_of(const dataset::CarrierPhase& carrier) {
    std::map<std::pair<gnss::SatelliteId, char>, std::pair<int, int>> before;
    std::vector<std::vector<bool>> out;
    for (const ppk::EpochSolution& e : carrier.epochs) {
        std::vector<bool>& epoch = out.emplace_back();
        for (const ppk::SignalView& s : e.signals) {
            const std::pair arcs{s.rover_arc, s.base_arc};
            const auto [it, fresh] = before.try_emplace({s.satellite, s.band}, arcs);
            epoch.push_back(!fresh && it->second != arcs);
            it->second = arcs;
        }
    }
    return out;
}

std::vector<SatelliteSummary> satellites_of(const SatelliteViews& views) {
    struct Gathered {
        SatelliteSummary summary;
        std::vector<double> cn0;
        Squares residual, normalised, rate;
    };
    std::map<gnss::SatelliteId, Gathered> all;
    for (const EpochView& e : views.epochs) {
        for (const SatelliteView& v : e.satellites) {
            Gathered& g = all[v.satellite];
            ++g.summary.seen;
            ++g.summary.fates[static_cast<std::size_t>(v.fate)];
            if (std::isfinite(v.cn0)) g.cn0.push_back(v.cn0);
            if (v.fate != Fate::Used) continue;
            g.residual.add(v.residual);
            g.normalised.add(v.residual / v.sigma);
            g.rate.add(v.rate_residual);
        }
    }
    if (views.carrier) {
        const auto slips = slips_of(*views.carrier);
        for (std::size_t i = 0; i < slips.size(); ++i)
            for (std::size_t k = 0; k < slips[i].size(); ++k)
                if (slips[i][k]) ++all[views.carrier->epochs[i].signals[k].satellite].summary.slips;
    }
    std::vector<SatelliteSummary> out;
    for (auto& [id, g] : all) {
        g.summary.satellite = id;
        g.summary.cn0 = math::median(std::move(g.cn0));
        g.summary.mean = g.residual.mean();
        g.summary.rms = g.residual.rms();
        g.summary.normalised = g.normalised.rms();
        g.summary.rate_rms = g.rate.rms();
        out.push_back(g.summary);
    }
    return out;
}

std::string gnss_csv(const SatelliteViews& views) {
    std::string text =
        "time_s,q,lat_deg,lon_deg,height_m,vel_n_m_s,vel_e_m_s,vel_d_m_s,std_n_m,std_e_m,std_d_m,std_vn_m_s,std_ve_m_s,std_vd_m_s,"
        "status,seen,used,faulty,gdop,pdop,hdop,vdop,tdop,statistic,redundancy,protection_horizontal_m,protection_vertical_m,clock_m,drift_m_s";
    text += views.carrier ? ",ratio,success_rate,ambiguities,integers,age_s\n" : "\n";
    CarrierAt carrier_at(views);
    for (const EpochView& e : views.epochs) {
        const gnss::SinglePointSolution& s = e.solution;
        const ppk::EpochSolution* c = carrier_at(e.tag);
        const bool phase = c != nullptr && (c->quality == ppk::Quality::Fixed || c->quality == ppk::Quality::Float);
        LocalSolution place;
        if (phase) place = local(c->position, c->covariance, c->velocity, c->velocity_covariance);
        else if (solved(e)) place = local(s.position, s.covariance, s.velocity, s.velocity_covariance);
        fmt::format_to(std::back_inserter(text), "{:.9f},{}", (phase ? c->time : time_of(e)).seconds(),
                       phase       ? quality_number(c->quality)
                       : solved(e) ? quality_number(ppk::Quality::Single)
                                   : 0);
        solution_fields(text, place);
        fmt::format_to(std::back_inserter(text), ",{},{},{},{}", gnss::name_of(s.status), e.satellites.size(), s.used(),
                       s.excluded());
        for (const double x :
             {e.dilution.geometry, e.dilution.position, e.dilution.horizontal, e.dilution.vertical, e.dilution.time})
            field(text, x, 3);
        field(text, solved(e) ? s.statistic : not_given, 3);
        fmt::format_to(std::back_inserter(text), ",{}", s.redundancy);
        field(text, e.protection.horizontal, 2);
        field(text, e.protection.vertical, 2);
        const auto clock = std::ranges::find_if(s.clock, [](double x) { return std::isfinite(x); });
        field(text, clock == s.clock.end() ? not_given : *clock, 3);
        field(text, s.drift, 4);
        if (views.carrier && c != nullptr)
            fmt::format_to(std::back_inserter(text), ",{:.1f},{:.6f},{},{},{:.3f}", c->ratio, c->success, c->ambiguities,
                           c->fixed, c->age);
        else if (views.carrier) text += ",,,,,";
        text += '\n';
    }
    return text;
}

std::string satellites_csv(const SatelliteViews& views) {
    std::string text = "time_s,satellite,signal,azimuth_deg,elevation_deg,cn0_db_hz,used,reason\n";
    for (const EpochView& e : views.epochs) {
        for (const SatelliteView& v : e.satellites) {
            fmt::format_to(std::back_inserter(text), "{:.9f},{},{}{}", time_of(e).seconds(), gnss::name_of(v.satellite),
                           v.signal.band, v.signal.attribute);
            const double azimuth = v.direction.azimuth / units::deg;
            field(text, azimuth < 0.0 ? azimuth + 360.0 : azimuth, 2);
            field(text, v.direction.elevation / units::deg, 2);
            field(text, v.cn0, 1);
            fmt::format_to(std::back_inserter(text), ",{},{}\n", v.fate == Fate::Used ? 1 : 0,
                           v.fate == Fate::Used ? "" : gnss::name_of(v.fate));
        }
    }
    return text;
}

std::string residuals_csv(const SatelliteViews& views) {
    std::string text = "time_s,satellite,signal,quantity,residual,sigma,used,whole,slip\n";
    const auto row = [&text](Time t, gnss::SatelliteId id, std::string_view signal, std::string_view quantity, double residual,
                             double sigma, bool used) {
        fmt::format_to(std::back_inserter(text), "{:.9f},{},{},{},{:.4f},{:.4f},{}", t.seconds(), gnss::name_of(id), signal,
                       quantity, residual, sigma, used ? 1 : 0);
    };
    for (const EpochView& e : views.epochs) {
        for (const SatelliteView& v : e.satellites) {
            const std::string signal{v.signal.band, v.signal.attribute};
            for (const auto& [quantity, residual, sigma] :
                 {std::tuple{"code_m", v.residual, v.sigma}, std::tuple{"rate_m_s", v.rate_residual, v.rate_sigma}}) {
                if (!std::isfinite(residual)) continue;
                row(time_of(e), v.satellite, signal, quantity, residual, sigma, v.fate == Fate::Used);
                text += ",,\n";
            }
        }
    }
    if (!views.carrier) return text;
    const auto slips = slips_of(*views.carrier);
    for (std::size_t i = 0; i < slips.size(); ++i) {
        const ppk::EpochSolution& e = views.carrier->epochs[i];
        for (std::size_t k = 0; k < e.signals.size(); ++k) {
            const ppk::SignalView& s = e.signals[k];
            const std::string band(1, s.band);
            if (std::isfinite(s.code)) {
                row(e.time, s.satellite, band, "difference_code_m", s.code, s.code_sigma, s.code_used);
                text += ",,\n";
            }
            row(e.time, s.satellite, band, "difference_phase_m", s.phase, s.phase_sigma, true);
            fmt::format_to(std::back_inserter(text), ",{},{}\n", s.whole ? 1 : 0, slips[i][k] ? 1 : 0);
        }
    }
    return text;
}

std::string satellite_json(const SatelliteReportInput& in) {
    const SatelliteViews& views = *in.views;
    const Totals t = totals_of(views);
    Json j;
    j["name"] = in.name;
    j["command"] = "gnss";
    j["version"] = in.version;
    j["epochs"] = views.epochs.size();
    for (const gnss::SinglePointStatus s : {gnss::SinglePointStatus::Solved, gnss::SinglePointStatus::TooFew,
                                            gnss::SinglePointStatus::WeakGeometry, gnss::SinglePointStatus::Inconsistent}) {
        const auto it = t.by_status.find(s);
        j["status"][std::string(gnss::name_of(s))] = it == t.by_status.end() ? 0 : it->second;
    }
    j["duration_s"] = (views.epochs.back().tag - views.epochs.front().tag).seconds();
    if (const auto place = median_place(t)) {
        const auto axes = [](const Eigen::Vector3d& v) {
            return Json{{"north", json_number(v[0])}, {"east", json_number(v[1])}, {"down", json_number(v[2])}};
        };
        j["position"] = {{"lat_deg", place->position.lat / units::deg},
                         {"lon_deg", place->position.lon / units::deg},
                         {"height_m", place->position.h}};
        j["sigma_m"] = axes(place->sigma);
        j["spread_m"] = axes(place->spread);
    } else {
        j["position"] = j["sigma_m"] = j["spread_m"] = nullptr;
    }
    j["used_satellites"] = {{"median", json_number(math::median(t.used))}, {"least", json_number(math::quantile(t.used, 0.0))}};
    j["dop"] = {{"geometry", json_number(math::median(t.gdop))},
                {"position", json_number(math::median(t.pdop))},
                {"horizontal", json_number(math::median(t.hdop))},
                {"vertical", json_number(math::median(t.vdop))}};
    j["protection"] = {{"horizontal_m", json_number(math::median(t.hpl))},
                       {"vertical_m", json_number(math::median(t.vpl))},
                       {"false_alarm", in.false_alarm},
                       {"missed_detection", in.missed_detection}};
    if (views.carrier) {
        const auto count = [&t](ppk::Quality q) { return t.by_quality.contains(q) ? t.by_quality.at(q) : 0; };
        // clang-format off
        j["carrier"] = {{"epochs", views.carrier->epochs.size()}, {"fixed", count(ppk::Quality::Fixed)}, {"float", count(ppk::Quality::Float)},
                        {"single", count(ppk::Quality::Single)}, {"slips", t.slips}};
        // clang-format on
    } else {
        j["carrier"] = nullptr;
    }
    j["satellites"] = Json::array();
    for (const SatelliteSummary& s : satellites_of(views)) {
        Json row{{"satellite", gnss::name_of(s.satellite)}, {"epochs", s.seen}};
        for (std::size_t f = 0; f < gnss::fate_count; ++f) {
            std::string key(gnss::name_of(static_cast<Fate>(f)));
            std::ranges::replace(key, ' ', '_');
            row[key] = s.fates[f];
        }
        row["cn0_db_hz"] = json_number(s.cn0);
        row["mean_m"] = json_number(s.mean);
        row["rms_m"] = json_number(s.rms);
        row["normalised_rms"] = json_number(s.normalised);
        row["rate_rms_m_s"] = json_number(s.rate_rms);
        row["slips"] = views.carrier ? Json(s.slips) : Json(nullptr);
        j["satellites"].push_back(std::move(row));
    }
    j["warnings"] = in.warnings;
    return text_of(j);
}

std::string satellite_text(const SatelliteReportInput& in) {
    const SatelliteViews& views = *in.views;
    const Totals t = totals_of(views);
    std::string text = fmt::format("{}: {} epochs over {:.1f} s", in.name, views.epochs.size(),
                                   (views.epochs.back().tag - views.epochs.front().tag).seconds());
    for (const auto& [status, count] : t.by_status) text += fmt::format(", {} {}", count, gnss::name_of(status));
    text += "\n";
    if (const auto place = median_place(t)) {
        text += fmt::format("median position {:.8f}, {:.8f} deg, height {:.3f} m\n", place->position.lat / units::deg,
                            place->position.lon / units::deg, place->position.h);
        text += fmt::format(
            "sigma of an epoch (north, east, down): {:.2f}, {:.2f}, {:.2f} m; spread around the median: {:.2f}, {:.2f}, {:.2f} m\n",
            place->sigma[0], place->sigma[1], place->sigma[2], place->spread[0], place->spread[1], place->spread[2]);
    }
    text += fmt::format("satellites used: median {:.0f}, least {:.0f}; DOP: {} position, {} horizontal, {} vertical\n",
                        math::median(t.used), math::quantile(t.used, 0.0), table_cell(math::median(t.pdop)),
                        table_cell(math::median(t.hdop)), table_cell(math::median(t.vdop)));
    text += fmt::format(
        "protection level: {} m horizontal, {} m vertical (median; one fault, false alarm {:g}, missed detection {:g})\n",
        table_cell(math::median(t.hpl)), table_cell(math::median(t.vpl)), in.false_alarm, in.missed_detection);
    if (views.carrier) {
        text += "against the base:";
        for (const auto& [quality, name] : {std::pair{ppk::Quality::Fixed, "fixed"}, std::pair{ppk::Quality::Float, "float"},
                                            std::pair{ppk::Quality::Single, "without the base"}})
            text += fmt::format(" {} {},", t.by_quality.contains(quality) ? t.by_quality.at(quality) : 0, name);
        text += fmt::format(" {} phase arcs restarted\n", t.slips);
    }
    return text + "\n" + table_text(table_of_satellites(views));
}

TableBlock satellite_table(const SatelliteViews& views) { return table_block(table_of_satellites(views)); }

}  // namespace schuler::report
