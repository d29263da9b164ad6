// docs/files.md and `schuler help formats`, from the tables used by the readers.
#include "schuler/io/formats.h"
#include "schuler/io/text/detail/column_dictionary.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace schuler::io {
namespace {

using detail::Dimension;
using detail::Quantity;

/// "x y | z" as "x, y; guessed: z".
std::string listed(const std::string& stems) {
    std::string clear, guessed;
    bool behind = false;
    std::string word;
    for (const char c : stems + " ") {
        if (c != ' ') {
            word += c;
            continue;
        }
        if (word == "|") {
            behind = true;
        } else if (!word.empty()) {
            std::string& to = behind ? guessed : clear;
            to += fmt::format("{}`{}`", to.empty() ? "" : ", ", word);
        }
        word.clear();
    }
    if (guessed.empty()) return clear;
    return fmt::format("{}{}by themselves a guess: {}", clear, clear.empty() ? "" : "; ", guessed);
}

std::string columns_of(TableKind kind) {
    std::string out = "\n| column | names that mean it, before the unit |\n|---|---|\n";
    std::vector<std::string> done;
    for (const Quantity& q : detail::quantities(kind)) {
        std::string note;
        if (q.sign < 0.0) note = ", with the other sign";
        if (q.height != HeightKind::Unstated) note += fmt::format(", {}", name_of(q.height));
        // components that differ only in their axis share a row
        out += fmt::format("| `{}`{} | {} |\n", q.canonical, note, listed(q.stems));
    }
    return out;
}

std::string units_table() {
    static constexpr std::array names = {std::pair(Dimension::Time, "time"),
                                         std::pair(Dimension::Angle, "angle"),
                                         std::pair(Dimension::Length, "length"),
                                         std::pair(Dimension::Rate, "turn rate"),
                                         std::pair(Dimension::Acceleration, "acceleration"),
                                         std::pair(Dimension::Velocity, "velocity"),
                                         std::pair(Dimension::Pressure, "pressure"),
                                         std::pair(Dimension::Field, "magnetic field"),
                                         std::pair(Dimension::Temperature, "temperature")};
    std::string out = "| quantity | units in names, in brackets, or in a line of units below the header |\n|---|---|\n";
    for (const auto& [dimension, name] : names) {
        std::string units;
        for (const std::string& unit : detail::unit_names(dimension))
            units += fmt::format("{}`{}`", units.empty() ? "" : ", ", unit);
        out += fmt::format("| {} | {} |\n", name, units);
    }
    return out;
}

std::string doors(const Format& f) {
    return f.recognise != nullptr && f.write != nullptr ? "read, written" : f.write != nullptr ? "written" : "read";
}

constexpr std::string_view introduction = R"(# Files

This page is made by the program (`ctest -R io.FormatsDocument` compares it; to renew it: `SCHULER_UPDATE=1`). `schuler help formats` is the short form,
`schuler inspect FILE` says what a file is taken for, `--explain` with every column. Mistakes and their messages: [own-data.md](own-data.md).

A file is recognised by its content: by marks of its own first, tables of text by the names of their columns, tables without names by their values. What is
not certain is "unknown": a trajectory is never taken for an IMU, a setpoint never for a measurement. Files may be compressed (`.gz`). A folder
is one recording; where nothing usable lies in it, its folders are looked through, those of these are not. Lines that begin with `#`, `%` or `//`, also in
quotation marks, are comments of a table, between the rows too. A column `gps_week` beside seconds of the week dates a log.

A log of several instruments has a *stream* each, named behind its file: `[imu] file = "flight.ulg#imu1"`. `schuler convert flight.ulg FOLDER` writes every
stream as a table, `schuler convert flight.ulg#imu imu.csv` one of them. Axes are forward-right-down where the format fixes them; axes of tables,
bags and MAT-files are found from the data, or given by `[imu] axes`.

## Formats

| name | format | usual names | | what is read | times |
|---|---|---|---|---|---|
)";

constexpr std::string_view codes = R"(
## Fix codes
A column `fix` has words (none, autonomous, differential, rtk_float, rtk_fixed and their usual synonyms) or numbers: of NMEA (0 none, 1 autonomous, 2 differential,
4 fixed, 5 float), RTKLIB (1 fixed, 2 float, 3 and 4 differential, 5 single), u-blox and MAVLink (0 and 1 none, 2 and 3 autonomous, 4 differential, 5 float, 6 fixed):
which, its name and the codes that occur decide, and `inspect` says it. `[gnss] fix_codes = { "7" = "rtk_fixed" }` gives others.

## Times
Whole nanoseconds inside. The unit is the name's (`time_us`, `timestamp [ns]`); where it does not say one, the steps of the rows decide, with a warning. What the numbers count
from is found ([found.md](found.md)) or given: `[time] scale = "gps"`, `"utc"`, `"boot"`, `"relative"`.
)";

}  // namespace

std::string formats_document() {
    std::string out(introduction);
    for (const Format* f : formats())
        out += fmt::format("| `{}` | {} | `{}` | {} | {} | {} |\n", f->name, f->title, f->extensions, doors(*f), f->holds,
                           f->time.empty() ? "-" : f->time);
    out +=
        "\n## Columns of tables\nNames are compared without case, as words: `GyroX`, `gyro.x` and `IMU::Gyro::X` are `gyro_x`. Words of origin before a name (`imu`, `gps`, `onboard`, ...) are "
        "passed over. Any other name: `[imu] columns = { gyro_x_rad_s = \"NAME\" }`, and factors: `scale = { gyro_rad_s = 0.01745 }`.\n\n" +
        units_table();
    static constexpr std::array kinds = {std::pair(TableKind::Imu, "IMU"),
                                         std::pair(TableKind::Gnss, "GNSS"),
                                         std::pair(TableKind::Baro, "Barometer"),
                                         std::pair(TableKind::Mag, "Magnetometer"),
                                         std::pair(TableKind::Reference, "Reference and trajectories"),
                                         std::pair(TableKind::Ranges, "Ranges"),
                                         std::pair(TableKind::Stations, "Stations")};
    for (const auto& [kind, title] : kinds) out += fmt::format("\n### {}\n{}", title, columns_of(kind));
    return out + std::string(codes);
}

std::string formats_text() {
    std::string out = "Formats of files (docs/files.md has the columns of tables)\n\n";
    for (const Format* f : formats()) {
        out += fmt::format("  {:<13} {} ({})  {}\n", f->name, f->title, f->extensions, doors(*f));
        if (f->holds == "-") continue;
        std::string words(f->holds), line = "               ";
        std::erase(words, '`');
        for (std::size_t at = 0; at < words.size();) {
            const std::size_t end = std::min(words.find(' ', at), words.size());
            if (line.size() + end - at > 118) {
                out += line + "\n";
                line = "               ";
            }
            line += " " + words.substr(at, end - at);
            at = end + 1;
        }
        out += line + "\n";
    }
    return out;
}

}  // namespace schuler::io
