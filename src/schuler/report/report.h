// One self-contained HTML page of plots and tables from plain numbers, independent of their origin.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace schuler::report {

/// Colours of Okabe and Ito (2008, "Color universal design"), distinguishable for colour-blind readers; Text follows the theme.
enum class Ink { Blue, Vermillion, Green, Purple, Orange, Sky, Text, Muted };

/// Drawing style of a series. Squares are hollow and larger than dots: visible in print and without colour.
enum class Mark { Line, Dashed, Dots, Squares };

/// One curve. x and y have the same length; an entry that is not finite is a gap in the line.
struct Series {
    std::string name;  ///< in the legend; empty: no legend entry
    std::vector<double> x, y;
    Ink ink = Ink::Blue;
    Mark mark = Mark::Line;
    double width = 1.5;          ///< px, of lines
    bool clamp = false;          ///< values beyond the y limits are drawn at the edge instead of being cut off
    std::vector<double> time{};  ///< time of each point (empty: none) on the axis of the time panels, to link their cursors
};

/// Area between lo and hi, drawn behind the series. A value that is not finite is a gap.
struct Band {
    std::string name;
    std::vector<double> x, lo, hi;
    Ink ink = Ink::Sky;
};

/// Interval of x: hatched (an outage) or shaded (a start-up).
struct Span {
    double start = 0.0, stop = 0.0;
    std::string label;
    bool hatched = true;
};

/// One plot. Labels are "quantity, unit". Without finite values the panel states that it is empty.
struct Panel {
    std::string title, x_label, y_label;
    std::vector<Series> series{};
    std::vector<Band> bands{};
    std::vector<Span> spans{};
    bool time_axis = true;    ///< x is the common time: cursors and zoom are linked with the other panels of this type
    bool equal_axes = false;  ///< equal scale on both axes (a map); with a scale bar
    bool log_y = false;       ///< values that are not positive are gaps, or at the lower edge if clamped
    std::optional<std::pair<double, double>> x_limits{};  ///< otherwise from the data; data outside are cut off
    std::optional<std::pair<double, double>> y_limits{};  ///< otherwise from the data, see data_range in detail/axis.h
    std::vector<std::pair<double, std::string>>
        row_names{};      ///< rows instead of a y scale: a text at the left edge, above that y
    double y_step = 0.0;  ///< fixed interval of the y ticks (90 deg); 0: from the range
    int height = 200;     ///< px at a width of 1100
};

/// Rows of text; a column whose cells all start like numbers is right-aligned.
struct TableBlock {
    std::string title;
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;
    std::vector<std::string> links{};  ///< of the first cell of each row, relative; empty: none
};

/// A heading of the page. A group is a subheading with its panels, followed by its tables.
struct Group {
    std::string title;  ///< may be empty
    std::vector<Panel> panels{};
    std::vector<TableBlock> tables{};
};
struct Section {
    std::string title;
    std::string intro;
    std::vector<Group> groups{};
};

struct Card {
    std::string label, value;
    std::string note{};  ///< small print under the value
};

struct ReportInput {
    std::string title, subtitle;
    std::vector<Card> cards{};
    std::vector<Section> sections{};
    std::vector<std::string> warnings{};
    std::string settings{};  ///< config.toml with the settings used
    std::string version{};
};

/// The page as UTF-8 HTML that is also well-formed XML; same input, same bytes. No network, complete without JavaScript (which
/// adds cursors, zoom and hiding of series). Each series is decimated to about 2000 points, keeping extremes. Bytes that are not
/// UTF-8 and control characters in texts become U+FFFD. Throws Error(Input) if x and y of a series differ in length.
[[nodiscard]] std::string render(const ReportInput& input);

/// v with the given number of significant digits, without exponent from 1e-4 to 1e7; "–" if v is not finite.
[[nodiscard]] std::string number(double v, int significant = 4);

}  // namespace schuler::report
