// The dataset.toml being drafted: keys with their confidence, in the order of presentation.
#pragma once

#include "schuler/core/fact.h"

#include <string>
#include <vector>

namespace schuler::inspect::detail {

class Draft {
public:
    /// Defines the position of a section; empty ones are not written.
    void begin(const std::string& section_name) { (void)section(section_name); }
    /// Inactive keys are written as comments. `how`: found in the data, or stated by a file; `sigma`: of a number.
    void set(const std::string& section, const std::string& key, FactValue value, const std::string& comment = {},
             bool active = true, Known how = Known::Found, double sigma = not_given);
    /// A separate comment line.
    void note(const std::string& section, const std::string& text);
    /// Writes the whole section as comments.
    void leave_out(const std::string& section);
    [[nodiscard]] bool has(const std::string& section) const;
    [[nodiscard]] std::string text() const;
    /// The active keys, as "section.key"; the interval of the evidence is set by the caller.
    [[nodiscard]] std::vector<Fact> facts() const;

private:
    struct Line {
        std::string key;
        FactValue value;
        std::string comment;
        bool active = true;
        Known how = Known::Found;
        double sigma = not_given;
    };
    struct Section {
        std::string name;
        std::vector<Line> lines;
        bool left_out = false;
    };
    Section& section(const std::string& name);
    std::vector<Section> sections_;
};

/// "sure", "likely", "probably" or "a guess" for a confidence of 0 to 1.
[[nodiscard]] const char* how_sure(double confidence);

}  // namespace schuler::inspect::detail
