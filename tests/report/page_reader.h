// Reads a page as the tests need it: are the tags balanced, which elements are there, what does a path draw. Written for the
// tests alone, so that what writes the page and what checks it share nothing.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace page_reader {

struct Element {
    std::string tag;
    std::map<std::string, std::string> attributes;
    std::string text;  ///< direct text content, references not resolved
};

struct Page {
    std::vector<Element> elements;  ///< in document order
    std::string problem;            ///< empty where the page is well-formed
};

inline bool bare_ampersand(const std::string& text) {
    for (std::size_t i = text.find('&'); i != std::string::npos; i = text.find('&', i + 1)) {
        const std::string end = text.substr(i, 6);
        bool reference = false;
        for (const char* r : {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"}) reference = reference || end.starts_with(r);
        if (!reference) return true;
    }
    return false;
}

// Attributes of the inside of a tag; sets problem where one is not name="value" or comes twice.
inline std::map<std::string, std::string> read_attributes(const std::string& inside, std::string& problem) {
    std::map<std::string, std::string> out;
    std::size_t i = inside.find(' ');
    while (i != std::string::npos) {
        i = inside.find_first_not_of(" \n", i);
        if (i == std::string::npos || inside[i] == '/') break;
        const std::size_t equals = inside.find('=', i);
        if (equals == std::string::npos || equals + 1 >= inside.size() || inside[equals + 1] != '"') {
            problem = "attribute without a quoted value: <" + inside + ">";
            break;
        }
        const std::size_t close = inside.find('"', equals + 2);
        if (close == std::string::npos) {
            problem = "attribute value without end: <" + inside + ">";
            break;
        }
        const std::string value = inside.substr(equals + 2, close - equals - 2);
        if (bare_ampersand(value) || value.find('<') != std::string::npos) problem = "unescaped attribute: " + value;
        if (!out.emplace(inside.substr(i, equals - i), value).second) problem = "attribute twice: <" + inside + ">";
        i = close + 1;
    }
    return out;
}

inline Page read(const std::string& html) {
    Page page;
    std::vector<std::size_t> open;
    std::size_t i = html.starts_with("<!DOCTYPE html>") ? 15 : 0;
    while (i < html.size() && page.problem.empty()) {
        if (html.compare(i, 9, "<![CDATA[") == 0) {
            i = html.find("]]>", i);
            if (i == std::string::npos) page.problem = "CDATA without end";
            else i += 3;
        } else if (html[i] != '<') {
            const std::size_t next = std::min(html.find('<', i), html.size());
            const std::string text = html.substr(i, next - i);
            if (bare_ampersand(text)) page.problem = "bare ampersand: " + text.substr(0, 80);
            if (!open.empty()) page.elements[open.back()].text += text;
            else if (text.find_first_not_of(" \n") != std::string::npos) page.problem = "text outside the root: " + text;
            i = next;
        } else {
            // The writer escapes a closing bracket in values; one that is not would show as a problem here.
            const std::size_t close = html.find('>', i);
            if (close == std::string::npos) {
                page.problem = "tag without end";
                break;
            }
            std::string inside = html.substr(i + 1, close - i - 1);
            i = close + 1;
            if (inside.starts_with("/")) {
                const std::string tag = inside.substr(1);
                if (open.empty() || page.elements[open.back()].tag != tag) {
                    page.problem = "</" + tag + "> closes " + (open.empty() ? "nothing" : page.elements[open.back()].tag);
                } else {
                    open.pop_back();
                }
                continue;
            }
            Element element{inside.substr(0, inside.find_first_of(" \n/")), read_attributes(inside, page.problem), ""};
            page.elements.push_back(std::move(element));
            if (!inside.ends_with("/")) open.push_back(page.elements.size() - 1);
        }
    }
    if (page.problem.empty() && !open.empty()) page.problem = "<" + page.elements[open.back()].tag + "> is not closed";
    return page;
}

inline std::string attribute(const Element& e, const std::string& name) {
    const auto it = e.attributes.find(name);
    return it == e.attributes.end() ? "" : it->second;
}

inline std::vector<Element> with_class(const Page& page, const std::string& name) {
    std::vector<Element> out;
    for (const Element& e : page.elements) {
        if ((" " + attribute(e, "class") + " ").find(" " + name + " ") != std::string::npos) out.push_back(e);
    }
    return out;
}

/// Runs of points of a path of M, l, h and z, in the numbers of the path.
inline std::vector<std::vector<std::pair<double, double>>> path_runs(const std::string& d) {
    std::vector<std::vector<std::pair<double, double>>> runs;
    const char* p = d.c_str();
    char command = ' ';
    while (*p != '\0') {
        if (*p == 'M' || *p == 'l' || *p == 'h' || *p == 'z') command = *p++;
        if (command == 'z') continue;
        char* end = nullptr;
        const double first = std::strtod(p, &end);
        p = end;
        if (command == 'h') continue;
        const double second = std::strtod(p, &end);
        p = end;
        if (command == 'M') runs.push_back({{first, second}});
        else runs.back().push_back({runs.back().back().first + first, runs.back().back().second + second});
        while (*p == ' ') ++p;
    }
    return runs;
}

}  // namespace page_reader
