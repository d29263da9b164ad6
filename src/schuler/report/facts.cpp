#include "schuler/report/facts.h"

#include "schuler/report/inner/json.h"
#include "schuler/solution/provenance.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>
#include <utility>

namespace schuler::report {
namespace {

struct ToJson {
    template <class T>
    Json operator()(const T& x) const {
        return Json(x);
    }
    Json operator()(double x) const { return json_number(x); }
};

Json text_or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

}  // namespace

Json facts_json(const std::vector<Fact>& facts) {
    Json list = Json::array();
    for (const Fact& f : facts) {
        list.push_back({{"key", f.key},
                        {"value", std::visit(ToJson{}, f.value)},
                        {"unit", text_or_null(unit_of_key(f.key))},
                        {"how", std::string(name_of(f.how))},
                        {"sigma", json_number(f.sigma)},
                        {"from_s", json_number(f.from)},
                        {"to_s", json_number(f.to)},
                        {"note", text_or_null(f.note)}});
    }
    return list;
}

std::string unit_of_key(const std::string& key) {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 14> units{{{"_deg_sqrt_h", "deg/sqrt(h)"},
                                                                                          {"_m_s_sqrt_h", "m/s/sqrt(h)"},
                                                                                          {"_deg_sqrt_s", "deg/sqrt(s)"},
                                                                                          {"_deg_h", "deg/h"},
                                                                                          {"_deg_s", "deg/s"},
                                                                                          {"_m_s2", "m/s2"},
                                                                                          {"_m_s", "m/s"},
                                                                                          {"_ppm", "ppm"},
                                                                                          {"_deg", "deg"},
                                                                                          {"_mg", "mg"},
                                                                                          {"_pa", "Pa"},
                                                                                          {"_hz", "Hz"},
                                                                                          {"_m", "m"},
                                                                                          {"_s", "s"}}};
    for (const auto& [end, unit] : units)
        if (key.ends_with(end)) return std::string(unit);
    return {};
}

std::string fact_text(const Fact& fact) {
    const auto short_number = [](double x) { return fmt::format("{:.4g}", x == 0.0 ? 0.0 : x); };
    std::string text;
    if (const double* x = std::get_if<double>(&fact.value)) {
        text = study::short_number(*x);
    } else if (const auto* list = std::get_if<std::vector<double>>(&fact.value)) {
        for (const double item : *list) text += (text.empty() ? "" : ", ") + study::short_number(item);
        text = "[" + text + "]";
    } else {
        text = to_text(fact.value);
    }
    if (std::isfinite(fact.sigma)) text += fmt::format(" +- {:.2g}", fact.sigma);
    const std::string unit = unit_of_key(fact.key);
    return unit.empty() ? text : text + " " + unit;
}

std::string facts_table(const std::vector<Fact>& facts, bool notes) {
    std::string out;
    for (const Fact& fact : facts) {
        if (!solution::is_news(fact)) continue;
        const std::string span = std::isfinite(fact.from) ? fmt::format("  {:.0f} to {:.0f} s", fact.from, fact.to) : std::string();
        out += fmt::format("  {:<6} {:<30} {}{}\n", name_of(fact.how), fact.key, fact_text(fact), span);
        if (notes && !fact.note.empty()) out += fmt::format("  {:<6} {:<30}   {}\n", "", "", fact.note);
    }
    return out.empty() ? out : "what the data are (given, stated by a file, found in the data)\n" + out;
}

}  // namespace schuler::report
