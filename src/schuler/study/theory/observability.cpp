#include "schuler/study/theory/observability.h"

#include "schuler/core/units.h"
#include "schuler/gravimetry/observability.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outcome.h"
#include "schuler/report/result_table.h"
#include "schuler/study/parts.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace schuler::study {
namespace {

using gravimetry::Observability;
using gravimetry::ObservedMotion;

ObservedMotion motion_of(const ObservabilityRequest& r) {
    ObservedMotion m;
    m.start = {r.latitude_deg * units::deg, r.longitude_deg * units::deg, r.height};
    m.v_eb_n = {r.vn, r.ve, r.vd};
    m.rpy.z() = r.heading_deg * units::deg;
    m.heading_rate = r.turn_deg_s * units::deg;
    m.random_rate = r.correlation_time != 0.0 ? 1.0 / r.correlation_time : 0.0;
    m.degree = r.polynomial;
    m.frozen = r.frozen;
    m.rhumb = r.rhumb;
    return m;
}

std::string text_of(const gravimetry::SeenCombination& c) {
    std::string out = "  " + c.state;
    for (const auto& [name, coefficient] : c.with)
        out += fmt::format(" {} {} {}", coefficient < 0.0 ? "-" : "+", short_number(std::abs(coefficient), 4), name);
    return out + "\n";
}

std::string tables_of(const ObservabilityRequest& r, const Observability& o) {
    std::string out = fmt::format("rank {} of {} ({}), position and velocity fixes\n", o.rank, o.states,
                                  r.tolerance > 0.0 ? fmt::format("pivots from {:g} on count", r.tolerance) : "exact");
    out += fmt::format("pivots: {} .. {}, the next is {}\n", short_number(o.pivots.front(), 4), short_number(o.pivots.back(), 4),
                       short_number(o.next, 2));
    out += "what is seen (SI units; Earth-fixed axes, sensor errors in body axes)\n";
    for (const gravimetry::SeenCombination& c : o.combinations) out += text_of(c);
    return out;
}

report::Json json_of(const Observability& o) {
    report::Json combinations = report::Json::array();
    for (const gravimetry::SeenCombination& c : o.combinations) {
        report::Json with = report::Json::object();
        for (const auto& [name, coefficient] : c.with) with[name] = coefficient;
        combinations.push_back({{"state", c.state}, {"with", with}});
    }
    return {{"rank", o.rank}, {"states", o.states}, {"pivots", o.pivots}, {"next_pivot", o.next}, {"combinations", combinations}};
}

/// Paper E's cases and additional ones that explain them.
report::Json papers_cases(const ObservabilityRequest& r, std::string& text) {
    struct Case {
        const char* name;
        const char* paper;
        double v;
        double tolerance;
        bool frozen, rhumb;
    };
    constexpr std::array cases{Case{"at rest", "15", 0.0, 0.0, false, false},
                               Case{"1 m/s north and east, pivots from 1e-7 on", "18", 1.0, 1e-7, false, false},
                               Case{"1 m/s north and east, exact", "", 1.0, 0.0, false, false},
                               Case{"constant course against north, exact", "", 1.0, 0.0, false, true},
                               Case{"model frozen", "", 1.0, 0.0, true, false}};
    report::ResultTable table{"paper E, section on observability; constant disturbance",
                              {{"case", "case"}, {"rank", "rank"}, {"paper", "paper"}}};
    for (const Case& c : cases) {
        ObservabilityRequest one = r;
        one.vn = one.ve = c.v;
        one.polynomial = 0;
        one.frozen = c.frozen;
        one.rhumb = c.rhumb;
        const Observability o = gravimetry::observability({}, motion_of(one), c.tolerance);
        table.rows.push_back({c.name, o.rank, c.paper});
    }
    text += report::table_text(table);
    return report::table_json(table);
}

}  // namespace

report::Outcome analyze_observability(const ObservabilityRequest& r) {
    const ObservabilityRequest usual;
    const char* of_scenario = !r.above.empty() ? "--set" : r.seed ? "--seed" : r.rate != usual.rate ? "--rate" : nullptr;
    if (of_scenario != nullptr)
        throw input_error("belongs to the path of a scenario", {.file = {}, .key = of_scenario},
                          "name the scenario file, or leave it out");
    return with_option_names([&] {
        check_finite({{"latitude-deg", r.latitude_deg},
                      {"longitude-deg", r.longitude_deg},
                      {"height", r.height},
                      {"vn", r.vn},
                      {"ve", r.ve},
                      {"vd", r.vd},
                      {"heading-deg", r.heading_deg},
                      {"turn-deg-s", r.turn_deg_s},
                      {"correlation-time", r.correlation_time},
                      {"tolerance", r.tolerance}});
        const Observability o = gravimetry::observability({}, motion_of(r), r.tolerance);
        report::Outcome out;
        out.tables = tables_of(r, o);
        report::Json document = json_of(o);
        if (r.paper) document["paper"] = papers_cases(r, out.tables);
        out.json = document.dump(2) + "\n";
        return out;
    });
}

}  // namespace schuler::study
