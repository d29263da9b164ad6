#include "schuler/report/report.h"

#include "schuler/report/detail/markup.h"
#include "schuler/report/detail/page_assets.h"
#include "schuler/report/detail/panel.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace schuler::report {
namespace {

using detail::anchor;
using io::xml_text;
using Out = std::back_insert_iterator<std::string>;

void append_table(std::string& out, const TableBlock& table) {
    const std::size_t columns = table.columns.size();
    std::vector<bool> numeric;
    for (std::size_t c = 0; c < columns; ++c) numeric.push_back(detail::numeric_column(table, c));
    const auto alignment = [&numeric](std::size_t c) { return numeric[c] ? " class=\"n\"" : ""; };
    out += "<div class=\"table\"><table>";
    if (!table.title.empty()) fmt::format_to(Out(out), "<caption>{}</caption>", xml_text(table.title));
    out += "<thead><tr>";
    for (std::size_t c = 0; c < columns; ++c) {
        fmt::format_to(Out(out), "<th scope=\"col\"{}>{}</th>", alignment(c), xml_text(table.columns[c]));
    }
    out += "</tr></thead><tbody>";
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
        const auto& row = table.rows[r];
        out += "<tr>";
        for (std::size_t c = 0; c < columns; ++c) {
            std::string cell = c < row.size() ? xml_text(row[c]) : "";
            if (c == 0 && r < table.links.size() && !table.links[r].empty())
                cell = fmt::format("<a href=\"{}\">{}</a>", xml_text(table.links[r]), cell);
            if (c == 0) fmt::format_to(Out(out), "<th scope=\"row\"{}>{}</th>", alignment(c), cell);
            else fmt::format_to(Out(out), "<td{}>{}</td>", alignment(c), cell);
        }
        out += "</tr>";
    }
    out += "</tbody></table></div>\n";
}

void append_group(std::string& out, const Group& group, int& figures) {
    if (!group.title.empty()) fmt::format_to(Out(out), "<h3>{}</h3>\n", xml_text(group.title));
    if (!group.panels.empty()) {
        out += "<div class=\"panels\">\n";
        for (const Panel& panel : group.panels) out += detail::figure(panel, ++figures) + "\n";
        out += "</div>\n";
    }
    if (!group.tables.empty()) {
        out += "<div class=\"tables\">\n";
        for (const TableBlock& table : group.tables) append_table(out, table);
        out += "</div>\n";
    }
}

void append_head(std::string& out, const ReportInput& input) {
    fmt::format_to(Out(out),
                   "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>"
                   "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>"
                   "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
                   "script-src 'unsafe-inline'\"/><title>{}</title><style>\n{}</style></head>\n<body>",
                   xml_text(input.title), detail::embedded_file("page.css"));
    // The hatching of outages, for all plots.
    out +=
        "<svg width=\"0\" height=\"0\" style=\"position:absolute\" aria-hidden=\"true\"><defs><pattern id=\"hatch\" "
        "patternUnits=\"userSpaceOnUse\" width=\"7\" height=\"7\" patternTransform=\"rotate(45)\"><path d=\"M0 0v7\"/></pattern>"
        "</defs></svg>\n";
}

void append_header(std::string& out, const ReportInput& input) {
    fmt::format_to(Out(out), "<div class=\"page\"><header><h1>{}</h1>", xml_text(input.title));
    if (!input.subtitle.empty()) fmt::format_to(Out(out), "<p class=\"subtitle\">{}</p>", xml_text(input.subtitle));
    if (!input.cards.empty()) {
        out += "<dl class=\"cards\">";
        for (const Card& card : input.cards) {
            fmt::format_to(Out(out), "<div><dt>{}</dt><dd>{}</dd>", xml_text(card.label), xml_text(card.value));
            if (!card.note.empty()) fmt::format_to(Out(out), "<dd class=\"note\">{}</dd>", xml_text(card.note));
            out += "</div>";
        }
        out += "</dl>";
    }
    out += "</header>\n";
}

void append_navigation(std::string& out, const ReportInput& input) {
    out += "<nav aria-label=\"Contents\"><ul>";
    int number = 0;
    const auto link = [&](const std::string& title) {
        ++number;
        fmt::format_to(Out(out), "<li><a href=\"#{}\">{}</a></li>", anchor(title, number), xml_text(title));
    };
    for (const Section& section : input.sections) link(section.title);
    link("Warnings");
    if (!input.settings.empty()) link("Settings");
    out += "</ul></nav>\n";
}

void append_sections(std::string& out, const ReportInput& input) {
    int number = 0, figures = 0;
    const auto open = [&](const std::string& title) {
        ++number;
        fmt::format_to(Out(out), "<section id=\"{}\"><h2>{}</h2>\n", anchor(title, number), xml_text(title));
    };
    for (const Section& section : input.sections) {
        open(section.title);
        if (!section.intro.empty()) fmt::format_to(Out(out), "<p>{}</p>\n", xml_text(section.intro));
        for (const Group& group : section.groups) append_group(out, group, figures);
        out += "</section>\n";
    }
    open("Warnings");
    if (input.warnings.empty()) {
        out += "<p>None.</p>";
    } else {
        out += "<ul class=\"warnings\">";
        for (const std::string& warning : input.warnings) fmt::format_to(Out(out), "<li>{}</li>", xml_text(warning));
        out += "</ul>";
    }
    out += "</section>\n";
    if (input.settings.empty()) return;
    open("Settings");
    // Focusable, to permit scrolling with keys.
    fmt::format_to(Out(out), "<pre tabindex=\"0\">{}</pre></section>\n", xml_text(input.settings));
}

}  // namespace

std::string render(const ReportInput& input) {
    std::string out;
    append_head(out, input);
    append_header(out, input);
    append_navigation(out, input);
    out +=
        "<main><p class=\"hint hidden\">Point at a plot to read values; drag to zoom (time plots zoom together), <kbd>Ctrl</kbd> "
        "or "
        "<kbd>Shift</kbd> with the wheel zooms at the pointer, a double click resets; a click in a legend hides a curve. With "
        "the "
        "keyboard: arrows, <kbd>+</kbd>, <kbd>-</kbd>, <kbd>Esc</kbd>.</p>\n";
    append_sections(out, input);
    fmt::format_to(Out(out), "</main><footer>Schuler {}</footer></div>\n<script>//<![CDATA[\n{}//]]></script></body></html>\n",
                   xml_text(input.version), detail::embedded_file("page.js"));
    return out;
}

}  // namespace schuler::report
