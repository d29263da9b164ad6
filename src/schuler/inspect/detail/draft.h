// The dataset.toml being drafted: keys with how sure they are, in the order a reader wants.
#pragma once

#include <string>
#include <vector>

namespace schuler::inspect::detail {

class Draft {
public:
    /// Fixes the place of a section; empty ones are not written.
    void begin(const std::string& section_name) { (void)section(section_name); }
    /// `value` is TOML ("\"frd\"", "0.12"); keys that are not active are written as comments.
    void set(const std::string& section, const std::string& key, const std::string& value, const std::string& comment = {},
             bool active = true);
    /// A comment line of its own.
    void note(const std::string& section, const std::string& text);
    /// The whole section is written as comments.
    void leave_out(const std::string& section);
    [[nodiscard]] bool has(const std::string& section) const;
    [[nodiscard]] std::string text() const;

private:
    struct Line {
        std::string key, value, comment;
        bool active;
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

/// A TOML basic string of any text.
[[nodiscard]] std::string toml_string(const std::string& text);

}  // namespace schuler::inspect::detail
