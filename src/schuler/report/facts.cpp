#include "schuler/report/facts.h"

#include "schuler/report/inner/json.h"
#include "schuler/settings/units_of_keys.h"
#include "schuler/solution/provenance.h"

#include <fmt/format.h>

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
                        {"unit", text_or_null(std::string(settings::unit_of_key(f.key).plain))},
                        {"how", std::string(name_of(f.how))},
                        {"sigma", json_number(f.sigma)},
                        {"from_s", json_number(f.from)},
                        {"to_s", json_number(f.to)},
                        {"note", text_or_null(f.note)}});
    }
    return list;
}

std::string fact_text(const Fact& fact) {
    const auto short_number = [](double x) { return fmt::format("{:.4g}", x == 0.0 ? 0.0 : x); };
    std::string text;
    if (const double* x = std::get_if<double>(&fact.value)) {
        text = short_number(*x);
    } else if (const auto* list = std::get_if<std::vector<double>>(&fact.value)) {
        for (const double item : *list) text += (text.empty() ? "" : ", ") + short_number(item);
        text = "[" + text + "]";
    } else {
        text = to_text(fact.value);
    }
    if (std::isfinite(fact.sigma)) text += fmt::format(" +- {:.2g}", fact.sigma);
    const std::string_view unit = settings::unit_of_key(fact.key).plain;
    return unit.empty() ? text : fmt::format("{} {}", text, unit);
}

std::string facts_table(const std::vector<Fact>& facts, bool notes) {
    std::string out;
    for (const Fact& fact : facts) {
        if (!solution::is_news(fact)) continue;
        const std::string span =
            std::isfinite(fact.from) ? fmt::format("  {:.0f} to {:.0f} s", fact.from, fact.to) : std::string();
        out += fmt::format("  {:<6} {:<30} {}{}\n", name_of(fact.how), fact.key, fact_text(fact), span);
        if (notes && !fact.note.empty()) out += fmt::format("  {:<6} {:<30}   {}\n", "", "", fact.note);
    }
    return out.empty() ? out : "what the data are (given, stated by a file, found in the data)\n" + out;
}

}  // namespace schuler::report
